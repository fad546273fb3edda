//! Accelerations averaged over consecutive windows.

use crate::columns::columns;
use crate::lanes::{LANES, Lanes};

/// Length over which accelerations are averaged \[s\].
pub const WINDOW_S: f64 = 0.5;

/// A jerk above this is counted as high [m/s³], a bound that studies of comfort often take.
pub const HIGH_JERK_MPS3: f64 = 2.0;

/// Control periods of one window.
fn periods(period_s: f64) -> f64 {
    (WINDOW_S / period_s).round().max(1.0)
}

columns! {
    /// The windows of a block of vehicles.
    #[derive(Debug, Clone)]
    pub(super) struct Window(period_s: f64) {
        shared {
            /// Control periods of one window.
            periods: f64 = periods(period_s),
            /// 1 / its length.
            rate_hz: f64 = 1.0 / (periods(period_s) * period_s),
        }
        columns {
            /// Control periods since the present window began.
            elapsed: f64 = 0.0,
            start_mps: f64 = 0.0,
            /// Acceleration of the window before, if `has_previous`.
            previous_mps2: f64 = 0.0,
            has_previous: f64 = 0.0,
            /// Windows that ended.
            pub closed: f64 = 0.0,
            pub accel_max: f64 = 0.0,
            pub decel_max: f64 = 0.0,
            /// Pairs of neighbouring windows.
            pub jerks: f64 = 0.0,
            pub jerk_squared: f64 = 0.0,
            /// Pairs with a jerk above [`HIGH_JERK_MPS3`].
            pub high_jerks: f64 = 0.0,
        }
    }
}

impl Window {
    /// RMS of the jerk between neighbouring windows [m/s³].
    pub fn jerk_rms(&self, slot: usize) -> Option<f64> {
        (self.jerks[slot] > 0.0).then(|| (self.jerk_squared[slot] / self.jerks[slot]).sqrt())
    }

    /// Share of the jerks above [`HIGH_JERK_MPS3`].
    pub fn high_jerk_share(&self, slot: usize) -> Option<f64> {
        (self.jerks[slot] > 0.0).then(|| self.high_jerks[slot] / self.jerks[slot])
    }

    /// Begins a window at `speed_mps`; what was before it is no neighbour.
    pub fn rejoin(&mut self, slot: usize, speed_mps: f64) {
        self.elapsed[slot] = 0.0;
        self.has_previous[slot] = 0.0;
        self.start_mps[slot] = speed_mps;
    }

    /// Counts a control period; where a window ends with it, closes it. That is seldom: once in [`WINDOW_S`].
    #[inline(always)]
    pub fn sample(&mut self, speed_mps: &Lanes, active: &Lanes) {
        let mut closes = [false; LANES];
        for i in 0..LANES {
            self.elapsed[i] += if active[i] > 0.0 { 1.0 } else { 0.0 };
            // A window that is full is closed at once: who does not drive has none.
            closes[i] = self.elapsed[i] >= self.periods;
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
            self.high_jerks[i] += if pairs & (jerk.abs() > HIGH_JERK_MPS3) { 1.0 } else { 0.0 };
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
