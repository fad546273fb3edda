//! A TraCI client for SUMO 1.15 and newer: many commands in one message, typed variables, replies read in place.
pub mod batch;
pub mod client;
pub mod compound;
pub mod error;
pub mod process;
pub mod reply;
pub mod typed;
pub mod value;
pub mod variables;
pub mod wire;

pub use batch::{Batch, BatchError, Handle, MAX_ID_BYTES, Prefix};
pub use client::{Client, SumoVersion};
pub use error::Error;
pub use process::{SumoBinary, SumoProcess, find_named, find_sumo};
pub use reply::{Block, Index, Refusal, Reply};
pub use typed::{Domain, FromValue, Never, Shape, Var};
pub use value::{Color, Value};
pub use variables::{edge, junction, lane, route, simulation, trafficlight, vehicle, vehicletype};
