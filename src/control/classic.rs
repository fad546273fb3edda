//! The classic model-free law: u_k = −(F̂_k − ẏ_r + K_P e_k)/α (Polack et al. 2017, Section 2). `mfc.rs` has the model and the
//! default tuning.

use super::controller::Controller;
use super::law::{Build, law};
use super::mfc::{Estimate, MfcKeys};
use super::signals::{Actuation, Command, Observation};
use crate::lanes::{LANES, Lanes, vectorised};
use crate::registry::Entry;

pub(super) fn entry() -> Entry<Build> {
    let summary = "model-free control with a constant input gain (Polack et al. 2017, Section 2)";
    law("classic", summary, |keys: MfcKeys, period_s| Classic { estimate: Estimate::of(&keys, period_s), keys })
}

struct Classic {
    keys: MfcKeys,
    estimate: Estimate,
}

impl Controller for Classic {
    fn command(&mut self, observation: &Observation, command: &mut Command) {
        self.estimate.update(observation);
        intelligent_p(&self.keys, observation, &self.estimate.f_hat_mps2, command);
    }

    fn feedback(&mut self, actuation: &Actuation) {
        self.estimate.take(actuation);
    }

    fn reset(&mut self, slot: usize, speed_mps: f64) {
        self.estimate.reset(slot, speed_mps);
    }

    fn f_hat_mps2(&self, slot: usize) -> f64 {
        self.estimate.f_hat_mps2[slot]
    }
}

vectorised! {
    /// The iP law.
    fn intelligent_p(keys: &MfcKeys, observed: &Observation, f_hat: &Lanes, command: &mut Command) {
        for i in 0..LANES {
            let [_, demand] = keys.inputs_mps2(observed, f_hat, i);
            let torque_per_u = keys.accel_per_unit_mps2 * observed.nominal_nm_per_mps2[i];
            command.ask(i, demand / keys.alpha_nominal, torque_per_u, keys.alpha_nominal);
        }
    }
}
