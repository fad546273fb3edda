//! Where time goes. The only clock below the modules that may touch clocks: it is read to be shown to people, never to
//! decide anything, so no result can depend on it. Off, a lap costs one branch.

use std::time::{Duration, Instant};

/// Time by part of a job; `PARTS` parts, known by number.
#[derive(Debug, Clone, Copy)]
pub struct Stopwatch<const PARTS: usize> {
    since: Option<Instant>,
    spent: [Duration; PARTS],
}

impl<const PARTS: usize> Stopwatch<PARTS> {
    /// A stopwatch that runs, or one that stays at zero.
    pub fn new(on: bool) -> Self {
        Self { since: on.then(Instant::now), spent: [Duration::ZERO; PARTS] }
    }

    /// True if it runs.
    pub fn is_on(&self) -> bool {
        self.since.is_some()
    }

    /// Forgets the time since the last lap.
    pub fn start(&mut self) {
        if let Some(since) = &mut self.since {
            *since = Instant::now();
        }
    }

    /// Books the time since the last lap, or since [`Stopwatch::start`], on a part.
    pub fn lap(&mut self, part: usize) {
        if let Some(since) = &mut self.since {
            let now = Instant::now();
            self.spent[part] += now - *since;
            *since = now;
        }
    }

    /// Time by part.
    pub fn spent(&self) -> [Duration; PARTS] {
        self.spent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lap_is_booked_on_its_part_only_while_the_watch_runs() {
        let pause = Duration::from_millis(3);
        let mut watch = Stopwatch::<2>::new(true);
        std::thread::sleep(pause);
        watch.start();
        watch.lap(0);
        std::thread::sleep(pause);
        watch.lap(1);
        let [first, second] = watch.spent();
        assert!(first < pause && second >= pause, "{first:?} {second:?}");

        let mut off = Stopwatch::<1>::new(false);
        off.start();
        off.lap(0);
        assert!(!off.is_on());
        assert_eq!(off.spent(), [Duration::ZERO]);
    }
}
