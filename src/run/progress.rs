//! How far a run is: a bar with simulated time, egos and real-time factor on stderr, if that is a terminal; or for the
//! study that it is a case of, "12.5 60" seconds on its standard output.

use super::session::Session;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::Write;
use std::time::{Duration, Instant};

/// Time between two updates.
const EVERY: Duration = Duration::from_millis(200);

/// A bar, or nothing.
pub struct Progress {
    bar: Option<ProgressBar>,
    to_study: bool,
    begin_s: f64,
    started: Instant,
    shown: std::cell::Cell<Instant>,
}

impl Progress {
    /// A bar from now to the end of the session; a spinner without an end.
    pub fn new(wanted: bool, to_study: bool, session: &Session) -> Self {
        let begin_s = session.time_s();
        let bar = wanted.then(|| {
            let (length, template) = match session.end_s() {
                Some(end_s) => (Some((end_s - begin_s).max(0.0) as u64), "{wide_bar} {pos}/{len} s, {msg}"),
                None => (None, "{spinner} {pos} s, {msg}"),
            };
            let bar = ProgressBar::with_draw_target(length, ProgressDrawTarget::stderr());
            bar.with_style(ProgressStyle::with_template(template).expect("a valid template"))
        });
        let now = Instant::now();
        Self { bar, to_study, begin_s, started: now, shown: std::cell::Cell::new(now) }
    }

    /// Shows where the run is, now and then.
    pub fn show(&self, session: &Session) {
        if self.shown.get().elapsed() < EVERY {
            return;
        }
        self.shown.set(Instant::now());
        let simulated_s = session.time_s() - self.begin_s;
        if let (true, Some(end_s)) = (self.to_study, session.end_s()) {
            // The study may be gone; then the run ends in another way.
            let _ = writeln!(std::io::stdout(), "{simulated_s} {}", end_s - self.begin_s);
        }
        let Some(bar) = &self.bar else { return };
        let factor = simulated_s / self.started.elapsed().as_secs_f64();
        bar.set_position(simulated_s as u64);
        bar.set_message(format!("{} egos, {factor:.1} x real time", session.world().egos().len()));
    }
}

/// Takes the bar away.
impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
