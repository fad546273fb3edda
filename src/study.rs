//! Studies: one scenario under many settings and seeds, and one table that says what differs, by how much, and how sure.
//!
//! A [`Definition`] (a file, or arguments of the command line) becomes a [`Plan`]: all settings and their cases, checked before
//! anything runs. An executor runs the cases that are not done, each as a process of its own with a result folder of its
//! own. [`collect()`] makes the tables from these folders alone, so that they cannot depend on who ran what, when and
//! where. `sweep` and `compare` of the command line are two ways to write a definition.
//!
//! Differences are paired: two runs of one seed share demand, vehicles and noise, and differ less than two seeds do.
//! `docs/studies.md` has the formulas.
//!
//! The tracking error is never shown alone. The reference is held near the true speed, which cuts large errors; so the
//! RMS of V_x − v* and the share of steps in which the reference was held stand beside it.

mod bars;
mod bootstrap;
mod case;
mod collect;
mod comparison;
mod definition;
mod error;
mod executor;
mod joined;
mod local;
mod metrics;
mod pairs;
mod plan;
mod process;
mod result;
mod seeds;
mod setting;
mod slurm;
mod statistics;
mod terminal;
mod values;
mod vehicle;
mod vehicles;
mod warm_up;
mod warming;
mod work;

pub use case::State;
pub use collect::{Tables, Turn, collect, study_schema};
pub use comparison::{ComparisonRow, comparison_layout, key_columns};
pub use definition::{Arguments, Definition, file_keys};
pub use error::StudyError;
pub use executor::EXECUTORS;
pub use metrics::{METRIC_COUNT, METRICS, Metric};
pub use plan::{Case, Plan};
pub use process::Program;
pub use setting::{Setting, settings};
pub use slurm::{SlurmKeys, run_task};
pub use statistics::{Estimate, advice, holm, seeds_for};
pub use terminal::{exported_table, terminal_table};
pub use warm_up::WarmUp;
pub use work::{Ended, Executor, Standing, Work};
