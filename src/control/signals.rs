//! What passes between the fleet and a speed controller in one control period.

use crate::lanes::Lanes;

/// What a controller sees in one control period.
#[derive(Debug, Clone, Copy, Default)]
pub struct Observation {
    /// Measured speed y (with noise, if any) [m/s].
    pub measured_mps: Lanes,
    /// Reference speed y_r at the same instant [m/s].
    pub reference_mps: Lanes,
    /// Its rate ẏ_r [m/s²].
    pub reference_rate_mps2: Lanes,
    /// Torque that accelerates the *nominal* vehicle at 1 m/s², M·r of the body's preset [N·m per m/s²]. The actual
    /// mass of a vehicle may differ; the controller never learns it.
    pub nominal_nm_per_mps2: Lanes,
}

/// What a controller asks for.
#[derive(Debug, Clone, Copy, Default)]
pub struct Command {
    /// Sum of wheel torques C_T, positive drives, negative brakes [N·m].
    pub torque_nm: Lanes,
    /// dv/dC_T, with v = α̂u the input of the ultra-local model ẏ = F + v [m/s² per N·m]. The actuators carry the
    /// product v alongside the torque, so that a delayed u is never multiplied by a later α̂.
    pub gain_mps2_per_nm: Lanes,
}

impl Command {
    /// Asks for the input u in a slot, of which one unit is the torque `torque_per_u_nm` and the input `v_per_u_mps2` of the
    /// model. Without a torque there is no v.
    #[inline(always)]
    pub fn ask(&mut self, slot: usize, u: f64, torque_per_u_nm: f64, v_per_u_mps2: f64) {
        self.torque_nm[slot] = u * torque_per_u_nm;
        self.gain_mps2_per_nm[slot] = if torque_per_u_nm > 0.0 { v_per_u_mps2 / torque_per_u_nm } else { 0.0 };
    }
}

/// What became of the last command.
#[derive(Debug, Clone, Copy, Default)]
pub struct Actuation {
    /// v of the torque asked for [m/s²].
    pub commanded_mps2: Lanes,
    /// v of that torque within the actuator's limits, not delayed [m/s²].
    pub saturated_mps2: Lanes,
    /// v of the torque that acts on the wheels now: limited, delayed, lagged [m/s²].
    pub applied_mps2: Lanes,
}
