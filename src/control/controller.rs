//! The contract between the fleet and a speed controller.

use super::port::Port;
use super::signals::{Actuation, Command, Observation};
use crate::columns::Slots;

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

    /// Where the law of the group is connected, if this is such a place.
    #[doc(hidden)]
    fn port(&mut self) -> Option<&mut Port> {
        None
    }
}

impl Slots for Option<Box<dyn Controller>> {
    fn clear(&mut self, slot: usize) {
        if let Some(controller) = self {
            controller.reset(slot, 0.0);
        }
    }
}
