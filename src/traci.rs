//! A TraCI client for SUMO 1.15 and newer: typed variables, many commands in one message, replies read in place.
//!
//! # One value at a time
//! [`Client`] reads and sets single values by the constants of one table, in modules named as in `libsumo`: [`simulation`],
//! [`vehicle`], [`vehicletype`], [`route`], [`edge`], [`lane`], [`junction`], [`trafficlight`]. A constant knows its type;
//! setting what cannot be set, or leaving out a parameter, does not compile.
//! ```
//! use std::time::Duration;
//! use sumo_mfc::traci::{SumoProcess, Subscribed, find_sumo, simulation, vehicle};
//!
//! # #[tokio::main(flavor = "current_thread")]
//! # async fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let log_dir = folder.path();
//! let args = ["-n", "tests/data/traci/grid.net.xml", "-r", "tests/data/traci/grid.rou.xml"].map(String::from);
//! let mut process = SumoProcess::spawn(&find_sumo(None)?, &args, None, log_dir)?;
//! let mut client = process.connect(Duration::from_secs(60)).await?;
//! client.step_until(10.0).await?;
//! for id in client.get(vehicle::IDS, "").await? {
//!     let speed_mps: f64 = client.get(vehicle::SPEED, &id).await?;
//!     let leader = client.get_with(vehicle::LEADER, &id, 100.0).await?;
//!     println!("{id}: {speed_mps} m/s behind {leader:?}");
//! }
//! client.set(vehicle::MAX_SPEED, "v0", 5.0).await?;
//!
//! // Values that come with every step are subscribed to, and read by the same variables, each in its type.
//! let wanted = (vehicle::ROAD, vehicle::SPEED);
//! let now_s = client.get(simulation::TIME, "").await?;
//! client.subscribe(wanted, "v0", now_s).await?;
//! for _ in 0..3 {
//!     for block in client.step().await?.blocks() {
//!         if let Subscribed::Own((Some(road), Some(speed_mps))) = block?.read(wanted)? {
//!             println!("v0 is on {road}, {speed_mps} m/s");
//! #           assert!(!road.is_empty() && (0.0..=5.0).contains(&speed_mps));
//!         }
//!     }
//! }
//! # assert_eq!(client.step().await?.block_count(), 1);
//! client.close().await?;
//! process.shut_down(Duration::from_secs(10)).await?;
//! # Ok(())
//! # }
//! ```
//!
//! # A fleet, one message per step
//! A lone command costs a round trip, some 50 µs; in a [`Batch`] it costs a fraction of a microsecond. Gets behind the step
//! go into a second batch that is sent behind it ([`Client::queue`], [`Client::receive`]): SUMO would answer commands behind
//! a step in the *same* message with the state before it.
//! ```no_run
//! # use std::collections::HashMap;
//! # use sumo_mfc::traci::{Batch, Client, Error, Prefix, Subscribed, simulation, vehicle};
//! # async fn example(client: &mut Client) -> Result<(), Error> {
//! let events = (simulation::TIME, simulation::DEPARTED, simulation::ARRIVED);
//! let motion = (vehicle::SPEED, vehicle::ANGLE);
//! let mut now_s = client.get(simulation::TIME, "").await?;
//! let mut batch = Batch::new();
//! batch.subscribe(events, "", now_s)?;
//! batch.step()?;
//! let mut fleet: HashMap<String, (Prefix, f64)> = HashMap::new();
//! loop {
//!     let reply = client.exchange(&batch).await?;
//!     batch.clear();
//!     for block in reply.blocks() {
//!         let block = block?;
//!         if let Subscribed::Own((Some(time_s), departed, arrived)) = block.read(events)? {
//!             now_s = time_s;
//!             for id in departed.unwrap_or_default() {
//!                 batch.subscribe(motion, &id, now_s)?;
//!                 fleet.insert(id.clone(), (Prefix::new(&id)?, 0.0));
//!             }
//!             for id in arrived.unwrap_or_default() {
//!                 fleet.remove(&id);
//!             }
//!         } else if let Some((prefix, speed_mps)) = fleet.get_mut(block.id) {
//!             // `None` inside: no value now, as while teleporting.
//!             if let Subscribed::Own((Some(wanted_mps), _angle_deg)) = block.read(motion)? {
//!                 *speed_mps = 0.9 * wanted_mps;
//!                 batch.set_previous_speed(prefix, *speed_mps, 0.0)?;
//!             }
//!         }
//!     }
//!     batch.step()?;
//! }
//! # }
//! ```
//!
//! # What can go wrong
//! A command that SUMO declines is data: [`Reply::refusals`], or [`Error::Refused`] from the calls for single values. A
//! batch refuses what would make SUMO hang or die ([`BatchError`]). Everything that waits has a time limit. Bytes that
//! make no sense, a timeout or a lost connection finish the client; [`SumoProcess::explain`] adds SUMO's exit code and last
//! words. "No value" (not departed, teleporting) is [`Value::Missing`], [`Error::NoValue`] or `None`, never a number.
//!
//! The codec ([`wire`], [`Batch`], [`Index`], [`Reply`]) works without sockets: give [`Index::read`] a frame and the batch
//! that it answers. Only [`Client`] and [`SumoProcess`] use tokio; its runtime needs I/O and time enabled.

// Units in brackets, [m], are not links.
#![allow(rustdoc::broken_intra_doc_links)]

mod batch;
mod client;
mod compound;
mod error;
mod find;
mod prefix;
mod process;
mod reply;
mod subscription;
mod tie;
mod typed;
mod value;
mod variables;
mod version;
pub mod wire;

#[cfg(feature = "libsumo")]
pub(crate) use batch::usable_speed;
pub use batch::{Batch, Handle};
pub use client::{Client, Ticket};
pub use compound::{
    AddVehicle, BestLane, Collision, ControlledLinks, JunctionFoe, Leader, Link, Logic, Neighbour, NewVehicle,
    NextStop, NextTrafficLight, Phase, Stage, StopData,
};
pub use error::{BatchError, Error, MAX_ID_BYTES};
pub use find::{SUMO_BINARY_VARIABLE, SumoBinary, find_named, find_sumo};
pub use prefix::Prefix;
pub use process::SumoProcess;
#[cfg(feature = "libsumo")]
pub(crate) use process::last_words;
pub use reply::{Blocks, Index, Refusal, Reply};
pub use subscription::{Block, Entries, Subscribed, Values, Variables};
#[cfg(feature = "sim")]
pub(crate) use tie::{Tie, tied};
#[cfg(feature = "libsumo")]
pub(crate) use typed::finite;
pub use typed::{Distance, Domain, FromValue, Never, Nothing, OnRoad, RoadPosition, Shape, Var};
pub use value::{Color, Compound, Doubles, Layout, Polygon, Texts, Value};
pub use variables::{Row, TABLE, edge, junction, lane, route, simulation, trafficlight, vehicle, vehicletype};
pub use version::SumoVersion;
