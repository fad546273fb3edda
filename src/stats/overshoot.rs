//! Overshoot: by how much a vehicle shoots beyond a reference that has risen.
//!
//! The paper's step test reads it off the plot as the first peak above the new reference (Polack et al. 2017, §5). In
//! traffic the reference never stands still, and e > 0 also arises where the reference *falls* and the vehicle lags, which
//! is no overshoot. Hence, per vehicle:
//!
//! 1. *Waiting.* The lowest reference since waiting began is remembered (at first, the vehicle's own speed: a reference
//!    that starts above it has risen). A **rise** begins when the reference is more than [`RISE_MPS`] above that lowest
//!    value and above the vehicle; ripples of the traffic are smaller.
//! 2. *Risen.* The crest, the highest reference since the rise began, is remembered. V_x − crest becomes positive only
//!    after the vehicle has reached the reference from below; its largest value is the overshoot. On a plateau and on a
//!    slope upwards that is e itself; behind a falling reference it is not.
//! 3. When the reference is more than [`RISE_MPS`] below the crest the rise is over: waiting again.
//!
//! A second step upwards (10 → 20 m/s) just lifts the crest.

use crate::columns::columns;
use crate::lanes::{LANES, Lanes};

/// What the reference must climb to count as a rise, and fall below its crest to end one [m/s].
pub const RISE_MPS: f64 = 0.5;

columns! {
    /// The overshoot of a block of vehicles.
    #[derive(Debug, Clone)]
    pub(super) struct Overshoot {
        columns {
            /// 1 after a rise began.
            risen: f64 = 0.0,
            /// The lowest reference while waiting, the crest after a rise began [m/s].
            mark: f64 = 0.0,
            /// The largest overshoot, 0 if there was none [m/s].
            pub max_mps: f64 = 0.0,
        }
    }
}

impl Overshoot {
    /// Waits afresh for a rise from `speed_mps`.
    pub(super) fn rejoin(&mut self, slot: usize, speed_mps: f64) {
        self.risen[slot] = 0.0;
        self.mark[slot] = speed_mps;
    }

    /// Takes the end of a control period.
    #[inline(always)]
    pub(super) fn sample(&mut self, speed_mps: &Lanes, reference_mps: &Lanes, active: &Lanes) {
        for i in 0..LANES {
            let (v, y) = (speed_mps[i], reference_mps[i]);
            let (on, was_risen) = (active[i] > 0.0, self.risen[i] > 0.0);
            let (crest, lowest) = (self.mark[i].max(y), self.mark[i].min(y));
            let over = self.max_mps[i].max(v - crest);
            let ends = y < crest - RISE_MPS;
            let begins = (y > lowest + RISE_MPS) & (v < y);
            let risen = if was_risen { !ends } else { begins };
            let kept = if was_risen { crest } else { lowest };
            // On every change of state the mark starts from the present reference.
            let mark = if risen == was_risen { kept } else { y };
            self.max_mps[i] = if on & was_risen { over } else { self.max_mps[i] };
            self.risen[i] = if on { f64::from(u8::from(risen)) } else { self.risen[i] };
            self.mark[i] = if on { mark } else { self.mark[i] };
        }
    }
}
