//! `sumo_mfc` gives every equipped car of a SUMO simulation a 7-DoF body and a model-free speed controller.
//!
//! # Layers
//! A module is a file `src/control.rs` with its parts in `src/control/`. A module imports only from lower layers;
//! `tests/tidy` holds the code to it.
//! ```text
//! 8  main                                      the program
//! 7  cli                                       the command line, for what a catalog offers
//! 6  map  tune  stability                      where adaptation helps, beyond the paper; the best gains of every law; its margins
//! 5  study  paper  report  doctor              studies of many runs; the paper's experiments; a result as a page; is all well?
//! 4  run                                       one scenario -> one result
//!    offline                                   vehicles along a profile, without SUMO
//! 3  cosim                                     fleet <-> SUMO: the coupling contract
//! 2  scenario                                  TOML (or a bare .sumocfg) -> checked SI values
//!    page                                      sections, tables and figures -> one HTML file
//! 1  sumo_files                                SUMO's configuration, options, demand, outputs
//!    figure                                    charts, maps and tables as SVG
//!    fleet                                     the closed loop on columns; where the modules of layer 0 meet
//! 0  plant control measurement reference traci output stats   and the common ground: columns keys lanes missing place registry random stopwatch table trig
//! ```
//! Units end the name (`speed_mps`, `torque_nm`, `dt_s`); frames are ISO 8855 (x forward, y left, yaw left positive).
//!
//! # What to use
//! [`traci`] talks to SUMO; [`run`] runs a scenario from code, step by step or as a whole; [`offline`] drives bodies
//! without SUMO; [`control`], [`plant`], [`mod@reference`] and [`keys!`] are for laws, bodies and targets of one's own, which
//! [`scenario::Catalog`] takes, and [`cli`] makes a command line with them. All else is public for this project's own tests
//! and may change in any version.
//!
//! # Features
//! `cli`, the default, is the command line; `sim` is all but the command line; without features there is only [`traci`].
//! `libsumo` adds SUMO in this process ([`run::Backend`]).

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "sim")]
mod columns;
#[cfg(feature = "sim")]
pub mod control;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod cosim;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod doctor;
#[cfg(feature = "sim")]
mod figure;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod fleet;
#[cfg(feature = "sim")]
pub mod keys;
#[cfg(feature = "sim")]
pub mod lanes;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod map;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod measurement;
#[cfg(feature = "sim")]
mod missing;
#[cfg(feature = "sim")]
pub mod offline;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod output;
#[cfg(feature = "sim")]
mod page;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod paper;
#[cfg(feature = "sim")]
mod place;
#[cfg(feature = "sim")]
pub mod plant;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod random;
#[cfg(feature = "sim")]
pub mod reference;
#[cfg(feature = "sim")]
pub mod registry;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod report;
#[cfg(feature = "sim")]
pub mod run;
#[cfg(feature = "sim")]
pub mod scenario;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod stability;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod stats;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod stopwatch;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod study;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod sumo_files;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod table;
pub mod traci;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod trig;
#[cfg(feature = "sim")]
#[doc(hidden)]
pub mod tune;
