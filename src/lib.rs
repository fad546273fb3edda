//! `sumo_mfc` gives every equipped car of a SUMO simulation a 7-DoF body and a model-free speed controller.
//!
//! # Floors
//! A module ("room") is a door file `src/control.rs` with its interior in `src/control/`. A room imports only from
//! lower floors; `tests/tidy.rs` holds the code to it.
//! ```text
//! 8  main                                      the program
//! 7  cli                                       the command line, for what a catalog offers
//! 6  map                                       where adaptation helps, beyond the paper
//! 5  compare  paper  doctor                    many runs; the paper's experiments; is all well?
//! 4  run                                       one scenario -> one result
//!    offline                                   vehicles along a profile, without SUMO
//! 3  cosim                                     fleet <-> SUMO: the coupling contract
//! 2  scenario                                  TOML (or a bare .sumocfg) -> checked SI values
//! 1  sumo_files                                SUMO's configuration, options, demand, outputs
//!    fleet                                     the closed loop on columns; where floor-0 rooms meet
//! 0  plant control measurement reference traci output stats   and the common ground: columns keys lanes place registry random stopwatch table trig
//! ```
//! Units end the name (`speed_mps`, `torque_nm`, `dt_s`); frames are ISO 8855 (x forward, y left, yaw left positive).
//!
//! # Features
//! `cli`, the default, is the command line; `sim` is all but the command line; without features there is only [`traci`].

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "sim")]
mod columns;
#[cfg(feature = "sim")]
pub mod compare;
#[cfg(feature = "sim")]
pub mod control;
#[cfg(feature = "sim")]
pub mod cosim;
#[cfg(feature = "sim")]
pub mod doctor;
#[cfg(feature = "sim")]
pub mod fleet;
#[cfg(feature = "sim")]
pub mod keys;
#[cfg(feature = "sim")]
pub mod lanes;
#[cfg(feature = "sim")]
pub mod map;
#[cfg(feature = "sim")]
pub mod measurement;
#[cfg(feature = "sim")]
pub mod offline;
#[cfg(feature = "sim")]
pub mod output;
#[cfg(feature = "sim")]
pub mod paper;
#[cfg(feature = "sim")]
mod place;
#[cfg(feature = "sim")]
pub mod plant;
#[cfg(feature = "sim")]
pub mod random;
#[cfg(feature = "sim")]
pub mod reference;
#[cfg(feature = "sim")]
pub mod registry;
#[cfg(feature = "sim")]
pub mod run;
#[cfg(feature = "sim")]
pub mod scenario;
#[cfg(feature = "sim")]
pub mod stats;
#[cfg(feature = "sim")]
pub mod stopwatch;
#[cfg(feature = "sim")]
pub mod sumo_files;
#[cfg(feature = "sim")]
pub mod table;
pub mod traci;
#[cfg(feature = "sim")]
pub mod trig;
