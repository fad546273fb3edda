//! Whether what an ego does can be. Its settings are legal and its numbers finite, so nothing breaks off; but what no road
//! vehicle does is told, one line for each kind, with the vehicle in which it is worst.

use crate::fleet::block::Block;
use crate::plant::FASTEST_MPS;
use std::sync::Arc;

/// A larger speed error is more than the whole speed of any car on a road [m/s].
pub const ERROR_MPS: f64 = 100.0;
/// Who is asked to brake at least this hard [m/s²] ...
pub const BRAKING_MPS2: f64 = 1.0;
/// ... for longer than this \[s\] without a pause, while it drives at more than this [m/s] ...
pub const BRAKING_S: f64 = 4.0;
/// As [`BRAKING_S`].
pub const MOVING_MPS: f64 = 5.0;
/// ... and loses less than this share of what the weakest such braking costs, has hardly any brakes. On ice, where tyres
/// hold 1 m/s², it loses all of it.
pub const LOST_SHARE: f64 = 0.25;
/// Body and SUMO's car count distances in the same way. A step of 1 s by Euler's rule makes them differ by some metres for
/// each stop; this is another way \[m\], or one of this share.
pub const GAP_M: f64 = 1000.0;
/// As [`GAP_M`], of a shorter way: this length and this share of it.
pub const SHORT_GAP: (f64, f64) = (100.0, 0.1);

/// Something that cannot be, and when \[s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct At<T> {
    time_s: f64,
    found: T,
}

/// A time in which SUMO asked for braking in every step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Braking {
    lasted_s: f64,
    from_mps: f64,
    to_mps: f64,
}

/// What is watched while an ego drives.
#[derive(Debug, Clone, Copy, Default)]
pub struct Watch {
    /// The braking that SUMO is asking for.
    braking: Option<Braking>,
    /// The largest error beyond [`ERROR_MPS`] [m/s].
    error: Option<At<f64>>,
    /// The longest braking that came to nothing.
    weakest: Option<At<Braking>>,
}

impl Watch {
    /// The end of a step.
    pub fn note(&mut self, block: &Block, lane: usize, step_s: f64, time_s: f64) {
        self.error(block.speed_mps(lane) - block.reference_mps(lane), time_s);
        self.braking(block.asked_mps2(lane), block.speed_mps(lane), step_s, time_s);
    }

    fn error(&mut self, error_mps: f64, time_s: f64) {
        let largest = self.error.map_or(ERROR_MPS, |error| error.found.abs());
        if error_mps.abs() > largest {
            self.error = Some(At { time_s, found: error_mps });
        }
    }

    fn braking(&mut self, asked_mps2: f64, speed_mps: f64, step_s: f64, time_s: f64) {
        if asked_mps2 > -BRAKING_MPS2 || speed_mps < MOVING_MPS {
            self.braking = None;
            return;
        }
        let braking = self.braking.get_or_insert(Braking { lasted_s: 0.0, from_mps: speed_mps, to_mps: speed_mps });
        (braking.lasted_s, braking.to_mps) = (braking.lasted_s + step_s, speed_mps);
        let Braking { lasted_s, from_mps, to_mps } = *braking;
        let longest_s = self.weakest.map_or(BRAKING_S, |weakest| weakest.found.lasted_s);
        if lasted_s > longest_s && from_mps - to_mps < LOST_SHARE * BRAKING_MPS2 * lasted_s {
            self.weakest = Some(At { time_s, found: *braking });
        }
    }
}

/// The end of the record of an ego.
#[derive(Debug, Clone, Copy)]
pub struct Ending<'a> {
    /// SUMO's id.
    pub id: &'a Arc<str>,
    /// What was watched on the way.
    pub watch: &'a Watch,
    /// When \[s\].
    pub time_s: f64,
    /// Whether that is why.
    pub diverged: bool,
    /// V_x [m/s].
    pub speed_mps: f64,
    /// The distance of its body \[m\].
    pub distance_m: f64,
    /// SUMO's distance minus that \[m\].
    pub odometer_gap_m: Option<f64>,
}

