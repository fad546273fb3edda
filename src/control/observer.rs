//! An observer of a speed and its rate of change, of which a law corrects the one and the other by the measured speed.
//!
//! Both of its poles are p = exp(−4Δt/T), so that what it says of the rate is late by T/2.

/// The gains of the observer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Observer {
    /// 1 − p², what of an innovation goes into the speed.
    speed_gain: f64,
    /// (1 − p)²/Δt, what of it goes into the rate [1/s].
    rate_gain_per_s: f64,
}

impl Observer {
    /// For T = `window_s`.
    pub fn new(window_s: f64, period_s: f64) -> Self {
        let pole = libm::exp(-4.0 * period_s / window_s);
        Self { speed_gain: 1.0 - pole * pole, rate_gain_per_s: (1.0 - pole) * (1.0 - pole) / period_s }
    }

    /// Corrects speed [m/s] and rate [m/s²] by what was measured [m/s].
    #[inline(always)]
    pub fn correct(&self, measured_mps: f64, speed_mps: &mut f64, rate_mps2: &mut f64) {
        let innovation = measured_mps - *speed_mps;
        *speed_mps += self.speed_gain * innovation;
        *rate_mps2 += self.rate_gain_per_s * innovation;
    }
}
