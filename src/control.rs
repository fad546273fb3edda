//! Speed controllers. Each law is one file in `control/` and one line of `laws!` below.
//!
//! A controller works on one block of vehicles. In every control period the fleet calls [`Controller::command`] with the
//! measured speed and the reference, sends the torque through the actuators (limits, dead time, lag), and reports with
//! [`Controller::feedback`] what the actuators made of it.

mod bounds;
mod chunks;
mod controller;
mod estimator;
mod mfc;

use crate::registry::Entry;
pub use controller::{Actuation, Build, Command, Controller, Observation, law};
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
}

#[cfg(test)]
mod tests;
