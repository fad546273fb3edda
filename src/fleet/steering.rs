//! Steering by the road that the car follows, so that the lateral states of the body are excited as they would be.
//!
//! SUMO tells a heading once a step. It is the chord from front to rear bumper and jumps at the joints of the network's
//! polylines, so curvature is heading change per driven metre, smoothed over [`SMOOTHING_M`]. The road wheel angle is
//! that of the steady turn, δ = atan(Lκ) + K_us·a_y with a_y = V²κ (single-track model, ISO 8855 signs: left is positive).

use crate::columns::{Slots, columns};
use crate::lanes::{LANES, Lanes, vectorised};
use crate::plant::body::GRAVITY_MPS2;
use crate::trig::{Polynomial, Trig};

/// Length constant of the curvature filter \[m\].
pub const SMOOTHING_M: f64 = 3.0;
/// Below this speed the wheels point straight ahead [m/s].
pub const STRAIGHT_BELOW_MPS: f64 = 0.5;
/// Share of μg that the road may ask for laterally.
pub const LATERAL_SHARE: f64 = 0.5;
/// No road wheel turns further \[rad\]: tyres that hardly hold across would ask for more than a quarter turn.
pub const LOCK_RAD: f64 = 1.4;

columns! {
    /// The road that each slot of a block follows.
    #[derive(Debug, Clone)]
    struct Road {
        columns {
            /// Curvature at the start and at the end of the running step [1/m], left positive.
            from_per_m: f64 = 0.0,
            to_per_m: f64 = 0.0,
            /// Last heading \[rad\], left positive; NaN before the first.
            heading_rad: f64 = f64::NAN,
        }
    }
}

columns! {
    /// How each slot of a block steers along its road.
    #[derive(Debug, Clone)]
    pub struct Steering {
        parts {
            road: Road = Road::default(),
        }
        columns {
            wheelbase_m: f64 = 1.0,
            understeer_s2_per_m: f64 = 0.0,
            lateral_max_mps2: f64 = 0.0,
        }
    }
}

impl Steering {
    /// Prepares a slot for a body: wheelbase \[m\], understeer gradient [rad per m/s²], friction coefficient.
    pub fn set(&mut self, slot: usize, wheelbase_m: f64, understeer_s2_per_m: f64, friction: f64) {
        self.refit(slot, wheelbase_m, understeer_s2_per_m, friction);
        self.straighten(slot);
    }

    /// The body of a slot is another one; it stays on its road.
    pub fn refit(&mut self, slot: usize, wheelbase_m: f64, understeer_s2_per_m: f64, friction: f64) {
        self.wheelbase_m[slot] = wheelbase_m;
        self.understeer_s2_per_m[slot] = understeer_s2_per_m;
        self.set_friction(slot, friction);
    }

    /// The road under the tyres has another friction coefficient.
    pub fn set_friction(&mut self, slot: usize, friction: f64) {
        self.lateral_max_mps2[slot] = LATERAL_SHARE * friction * GRAVITY_MPS2;
    }

    /// Forgets the road: a new vehicle, or one that was moved by other means than driving.
    pub fn straighten(&mut self, slot: usize) {
        self.road.clear(slot);
    }

    /// Takes the heading at the end of a step [rad, left positive] in which the slot drove `driven_m` metres at
    /// `speed_mps`. Returns true if the curvature was limited to what the tyres hold, or the wheels are at their lock. A slot that stands turns nowhere:
    /// its wheels come straight, and what SUMO's chord does meanwhile (it can turn) is no turn.
    pub fn see_heading(
        &mut self,
        slot: usize,
        heading_rad: impl Into<Option<f64>>,
        driven_m: f64,
        speed_mps: f64,
    ) -> bool {
        let road = &mut self.road;
        road.from_per_m[slot] = road.to_per_m[slot];
        let before = road.heading_rad[slot];
        let heading_rad = heading_rad.into().filter(|_| driven_m > 0.0).unwrap_or(f64::NAN);
        road.heading_rad[slot] = heading_rad;
        if before.is_nan() || heading_rad.is_nan() || speed_mps < STRAIGHT_BELOW_MPS {
            road.to_per_m[slot] = 0.0;
            return false;
        }
        let turn = wrap(heading_rad - before);
        let from = road.from_per_m[slot];
        let filtered = from + driven_m / (SMOOTHING_M + driven_m) * (turn / driven_m - from);
        let limit = self.lateral_max_mps2[slot] / (speed_mps * speed_mps);
        let kappa = filtered.clamp(-limit, limit);
        road.to_per_m[slot] = kappa;
        let across = self.understeer_s2_per_m[slot] * speed_mps * speed_mps * kappa;
        filtered.abs() > limit || (libm::atan(self.wheelbase_m[slot] * kappa) + across).abs() > LOCK_RAD
    }

    /// Drives a given curvature (a recorded path) instead of the one from headings.
    pub fn set_curvature(&mut self, slot: usize, curvature_per_m: f64) {
        self.road.from_per_m[slot] = curvature_per_m;
        self.road.to_per_m[slot] = curvature_per_m;
    }

    /// Road wheel angles at `share` of the step, for the speeds of the block \[rad\].
    pub fn angles_rad(&self, share: f64, speed_mps: &Lanes, out: &mut Lanes) {
        angles_rad(self, share, speed_mps, out);
    }
}

vectorised! {
    fn angles_rad(steering: &Steering, share: f64, speed_mps: &Lanes, out: &mut Lanes) {
        for slot in 0..LANES {
            let (from, to) = (steering.road.from_per_m[slot], steering.road.to_per_m[slot]);
            let curvature = from + share * (to - from);
            let square = speed_mps[slot] * speed_mps[slot];
            // The step's curvature was limited at its end; the speed inside the step may be higher.
            let limit = steering.lateral_max_mps2[slot] / square.max(STRAIGHT_BELOW_MPS * STRAIGHT_BELOW_MPS);
            let kappa = curvature.min(limit).max(-limit);
            let angle =
                Polynomial::atan(steering.wheelbase_m[slot] * kappa) + steering.understeer_s2_per_m[slot] * square * kappa;
            out[slot] = angle.clamp(-LOCK_RAD, LOCK_RAD);
        }
    }
}

/// The angle within (−π, π].
fn wrap(angle_rad: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let turned = angle_rad - TAU * (angle_rad / TAU).round();
    if turned <= -PI { turned + TAU } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A heavy vehicle on tyres that hardly hold across asks for any angle; the plant takes those within a quarter turn.
    #[test]
    fn law_no_wheel_turns_beyond_its_lock() {
        for understeer_s2_per_m in [-4.0, 4.0] {
            let mut steering = Steering::default();
            steering.set(0, 3.0, understeer_s2_per_m, 1.0);
            assert!(!steering.see_heading(0, 0.0, 1.0, 10.0), "straight ahead");
            assert!(steering.see_heading(0, 0.1, 1.0, 10.0), "at its lock, which is told");
            let (mut angle_rad, speed_mps) = ([0.0; LANES], [10.0; LANES]);
            steering.angles_rad(1.0, &speed_mps, &mut angle_rad);
            assert_eq!(angle_rad[0], LOCK_RAD.copysign(understeer_s2_per_m));
        }
    }
}
