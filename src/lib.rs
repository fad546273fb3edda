//! `sumo_mfc` gives every equipped car of a SUMO simulation a 7-DoF body and a model-free speed controller.
//!
//! # Floors
//! A module ("room") is a door file `src/control.rs` with its interior in `src/control/`. A room imports only from
//! lower floors; `tests/tidy.rs` holds the code to it.
//! ```text
//! 7  main                                      the program
//! 6  cli                                       the command line, for what a catalog offers
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

pub mod cli;
mod columns;
pub mod compare;
pub mod control;
pub mod cosim;
pub mod doctor;
pub mod fleet;
pub mod keys;
pub mod lanes;
pub mod measurement;
pub mod offline;
pub mod output;
pub mod paper;
mod place;
pub mod plant;
pub mod random;
pub mod reference;
pub mod registry;
pub mod run;
pub mod scenario;
pub mod stats;
pub mod stopwatch;
pub mod sumo_files;
pub mod table;
pub mod traci;
pub mod trig;
