//! PI with a Smith predictor: a baseline that knows the dead time.
//!
//! The actuators are taken for a dead time θ and a lag, the vehicle for ẏ = a + F with a unknown but constant F. The predictor (Smith
//! 1957) acts on the error that is to be when a torque asked for now begins to act. For a plant that integrates, Smith's own form
//! leaves an error after a constant disturbance; what the integral I has found of it has to be in the prediction as
//! well (Matausek and Micic 1996, IEEE Trans. Autom. Control 41(8), 1199-1203):
//! ```text
//! ê_k = e_k + P_k − θ (ẏ_r + I_{k−1})                P the speed on its way (actuator_model.rs)
//! I_k = I_{k−1} − k_i Δt ê_k,   a_k = ẏ_r + I_k − k_p ê_k
//! ```
//! Without lag and with the right dead time, the error to be obeys s² + (k_p − θk_i)s + k_i = 0: the dead time costs damping by way of
//! the unknown force alone. While the limits cut a_k off, the integral takes nothing up that would have more cut off, as in `pid.rs`.
//!
//! # Default tuning
//! k_p = 1/s as for the other laws; k_i = 0.25/s² is critically damped without dead time and well damped (ζ > 0.8) up to 0.5 s.

use super::actuator_model::{ActuatorModel, Lateness, ModelKeys};
use super::bounds::{INPUT_MAX_MPS2, RateKeys};
use super::controller::Controller;
use super::law::{Build, law};
use super::signals::{Actuation, Command, Observation};
use crate::columns::{Slots, columns};
use crate::keys;
use crate::lanes::{LANES, vectorised};
use crate::registry::Entry;

keys! {
    /// Keys of the law.
    #[derive(Copy)]
    struct SmithKeys {
        ..model: ModelKeys,
        /// acceleration per predicted speed error
        k_p: f64 = 1.0, "1/s", 0.0..=1e6;
        /// acceleration per integrated predicted speed error
        k_i: f64 = 0.25, "1/s2", 0.0..=1e6;
        and ..rate: RateKeys,
    }
}

pub(super) fn entry() -> Entry<Build> {
    law(
        "smith_pi",
        "PI with a Smith predictor for the actuators' dead time (Smith 1957)",
        |keys: SmithKeys, period_s| SmithPi::new(keys, ActuatorModel::new(Lateness::of(&keys.model, period_s))),
    )
}

columns! {
    struct SmithPi(keys: SmithKeys, model: ActuatorModel) {
        shared {
            keys: SmithKeys = keys,
        }
        parts {
            model: ActuatorModel = model,
        }
        columns {
            /// I_{k−1} [m/s²].
            integral: f64 = 0.0,
        }
    }
}

impl Controller for SmithPi {
    fn command(&mut self, observation: &Observation, command: &mut Command) {
        act(self, observation, command);
    }

    fn feedback(&mut self, actuation: &Actuation) {
        self.model.take(actuation);
    }

    fn reset(&mut self, slot: usize, _speed_mps: f64) {
        self.clear(slot);
    }
}

vectorised! {
    fn act(law: &mut SmithPi, observed: &Observation, command: &mut Command) {
        let (keys, late) = (law.keys, law.model.late);
        for i in 0..LANES {
            let rate = keys.rate.bound(observed.reference_rate_mps2[i]);
            let e = observed.measured_mps[i] - observed.reference_mps[i];
            let e_ahead = e + law.model.pending_mps[i] - late.delay_s() * (rate + law.integral[i]);
            let step = -keys.k_i * late.period_s * e_ahead;
            let step = if step * law.model.excess_mps2[i] > 0.0 { 0.0 } else { step };
            law.integral[i] = (law.integral[i] + step).clamp(-INPUT_MAX_MPS2, INPUT_MAX_MPS2);
            let accel = rate + law.integral[i] - keys.k_p * e_ahead;
            command.ask(i, accel, observed.nominal_nm_per_mps2[i], 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::loop_tests::{PERIOD_S, Plant};

    #[test]
    fn law_the_closed_loop_is_the_promised_one() {
        // From 1 m/s too fast, under a constant force; v the force that is still unknown, x the error to be: x' = v − k_p (x − θv), v' = −k_i (x − θv).
        let (k_p, k_i, delay_s, force_mps2) = (1.5, 0.6, 0.3, -0.4);
        let model = ModelKeys { model_delay_s: Some(delay_s), model_lag_s: None };
        let keys = SmithKeys { k_p, k_i, model, rate: RateKeys::default() };
        let mut law = SmithPi::new(keys, ActuatorModel::new(Lateness::of(&model, PERIOD_S)));
        let mut plant = Plant::new(delay_s, 0.0, force_mps2, 1.0);
        let mut ahead = std::collections::VecDeque::new();
        let (mut x, mut unknown) = (1.0 + delay_s * force_mps2, force_mps2);
        for k in 0..2_000 {
            ahead.push_back(x);
            let e = plant.period(&mut law, 0.0, 0.0);
            if k >= 30 {
                let promised = ahead.pop_front().unwrap();
                assert!((e - promised).abs() < 1e-9, "k {k}: {e} for {promised}");
            }
            let seen = x - delay_s * unknown;
            unknown -= PERIOD_S * k_i * seen;
            x += PERIOD_S * (unknown - k_p * seen);
        }
        assert!(plant.error_mps.abs() < 1e-3, "no error is left after a constant force: {}", plant.error_mps);
    }

    #[test]
    fn law_what_the_limits_cut_off_is_not_integrated() {
        // Twenty seconds at the limit, from 20 m/s too slow.
        let keys = SmithKeys::default();
        let mut law = SmithPi::new(keys, ActuatorModel::new(Lateness::of(&keys.model, PERIOD_S)));
        let mut plant = Plant::new(0.0, 0.0, 0.0, -20.0);
        plant.limits_mps2 = [-1.0, 1.0];
        let overshoot = (0..4_000).map(|_| plant.period(&mut law, 30.0, 0.0)).fold(0.0, f64::max);
        assert!(overshoot < 0.5, "{overshoot} m/s");
    }
}
