//! A TraCI client for SUMO 1.15 and newer: typed variables, many commands in one message, replies read in place.
//!
//! # One value at a time
//! [`Client`] reads and sets single values by the constants of one table, in modules named as in `libsumo`: [`simulation`],
//! [`vehicle`], [`vehicletype`], [`route`], [`edge`], [`lane`], [`junction`], [`trafficlight`]. A constant knows its type;
//! setting what cannot be set, or leaving out a parameter, does not compile.
//! ```no_run
//! use std::time::Duration;
//! use sumo_mfc::traci::{SumoProcess, find_sumo, simulation, vehicle};
//!
//! # async fn example() -> Result<(), sumo_mfc::traci::Error> {
//! let args = ["-c".to_owned(), "city.sumocfg".to_owned()];
//! let mut process = SumoProcess::spawn(&find_sumo(None)?, &args, None, "out".as_ref())?;
//! let mut client = process.connect(Duration::from_secs(60)).await?;
//! client.step_until(10.0).await?;
//! for id in client.get(vehicle::IDS, "").await? {
//!     let speed_mps = client.get(vehicle::SPEED, &id).await?;
//!     let leader = client.get_with(vehicle::LEADER, &id, 100.0).await?;
//!     println!("{id}: {speed_mps} m/s behind {leader:?}");
//!     client.set(vehicle::MAX_SPEED, &id, 12.0).await?;
//! }
//! println!("{} s", client.get(simulation::TIME, "").await?);
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
//! # use sumo_mfc::traci::{Batch, Client, Domain, Error, Prefix, simulation, vehicle};
//! # async fn example(client: &mut Client) -> Result<(), Error> {
//! let now_s = client.get(simulation::TIME, "").await?;
//! let mut batch = Batch::new();
//! batch.subscribe(Domain::Simulation, "", &[simulation::TIME.id, simulation::DEPARTED.id, simulation::ARRIVED.id], now_s)?;
//! batch.step()?;
//! let mut fleet: HashMap<String, (Prefix, f64)> = HashMap::new();
//! loop {
//!     let reply = client.exchange(&batch).await?;
//!     batch.clear();
//!     for block in reply.blocks() {
//!         let block = block?;
//!         if block.domain == Some(Domain::Simulation) {
//!             let now_s = block.get(simulation::TIME)?.unwrap_or(now_s);
//!             for id in block.get(simulation::DEPARTED)?.unwrap_or_default() {
//!                 batch.subscribe(Domain::Vehicle, &id, &[vehicle::SPEED.id, vehicle::ANGLE.id], now_s)?;
//!                 fleet.insert(id.clone(), (Prefix::new(&id)?, 0.0));
//!             }
//!             for id in block.get(simulation::ARRIVED)?.unwrap_or_default() {
//!                 fleet.remove(&id);
//!             }
//!         } else if let Some((prefix, speed_mps)) = fleet.get_mut(block.id) {
//!             // `None` inside: no value, teleporting; `None` outside: gone.
//!             if let Some([Some(wanted_mps), _angle]) = block.doubles([vehicle::SPEED.id, vehicle::ANGLE.id])? {
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
//! that it answers. Only [`client`] and [`process`] know tokio; its runtime needs I/O and time enabled.

// Units in brackets, [m], are not links.
#![allow(rustdoc::broken_intra_doc_links)]

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
pub use client::{Client, SumoVersion, Ticket};
pub use error::Error;
pub use process::{SumoBinary, SumoProcess, find_named, find_sumo};
pub use reply::{Block, Index, Refusal, Reply};
pub use typed::{Domain, FromValue, Never, Shape, Var};
pub use value::{Color, Value};
pub use variables::{edge, junction, lane, route, simulation, trafficlight, vehicle, vehicletype};
