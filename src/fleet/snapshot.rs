//! What one vehicle shows at one instant, for trajectories.

use crate::control::Controller;
use crate::plant::{Inputs, PlantBlock};

/// One vehicle at the end of a control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Snapshot {
    /// Target speed; that of a profile is its reference [m/s].
    pub target_mps: f64,
    /// Reference speed y_ref [m/s].
    pub reference_mps: f64,
    /// True speed V_x [m/s].
    pub speed_mps: f64,
    /// Measured speed [m/s].
    pub measured_mps: f64,
    /// Lateral speed V_y, positive to the left [m/s].
    pub lateral_mps: f64,
    /// Yaw rate, positive to the left [rad/s].
    pub yaw_rate_radps: f64,
    /// Slip ratios of front and rear axle.
    pub slip: [f64; 2],
    /// Applied sum of wheel torques [N·m].
    pub torque_nm: f64,
    /// α̂/α_nominal.
    pub alpha_ratio: f64,
    /// F̂ [m/s²].
    pub f_hat_mps2: f64,
    /// ∫V_x dt since departure \[m\].
    pub distance_m: f64,
}

impl Snapshot {
    /// The vehicle in a slot now, with its target, reference and measured speed [m/s].
    pub(super) fn of(
        slot: usize,
        plant: &PlantBlock,
        inputs: &Inputs,
        controller: Option<&dyn Controller>,
        [target_mps, reference_mps, measured_mps]: [f64; 3],
    ) -> Self {
        let state = plant.state(slot);
        Self {
            target_mps: if target_mps.is_finite() { target_mps } else { reference_mps },
            reference_mps,
            speed_mps: state.vx_mps,
            measured_mps,
            lateral_mps: state.vy_mps,
            yaw_rate_radps: state.yaw_rate_radps,
            slip: plant.slip(slot, inputs.steer_rad[slot]),
            torque_nm: inputs.torque_nm[slot],
            alpha_ratio: controller.map_or(1.0, |controller| controller.alpha_ratio(slot)),
            f_hat_mps2: controller.map_or(0.0, |controller| controller.f_hat_mps2(slot)),
            distance_m: plant.distance_m[slot],
        }
    }
}
