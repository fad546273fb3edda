//! What a law with a model believes of the actuators: a dead time, then a first-order lag, as `plant/actuator.rs` has them.
//!
//! The law hears from the actuators only what their limits left of its torque. The model runs twice: without the dead time, which says
//! what the torque sent by now comes to (a), and with it, which says what acts. Between the two lies what is on its way:
//! ```text
//! a_k = λ a_{k−1} + (1 − λ) v_k                       λ = exp(−Δt/τ), v the torque within the limits
//! P_{k+1} = P_k + Δt (a_k − a_{k−d})                   speed that is still to come, whatever is asked for from now on
//! R_{k+1} = R_k + Δt P_k − Δt² d a_{k−d}               its sum over the dead time: Σ e_{k+j} = d e_k + R_k/Δt, j = 0..d−1
//! ```
//! A dead time between two periods interpolates between the samples on both sides, as the actuator does.

use super::bounds::INPUT_MAX_MPS2;
use super::signals::Actuation;
use crate::columns::columns;
use crate::keys;
use crate::keys::Values;
use crate::lanes::{LANES, Lanes, vectorised};

keys! {
    /// The model of the actuators.
    #[derive(Copy)]
    pub(super) struct ModelKeys {
        /// dead time of the actuators that the law reckons with; not set = that of the section actuator
        model_delay_s: Option<f64>, "s", 0.0..=5.0;
        /// time constant of the actuators that the law reckons with; not set = that of the section actuator
        model_lag_s: Option<f64>, "s", 0.0..=5.0;
    }
}

/// Tells a law that has a model what the actuators are like, where its keys do not say it. Other laws have no such keys.
pub fn with_model(values: &Values, delay_s: f64, lag_s: f64) -> Values {
    let mut told = Values::default().with("model_delay_s", delay_s).with("model_lag_s", lag_s);
    told.0.append(&mut values.0.clone());
    told
}

/// Dead time and lag in control periods.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lateness {
    pub period_s: f64,
    /// Whole periods of dead time, and the weight of the sample one period older.
    whole: usize,
    older: f64,
    /// λ.
    pub decay: f64,
}

impl Lateness {
    pub fn of(keys: &ModelKeys, period_s: f64) -> Self {
        let periods = keys.model_delay_s.unwrap_or(0.0) / period_s;
        // As for the actuator, a dead time typed as a multiple of the period is one.
        let periods = if (periods - periods.round()).abs() < 1e-9 { periods.round() } else { periods };
        let lag_s = keys.model_lag_s.unwrap_or(0.0);
        let decay = if lag_s > 0.0 { libm::exp(-period_s / lag_s) } else { 0.0 };
        Self { period_s, whole: periods.floor() as usize, older: periods - periods.floor(), decay }
    }

    /// d, not always whole.
    pub fn periods(&self) -> f64 {
        self.whole as f64 + self.older
    }

    /// The dead time \[s\].
    pub fn delay_s(&self) -> f64 {
        self.period_s * self.periods()
    }
}

columns! {
    /// The model of one block of vehicles.
    #[derive(Debug, Clone)]
    pub(super) struct ActuatorModel(late: Lateness) {
        shared {
            pub(super) late: Lateness = late,
            /// The newest row of the ring, which has one row per period.
            head: usize = 0,
        }
        parts {
            ring: Vec<Lanes> = vec![[0.0; LANES]; late.whole + 2],
        }
        columns {
            /// What the limits cut off the last torque [m/s²].
            pub(super) excess_mps2: f64 = 0.0,
            /// a_{k−1}.
            pub(super) ahead_mps2: f64 = 0.0,
            /// a_{k−1−d}, which acts.
            pub(super) acts_mps2: f64 = 0.0,
            /// P.
            pub(super) pending_mps: f64 = 0.0,
            /// R \[m\].
            pub(super) pending_m: f64 = 0.0,
        }
    }
}

impl ActuatorModel {
    /// Takes what was sent in this period.
    pub fn take(&mut self, actuation: &Actuation) {
        self.excess_mps2 = std::array::from_fn(|i| actuation.commanded_mps2[i] - actuation.saturated_mps2[i]);
        self.head = if self.head + 1 < self.ring.len() { self.head + 1 } else { 0 };
        let row = |back: usize| (self.head + self.ring.len() - back) % self.ring.len();
        let [newer, older] = [row(self.late.whole), row(self.late.whole + 1)];
        lag(&self.late, &actuation.saturated_mps2, &mut self.ahead_mps2);
        self.ring[self.head] = self.ahead_mps2;
        let [newer, older] = [self.ring[newer], self.ring[older]];
        pass_on(self, &newer, &older);
    }
}

vectorised! {
    fn lag(late: &Lateness, sent: &Lanes, ahead: &mut Lanes) {
        for i in 0..LANES {
            let sent = sent[i].clamp(-INPUT_MAX_MPS2, INPUT_MAX_MPS2);
            ahead[i] = sent + late.decay * (ahead[i] - sent);
        }
    }
}

