//! Where the time of a run's steps goes.

use crate::cosim::World;
use crate::fleet::FleetTime;
use crate::stopwatch::Stopwatch;
use std::fmt;
use std::time::Duration;

const STEP: usize = 0;
const OUTPUT: usize = 1;

/// Takes the times while a run goes on, if it was asked to.
pub(super) struct Profiler {
    watch: Stopwatch<2>,
    waited: Duration,
    steps: u64,
    ego_steps: u64,
}

impl Profiler {
    /// A profiler at work, or one that does nothing.
    pub fn new(on: bool) -> Self {
        Self { watch: Stopwatch::new(on), waited: Duration::ZERO, steps: 0, ego_steps: 0 }
    }

    /// The first step is about to begin.
    pub fn begin(&mut self, world: &mut World) {
        if self.watch.is_on() {
            world.time_fleet();
            self.waited = world.waited();
        }
    }

    /// A step is about to begin.
    pub fn start(&mut self) {
        self.watch.start();
    }

    /// SUMO and the fleet have made a step.
    pub fn stepped(&mut self, world: &World) {
        self.watch.lap(STEP);
        self.steps += 1;
        self.ego_steps += world.egos().len() as u64;
    }

    /// The step has been written down.
    pub fn written(&mut self) {
        self.watch.lap(OUTPUT);
    }

    /// What was measured.
    pub fn profile(&self, world: &World) -> Option<Profile> {
        let [step, output] = self.watch.spent();
        let fleet = world.fleet().time_spent();
        let sumo = world.waited().saturating_sub(self.waited);
        let wire = step.saturating_sub(sumo + fleet.control + fleet.plant + fleet.statistics);
        let (steps, ego_steps) = (self.steps, self.ego_steps);
        self.watch.is_on().then_some(Profile { steps, ego_steps, sumo, wire, fleet, output })
    }
}

/// Time by part, summed over all steps; loading and the final tables are not in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Profile {
    /// SUMO steps.
    pub steps: u64,
    /// Egos, summed over the steps.
    pub ego_steps: u64,
    /// From a message's first byte to its answer's last: SUMO's own work and the socket's.
    pub sumo: Duration,
    /// Messages written and answers read, arrivals and departures: all that is left of a step.
    pub wire: Duration,
    /// Control periods of the vehicles.
    pub fleet: FleetTime,
    /// Trace and sample.
    pub output: Duration,
}

impl Profile {
    /// The parts by name, in the order of a step, with what they are.
    pub fn parts(&self) -> [(&'static str, Duration, &'static str); 6] {
        [
            ("SUMO", self.sumo, "waiting for its answers"),
            ("wire", self.wire, "messages written, answers read"),
            ("control", self.fleet.control, "measurement, law, actuators"),
            ("plant", self.fleet.plant, "steering, bodies"),
            ("statistics", self.fleet.statistics, "by control period"),
            ("output", self.output, "trace, sample"),
        ]
    }

    /// Time of all parts.
    pub fn total(&self) -> Duration {
        self.parts().iter().map(|(_, time, _)| *time).sum()
    }
}

/// A table: milliseconds per step and per cent.
impl fmt::Display for Profile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let steps = self.steps.max(1) as f64;
        let total_s = self.total().as_secs_f64();
        writeln!(f, "profile        {} steps, {:.1} egos on average", self.steps, self.ego_steps as f64 / steps)?;
        let mut row = |name: &str, time: Duration, what: &str| {
            let time_s = time.as_secs_f64();
            let percent = if total_s > 0.0 { 100.0 * time_s / total_s } else { 0.0 };
            let line = format!("  {name:10}  {:10.4} ms/step  {percent:5.1} %  {what}", 1e3 * time_s / steps);
            writeln!(f, "{}", line.trim_end())
        };
        for (name, time, what) in self.parts() {
            row(name, time, what)?;
        }
        row("total", self.total(), "")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_gives_milliseconds_per_step_and_shares() {
        let ms = Duration::from_millis;
        let fleet = FleetTime { control: ms(10), plant: ms(40), statistics: ms(5) };
        let profile = Profile { steps: 10, ego_steps: 25, sumo: ms(30), wire: ms(10), fleet, output: ms(5) };
        let text = profile.to_string();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "profile        10 steps, 2.5 egos on average");
        assert_eq!(lines[1], "  SUMO            3.0000 ms/step   30.0 %  waiting for its answers");
        assert_eq!(lines[4], "  plant           4.0000 ms/step   40.0 %  steering, bodies");
        assert!(lines[7].starts_with("  total          10.0000 ms/step  100.0 %"), "{text}");
    }
}
