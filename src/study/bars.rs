//! What the terminal shows of a study under way: a line per running case, and one for all of them. Without a terminal
//! there is a line per case that has ended.

use super::plan::{Case, Plan};
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// Thousandths of a case.
const WHOLE: u64 = 1000;

/// The lines.
pub struct Bars {
    lines: MultiProgress,
    all: ProgressBar,
    quiet: bool,
}

impl Bars {
    /// The lines of so many cases.
    pub fn new(cases: usize, quiet: bool) -> Self {
        let shown = !quiet && std::io::stderr().is_terminal();
        let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let lines = MultiProgress::with_draw_target(target);
        let style = "{spinner} {pos} of {len} cases, {elapsed} so far, {eta} left";
        let all = lines.add(ProgressBar::new(cases as u64).with_style(style_of(style)));
        all.enable_steady_tick(Duration::from_millis(500));
        Self { lines, all, quiet }
    }

    /// The line of a case that begins.
    pub fn start(&self, plan: &Plan, case: &Case) -> ProgressBar {
        let bar = ProgressBar::new(WHOLE).with_style(style_of("{bar:30} {percent} % of case {msg}"));
        let bar = self.lines.insert_before(&self.all, bar);
        bar.set_message(format!("{:04}, {}, seed {}", case.number, plan.shown(case.setting), case.seed));
        bar
    }

    /// A case has ended: how, in words.
    pub fn end(&self, what: &str) {
        self.all.inc(1);
        if self.quiet {
            return;
        }
        let text = format!("[{}/{}] {what}", self.all.position(), self.all.length().unwrap_or(0));
        if self.lines.is_hidden() {
            let left_s = self.all.elapsed().as_secs_f64() / self.all.position() as f64
                * (self.all.length().unwrap_or(0) - self.all.position()) as f64;
            eprintln!("{text}; {left_s:.0} s left");
        } else {
            // A terminal that is gone is no reason to stop.
            let _ = self.lines.println(text);
        }
    }
}

impl Drop for Bars {
    fn drop(&mut self) {
        self.all.finish_and_clear();
    }
}

/// Takes the share of a case that is done, as the process that runs it tells it: "12.5 60" seconds.
pub fn advance(bar: &ProgressBar, line: &str) {
    let numbers: Vec<f64> = line.split_whitespace().filter_map(|number| number.parse().ok()).collect();
    if let [done_s, all_s] = numbers[..]
        && all_s > 0.0
    {
        bar.set_position((done_s / all_s * WHOLE as f64) as u64);
    }
}

fn style_of(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("a valid template")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_moves_the_bar_and_nonsense_does_not() {
        let bar = ProgressBar::hidden();
        bar.set_length(WHOLE);
        advance(&bar, "15 60");
        assert_eq!(bar.position(), 250);
        for nonsense in ["", "30", "30 0", "a b", "30 60 90"] {
            advance(&bar, nonsense);
            assert_eq!(bar.position(), 250, "{nonsense}");
        }
    }
}