/// How many egos did something, and the one in which it was worst.
#[derive(Debug, Clone)]
struct Tally<T> {
    egos: u64,
    id: Arc<str>,
    worst: At<T>,
}

fn count<T>(tally: &mut Option<Tally<T>>, id: &Arc<str>, at: At<T>, is_worse: impl Fn(&T, &T) -> bool) {
    match tally {
        None => *tally = Some(Tally { egos: 1, id: id.clone(), worst: at }),
        Some(tally) => {
            tally.egos += 1;
            if is_worse(&at.found, &tally.worst.found) {
                (tally.id, tally.worst) = (id.clone(), at);
            }
        }
    }
}

/// What was seen that cannot be.
#[derive(Debug, Clone, Default)]
pub struct Implausible {
    /// Speed when it diverged [m/s].
    diverged: Option<Tally<f64>>,
    /// Error [m/s].
    error: Option<Tally<f64>>,
    /// Braking that came to nothing.
    weakest: Option<Tally<Braking>>,
    /// Gap and distance \[m\].
    odometer: Option<Tally<[f64; 2]>>,
}

impl Implausible {
    /// Takes the end of a record.
    pub fn note(&mut self, ending: &Ending<'_>) {
        let Ending { id, watch, time_s, diverged, speed_mps, distance_m, odometer_gap_m } = *ending;
        if diverged {
            // The first one is told: whatever drives into it may follow.
            count(&mut self.diverged, id, At { time_s, found: speed_mps }, |_, _| false);
        }
        if let Some(error) = watch.error {
            count(&mut self.error, id, error, |a, b| a.abs() > b.abs());
        }
        if let Some(weakest) = watch.weakest {
            count(&mut self.weakest, id, weakest, |a, b| a.lasted_s > b.lasted_s);
        }
        let is_another_way = |gap_m: &f64| {
            let (short_m, share) = SHORT_GAP;
            gap_m.abs() > GAP_M || gap_m.abs() > short_m && gap_m.abs() > share * distance_m
        };
        if let Some(gap_m) = odometer_gap_m.filter(is_another_way) {
            count(&mut self.odometer, id, At { time_s, found: [gap_m, distance_m] }, |a, b| a[0].abs() > b[0].abs());
        }
    }

