//! Speed controllers. Each law is one file in `control/` and one line of `laws!` below.
//!
//! A controller works on one block of vehicles. In every control period the fleet calls [`Controller::command`] with the
//! measured speed and the reference, sends the torque through the actuators (limits, dead time, lag), and reports with
//! [`Controller::feedback`] what the actuators made of it.

mod actuator_model;
mod bounds;
mod chunks;
mod controller;
mod estimator;
mod mfc;
mod observer;
mod riccati;

use crate::registry::Entry;
pub use actuator_model::with_model;
pub use controller::{Actuation, Build, Command, Controller, Observation, law};
pub use estimator::f_hat;
use std::sync::LazyLock;

/// Declares the file of each law and lists its entry.
macro_rules! laws {
    ($($law:ident)*) => {
        $(mod $law;)*

        /// All controllers, the default first.
        pub static CONTROLLERS: LazyLock<Vec<Entry<Build>>> = LazyLock::new(|| vec![$($law::entry()),*]);
    };
}

laws! {
    adaptive
    classic
    pid
    calibrating
    ideal
    smith_pi
    lqi
    mpc
}

#[cfg(test)]
mod loop_tests;
#[cfg(test)]
mod tests;
