//! The lane loops. Values of inactive slots are selected away before they are used, so that whatever stands there, NaN
//! included, never enters a sum.

use super::{Sample, StatsBlock, StepSample, WINDOW_S};
use crate::lanes::{LANES, Lanes, vectorised};

/// Accelerations averaged over consecutive windows, per slot.
#[derive(Debug, Clone)]
pub(super) struct Window {
    /// Control periods of one window.
    periods: f64,
    /// 1 / its length.
    rate_hz: f64,
    /// Control periods since the present window began.
    elapsed: Lanes,
    start_mps: Lanes,
    /// Acceleration of the window before, if `has_previous`.
    previous_mps2: Lanes,
    has_previous: Lanes,
    /// Windows that ended.
    pub closed: Lanes,
    pub accel_max: Lanes,
    pub decel_max: Lanes,
    /// Pairs of neighbouring windows.
    pub jerks: Lanes,
    pub jerk_squared: Lanes,
}

impl Window {
    pub fn new(period_s: f64) -> Self {
        const ZERO: Lanes = [0.0; LANES];
        let periods = (WINDOW_S / period_s).round().max(1.0);
        Self {
            periods,
            rate_hz: 1.0 / (periods * period_s),
            elapsed: ZERO,
            start_mps: ZERO,
            previous_mps2: ZERO,
            has_previous: ZERO,
            closed: ZERO,
            accel_max: ZERO,
            decel_max: ZERO,
            jerks: ZERO,
            jerk_squared: ZERO,
        }
    }

    pub fn reset(&mut self, slot: usize) {
        for column in
            [&mut self.closed, &mut self.accel_max, &mut self.decel_max, &mut self.jerks, &mut self.jerk_squared]
        {
            column[slot] = 0.0;
        }
    }

    pub fn rejoin(&mut self, slot: usize, speed_mps: f64) {
        self.elapsed[slot] = 0.0;
        self.has_previous[slot] = 0.0;
        self.start_mps[slot] = speed_mps;
    }

    /// Counts a control period; where a window ends with it, closes it. That is seldom: once in [`WINDOW_S`].
    #[inline(always)]
    fn sample(&mut self, speed_mps: &Lanes, active: &Lanes) {
        let mut closes = [false; LANES];
        for i in 0..LANES {
            self.elapsed[i] += if active[i] > 0.0 { 1.0 } else { 0.0 };
            closes[i] = (active[i] > 0.0) & (self.elapsed[i] >= self.periods);
        }
        if closes.contains(&true) {
            self.close(speed_mps, &closes);
        }
    }

    #[inline(always)]
    fn close(&mut self, speed_mps: &Lanes, closes: &[bool; LANES]) {
        for i in 0..LANES {
            let closes = closes[i];
            let accel = (speed_mps[i] - self.start_mps[i]) * self.rate_hz;
            let jerk = (accel - self.previous_mps2[i]) * self.rate_hz;
            let pairs = closes & (self.has_previous[i] > 0.0);
            self.jerk_squared[i] += if pairs { jerk * jerk } else { 0.0 };
            self.jerks[i] += if pairs { 1.0 } else { 0.0 };
            self.accel_max[i] = if closes { self.accel_max[i].max(accel) } else { self.accel_max[i] };
            self.decel_max[i] = if closes { self.decel_max[i].max(-accel) } else { self.decel_max[i] };
            self.closed[i] += if closes { 1.0 } else { 0.0 };
            self.previous_mps2[i] = if closes { accel } else { self.previous_mps2[i] };
            self.has_previous[i] = if closes { 1.0 } else { self.has_previous[i] };
            self.start_mps[i] = if closes { speed_mps[i] } else { self.start_mps[i] };
            self.elapsed[i] = if closes { 0.0 } else { self.elapsed[i] };
        }
    }
}

vectorised! {
    /// The end of a control period.
    pub(super) fn sample(block: &mut StatsBlock, sample: &Sample) {
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
    pub(super) fn step(block: &mut StatsBlock, step: &StepSample) {
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
