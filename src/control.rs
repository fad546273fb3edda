//! Speed controllers. Each law is one file in `control/` and one line of `laws!` below.
//!
//! A controller works on one block of vehicles. In every control period the fleet calls [`Controller::command`] with the
//! measured speed and the reference, sends the torque through the actuators (limits, dead time, lag), and reports with
//! [`Controller::feedback`] what the actuators made of it. A [`GroupController`] does the same for all vehicles of a group.

mod actuator_model;
mod bounds;
mod chunks;
mod controller;
mod estimator;
mod group;
mod law;
mod mfc;
mod observer;
mod port;
mod riccati;
mod signals;

use crate::registry::Entry;
pub use actuator_model::with_model;
pub use controller::Controller;
pub use estimator::f_hat;
pub use group::{Delegate, GroupController, GroupPeriod};
pub use law::{Build, Law, group_law, law};
pub use port::Port;
pub use signals::{Actuation, Command, Observation};
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
