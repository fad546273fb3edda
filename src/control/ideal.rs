//! No controller: the vehicle takes the reference speed as it is. It shows what the coupling alone does, and it is the
//! smallest example of a controller.

use super::{Actuation, Command, Controller, Observation};

pub(super) struct Ideal;

impl Controller for Ideal {
    fn command(&mut self, _observation: &Observation, command: &mut Command) {
        *command = Command::default();
    }

    fn feedback(&mut self, _actuation: &Actuation) {}

    fn reset(&mut self, _slot: usize, _speed_mps: f64) {}

    fn is_ideal(&self) -> bool {
        true
    }
}
