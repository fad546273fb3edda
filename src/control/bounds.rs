//! Bounds that all laws share.

use crate::keys;

/// Bound on inputs, far outside anything physical. An unlimited input can run away; bounded, sums of it stay numbers.
pub(super) const INPUT_MAX_MPS2: f64 = 1e6;

keys! {
    /// What a law believes of the reference's rate.
    #[derive(Copy)]
    pub(super) struct RateKeys {
        /// rates of the reference above this are jumps and taken as 0; 0 ignores the rate altogether
        reference_rate_max_mps2: f64 = 20.0, "m/s2", 0.0..=1e6;
    }
}

impl RateKeys {
    /// The rate of the reference, without its jumps [m/s²].
    #[inline(always)]
    pub(super) fn bound(&self, rate_mps2: f64) -> f64 {
        if rate_mps2.abs() <= self.reference_rate_max_mps2 { rate_mps2 } else { 0.0 }
    }
}
