//! What the classic and the adaptive model-free law have in common (Polack et al. 2017, Sections 2 and 3).
//!
//! The vehicle is taken for ẏ = F + αu with everything unknown in F. In period k, with e = y − y_r:
//! ```text
//! F̂_k = filter(y up to k, v up to k−1)                                  (estimator.rs)
//! u_k = −(F̂_k − ẏ_r + K_P e_k)/α̂_{k−1}                                   (iP law)
//! v_k = α̂_k u_k                                                          (α̂_k = α_nominal in classic.rs; adaptive.rs)
//! ```
//! u is scaled: the torque is u·b·M·r with b = `accel_per_unit_mps2`, so that every key means the same for every vehicle.
//!
//! # Default tuning
//! For traffic: Δt = 10 ms, references in ramps of 0.1 s or longer, up to 4.5 m/s² of braking, no noise. b/α = 1 says that the
//! nominal torque scale is believed: one unit of v is then one of acceleration, and what is left in F is small. K_P = 1/s
//! lets an error fade within a second. The window holds the torque that acts (`applied`): without delay that is the
//! saturated torque, and with delay it keeps the estimator from charging F with torque that has yet to arrive. A point
//! mass with drag and 50 ms of lag then follows stop and go with an RMS error below 0.06 m/s, with 40 % less mass likewise;
//! with 250 ms of dead time below 0.35 (`saturated` gives more than twice that), with −6 dB of noise on top below 0.5:
//! `tests.rs` has the drive.
//!
//! On a grid of b/α from 0.15 to 1.5 and K_P from 0.3 to 3: a smaller b/α of 0.7 multiplies the undisturbed error by ten, 1.5 the
//! effect of noise by 1.5. More K_P gains a little on each disturbance alone and loses 9 % (1.5/s) to 78 % (3/s) where a
//! light car meets 250 ms of dead time. Both laws have the same tuning, so that a comparison shows the adaptation and
//! nothing else.

use super::bounds::{INPUT_MAX_MPS2, RateKeys};
use super::estimator::Window;
use super::signals::{Actuation, Observation};
use crate::columns::{Slots, columns};
use crate::lanes::Lanes;
use crate::{choice, keys};

choice! {
    /// How F is estimated.
    pub(super) enum Estimator {
        Algebraic = "algebraic",
        Difference = "difference",
    }
}

choice! {
    /// Which torque the window is told about.
    pub(super) enum InputEstimate {
        Commanded = "commanded",
        Saturated = "saturated",
        Applied = "applied",
    }
}

keys! {
    /// Keys of both laws.
    #[derive(Copy)]
    pub(super) struct MfcKeys {
        /// K_P, rate at which the error decays if the estimate is right
        k_p: f64 = 1.0, "1/s", 0.0..=1000.0;
        /// alpha of the classic law and lower bound of the adapted one
        alpha_nominal: f64 = 1.0, "m/s2 per u", 1e-6..=1e6;
        /// b, acceleration of the nominal vehicle per unit of u: the torque is u*b*M*r
        accel_per_unit_mps2: f64 = 1.0, "m/s2 per u", 1e-6..=1e3;
        /// T, length of the estimator's window
        window_s: f64 = 0.2, "s", 0.001..=5.0;
        /// filter over the window, or the two-point formula F = dy/dt - alpha u
        estimator: Estimator = Estimator::Algebraic;
        /// torque in the estimator's window: as asked for, within limits, or as it acts (limits, delay, lag)
        input_estimate: InputEstimate = InputEstimate::Applied;
        and ..rate: RateKeys,
    }
}

impl MfcKeys {
    /// ẏ_r − F̂, the input that keeps the error of a slot as it is, and αu, the input that lets it decay [m/s²].
    #[inline(always)]
    pub(super) fn inputs_mps2(&self, observed: &Observation, f_hat_mps2: &Lanes, slot: usize) -> [f64; 2] {
        let wanted = self.rate.bound(observed.reference_rate_mps2[slot]) - f_hat_mps2[slot];
        let error = observed.measured_mps[slot] - observed.reference_mps[slot];
        [wanted, wanted - self.k_p * error]
    }
}

columns! {
    /// F̂ of one block of vehicles, and what it is estimated from.
    pub(super) struct Estimate(input_estimate: InputEstimate, window: Window) {
        shared {
            input_estimate: InputEstimate = input_estimate,
        }
        parts {
            window: Window = window,
        }
        columns {
            /// v_{k−1} as the window will be told [m/s²].
            v_mps2: f64 = 0.0,
            pub(super) f_hat_mps2: f64 = 0.0,
        }
    }
}

impl Estimate {
    /// An estimate as the keys have it.
    pub(super) fn of(keys: &MfcKeys, period_s: f64) -> Self {
        let window_s = if keys.estimator == Estimator::Difference { period_s } else { keys.window_s };
        Self::new(keys.input_estimate, Window::new(window_s, period_s))
    }

    /// F̂_k, with the measured speed of this period.
    pub(super) fn update(&mut self, observation: &Observation) {
        self.f_hat_mps2 = self.window.estimate(&observation.measured_mps, &self.v_mps2);
    }

    /// Takes the input of this period for the next one.
    pub(super) fn take(&mut self, actuation: &Actuation) {
        let v_mps2 = match self.input_estimate {
            InputEstimate::Commanded => &actuation.commanded_mps2,
            InputEstimate::Saturated => &actuation.saturated_mps2,
            InputEstimate::Applied => &actuation.applied_mps2,
        };
        self.v_mps2 = v_mps2.map(|v| v.clamp(-INPUT_MAX_MPS2, INPUT_MAX_MPS2));
    }

    /// A new vehicle in a slot: its window is filled with its speed.
    pub(super) fn reset(&mut self, slot: usize, speed_mps: f64) {
        self.clear(slot);
        self.window.fill(slot, speed_mps);
    }
}
