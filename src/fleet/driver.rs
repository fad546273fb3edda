//! The reference of a step in which SUMO leads: what SUMO's driver asks of the body, made a ramp.

use crate::columns::columns;

/// Within this time a speed that was asked for is forgotten \[s\]: longer than a body with dead time takes to swing once,
/// shorter than anybody stays at a speed that is no longer wanted.
const FORGETTING_S: f64 = 1.0;

/// A demand is beyond the body if it exceeds its limits by more than this share: limits are products of rounded numbers.
const TOLERANCE: f64 = 1e-3;

/// A step in which SUMO leads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SumoStep {
    /// SUMO's speed v* at its end [m/s].
    pub target_mps: f64,
    /// The body's speed V at its beginning, from which SUMO planned [m/s].
    pub speed_mps: f64,
    /// Its length Δt \[s\].
    pub step_s: f64,
}

/// A straight piece of reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// Where it begins [m/s].
    pub start_mps: f64,
    /// Its slope [m/s²].
    pub rate_mps2: f64,
    /// True if the reference had been too far from the body, or SUMO asks for more than the body can give.
    pub limited: bool,
}

columns! {
    /// What SUMO's drivers asked for.
    pub struct Driver {
        columns {
            /// Highest speed of late [m/s].
            highest_mps: f64 = 0.0,
            /// Lowest speed of late [m/s].
            lowest_mps: f64 = 0.0,
            /// Acceleration of the last step [m/s²].
            asked_mps2: f64 = 0.0,
            /// Largest acceleration of the body [m/s²].
            drive_mps2: f64 = f64::INFINITY,
            /// Largest deceleration of the body [m/s²].
            brake_mps2: f64 = f64::INFINITY,
        }
    }
}

impl Driver {
    /// What the body of a slot can do: its largest acceleration and deceleration [m/s²].
    pub fn set_limits(&mut self, slot: usize, [drive_mps2, brake_mps2]: [f64; 2]) {
        self.drive_mps2[slot] = drive_mps2;
        self.brake_mps2[slot] = brake_mps2;
    }

    /// The vehicle appears at this speed; nothing has been asked for yet.
    pub fn appear(&mut self, slot: usize, speed_mps: f64) {
        self.highest_mps[slot] = speed_mps;
        self.lowest_mps[slot] = speed_mps;
        self.asked_mps2[slot] = 0.0;
    }

    /// The acceleration that SUMO asked for in the last step [m/s²].
    pub fn asked_mps2(&self, slot: usize) -> f64 {
        self.asked_mps2[slot]
    }

