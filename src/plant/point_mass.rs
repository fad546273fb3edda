//! The smallest plant: a point on a line with the body's mass and brakes, to tell apart what the tyres do.

use super::block::{Inputs, Plant, PlantBlock, State};
use super::body::GRAVITY_MPS2;
use crate::lanes::{Flags, LANES};

/// (M + ΣI_r/r²) V̇_x = C_T/r − M g sin(grade) − drag − rolling resistance, wheels that never slip, no lateral motion.
pub struct PointMass;

impl Plant for PointMass {
    fn advance(&self, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, period_s: f64) {
        for slot in (0..LANES).filter(|&slot| moving[slot] > 0.0) {
            let body = block.body(slot);
            let (speed, torque) = (block.state(slot).vx_mps, inputs.torque_nm[slot]);
            let mass = body.effective_mass_kg();
            let wind = speed + inputs.headwind_mps[slot];
            let air = body.drag_ns2pm2() * wind * wind.abs();
            let slope = body.mass_kg * GRAVITY_MPS2 * libm::sin(inputs.grade_rad[slot]);
            let rolling = if speed > 0.0 { body.rolling_n() } else { 0.0 };
            let pull = -slope - air - rolling;
            let next = speed + period_s * (pull + torque / body.wheel_radius_m) / mass;
            // Brakes stop, they do not reverse; and they hold what they can.
            let stopped = torque < 0.0 && next <= 0.0 && pull.abs() * body.wheel_radius_m <= -torque;
            let next = if stopped { 0.0 } else { next };
            let state = if stopped { State::default() } else { State::rolling(body, next) };
            block.set_state(slot, &state);
            block.distance_m[slot] += 0.5 * period_s * (speed + next);
        }
    }
}
