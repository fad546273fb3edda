//! The progress bar: simulated time, egos, real-time factor. On stderr, and only if that is a terminal.

use super::session::Session;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};

/// Time between two updates.
const EVERY: Duration = Duration::from_millis(100);

/// A bar, or nothing.
pub struct Progress {
    bar: Option<ProgressBar>,
    begin_s: f64,
    started: Instant,
    shown: std::cell::Cell<Instant>,
}

impl Progress {
    /// A bar from now to the end of the session; a spinner without an end.
    pub fn new(wanted: bool, session: &Session) -> Self {
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
        Self { bar, begin_s, started: now, shown: std::cell::Cell::new(now) }
    }

    /// Shows where the run is, now and then.
    pub fn show(&self, session: &Session) {
        let Some(bar) = self.bar.as_ref().filter(|_| self.shown.get().elapsed() >= EVERY) else { return };
        self.shown.set(Instant::now());
        let simulated_s = session.time_s() - self.begin_s;
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