vectorised! {
    fn pass_on(model: &mut ActuatorModel, newer: &Lanes, older: &Lanes) {
        let (period_s, periods) = (model.late.period_s, model.late.periods());
        for i in 0..LANES {
            let acts = newer[i] + model.late.older * (older[i] - newer[i]);
            model.pending_m[i] += period_s * (model.pending_mps[i] - period_s * periods * acts);
            model.pending_mps[i] += period_s * (model.ahead_mps2[i] - acts);
            model.acts_mps2[i] = acts;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::Slots;

    const PERIOD_S: f64 = 0.01;

    fn model(delay_s: f64, lag_s: f64) -> ActuatorModel {
        let keys = ModelKeys { model_delay_s: Some(delay_s), model_lag_s: Some(lag_s) };
        ActuatorModel::new(Lateness::of(&keys, PERIOD_S))
    }

    fn send(model: &mut ActuatorModel, v_mps2: f64) {
        model.take(&Actuation { saturated_mps2: [v_mps2; LANES], ..Actuation::default() });
    }

    #[test]
    fn a_dead_time_typed_as_a_multiple_of_the_period_is_one() {
        // 0.3 / 0.1 is a bit below 3, 0.07 / 0.01 a bit above 7.
        for (delay_s, period_s, periods) in [(0.3, 0.1, 3.0), (0.07, 0.01, 7.0), (0.02, 0.01, 2.0), (0.005, 0.02, 0.25)]
        {
            let late = Lateness::of(&ModelKeys { model_delay_s: Some(delay_s), model_lag_s: None }, period_s);
            assert_eq!((late.periods(), late.delay_s(), late.decay), (periods, period_s * periods, 0.0), "{delay_s}");
        }
        let between = Lateness::of(&ModelKeys { model_delay_s: Some(0.025), model_lag_s: Some(0.1) }, 0.01);
        assert!((between.periods() - 2.5).abs() < 1e-12 && (between.delay_s() - 0.025).abs() < 1e-15);
        assert!((between.decay - (-0.1f64).exp()).abs() < 1e-15);
    }

    #[test]
    fn law_what_is_pending_comes() {
        // After some inputs nothing more is sent; without lag the speed gained from there on is P, its sum R.
        for delay_s in [0.0, 0.05, 0.07] {
            let mut model = model(delay_s, 0.0);
            let periods = model.late.periods() as usize;
            for k in 0..40 {
                send(&mut model, f64::from(k % 7) - 2.5);
            }
            let (promised_mps, promised_m) = (model.pending_mps[3], model.pending_m[3]);
            let (mut gained_mps, mut gained_m) = (0.0, 0.0);
            for _ in 0..periods {
                gained_m += PERIOD_S * gained_mps;
                send(&mut model, 0.0);
                gained_mps += PERIOD_S * model.acts_mps2[3];
            }
            assert!((promised_mps - gained_mps).abs() < 1e-12, "{delay_s}: {promised_mps} for {gained_mps}");
            assert!((promised_m - gained_m).abs() < 1e-12, "{delay_s}: {promised_m} for {gained_m}");
            assert_eq!(delay_s > 0.0, gained_mps.abs() > 1e-3);
        }
    }

    #[test]
    fn val_the_model_acts_as_the_actuators_of_the_fleet_do() {
        for (delay_s, lag_s) in [(0.0, 0.0), (0.07, 0.0), (0.0, 0.2), (0.123, 0.05)] {
            let mut model = model(delay_s, lag_s);
            let mut actuators = crate::plant::Actuators::new(PERIOD_S, 0.5);
            actuators.set(0, delay_s, lag_s, 300.0, 800.0);
            for k in 0..200 {
                let torque = [700.0 * libm::sin(0.07 * f64::from(k)); LANES];
                let out = actuators.step(&torque, &[0.002; LANES]);
                let (sent, acts) = (out.saturated, out.applied);
                model.take(&Actuation { saturated_mps2: sent, ..Actuation::default() });
                assert!((model.acts_mps2[0] - acts[0]).abs() < 1e-12, "{delay_s} {lag_s} k {k}");
            }
        }
    }

    #[test]
    fn a_cleared_slot_has_nothing_on_its_way() {
        let mut model = model(0.05, 0.1);
        (0..20).for_each(|_| send(&mut model, 1.0));
        model.clear(4);
        (0..20).for_each(|_| send(&mut model, 0.0));
        assert_eq!((model.pending_mps[4], model.pending_m[4], model.ahead_mps2[4]), (0.0, 0.0, 0.0));
        assert!(model.ahead_mps2[5] > 0.0);
    }

    #[test]
    fn what_a_key_says_is_not_overridden() {
        let told = with_model(&Values::default().with("model_lag_s", 0.4), 0.25, 0.1);
        assert_eq!((told.get::<f64>("model_delay_s"), told.get::<f64>("model_lag_s")), (Some(0.25), Some(0.4)));
    }
}