    /// The ramp of a step from the reference's last value `reference_mps`, kept within `bound_mps` of the body.
    ///
    /// SUMO plans from the body's speed V, so what it asks for is the acceleration a* = (v* − V)/Δt, and the ramp is
    /// y_r(τ) = y_r0 + a*τ. With a ramp from V, a sluggish controller's error would be forgotten in every step and show up
    /// as lost acceleration; with dead time cars would creep.
    ///
    /// Near a speed that it wants, however, SUMO asks for v* whatever V is. Adding v* − V up would integrate the
    /// error there, and a body with dead time would swing about that speed for ever. So a speed that was asked for within
    /// about a second holds: the ramp does not leave the range of those speeds, unless v* does.
    pub fn ramp(&mut self, slot: usize, step: SumoStep, reference_mps: f64, bound_mps: f64) -> Ramp {
        let SumoStep { target_mps, speed_mps, step_s } = step;
        let start_mps = reference_mps.max(speed_mps - bound_mps).min(speed_mps + bound_mps);
        let asked_mps2 = (target_mps - speed_mps) / step_s;
        let (drive_mps2, brake_mps2) = (self.drive_mps2[slot], self.brake_mps2[slot]);
        let can_mps2 = asked_mps2.min(drive_mps2).max(-brake_mps2);
        let (highest_mps, lowest_mps) = (self.highest_mps[slot], self.lowest_mps[slot]);
        let mut end_mps = start_mps + can_mps2 * step_s;
        if asked_mps2 > 0.0 && target_mps <= highest_mps {
            end_mps = end_mps.min(highest_mps.max(start_mps));
        }
        if asked_mps2 < 0.0 && target_mps >= lowest_mps {
            end_mps = end_mps.max(lowest_mps.min(start_mps));
        }
        let forgotten = (step_s / FORGETTING_S).min(1.0);
        let towards = |known_mps: f64| known_mps + forgotten * (target_mps - known_mps);
        self.highest_mps[slot] = target_mps.max(towards(highest_mps));
        self.lowest_mps[slot] = target_mps.min(towards(lowest_mps));
        self.asked_mps2[slot] = asked_mps2;
        let beyond = (asked_mps2 - can_mps2).abs() > TOLERANCE * can_mps2.abs();
        let rate_mps2 = (end_mps - start_mps) / step_s;
        Ramp { start_mps, rate_mps2, limited: start_mps != reference_mps || beyond }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.1;

    /// Steps of a driver that asks for `ask(V)`, and of a body that has the speed `follow(reference)` at the end of each.
    fn drive(
        driver: &mut Driver,
        steps: usize,
        from_mps: f64,
        ask: impl Fn(f64) -> f64,
        mut follow: impl FnMut(f64) -> f64,
    ) -> Vec<(f64, Ramp)> {
        let (mut speed_mps, mut reference_mps) = (from_mps, from_mps);
        (0..steps)
            .map(|_| {
                let step = SumoStep { target_mps: ask(speed_mps), speed_mps, step_s: STEP_S };
                let ramp = driver.ramp(0, step, reference_mps, 1.0);
                reference_mps = ramp.start_mps + ramp.rate_mps2 * STEP_S;
                speed_mps = follow(reference_mps);
                (speed_mps, ramp)
            })
            .collect()
    }

    /// A body that has the reference's value of some steps ago: a dead time.
    fn delayed(steps: usize, from_mps: f64) -> impl FnMut(f64) -> f64 {
        let mut line = std::collections::VecDeque::from(vec![from_mps; steps]);
        move |reference_mps| {
            line.push_back(reference_mps);
            line.pop_front().unwrap()
        }
    }

    fn rolling(from_mps: f64) -> Driver {
        let mut driver = Driver::default();
        driver.appear(0, from_mps);
        driver
    }

    /// Drivers ask for V + a·Δt. Whatever share of it they leave out, a body with lag gains just as much.
    #[test]
    fn law_a_body_with_lag_loses_no_acceleration() {
        for asked_mps2 in [2.6, 1.3, 0.4] {
            let ask = |speed_mps: f64| speed_mps + asked_mps2 * STEP_S;
            let mut speed_mps = 5.0;
            let lagging = |reference_mps: f64| {
                speed_mps += (reference_mps - speed_mps) * STEP_S / 0.3;
                speed_mps
            };
            let steps = drive(&mut rolling(5.0), 60, 5.0, ask, lagging);
            let gained_mps = steps[59].0 - steps[29].0;
            assert!((gained_mps / 3.0 - asked_mps2).abs() < 1e-3 * asked_mps2, "{asked_mps2}: {gained_mps} m/s in 3 s");
        }
    }

    /// A driver who wants 10 m/s at once whenever he is slower, as SUMO's do, and a body that is late by 0.3 s.
    #[test]
    fn law_a_wanted_speed_is_reached_and_not_swung_about() {
        for from_mps in [7.0, 13.0] {
            let ask = |speed_mps: f64| (speed_mps + 0.26).min(10.0).max(speed_mps - 0.45);
            let steps = drive(&mut rolling(from_mps), 120, from_mps, ask, delayed(3, from_mps));
            let late = &steps[80..];
            assert!(late.iter().all(|(speed_mps, _)| (speed_mps - 10.0).abs() < 0.05), "{late:?}");
        }
    }

    #[test]
    fn law_no_braking_while_sumo_asks_for_more() {
        let ask = |speed_mps: f64| (speed_mps + 1.3).min(10.0);
        let mut driver = rolling(0.0);
        driver.set_limits(0, [3.0, 9.0]);
        let mut speed_mps = 0.0;
        let follow = |reference_mps: f64| {
            speed_mps = f64::min(speed_mps + 0.3, reference_mps);
            speed_mps
        };
        let steps = drive(&mut driver, 60, 0.0, ask, follow);
        assert!(steps.iter().all(|(_, ramp)| (0.0..=3.0 + 1e-9).contains(&ramp.rate_mps2)), "{steps:?}");
        assert!(steps[..30].iter().all(|(_, ramp)| ramp.limited) && !steps[59].1.limited, "{steps:?}");
        assert!(steps.iter().all(|(speed_mps, _)| *speed_mps <= 10.0) && steps[59].0 == 10.0, "{steps:?}");
    }

    #[test]
    fn the_reference_stays_near_the_body_and_that_is_counted() {
        let mut driver = rolling(10.0);
        let step = SumoStep { target_mps: 10.1, speed_mps: 10.0, step_s: STEP_S };
        assert_eq!(driver.ramp(0, step, 12.0, 1.0).start_mps, 11.0);
        assert!(driver.ramp(0, step, 12.0, 1.0).limited);
        assert!(!driver.ramp(0, step, 10.5, 1.0).limited);
        assert!((driver.asked_mps2(0) - 1.0).abs() < 1e-9);
    }
}
