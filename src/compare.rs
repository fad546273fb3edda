//! Controllers side by side: the same scenario, seeds, vehicles and noise streams under each of them.
//!
//! A run enters with its [`Summary`](crate::run::Summary). Every number is first taken per run ([`METRICS`]), then
//! averaged over the seeds. The difference to the first controller is paired, that is, taken seed by seed: two runs of
//! one seed share demand, vehicles and noise, and differ less than two seeds do. Its spread is the standard deviation of
//! those differences (n − 1), and the half width of their 95 % Student t interval, t₀.₉₇₅,ₙ₋₁·sd/√n. Both need two
//! seeds. The interval takes the seeds as independent and the differences as about normal; with a handful of seeds it is
//! a guide and no proof.
//!
//! The tracking error is never shown alone. The reference is held near the true speed, which cuts large errors; so the
//! RMS of V_x − v* and the share of steps in which the reference was held stand beside it.

mod jobs;
mod metrics;
mod paired;
mod seeds;
mod student;
mod table;

pub use jobs::{RunFailed, run_all};
pub use metrics::{METRIC_COUNT, METRICS, Metric};
pub use paired::{ControllerRow, Difference, Measured, compare};
pub use seeds::{SeedsError, parse_seeds};
pub use table::{COMPARISON, terminal_table, write_comparison};

#[cfg(test)]
mod tests;
