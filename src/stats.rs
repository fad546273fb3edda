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
//! - **Overshoot**: see [`Overshoot`].
//! - **Shares** count SUMO steps by what bound the target; they sum to 1.

mod kernel;
mod overshoot;

use crate::lanes::{Flags, LANES, Lanes};
use kernel::Window;
pub use overshoot::{Overshoot, RISE_MPS};

/// Length over which accelerations are averaged \[s\].
pub const WINDOW_S: f64 = 0.5;

/// The end of one control period of a block.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sample {
    /// True speed V_x [m/s].
    pub speed_mps: Lanes,
    /// Reference speed y_ref [m/s].
    pub reference_mps: Lanes,
    /// Torque applied, sum over the wheels, positive drives [N·m].
    pub torque_nm: Lanes,
    /// 1 where a vehicle drove. Other slots' values are not looked at.
    pub active: Flags,
}

/// The end of one SUMO step of a block. Of the four `bound_*` exactly one is 1 for an active slot.
#[derive(Debug, Clone, Copy, Default)]
pub struct StepSample {
    /// V_x − v* [m/s].
    pub speed_gap_mps: Lanes,
    /// 1 where the reference's memory hit its bound.
    pub lead_limited: Flags,
    /// 1 where the curvature had to be limited.
    pub curvature_limited: Flags,
    /// 1 where the traffic (SUMO's car-following, lights, ...) gave the target.
    pub bound_traffic: Flags,
    /// 1 where a speed limit gave the target.
    pub bound_limit: Flags,
    /// 1 where a profile gave the target.
    pub bound_profile: Flags,
    /// 1 where SUMO clamped the commanded speed.
    pub bound_clamp: Flags,
    /// 1 where a vehicle drove.
    pub active: Flags,
}

/// Sums of a slot since they were last taken, for tables by place: see [`StatsBlock::take_sums`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sums {
    /// Control periods.
    pub samples: u64,
    /// Σ e [m/s].
    pub error_mps: f64,
    /// Σ e² [m²/s²].
    pub error_squared: f64,
    /// Σ V_x [m/s].
    pub speed_mps: f64,
}

/// The statistics of one vehicle; `None` where nothing was there to be averaged.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct VehicleStats {
    /// Control periods.
    pub samples: u64,
    /// Mean of e [m/s].
    pub error_mean: Option<f64>,
    /// Standard deviation of e, divided by n [m/s].
    pub error_std: Option<f64>,
    /// Root mean square of e [m/s].
    pub error_rms: Option<f64>,
    /// Largest |e| [m/s].
    pub error_max_abs: Option<f64>,
    /// Largest overshoot, else 0: see [`Overshoot`] [m/s].
    pub overshoot_max: Option<f64>,
    /// Root mean square of V_x − v* at the ends of SUMO steps [m/s].
    pub speed_gap_rms: Option<f64>,
    /// Root mean square of the jerk; none before two windows have passed [m/s³].
    pub jerk_rms: Option<f64>,
    /// Largest acceleration of a window; none before one has passed [m/s²].
    pub accel_max: Option<f64>,
    /// Largest deceleration of a window, positive [m/s²].
    pub decel_max: Option<f64>,
    /// Root mean square of the applied torque, sum over the wheels [N·m].
    pub torque_rms: Option<f64>,
    /// Share of SUMO steps in which the traffic gave the target.
    pub share_traffic: Option<f64>,
    /// Share of SUMO steps in which a speed limit gave it.
    pub share_limit: Option<f64>,
    /// Share of SUMO steps in which a profile gave it.
    pub share_profile: Option<f64>,
    /// Share of SUMO steps in which SUMO clamped the command.
    pub share_clamp: Option<f64>,
    /// SUMO steps in which SUMO clamped the command.
    pub clamped_steps: u64,
    /// Share of SUMO steps in which the reference's memory hit its bound.
    pub lead_limited: Option<f64>,
    /// Share of SUMO steps in which the curvature was limited.
    pub curvature_limited: Option<f64>,
}

/// Running statistics of one block of vehicles, one column per sum.
#[derive(Debug, Clone)]
pub struct StatsBlock {
    samples: Lanes,
    error_mean: Lanes,
    error_m2: Lanes,
    error_max_abs: Lanes,
    torque_squared: Lanes,
    window: Window,
    overshoot: Overshoot,
    sums: [Lanes; 4],
    steps: Lanes,
    gap_squared: Lanes,
    lead_limited: Lanes,
    curvature_limited: Lanes,
    /// Steps bound by traffic, limit, profile, clamp.
    bound: [Lanes; 4],
}

