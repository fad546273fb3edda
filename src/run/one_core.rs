//! SUMO and this program on one core. With few vehicles the two work in turns, for some hundredths of a millisecond each,
//! and most of a step is the waking of a core that has gone to sleep meanwhile. On one core nobody sleeps, and nothing
//! has to be woken. Where others need the core, or the two have work at the same time, that is slower. So both ways are
//! tried by turns while the run goes on, and the faster one is kept for a while. No result depends on it.

use super::session::Session;
use rustix::thread::{CpuSet, Pid, sched_getaffinity, sched_getcpu, sched_setaffinity};
use std::path::PathBuf;
use std::time::Duration;

/// Steps on one core or on all, in a trial.
const WINDOW: usize = 20;
/// Windows of a trial, on all cores and on one by turns.
const WINDOWS: usize = 6;
/// Steps from one trial to the next.
const KEPT: usize = 2_000;
/// What waking costs is not seen in longer steps.
const LONG: Duration = Duration::from_millis(1);
/// One core must win by this factor.
const GAIN: f64 = 0.95;

/// Where SUMO and the thread that steps it may run.
pub(super) struct OneCore {
    sumo: Pid,
    /// The cores that both were given.
    given: CpuSet,
    /// Both are on one of them.
    is_placed: bool,
    trial: Trial,
}

impl OneCore {
    /// For a session with a SUMO that it has started, called in the thread that will step it; `None` where there is
    /// nothing to choose. Whoever commands a group may have threads of its own, which would inherit the one core.
    pub fn of(session: &Session) -> Option<Self> {
        let sumo = i32::try_from(session.sumo_id()?).ok().and_then(Pid::from_raw)?;
        let given = sched_getaffinity(None).ok()?;
        // Somebody who has chosen cores for SUMO, in a script around it, knows why.
        let chosen = sched_getaffinity(Some(sumo)).ok()? != given;
        let is_free = given.count() > 1 && !chosen && !session.world().fleet().has_group_law();
        is_free.then_some(Self { sumo, given, is_placed: false, trial: Trial::default() })
    }

    /// A step has taken this long. Where that changes, both are placed anew.
    pub fn stepped(&mut self, took: Duration) {
        match self.trial.stepped(took) {
            // Threads that SUMO makes inherit its core: with more than one it is left alone.
            Some(true) if self.threads_of_sumo().count() == 1 => {
                let mut one = CpuSet::new();
                one.set(sched_getcpu());
                self.place(&one);
                self.is_placed = true;
            }
            Some(_) => self.release(),
            None => {}
        }
    }

    fn release(&mut self) {
        if std::mem::take(&mut self.is_placed) {
            self.place(&self.given);
        }
    }

    fn threads_of_sumo(&self) -> impl Iterator<Item = Pid> {
        let folder = PathBuf::from(format!("/proc/{}/task", self.sumo.as_raw_pid()));
        let names = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.file_name());
        names.filter_map(|name| Pid::from_raw(name.to_str()?.parse().ok()?))
    }

    /// A SUMO that has ended, or a system that declines, leaves all as it is.
    fn place(&self, cores: &CpuSet) {
        for thread in self.threads_of_sumo() {
            let _ = sched_setaffinity(Some(thread), cores);
        }
        let _ = sched_setaffinity(None, cores);
    }
}

impl Drop for OneCore {
    fn drop(&mut self) {
        self.release();
    }
}

/// What steps take on one core and on all.
#[derive(Default)]
struct Trial {
    /// Where the two are.
    on_one: bool,
    /// Steps since the trial began.
    steps: usize,
    /// What they took on all cores, and on one.
    taken: [Vec<Duration>; 2],
}

impl Trial {
    /// Notes a step. True or false if the next one is to be made on one core, or on all; `None` if that does not change.
    fn stepped(&mut self, took: Duration) -> Option<bool> {
        let before = self.on_one;
        if self.steps < WINDOWS * WINDOW {
            self.taken[usize::from(before)].push(took);
        }
        self.steps += 1;
        self.on_one = match self.steps {
            WINDOW if median(&mut self.taken[0]) > LONG => self.end(false),
            steps if steps < WINDOWS * WINDOW => (steps / WINDOW) % 2 == 1,
            steps if steps == WINDOWS * WINDOW => {
                let [all, one] = &mut self.taken;
                let pays = median(one).as_secs_f64() < GAIN * median(all).as_secs_f64();
                self.end(pays)
            }
            steps if steps < KEPT => before,
            _ => {
                self.steps = 0;
                false
            }
        };
        (self.on_one != before).then_some(self.on_one)
    }

    /// The trial is over.
    fn end(&mut self, on_one: bool) -> bool {
        self.taken.iter_mut().for_each(Vec::clear);
        self.steps = WINDOWS * WINDOW;
        on_one
    }
}

fn median(taken: &mut [Duration]) -> Duration {
    let middle = taken.len() / 2;
    *taken.select_nth_unstable(middle).1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps on one core in so many steps, if they take this long there and on all cores [µs].
    fn steps_on_one(steps: usize, [one_us, all_us]: [u64; 2]) -> usize {
        let (mut trial, mut on_one) = (Trial::default(), false);
        let mut count = 0;
        for _ in 0..steps {
            count += usize::from(on_one);
            let took = Duration::from_micros(if on_one { one_us } else { all_us });
            on_one = trial.stepped(took).unwrap_or(on_one);
        }
        count
    }

    #[test]
    fn the_faster_way_is_kept_and_tried_again() {
        let tried = WINDOWS / 2 * WINDOW;
        assert_eq!(steps_on_one(KEPT, [100, 200]), KEPT - tried, "one core pays");
        assert_eq!(steps_on_one(KEPT, [200, 100]), tried, "it does not");
        assert_eq!(steps_on_one(KEPT, [98, 100]), tried, "a difference that is chance");
        assert_eq!(steps_on_one(10 * KEPT, [100, 200]), 10 * (KEPT - tried));
    }

    #[test]
    fn long_steps_are_never_made_on_one_core() {
        assert_eq!(steps_on_one(10 * KEPT, [1_000, 2_000]), 0);
    }
}
