//! The running statistics of a block of vehicles. Values of inactive slots are selected away before they are used, so that
//! whatever stands there, NaN included, never enters a sum.

use super::overshoot::Overshoot;
use super::sample::{Sample, StepSample};
use super::vehicle::{Sums, VehicleStats};
use super::window::Window;
use crate::columns::{Slots, columns};
use crate::lanes::{LANES, Lanes, vectorised};

columns! {
    /// Running statistics of one block of vehicles, one column per sum, for control periods of `period_s` \[s\].
    #[derive(Debug, Clone)]
    pub struct StatsBlock(period_s: f64) {
        parts {
            window: Window = Window::new(period_s),
            overshoot: Overshoot = Overshoot::default(),
            /// Samples, Σ e, Σ e², Σ V_x since they were last taken.
            sums: [Lanes; 4] = [[0.0; LANES]; 4],
            /// Steps bound by traffic, limit, profile, clamp.
            bound: [Lanes; 4] = [[0.0; LANES]; 4],
        }
        columns {
            samples: f64 = 0.0,
            error_mean: f64 = 0.0,
            error_m2: f64 = 0.0,
            error_max_abs: f64 = 0.0,
            torque_squared: f64 = 0.0,
            steps: f64 = 0.0,
            gap_squared: f64 = 0.0,
            lead_limited: f64 = 0.0,
            curvature_limited: f64 = 0.0,
        }
    }
}

impl StatsBlock {
    /// Forgets a slot: a new vehicle, now at `speed_mps`.
    pub fn reset(&mut self, slot: usize, speed_mps: f64) {
        self.clear(slot);
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
        sample_end(self, sample);
    }

    /// Takes the end of a SUMO step.
    pub fn step(&mut self, step: &StepSample) {
        step_end(self, step);
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
            overshoot_max: sampled(self.overshoot.max_mps[slot]),
            speed_gap_rms: some(steps, (self.gap_squared[slot] / steps).sqrt()),
            jerk_rms: window.jerk_rms(slot),
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

vectorised! {
    /// The end of a control period.
    fn sample_end(block: &mut StatsBlock, sample: &Sample) {
        let [samples, error_sum, error_squared, speed_sum] = &mut block.sums;
        for i in 0..LANES {
            let on = sample.active[i] > 0.0;
            let one = if on { 1.0 } else { 0.0 };
            let error = if on { sample.speed_mps[i] - sample.reference_mps[i] } else { 0.0 };
            let speed = if on { sample.speed_mps[i] } else { 0.0 };
            let torque = if on { sample.torque_nm[i] } else { 0.0 };
            let n = block.samples[i] + one;
            let delta = if on { error - block.error_mean[i] } else { 0.0 };
            let mean = block.error_mean[i] + delta / n.max(1.0);
            block.samples[i] = n;
            block.error_m2[i] += delta * (error - mean);
            block.error_mean[i] = mean;
            block.error_max_abs[i] = block.error_max_abs[i].max(error.abs());
            block.torque_squared[i] += torque * torque;
            samples[i] += one;
            error_sum[i] += error;
            error_squared[i] += error * error;
            speed_sum[i] += speed;
        }
        block.window.sample(&sample.speed_mps, &sample.active);
        block.overshoot.sample(&sample.speed_mps, &sample.reference_mps, &sample.active);
    }
}

vectorised! {
    /// The end of a SUMO step.
    fn step_end(block: &mut StatsBlock, step: &StepSample) {
        let [traffic, limit, profile, clamp] = &mut block.bound;
        for i in 0..LANES {
            let on = step.active[i] > 0.0;
            let gap = if on { step.speed_gap_mps[i] } else { 0.0 };
            block.steps[i] += if on { 1.0 } else { 0.0 };
            block.gap_squared[i] += gap * gap;
            block.lead_limited[i] += if on { step.lead_limited[i] } else { 0.0 };
            block.curvature_limited[i] += if on { step.curvature_limited[i] } else { 0.0 };
            traffic[i] += if on { step.bound_traffic[i] } else { 0.0 };
            limit[i] += if on { step.bound_limit[i] } else { 0.0 };
            profile[i] += if on { step.bound_profile[i] } else { 0.0 };
            clamp[i] += if on { step.bound_clamp[i] } else { 0.0 };
        }
    }
}