impl StatsBlock {
    /// Empty statistics for control periods of `period_s` \[s\].
    pub fn new(period_s: f64) -> Self {
        const ZERO: Lanes = [0.0; LANES];
        Self {
            samples: ZERO,
            error_mean: ZERO,
            error_m2: ZERO,
            error_max_abs: ZERO,
            torque_squared: ZERO,
            window: Window::new(period_s),
            overshoot: Overshoot::default(),
            sums: [ZERO; 4],
            steps: ZERO,
            gap_squared: ZERO,
            lead_limited: ZERO,
            curvature_limited: ZERO,
            bound: [ZERO; 4],
        }
    }

    /// Forgets a slot: a new vehicle, now at `speed_mps`.
    pub fn reset(&mut self, slot: usize, speed_mps: f64) {
        let columns = [
            &mut self.samples,
            &mut self.error_mean,
            &mut self.error_m2,
            &mut self.error_max_abs,
            &mut self.torque_squared,
            &mut self.steps,
            &mut self.gap_squared,
            &mut self.lead_limited,
            &mut self.curvature_limited,
        ];
        for column in columns.into_iter().chain(&mut self.bound).chain(&mut self.sums) {
            column[slot] = 0.0;
        }
        self.window.reset(slot);
        self.overshoot.reset(slot);
        self.rejoin(slot, speed_mps);
    }

    /// Keeps a slot's statistics but lets nothing reach across the gap: the vehicle was off the road (teleport, parking)
    /// or was put to another speed, and goes on at `speed_mps`. The jump counts neither as acceleration nor as jerk.
    pub fn rejoin(&mut self, slot: usize, speed_mps: f64) {
        self.window.rejoin(slot, speed_mps);
        self.overshoot.rejoin(slot, speed_mps);
    }

    /// Takes the end of a control period.
    pub fn sample(&mut self, sample: &Sample) {
        kernel::sample(self, sample);
    }

    /// Takes the end of a SUMO step.
    pub fn step(&mut self, step: &StepSample) {
        kernel::step(self, step);
    }

    /// The sums of a slot since the last call (or the reset), and zero from here on.
    pub fn take_sums(&mut self, slot: usize) -> Sums {
        let [samples, error_mps, error_squared, speed_mps] =
            self.sums.each_mut().map(|column| std::mem::take(&mut column[slot]));
        Sums { samples: samples as u64, error_mps, error_squared, speed_mps }
    }

    /// The statistics of a slot so far.
    pub fn read(&self, slot: usize) -> VehicleStats {
        let some = |count: f64, value: f64| (count > 0.0).then_some(value);
        let n = self.samples[slot];
        let mean = self.error_mean[slot];
        let variance = self.error_m2[slot] / n;
        let sampled = |value| some(n, value);
        let steps = self.steps[slot];
        let share = |column: &Lanes| some(steps, column[slot] / steps);
        let bound = self.bound.map(|column| column[slot]);
        let bound_steps: f64 = bound.iter().sum();
        let bound_share = |count: f64| some(bound_steps, count / bound_steps);
        let window = &self.window;
        VehicleStats {
            samples: n as u64,
            error_mean: sampled(mean),
            error_std: sampled(variance.sqrt()),
            error_rms: sampled((mean * mean + variance).sqrt()),
            error_max_abs: sampled(self.error_max_abs[slot]),
            overshoot_max: sampled(self.overshoot.max_mps(slot)),
            speed_gap_rms: some(steps, (self.gap_squared[slot] / steps).sqrt()),
            jerk_rms: some(window.jerks[slot], (window.jerk_squared[slot] / window.jerks[slot]).sqrt()),
            accel_max: some(window.closed[slot], window.accel_max[slot]),
            decel_max: some(window.closed[slot], window.decel_max[slot]),
            torque_rms: sampled((self.torque_squared[slot] / n).sqrt()),
            share_traffic: bound_share(bound[0]),
            share_limit: bound_share(bound[1]),
            share_profile: bound_share(bound[2]),
            share_clamp: bound_share(bound[3]),
            clamped_steps: bound[3] as u64,
            lead_limited: share(&self.lead_limited),
            curvature_limited: share(&self.curvature_limited),
        }
    }
}

#[cfg(test)]
mod tests;
