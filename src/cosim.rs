//! The coupling of fleet and SUMO, in every SUMO step:
//!
//! 1. For every ego `setPreviousSpeed(V, a)`: SUMO takes the body's speed for the car's. Then the step. Of every ego that
//!    is still there, speed and heading are asked.
//! 2. The speed that comes back is v*, what SUMO's car-following, lights, right of way and stops chose from there.
//! 3. Body and controller run the *same* interval after the reply, along the ramp to v* (see
//!    [`crate::fleet::block`]). The speed that they reach is sent at once.
//!
//! The egos go through 2 and 3 in chunks: SUMO looks up and takes the values of one chunk while the bodies of another
//! drive. Nothing waits for SUMO but the step itself. `world.rs` has these steps in order.
//!
//! The two loops that come to mind first do not work. Commanding `setSpeed` with a speed derived from SUMO's "speed
//! without TraCI" freezes every car, because SUMO bounds that value by the command itself. Handing v* to the controller as
//! a step makes cars creep, because v* is never more than a·dt ahead.
//!
//! With the targets `limit` and `profile` the body runs first and leads, and SUMO is told `setSpeed` (`body_leads.rs`).
//!
//! SUMO itself is behind a small trait, [`Sumo`].

mod admission;
pub mod bodies;
mod body_leads;
mod changes;
mod chunk;
mod creep;
mod display;
mod egos;
mod error;
mod events;
mod following;
mod lanes;
mod leader;
#[cfg(feature = "libsumo")]
mod libsumo_link;
mod link;
mod newcomers;
mod observation;
mod orders;
mod places;
mod platoon;
mod plausible;
mod question;
mod readings;
mod records;
mod roads;
pub mod self_check;
mod setup;
mod subscriptions;
mod sumo;
mod traci_link;
mod world;

pub use admission::Rules;
pub use creep::{LONG_S, SLOW_MPS};
pub use display::{Display, FULL_COLOUR_MPS};
pub use egos::{Ego, EgoTable, Presence};
pub use error::CosimError;
pub use events::Events;
#[cfg(feature = "libsumo")]
pub use libsumo_link::LibsumoLink;
pub use link::Link;
pub use orders::{Hand, OrderError, Orders};
pub use places::Place;
pub use platoon::StringGain;
pub use question::{Gets, NoAnswer, Object, Question, With};
pub use records::{Counters, Finished, Reason, Records, Told};
pub use roads::Roads;
pub use setup::WorldSetup;
pub use sumo::{Joined, Sumo, Tell};
pub use traci_link::TraciLink;
pub use world::World;
