//! Statistics of every vehicle, kept while it drives: memory does not depend on how long.
//!
//! A block keeps one column per running sum. [`StatsBlock::sample`] takes the end of every control period,
//! [`StatsBlock::step`] the end of every SUMO step, [`StatsBlock::read`] turns a slot's columns into [`VehicleStats`].
//! All errors are those of the true speed: e = V_x − y_ref.
//!
//! - **Moments of e** by Welford's update (Welford 1962, Technometrics 4(3)). `error_std` divides by n, so that
//!   rms² = mean² + std², as in the paper's table of the driver test (Polack et al. 2017, §5).
//! - **Acceleration** is the change of V_x over consecutive windows of [`WINDOW_S`] (rounded to whole control periods)
//!   divided by their length: the spikes of a slipping wheel inside a control period are not felt by anybody, while
//!   whatever lasts twice the window is seen in full. `jerk_rms` is the RMS of the difference of neighbouring windows'
//!   accelerations divided by the window; `accel_max` and `decel_max` are the extremes of the same accelerations, both
//!   positive, 0 if the vehicle never sped up or never slowed down.
//! - **Overshoot** is how far V_x goes beyond a reference that has risen by more than [`RISE_MPS`] (`stats/overshoot.rs`).
//! - **Shares** count SUMO steps by what bound the target; they sum to 1.
//! - **Drive quality** (ratings, comfort, work) is kept beside these by [`QualityBlock`].

mod block;
mod comfort;
mod overshoot;
mod quality;
mod sample;
mod trace;
mod vehicle;
mod weighting;
mod window;

pub use block::StatsBlock;
pub use overshoot::RISE_MPS;
pub use quality::{DriveQuality, QualityBlock, RoadLoad};
pub use sample::{Sample, StepSample};
pub use vehicle::{Sums, VehicleStats};
pub use window::WINDOW_S;

#[cfg(test)]
mod tests;
