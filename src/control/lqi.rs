//! LQI, gain-scheduled over speed: a baseline that knows dead time, lag and drag.
//!
//! With ã = a − ẏ_r the acceleration that acts (without dead time) above that of the reference, and q the integrated error, a vehicle near
//! the speed y with drag c y² is
//! ```text
//! e_{k+1} = exp(−2cyΔt) e_k + Δt ã_k,   ã_k = λ ã_{k−1} + (1 − λ) ṽ_k,   q_{k+1} = q_k + Δt e_k
//! ```
//! Of all laws ṽ = −K (e, ã, q), the one used has the least Σ e² + (T_e ṽ)² + (q/T_i)² (`riccati.rs`). K is solved for speeds [`STEP_MPS`]
//! apart when the law is built, and interpolated in between. A dead time of d periods changes nothing of it: the best input is the
//! same K times the state to be in d periods (finite spectrum assignment: Manitius and Olbrot 1979, IEEE Trans.
//! Autom. Control 24(4), 541-552), which the past inputs tell (`actuator_model.rs`):
//! ```text
//! ê = e + P − θẏ_r,   q̂ = q + θ e + R − θ(θ − Δt)ẏ_r/2,   v = ẏ_r − K (ê, ã, q̂)
//! ```
//! so the eigenvalues of the loop are those without dead time. The prediction needs no unknown force: as q integrates the error that is,
//! a constant force leaves none.
//! While the limits cut v off, q takes nothing up that would have more cut off.
//!
//! # Default tuning
//! T_e = 1 s and T_i = 2 s: K is about 1.4/s and 0.5/s² without lag, near the other laws' K_P of 1/s. c = 4e-4/m is a saloon's; it matters little: at
//! 40 m/s it takes 2 % off K.

use super::actuator_model::{ActuatorModel, Lateness, ModelKeys};
use super::bounds::RateKeys;
use super::controller::Controller;
use super::law::{Build, law};
use super::riccati::{Matrix, Vector, regulator};
use super::signals::{Actuation, Command, Observation};
use crate::columns::{Slots, columns};
use crate::keys;
use crate::lanes::{LANES, vectorised};
use crate::registry::Entry;

/// Speeds that K is solved for are this far apart [m/s].
const STEP_MPS: f64 = 10.0;
/// Bound on the integrated error \[m\].
const INTEGRAL_MAX_M: f64 = 1e6;
/// How many there are, from 0 on.
const SPEEDS: usize = 7;

keys! {
    /// Keys of the law.
    #[derive(Copy)]
    struct LqiKeys {
        ..model: ModelKeys,
        /// T_e, weight of acceleration against that of the speed error: less is faster
        error_time_s: f64 = 1.0, "s", 1e-3..=1e3;
        /// T_i, weight of the speed error against that of its integral: less is faster
        integral_time_s: f64 = 2.0, "s", 1e-3..=1e4;
        /// c, the nominal vehicle's drag is a deceleration of c*y*y
        drag_per_m: f64 = 4e-4, "1/m", 0.0..=0.1;
        and ..rate: RateKeys,
    }
}

pub(super) fn entry() -> Entry<Build> {
    let summary =
        "linear-quadratic regulator with integral action, predicted over the dead time, gains scheduled over speed";
    law("lqi", summary, |keys: LqiKeys, period_s| {
        let late = Lateness::of(&keys.model, period_s);
        let gains = std::array::from_fn(|at| gains(&keys, late, STEP_MPS * at as f64));
        Lqi::new(gains, keys.rate, ActuatorModel::new(late))
    })
}

/// K near a speed.
fn gains(keys: &LqiKeys, late: Lateness, speed_mps: f64) -> Vector<3> {
    let (a, b) = vehicle(late, keys.drag_per_m * speed_mps);
    let weights = [1.0, 0.0, 1.0 / (keys.integral_time_s * keys.integral_time_s)];
    regulator(&a, &b, &weights, keys.error_time_s * keys.error_time_s).gains
}

