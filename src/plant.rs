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

use crate::keys::{Key, Kind, Values};
use crate::registry::Entry;
pub use actuator::{Actuated, Actuators};
pub use block::{Inputs, Plant, PlantBlock, State};
pub use body::{BODIES, BODY_KEYS, Body};
pub use kernel::SevenDof;

/// Builds a plant from the checked values of its keys.
pub type BuildPlant = fn(&Values) -> Box<dyn Plant>;

/// The plants that can be chosen by name.
pub static PLANTS: &[Entry<BuildPlant>] = &[
    Entry {
        name: "seven_dof",
        summary: "7 degrees of freedom: V_x, V_y, yaw rate and four wheels with Magic Formula tyres",
        keys: &[Key {
            name: "substep_s",
            kind: Kind::Number { unit: "s", min: 1e-5, max: 0.01 },
            default: "0.01",
            help: "largest integration step; a control period is divided evenly",
        }],
        build: |values| Box::new(SevenDof::new(values.number("substep_s"))),
    },
    Entry {
        name: "reference",
        summary: "the 7-DoF model integrated implicitly to a tolerance: slow, to measure the others against",
        keys: &[Key {
            name: "tolerance",
            kind: Kind::Number { unit: "m/s", min: 1e-12, max: 1e-3 },
            default: "1e-8",
            help: "largest error of one integration step",
        }],
        build: |values| Box::new(oracle::Reference::new(values.number("tolerance"))),
    },
    Entry {
        name: "point_mass",
        summary: "a point on a line: mass, torque, slope, drag and brakes, no tyres",
        keys: &[],
        build: |_| Box::new(point_mass::PointMass),
    },
];
