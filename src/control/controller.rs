//! The contract between the fleet and a speed controller.

use crate::columns::Slots;
use crate::keys::{Keys, Values};
use crate::lanes::Lanes;
use crate::registry::Entry;
use std::sync::Arc;

/// Builds the controller of one block from its checked keys and the control period Δt (s). `None` = no controller: the
/// vehicles take the reference speed as it is.
pub type Build = Arc<dyn Fn(&Values, f64) -> Option<Box<dyn Controller>> + Send + Sync>;

/// The entry of a law: its name, one line about it, and its constructor from the law's keys and the control period Δt (s).
pub fn law<K: Keys, C: Controller + 'static>(
    name: &'static str,
    summary: &'static str,
    build: impl Fn(K, f64) -> C + Send + Sync + 'static,
) -> Entry<Build> {
    let build: Build = Arc::new(move |values, period_s| Some(Box::new(build(K::from_values(values), period_s))));
    Entry { name, summary, keys: K::keys(), build }
}

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

/// A speed controller for one block of vehicles.
pub trait Controller: Send {
    /// Computes the torques of this control period.
    fn command(&mut self, observation: &Observation, command: &mut Command);

    /// Takes note of what the actuators made of the last command.
    fn feedback(&mut self, _actuation: &Actuation) {}

    /// Starts a slot afresh with a new vehicle at `speed_mps`. The estimator's window is filled with this speed and zero
    /// input, α̂ is nominal.
    fn reset(&mut self, slot: usize, speed_mps: f64);

    /// The vehicle of a slot has come to rest and is held. What a law has learned of the vehicle and its actuators may
    /// stay; all else starts afresh as in [`Controller::reset`].
    fn rest(&mut self, slot: usize) {
        self.reset(slot, 0.0);
    }

    /// α̂/α_nominal of a slot; 1 for laws without adaptation.
    fn alpha_ratio(&self, _slot: usize) -> f64 {
        1.0
    }

    /// F̂ of a slot [m/s²]; 0 for laws without an estimate.
    fn f_hat_mps2(&self, _slot: usize) -> f64 {
        0.0
    }
}

impl Slots for Option<Box<dyn Controller>> {
    fn clear(&mut self, slot: usize) {
        if let Some(controller) = self {
            controller.reset(slot, 0.0);
        }
    }
}