    /// What the user should be told, one line for each kind.
    pub fn notes(&self) -> impl Iterator<Item = String> {
        let diverged = self.diverged.as_ref().map(|Tally { egos, id, worst: At { time_s, found } }| {
            format!(
                "{egos} egos diverged (a state that is no number, or more than {FASTEST_MPS} m/s); the first, \"{id}\" at {time_s} s: \
                 V_x = {found:.1} m/s"
            )
        });
        let error = self.error.as_ref().map(|Tally { egos, id, worst: At { time_s, found } }| {
            format!(
                "implausible: {egos} egos had a speed error of more than {ERROR_MPS} m/s; the worst, \"{id}\" at {time_s} s: \
                 {found:+.1} m/s"
            )
        });
        let weakest = self.weakest.as_ref().map(|Tally { egos, id, worst: At { time_s, found } }| {
            let Braking { lasted_s, from_mps, to_mps } = found;
            format!(
                "implausible: {egos} egos hardly braked; the worst, \"{id}\" up to {time_s} s: asked to brake for {lasted_s:.1} s \
                 without a pause, it came from {from_mps:.1} to {to_mps:.1} m/s (its brake torque, friction and dead time allow no more)"
            )
        });
        let odometer = self.odometer.as_ref().map(|Tally { egos, id, worst: At { time_s, found: [gap, distance] } }| {
            format!(
                "implausible: {egos} egos drove another distance than SUMO's vehicles; the worst, \"{id}\" at {time_s} s: \
                 odometer gap {gap:+.0} m after {distance:.0} m"
            )
        });
        [diverged, error, weakest, odometer].into_iter().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ended(watch: &Watch, diverged: bool, distance_m: f64, odometer_gap_m: f64) -> Vec<String> {
        let mut implausible = Implausible::default();
        for (id, scale) in [("a", 1.0), ("b", 2.0), ("c", 0.5)] {
            let (id, odometer_gap_m) = (Arc::from(id), Some(scale * odometer_gap_m));
            let (time_s, speed_mps) = (60.0, f64::INFINITY);
            implausible.note(&Ending { id: &id, watch, time_s, diverged, speed_mps, distance_m, odometer_gap_m });
        }
        implausible.notes().collect()
    }

    /// A second of error, request and speed after the other.
    fn driven(steps: impl IntoIterator<Item = [f64; 3]>) -> Watch {
        let mut watch = Watch::default();
        for (k, [error_mps, asked_mps2, speed_mps]) in steps.into_iter().enumerate() {
            watch.error(error_mps, k as f64);
            watch.braking(asked_mps2, speed_mps, 1.0, k as f64);
        }
        watch
    }

    #[test]
    fn what_any_vehicle_may_do_is_not_told() {
        let told = |watch: &Watch, distance_m, gap_m| ended(watch, false, distance_m, gap_m);
        assert_eq!(told(&driven((0..9).map(|k| [99.0 * f64::from(k % 3 - 1), 0.0, 50.0])), 5000.0, 45.0), [""; 0]);
        assert_eq!(told(&Watch::default(), 20_000.0, 400.0), [""; 0]);
        let late = driven((0..20).map(|k| [0.0, -9.0, if k < 3 { 30.0 } else { 36.0 - 2.0 * f64::from(k) }]));
        assert_eq!(told(&late, 5000.0, 0.0), [""; 0], "a dead time of 3 s");
        let ice = driven((0..20).map(|k| [0.0, -9.0, 30.0 - 0.9 * f64::from(k)]));
        assert_eq!(told(&ice, 5000.0, 0.0), [""; 0], "ice");
        let again = driven((0..100).map(|k| [0.0, if k % 4 == 3 { 0.1 } else { -4.5 }, 20.0]));
        assert_eq!(told(&again, 5000.0, 0.0), [""; 0], "with pauses");
        let crawling = driven((0..100).map(|_| [0.0, -4.5, 0.3]));
        assert_eq!(told(&crawling, 5000.0, 0.0), [""; 0], "it nearly stands");
    }

    #[test]
    fn what_is_just_at_a_bound_is_not_beyond_it() {
        assert_eq!(ended(&driven([[ERROR_MPS, 0.0, 50.0], [-ERROR_MPS, 0.0, 50.0]]), false, 5000.0, 0.0), [""; 0]);
        assert_eq!(ended(&Watch::default(), false, 50_000.0, 0.5 * GAP_M), [""; 0], "twice that in \"b\"");
        assert_eq!(ended(&Watch::default(), false, 900.0, 0.5 * SHORT_GAP.0), [""; 0]);
        assert_eq!(ended(&Watch::default(), false, 2000.0, 100.0), [""; 0], "a tenth in \"b\"");
        let weak = driven((0..30).map(|_| [0.0, -BRAKING_MPS2, 14.0]));
        assert_eq!(ended(&weak, false, 1000.0, 0.0).len(), 1, "at least this hard");
        let slow = driven((0..30).map(|_| [0.0, -4.5, MOVING_MPS]));
        assert_eq!(ended(&slow, false, 1000.0, 0.0).len(), 1, "not slower than that");
        // In the fifth second it has lost the share, or less.
        let lost_at_last =
            |lost_mps: f64| driven((0..5).map(|k| [0.0, -4.5, if k < 4 { 14.0 } else { 14.0 - lost_mps }]));
        let share_mps = LOST_SHARE * BRAKING_MPS2 * 5.0;
        assert_eq!(ended(&lost_at_last(share_mps), false, 1000.0, 0.0), [""; 0]);
        assert_eq!(ended(&lost_at_last(0.8 * share_mps), false, 1000.0, 0.0).len(), 1);
    }

    /// Whoever comes first: the worst is told.
    #[test]
    fn law_the_worst_of_all_vehicles_is_told() {
        for order in [["mild", "worst", "odd"], ["worst", "odd", "mild"], ["odd", "mild", "worst"]] {
            let mut implausible = Implausible::default();
            for id in order {
                let (steps, error_mps): (u32, f64) = match id {
                    "worst" => (30, -190.0),
                    "odd" => (20, 160.0),
                    _ => (10, 130.0),
                };
                let watch = driven((0..steps).map(|_| [error_mps, -4.5, 14.0]));
                let (id, odometer_gap_m) = (Arc::from(id), Some(20.0 * error_mps));
                let (time_s, diverged, speed_mps, distance_m) = (60.0, false, 14.0, 100.0);
                implausible.note(&Ending {
                    id: &id,
                    watch: &watch,
                    time_s,
                    diverged,
                    speed_mps,
                    distance_m,
                    odometer_gap_m,
                });
            }
            let lines: Vec<String> = implausible.notes().collect();
            assert!(lines.len() == 3 && lines.iter().all(|line| line.contains("the worst, \"worst\"")), "{lines:?}");
        }
    }

    #[test]
    fn of_two_that_are_as_bad_the_first_is_told() {
        let watch = driven((0..30).map(|_| [150.0, -4.5, 14.0]));
        let mut implausible = Implausible::default();
        for (id, odometer_gap_m) in [("first", Some(2000.0)), ("second", Some(-2000.0))] {
            let (id, time_s, diverged, speed_mps, distance_m) = (Arc::from(id), 60.0, false, 14.0, 100.0);
            let watch = &watch;
            implausible.note(&Ending { id: &id, watch, time_s, diverged, speed_mps, distance_m, odometer_gap_m });
        }
        let lines: Vec<String> = implausible.notes().collect();
        assert!(lines.len() == 3 && lines.iter().all(|line| line.contains("the worst, \"first\"")), "{lines:?}");
    }

    #[test]
    fn each_kind_is_one_line_with_the_worst_vehicle_its_time_and_its_quantity() {
        let wild = driven([[-150.0, 0.0, 0.0], [220.04, 0.0, 0.0], [-180.0, 0.0, 0.0]]);
        assert_eq!(
            ended(&wild, false, 1000.0, 0.0),
            ["implausible: 3 egos had a speed error of more than 100 m/s; the worst, \"a\" at 1 s: +220.0 m/s"]
        );
        let weak = driven((0..30).map(|k| [0.0, -4.5, 14.0 - 0.01 * f64::from(k)]));
        let lines = ended(&weak, false, 1000.0, 0.0);
        let said = "implausible: 3 egos hardly braked; the worst, \"a\" up to 29 s: asked to brake for 30.0 s without a \
                    pause, it came from 14.0 to 13.7 m/s";
        assert!(lines.len() == 1 && lines[0].starts_with(said), "{lines:?}");
        let gap =
            "implausible: 3 egos drove another distance than SUMO's vehicles; the worst, \"b\" at 60 s: odometer gap";
        assert_eq!(ended(&Watch::default(), false, 50_000.0, -2500.0), [format!("{gap} -5000 m after 50000 m")]);
        assert_eq!(ended(&Watch::default(), false, 900.0, 250.0), [format!("{gap} +500 m after 900 m")]);
        assert_eq!(
            ended(&Watch::default(), true, 900.0, 0.0),
            [
                "3 egos diverged (a state that is no number, or more than 200 m/s); the first, \"a\" at 60 s: V_x = inf m/s"
            ]
        );
    }
}
