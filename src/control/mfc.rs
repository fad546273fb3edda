//! Model-free control, classic and adaptive (Polack et al. 2017, Sections 2 and 3).
//!
//! The vehicle is taken for ẏ = F + αu with everything unknown in F. In period k, with e = y − y_r:
//! ```text
//! F̂_k = filter(y up to k, v up to k−1)                                  (estimator.rs)
//! u_k = −(F̂_k − ẏ_r + K_P e_k)/α̂_{k−1}                                   (iP law)
//! α̂_k = max((−F̂_k + ẏ_r)/(u_k + ε sign u_k), α_nominal), sign 0 = +1     (adaptive; classic keeps α_nominal)
//! v_k = α̂_k u_k                                                          (Algorithm 1)
//! ```
//! u is scaled: the torque is u·b·M·r with b = `accel_per_unit_mps2`, so that ε means the same for every vehicle. Steps
//! two and three give α̂_k ≈ α̂_{k−1} + K_P e/u: α̂ grows while the torque pushes the wrong way, which takes it back
//! within a few periods, and else returns to its nominal value.
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

use super::estimator::Window;
use super::{Actuation, Command, Controller, Observation};
use crate::columns::{Column, Slots, columns};
use crate::lanes::{LANES, Lanes, vectorised};
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

choice! {
    /// Which α̂ the input in the window is multiplied with.
    pub(super) enum WindowAlpha {
        Updated = "updated",
        Used = "used",
    }
}

keys! {
    /// Keys of the classic law.
    pub(super) struct ClassicKeys {
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
        /// rates of the reference above this are jumps and taken as 0; 0 ignores the rate altogether
        reference_rate_max_mps2: f64 = 20.0, "m/s2", 0.0..=1e6;
    }
}

keys! {
    /// Keys of the adaptive law.
    pub(super) struct AdaptiveKeys {
        ..classic: ClassicKeys,
        /// keeps the adaptation finite at u = 0
        epsilon: f64 = 0.01, "u", 1e-9..=1e3;
        /// alpha times u in the window: with the alpha adapted after u (Algorithm 1) or with the one that gave u
        window_alpha: WindowAlpha = WindowAlpha::Updated;
        /// compute u once more with the adapted alpha before it is sent
        recompute_u: bool = false;
    }
}

pub(super) fn classic(keys: ClassicKeys, period_s: f64) -> Mfc {
    build(Law::classic(&keys), &keys, period_s)
}

pub(super) fn adaptive(keys: AdaptiveKeys, period_s: f64) -> Mfc {
    let adaptation = Adaptation {
        epsilon: keys.epsilon,
        window_uses_updated: keys.window_alpha == WindowAlpha::Updated,
        recompute_u: keys.recompute_u,
    };
    build(Law { adaptation: Some(adaptation), ..Law::classic(&keys.classic) }, &keys.classic, period_s)
}

/// The constants of the law.
#[derive(Debug, Clone, Copy)]
pub(super) struct Law {
    k_p: f64,
    alpha_nominal: f64,
    accel_per_unit_mps2: f64,
    rate_max_mps2: f64,
    adaptation: Option<Adaptation>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Adaptation {
    epsilon: f64,
    window_uses_updated: bool,
    recompute_u: bool,
}

impl Law {
    fn classic(keys: &ClassicKeys) -> Self {
        Self {
            k_p: keys.k_p,
            alpha_nominal: keys.alpha_nominal,
            accel_per_unit_mps2: keys.accel_per_unit_mps2,
            rate_max_mps2: keys.reference_rate_max_mps2,
            adaptation: None,
        }
    }
}

columns! {
    /// Both laws for one block of vehicles.
    pub(super) struct Mfc(law: Law, input_estimate: InputEstimate, window: Window) {
        shared {
            law: Law = law,
            input_estimate: InputEstimate = input_estimate,
        }
        parts {
            window: Window = window,
            alpha: Column = Column::new(law.alpha_nominal),
        }
        columns {
            /// v_{k−1} as the window will be told [m/s²].
            v_mps2: f64 = 0.0,
            f_hat_mps2: f64 = 0.0,
        }
    }
}

/// Either law, as the keys have it.
fn build(law: Law, keys: &ClassicKeys, period_s: f64) -> Mfc {
    let window_s = if keys.estimator == Estimator::Difference { period_s } else { keys.window_s };
    Mfc::new(law, keys.input_estimate, Window::new(window_s, period_s))
}

impl Controller for Mfc {
    fn command(&mut self, observation: &Observation, command: &mut Command) {
        self.f_hat_mps2 = self.window.estimate(&observation.measured_mps, &self.v_mps2);
        intelligent_p(&self.law, observation, &self.f_hat_mps2, &mut self.alpha.values, command);
    }

    fn feedback(&mut self, actuation: &Actuation) {
        self.v_mps2 = match self.input_estimate {
            InputEstimate::Commanded => actuation.commanded_mps2,
            InputEstimate::Saturated => actuation.saturated_mps2,
            InputEstimate::Applied => actuation.applied_mps2,
        };
        for v in &mut self.v_mps2 {
            *v = v.clamp(-INPUT_MAX_MPS2, INPUT_MAX_MPS2);
        }
    }

    fn reset(&mut self, slot: usize, speed_mps: f64) {
        self.clear(slot);
        self.window.fill(slot, speed_mps);
    }

    fn alpha_ratio(&self, slot: usize) -> f64 {
        self.alpha.values[slot] / self.law.alpha_nominal
    }

    fn f_hat_mps2(&self, slot: usize) -> f64 {
        self.f_hat_mps2[slot]
    }
}

/// Bound on the input in the window, far outside anything physical. An unlimited commanded input can run away; bounded, it
/// stays a number.
const INPUT_MAX_MPS2: f64 = 1e6;

vectorised! {
    /// The iP law and, if asked for, the adaptation, in the order of Algorithm 1.
    fn intelligent_p(law: &Law, observed: &Observation, f_hat: &Lanes, alpha: &mut Lanes, command: &mut Command) {
        let adapts = law.adaptation.is_some();
        let Adaptation { epsilon, window_uses_updated, recompute_u } =
            law.adaptation.unwrap_or(Adaptation { epsilon: 1.0, window_uses_updated: false, recompute_u: false });
        for i in 0..LANES {
            let rate = observed.reference_rate_mps2[i];
            let rate = if rate.abs() <= law.rate_max_mps2 { rate } else { 0.0 };
            let e = observed.measured_mps[i] - observed.reference_mps[i];
            let wanted = rate - f_hat[i]; // the input that would keep the error as it is
            let demand = wanted - law.k_p * e;

            let used = alpha[i];
            let u = demand / used;
            let away_from_zero = if u < 0.0 { u - epsilon } else { u + epsilon };
            let adapted = (wanted / away_from_zero).max(law.alpha_nominal);
            let updated = if adapts { adapted } else { used };
            let sent = if recompute_u { demand / updated } else { u };
            let in_window = if window_uses_updated { updated } else { used };
            alpha[i] = updated;

            let torque_per_u = law.accel_per_unit_mps2 * observed.nominal_nm_per_mps2[i];
            command.torque_nm[i] = sent * torque_per_u;
            command.gain_mps2_per_nm[i] = if torque_per_u > 0.0 { in_window / torque_per_u } else { 0.0 };
        }
    }
}
