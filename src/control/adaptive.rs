//! The adaptive model-free law (Polack et al. 2017, Section 3). `mfc.rs` has the model and the default tuning.
//!
//! ```text
//! u_k = −(F̂_k − ẏ_r + K_P e_k)/α̂_{k−1}                                   (iP law)
//! α̂_k = max((−F̂_k + ẏ_r)/(u_k + ε sign u_k), α_nominal), sign 0 = +1     (adaptation)
//! v_k = α̂_k u_k                                                          (Algorithm 1)
//! ```
//! The first two lines give α̂_k ≈ α̂_{k−1} + K_P e/u. While the torque pushes the wrong way, α̂ grows and takes the torque
//! back within a few periods. Otherwise α̂ returns to its nominal value.

use super::controller::Controller;
use super::law::{Build, law};
use super::mfc::{Estimate, MfcKeys};
use super::signals::{Actuation, Command, Observation};
use crate::columns::{Column, Slots, columns};
use crate::lanes::{LANES, Lanes, vectorised};
use crate::registry::Entry;
use crate::{choice, keys};

choice! {
    /// Which α̂ the input in the window is multiplied with.
    enum WindowAlpha {
        Updated = "updated",
        Used = "used",
    }
}

keys! {
    /// Keys of the adaptive law.
    #[derive(Copy)]
    struct AdaptiveKeys {
        ..mfc: MfcKeys,
        /// keeps the adaptation finite at u = 0
        epsilon: f64 = 0.01, "u", 1e-9..=1e3;
        /// alpha times u in the window: with the alpha adapted after u (Algorithm 1) or with the one that gave u
        window_alpha: WindowAlpha = WindowAlpha::Updated;
        /// compute u once more with the adapted alpha before it is sent
        recompute_u: bool = false;
    }
}

pub(super) fn entry() -> Entry<Build> {
    let summary = "model-free control with the input gain adapted in every period (Polack et al. 2017, Algorithm 1)";
    law("adaptive", summary, |keys: AdaptiveKeys, period_s| {
        let estimate = Estimate::of(&keys.mfc, period_s);
        Adaptive::new(keys, estimate)
    })
}

columns! {
    /// The law for one block of vehicles.
    struct Adaptive(keys: AdaptiveKeys, estimate: Estimate) {
        shared {
            keys: AdaptiveKeys = keys,
        }
        parts {
            alpha: Column = Column::new(keys.mfc.alpha_nominal),
            estimate: Estimate = estimate,
        }
    }
}

impl Controller for Adaptive {
    fn command(&mut self, observation: &Observation, command: &mut Command) {
        self.estimate.update(observation);
        adapt(&self.keys, observation, &self.estimate.f_hat_mps2, &mut self.alpha.values, command);
    }

    fn feedback(&mut self, actuation: &Actuation) {
        self.estimate.take(actuation);
    }

    fn reset(&mut self, slot: usize, speed_mps: f64) {
        self.clear(slot);
        self.estimate.reset(slot, speed_mps);
    }

    fn alpha_ratio(&self, slot: usize) -> f64 {
        self.alpha.values[slot] / self.keys.mfc.alpha_nominal
    }

    fn f_hat_mps2(&self, slot: usize) -> f64 {
        self.estimate.f_hat_mps2[slot]
    }
}

vectorised! {
    /// The iP law and the adaptation, in the order of Algorithm 1.
    fn adapt(keys: &AdaptiveKeys, observed: &Observation, f_hat: &Lanes, alpha: &mut Lanes, command: &mut Command) {
        let (mfc, epsilon, recompute_u) = (&keys.mfc, keys.epsilon, keys.recompute_u);
        let window_uses_updated = keys.window_alpha == WindowAlpha::Updated;
        for i in 0..LANES {
            let [wanted, demand] = mfc.inputs_mps2(observed, f_hat, i);
            let used = alpha[i];
            let u = demand / used;
            let away_from_zero = if u < 0.0 { u - epsilon } else { u + epsilon };
            let updated = (wanted / away_from_zero).max(mfc.alpha_nominal);
            let sent = if recompute_u { demand / updated } else { u };
            let in_window = if window_uses_updated { updated } else { used };
            alpha[i] = updated;
            command.ask(i, sent, mfc.accel_per_unit_mps2 * observed.nominal_nm_per_mps2[i], in_window);
        }
    }
}
