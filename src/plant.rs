//! Vehicle bodies in motion. One file per model in `plant/`, one line each in [`PLANTS`].
//!
//! A [`PlantBlock`] holds constants and states of a block of vehicles in columns. In every control period the fleet
//! calls [`Plant::advance`] with the torques that the actuators let through and the steering of the road.
//! Frames and signs: see [`seven_dof`].

pub mod actuator;
mod axle;
mod block;
pub mod body;
pub mod integrator;
mod kernel;
mod layout;
mod loops;
pub mod oracle;
mod point_mass;
pub mod seven_dof;
pub mod tyre;

use crate::keys;
use crate::keys::{Keys, NoKeys, Values};
use crate::registry::Entry;
pub use actuator::{Actuated, ActuatorKeys, Actuators, DEAD_TIME_MAX_S};
pub use block::{FASTEST_MPS, Inputs, Plant, PlantBlock, State};
pub use body::{BODIES, Body, BodyKeys, BuildBody, preset};
pub use kernel::SevenDof;
use std::sync::{Arc, LazyLock};

/// Builds a plant from the checked values of its keys.
pub type BuildPlant = Arc<dyn Fn(&Values) -> Box<dyn Plant> + Send + Sync>;

/// The entry of a vehicle model: its name, one line about it, and its constructor from the model's keys.
pub fn model<K: Keys, P: Plant + 'static>(
    name: &'static str,
    summary: &'static str,
    build: impl Fn(K) -> P + Send + Sync + 'static,
) -> Entry<BuildPlant> {
    Entry { name, summary, keys: K::keys(), build: Arc::new(move |values| Box::new(build(K::from_values(values)))) }
}

/// The plants that can be chosen by name, the default first.
pub static PLANTS: LazyLock<Vec<Entry<BuildPlant>>> = LazyLock::new(|| {
    vec![
        model(
            "seven_dof",
            "7 degrees of freedom: V_x, V_y, yaw rate and four wheels with Magic Formula tyres",
            |keys: SevenDofKeys| SevenDof::new(keys.substep_s),
        ),
        model(
            "reference",
            "the 7-DoF model integrated implicitly to a tolerance: slow, to measure the others against",
            |keys: ReferenceKeys| oracle::Reference::new(keys.tolerance),
        ),
        model("point_mass", "a point on a line: mass, torque, slope, drag and brakes, no tyres", |_: NoKeys| {
            point_mass::PointMass
        }),
    ]
});

keys! {
    struct SevenDofKeys {
        /// largest integration step; a control period is divided evenly
        substep_s: f64 = 0.01, "s", 1e-5..=0.01;
    }
}

keys! {
    struct ReferenceKeys {
        /// largest error of one integration step
        tolerance: f64 = 1e-8, "m/s", 1e-12..=1e-3;
    }
}

#[cfg(test)]
mod tests;