/// A and B of the head of this file, for c y.
fn vehicle(late: Lateness, drag_per_s: f64) -> (Matrix<3>, Vector<3>) {
    let (dt, decay) = (late.period_s, late.decay);
    let a = [[libm::exp(-2.0 * drag_per_s * dt), dt * decay, 0.0], [0.0, decay, 0.0], [dt, 0.0, 1.0]];
    (a, [dt * (1.0 - decay), 1.0 - decay, 0.0])
}

columns! {
    struct Lqi(gains: [Vector<3>; SPEEDS], rate: RateKeys, model: ActuatorModel) {
        shared {
            gains: [Vector<3>; SPEEDS] = gains,
            rate: RateKeys = rate,
        }
        parts {
            model: ActuatorModel = model,
        }
        columns {
            /// q \[m\].
            integral_m: f64 = 0.0,
        }
    }
}

impl Controller for Lqi {
    fn command(&mut self, observation: &Observation, command: &mut Command) {
        regulate(self, observation, command);
    }

    fn feedback(&mut self, actuation: &Actuation) {
        self.model.take(actuation);
    }

    fn reset(&mut self, slot: usize, _speed_mps: f64) {
        self.clear(slot);
    }
}

vectorised! {
    fn regulate(law: &mut Lqi, observed: &Observation, command: &mut Command) {
        let period_s = law.model.late.period_s;
        let delay_s = law.model.late.delay_s();
        for i in 0..LANES {
            let rate = law.rate.bound(observed.reference_rate_mps2[i]);
            let e = observed.measured_mps[i] - observed.reference_mps[i];
            let place = (observed.measured_mps[i] / STEP_MPS).clamp(0.0, (SPEEDS - 1) as f64 - 1e-9);
            let (below, share) = (place as usize, place - (place as usize) as f64);
            let (low, high) = (&law.gains[below], &law.gains[below + 1]);
            let gain = |j: usize| low[j] + share * (high[j] - low[j]);
            let e_ahead = e + law.model.pending_mps[i] - delay_s * rate;
            let on_the_way_m = law.model.pending_m[i] - 0.5 * delay_s * (delay_s - period_s) * rate;
            let q_ahead = law.integral_m[i] + delay_s * e + on_the_way_m;
            let v = rate - gain(0) * e_ahead - gain(1) * (law.model.ahead_mps2[i] - rate) - gain(2) * q_ahead;
            let step = period_s * e;
            let step = if step * law.model.excess_mps2[i] < 0.0 { 0.0 } else { step };
            law.integral_m[i] = (law.integral_m[i] + step).clamp(-INTEGRAL_MAX_M, INTEGRAL_MAX_M);
            command.ask(i, v, observed.nominal_nm_per_mps2[i], 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::loop_tests::{PERIOD_S, Plant};
    use crate::control::riccati::{apply, dot};
    use crate::keys::Values;

    fn law(delay_s: f64, lag_s: f64, drag_per_m: f64) -> (Lqi, LqiKeys, Lateness) {
        let model = ModelKeys { model_delay_s: Some(delay_s), model_lag_s: Some(lag_s) };
        let keys = LqiKeys { model, drag_per_m, ..LqiKeys::default() };
        let late = Lateness::of(&model, PERIOD_S);
        let gains = std::array::from_fn(|at| gains(&keys, late, STEP_MPS * at as f64));
        (Lqi::new(gains, keys.rate, ActuatorModel::new(late)), keys, late)
    }

    #[test]
    fn law_the_closed_loop_is_the_promised_one_whatever_the_dead_time() {
        for (delay_s, lag_s) in [(0.0, 0.0), (0.3, 0.0), (0.0, 0.2), (0.25, 0.3)] {
            let (mut law, keys, late) = law(delay_s, lag_s, 0.0);
            let k = gains(&keys, late, 0.0);
            let (a, b) = vehicle(late, 0.0);
            // The states in d periods; nothing is on its way at first, so that q has grown by e in each of them.
            let mut x = [1.0, 0.0, delay_s];
            let mut promised: std::collections::VecDeque<f64> = vec![1.0; late.periods() as usize].into();
            let mut plant = Plant::new(delay_s, lag_s, 0.0, 1.0);
            for period in 0..1_000 {
                promised.push_back(x[0]);
                let (e, wanted) = (plant.period(&mut law, 20.0, 0.0), promised.pop_front().unwrap());
                assert!((e - wanted).abs() < 1e-9, "{delay_s} {lag_s} period {period}: {e} for {wanted}");
                let (next, u) = (apply(&a, &x), -dot(&k, &x));
                x = std::array::from_fn(|i| next[i] + b[i] * u);
            }
            assert!(x[0].abs() < 0.02, "it comes to rest: {x:?}");
        }
    }

    #[test]
    fn law_a_constant_force_and_a_ramp_leave_no_error() {
        let (mut law, ..) = law(0.25, 0.1, 4e-4);
        let mut plant = Plant::new(0.25, 0.1, -0.5, 0.0);
        let mut reference = 5.0;
        for _ in 0..3_000 {
            plant.period(&mut law, reference, 0.5);
            reference += PERIOD_S * 0.5;
        }
        assert!(plant.error_mps.abs() < 1e-3, "{}", plant.error_mps);
    }

    /// The gains are the best for the cost that the keys state: any other ones cost more.
    #[test]
    fn law_the_weights_are_those_of_the_keys() {
        let model = ModelKeys { model_delay_s: None, model_lag_s: Some(0.2) };
        let keys = LqiKeys { model, error_time_s: 0.7, integral_time_s: 3.0, ..LqiKeys::default() };
        let late = Lateness::of(&model, PERIOD_S);
        let (a, b) = vehicle(late, keys.drag_per_m * 20.0);
        let cost = |k: &Vector<3>| {
            let (mut x, mut sum) = ([1.0, 0.5, 0.5], 0.0);
            for _ in 0..10_000 {
                let u = -dot(k, &x);
                sum += x[0] * x[0] + (x[2] / 3.0).powi(2) + (0.7 * u).powi(2);
                let next = apply(&a, &x);
                x = std::array::from_fn(|i| next[i] + b[i] * u);
            }
            sum
        };
        let best = gains(&keys, late, 20.0);
        for i in 0..3 {
            for factor in [0.99, 1.01] {
                let mut other = best;
                other[i] *= factor;
                assert!(cost(&other) > cost(&best), "gain {i}, {factor}");
            }
        }
    }

    /// The entry schedules the gains as the law is tested here.
    #[test]
    fn law_the_entry_has_a_gain_for_each_speed() {
        let keys = LqiKeys::default();
        let late = Lateness::of(&keys.model, PERIOD_S);
        let mut built = (entry().build)(&Values::defaults(entry().keys), PERIOD_S).block().expect("a law");
        for speed_mps in [0.0, 12.0, 30.0] {
            built.reset(0, speed_mps);
            let observation = Observation {
                measured_mps: [speed_mps + 1.0; LANES],
                reference_mps: [speed_mps; LANES],
                nominal_nm_per_mps2: [1.0; LANES],
                ..Observation::default()
            };
            let mut command = Command::default();
            built.command(&observation, &mut command);
            // Between two speeds the gain is interpolated.
            let wanted = -gains(&keys, late, speed_mps + 1.0)[0];
            assert!((command.torque_nm[0] - wanted).abs() < 1e-4, "{speed_mps}: {} for {wanted}", command.torque_nm[0]);
        }
    }

    #[test]
    fn law_gains_fall_with_the_drag_that_helps_them() {
        let (law, ..) = law(0.0, 0.1, 4e-3);
        assert!(law.gains.windows(2).all(|pair| pair[1][0] < pair[0][0]), "{:?}", law.gains);
        let (flat, ..) = self::law(0.0, 0.1, 0.0);
        assert!(flat.gains.iter().all(|gains| *gains == flat.gains[0]));
    }

    #[test]
    fn law_what_the_limits_cut_off_is_not_integrated() {
        // Twenty seconds at the limit, from 20 m/s too slow.
        let (mut law, ..) = law(0.0, 0.0, 0.0);
        let mut plant = Plant::new(0.0, 0.0, 0.0, -20.0);
        plant.limits_mps2 = [-1.0, 1.0];
        let overshoot = (0..4_000).map(|_| plant.period(&mut law, 30.0, 0.0)).fold(0.0, f64::max);
        assert!(overshoot < 0.5, "{overshoot} m/s");
    }
}
