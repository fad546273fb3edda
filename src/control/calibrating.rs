//! Model-free control that finds its torque scale and the delay of the actuators on the drive, and predicts over it.
//!
//! The classic law takes the vehicle for ẏ = F + v, v = αu. If the vehicle in truth answers with ρv, F has to stand for (ρ − 1)v
//! as well, which is fast, and is known only after half the window. The adaptive law reacts to that in every period and
//! forgets it in the next. Here ρ is a number of the vehicle, to be found once:
//! ```text
//! ẏ(t) = F + ρ v(t)        v the nominal vehicle's acceleration by the torque that acts, F slow, ρ constant
//! ```
//! **Observer.** Speed and F come from ŷ' = F̂ + ρ̂v + l₁(y − ŷ), F̂' = l₂(y − ŷ) with both poles at 4/T, so that F̂ is late by T/2 as with the
//! paper's window; in discrete time both poles are p = exp(−4Δt/T) and an affine y gives its slope exactly. It is
//! linear, so it runs on y and on v apart from each other, and whatever ρ̂ becomes, no past has to be corrected:
//! ```text
//! F̂ = d − ρ̂ w,   d = H(s) s y,   w = H(s) v,   H(s) = 1/(1 + sT/4)²
//! ```
//! **Calibration.** For constant F the same filter on both sides gives d = F + ρw + noise. Least squares would be
//! biased: the noise in d has come into w by the feedback. An instrument z that knows nothing of the noise does not have
//! that fault (Söderström and Stoica 1983), and one that follows the reference knows nothing of slope and wind either:
//! ```text
//! z = (y_r − ȳ_r)/τ,   ȳ_r' = z        the reference's rate, smoothed; of a jump it keeps what the bound on rates drops
//! ρ = cov(z, d)/cov(z, w)              F drops out with the means
//! ```
//! The moments are running means over `memory_s`, whose clock runs with z²/(z² + γ²): at constant speed nothing is learned and
//! nothing forgotten. With c for the covariances ρ̂ = (c_d c_w + ρ̂₀κ²)/(c_w² + κ²), which is ρ̂₀ (1, or see below) until something is known. z varies
//! within seconds, and so averages the noise of d, a derivative's, nearly to nothing.
//!
//! **Prediction.** The actuators tell what was sent within the limits and what acts. P = ∫ (v_sent − v_acts) dt is the speed, in units of
//! v, that is still on its way, be it in a dead time or in a lag. A torque asked for now acts after the delay θ, when
//! ```text
//! e(t + θ) = e + ρP + θF − θẏ_r
//! ```
//! with the rate of now, and that is the error to act on: u = (ẏ_r − F̂ − K_P e(t + θ))/ρ̂. In a steady pull P = θv and the sum is e.
//! The delay leaves the loop (Smith 1957, without a delay line, and without the need to know it: P ≈ θ(v_sent + v_acts)/2
//! by the trapezoidal rule, all of it known without noise, gives θ̂ by normalised least mean squares). With ρ̂ = ρ and
//! exact F̂, ė(t + θ) + K_P e(t + θ) = 0.
//!
//! A wrong ρ̂ is a feedback of (ρ/ρ̂ − 1)H around the law. The phase of H stays above −180°, so without delay even a scale
//! guessed far too low is stable while nothing moves that could teach it. With a delay that takes a gain below 1 (small
//! gain theorem), ρ < 2ρ̂. So until the reference teaches better, ρ̂ is ρ̂₀ = 1 + 2θ̂/(θ̂ + T/4), which bears a scale guessed too
//! low by 4 from a delay of T/4 on, and by 6 if it is long.
//! Where the tyres slide ρ is no constant; ρ̂ stays within bounds.
//!
//! # Default tuning
//! K_P = 1/s as for the other laws: more of it pays along a smooth recording with dead time (0.14 instead of 0.32 m/s on a racing lap with
//! 250 ms, K_P = 8/s) and harms in traffic, where the reference's rate jumps in every step of SUMO. T = 0.5 s instead of their
//! 0.2 s: with the scale right, F holds little that is fast, and the noise in F̂ falls with T^(−3/2); at 0.8 s the response to a slope
//! or a start comes late. `docs/controllers.md` compares the laws at equal tuning and says where this one loses.

use super::bounds::{INPUT_MAX_MPS2, RateKeys};
use super::controller::Controller;
use super::law::{Build, law};
use super::observer::Observer;
use super::signals::{Actuation, Command, Observation};
use crate::columns::{Slots, columns};
use crate::keys;
use crate::lanes::{LANES, vectorised};
use crate::registry::Entry;

keys! {
    /// Keys of the law.
    struct CalibratingKeys {
        /// K_P, rate at which the predicted error decays
        k_p: f64 = 1.0, "1/s", 0.0..=1000.0;
        /// b, first guess of the torque scale: the torque is u*b*M*r; may be wrong by a factor of 0.01 to 20
        accel_per_unit_mps2: f64 = 1.0, "m/s2 per u", 1e-6..=1e3;
        /// T, the observer's estimate of F is late by T/2
        window_s: f64 = 0.5, "s", 0.001..=5.0;
        /// time of speeding up and slowing down over which the torque scale is averaged
        memory_s: f64 = 10.0, "s", 0.1..=1e4;
        and ..rate: RateKeys,
    }
}

/// τ of the instrument, and time constant of what the delay is found from \[s\].
const SMOOTHING_S: f64 = 1.0;
/// γ: instrument and input count fully where they are well above this [m/s²].
const GATE_MPS2: f64 = 0.3;
/// κ, the covariance of instrument and input from which on the drive is believed [(m/s²)²].
const DOUBT_MPS4: f64 = 0.02;
/// Bounds on ρ̂.
const SCALE: [f64; 2] = [0.01, 20.0];
/// What a long delay adds to the scale of which nothing is known.
const CAUTION: f64 = 2.0;
/// Bound on the delay \[s\].
const DELAY_MAX_S: f64 = 2.0;

pub(super) fn entry() -> Entry<Build> {
    law(
        "calibrating",
        "model-free control that finds its torque scale and the actuators' delay on the drive and predicts over it",
        |keys: CalibratingKeys, period_s| Calibrating::new(Law::new(&keys, period_s)),
    )
}

/// The constants of the law.
#[derive(Debug, Clone, Copy)]
struct Law {
    period_s: f64,
    k_p: f64,
    accel_per_unit_mps2: f64,
    rate: RateKeys,
    /// T/4, the time constant of H \[s\].
    filter_s: f64,
    observer: Observer,
    /// Share of a period's sample in a mean over [`SMOOTHING_S`].
    smoothing: f64,
    /// Share of a period's sample in a mean over `memory_s`.
    forgetting: f64,
}

columns! {
    /// What a vehicle's motion leaves to the next period; it is void once the vehicle has come to rest.
    #[derive(Debug, Clone)]
    struct Motion {
        columns {
            /// The observer on y: ŷ [m/s] and d [m/s²].
            y_mps: f64 = 0.0,
            d_mps2: f64 = 0.0,
            /// The observer on v: what the inputs of the past have to do with ŷ [m/s], and −w [m/s²].
            from_v_mps: f64 = 0.0,
            from_v_mps2: f64 = 0.0,
            /// ȳ_r.
            reference_mps: f64 = 0.0,
            /// P, and its mean.
            pending_mps: f64 = 0.0,
            pending_mean_mps: f64 = 0.0,
            /// Mean of (v_sent + v_acts)/2.
            on_its_way_mps2: f64 = 0.0,
            f_hat_mps2: f64 = 0.0,
        }
    }
}

columns! {
    /// What was learned of a vehicle and its actuators.
    #[derive(Debug, Clone)]
    struct Known {
        columns {
            /// Means of z, d, w [m/s²] and of the products zd, zw.
            z: f64 = 0.0,
            d: f64 = 0.0,
            w: f64 = 0.0,
            zd: f64 = 0.0,
            zw: f64 = 0.0,
            /// θ̂.
            delay_s: f64 = 0.0,
            /// ρ̂.
            scale: f64 = 1.0,
        }
    }
}

columns! {
    /// The law for one block of vehicles.
    struct Calibrating(law: Law) {
        shared {
            law: Law = law,
        }
        parts {
            motion: Motion = Motion::default(),
            known: Known = Known::default(),
        }
    }
}

impl Law {
    fn new(keys: &CalibratingKeys, period_s: f64) -> Self {
        Self {
            period_s,
            k_p: keys.k_p,
            accel_per_unit_mps2: keys.accel_per_unit_mps2,
            rate: keys.rate,
            filter_s: 0.25 * keys.window_s,
            observer: Observer::new(keys.window_s, period_s),
            smoothing: 1.0 - libm::exp(-period_s / SMOOTHING_S),
            forgetting: 1.0 - libm::exp(-period_s / keys.memory_s),
        }
    }
}

impl Controller for Calibrating {
    fn command(&mut self, observation: &Observation, command: &mut Command) {
        observe(&self.law, observation, &mut self.motion);
        calibrate(&self.law, observation, &mut self.motion, &mut self.known);
        act(&self.law, observation, &self.known, &mut self.motion, command);
    }

    fn feedback(&mut self, actuation: &Actuation) {
        predict(&self.law, actuation, &mut self.motion, &mut self.known);
    }

    fn reset(&mut self, slot: usize, speed_mps: f64) {
        self.clear(slot);
        self.motion.y_mps[slot] = speed_mps;
        self.motion.reference_mps[slot] = speed_mps;
    }

    fn rest(&mut self, slot: usize) {
        self.motion.clear(slot);
    }

    fn alpha_ratio(&self, slot: usize) -> f64 {
        self.known.scale[slot]
    }

    fn f_hat_mps2(&self, slot: usize) -> f64 {
        self.motion.f_hat_mps2[slot]
    }
}

vectorised! {
    /// The observer's correction by the measured speed.
    fn observe(law: &Law, observed: &Observation, m: &mut Motion) {
        for i in 0..LANES {
            law.observer.correct(observed.measured_mps[i], &mut m.y_mps[i], &mut m.d_mps2[i]);
            law.observer.correct(0.0, &mut m.from_v_mps[i], &mut m.from_v_mps2[i]);
        }
    }
}

vectorised! {
    /// The moments and ρ̂.
    fn calibrate(law: &Law, observed: &Observation, m: &mut Motion, known: &mut Known) {
        for i in 0..LANES {
            m.reference_mps[i] += law.smoothing * (observed.reference_mps[i] - m.reference_mps[i]);
            let z = (observed.reference_mps[i] - m.reference_mps[i]) / SMOOTHING_S;
            let (d, w) = (m.d_mps2[i], -m.from_v_mps2[i]);
            let share = law.forgetting * z * z / (z * z + GATE_MPS2 * GATE_MPS2);
            known.z[i] += share * (z - known.z[i]);
            known.d[i] += share * (d - known.d[i]);
            known.w[i] += share * (w - known.w[i]);
            known.zd[i] += share * (z * d - known.zd[i]);
            known.zw[i] += share * (z * w - known.zw[i]);
            let c_d = known.zd[i] - known.z[i] * known.d[i];
            let c_w = known.zw[i] - known.z[i] * known.w[i];
            let doubt = DOUBT_MPS4 * DOUBT_MPS4;
            let unknown = 1.0 + CAUTION * known.delay_s[i] / (known.delay_s[i] + law.filter_s);
            known.scale[i] = ((c_d * c_w + unknown * doubt) / (c_w * c_w + doubt)).clamp(SCALE[0], SCALE[1]);
        }
    }
}

vectorised! {
    /// The law, on the error that is to be when the torque comes to act.
    fn act(law: &Law, observed: &Observation, known: &Known, m: &mut Motion, command: &mut Command) {
        for i in 0..LANES {
            let rate = law.rate.bound(observed.reference_rate_mps2[i]);
            let scale = known.scale[i];
            let y_hat = m.y_mps[i] + scale * m.from_v_mps[i];
            let f_hat = m.d_mps2[i] + scale * m.from_v_mps2[i];
            m.f_hat_mps2[i] = f_hat;
            let wanted = rate - f_hat; // the input that would keep the error as it is
            let e = y_hat - observed.reference_mps[i];
            let e_ahead = e + scale * m.pending_mps[i] - known.delay_s[i] * wanted;
            let u = (wanted - law.k_p * e_ahead) / scale;
            command.ask(i, u, law.accel_per_unit_mps2 * observed.nominal_nm_per_mps2[i], 1.0);
        }
    }
}

vectorised! {
    /// The observer's prediction with the torque that acts, and the account of the torque on its way.
    fn predict(law: &Law, actuation: &Actuation, m: &mut Motion, known: &mut Known) {
        for i in 0..LANES {
            let sent = actuation.saturated_mps2[i].clamp(-INPUT_MAX_MPS2, INPUT_MAX_MPS2);
            let acts = actuation.applied_mps2[i].clamp(-INPUT_MAX_MPS2, INPUT_MAX_MPS2);
            m.y_mps[i] += law.period_s * m.d_mps2[i];
            m.from_v_mps[i] += law.period_s * (m.from_v_mps2[i] + acts);
            m.pending_mps[i] += law.period_s * (sent - acts);
            m.pending_mean_mps[i] += law.smoothing * (m.pending_mps[i] - m.pending_mean_mps[i]);
            m.on_its_way_mps2[i] += law.smoothing * (0.5 * (sent + acts) - m.on_its_way_mps2[i]);
            let v = m.on_its_way_mps2[i];
            let missed = m.pending_mean_mps[i] - known.delay_s[i] * v;
            let delay = known.delay_s[i] + law.smoothing * missed * v / (v * v + GATE_MPS2 * GATE_MPS2);
            known.delay_s[i] = delay.clamp(0.0, DELAY_MAX_S);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keys::{Keys, Values};
    use crate::lanes::Lanes;
    use crate::random::Stream;
    use std::collections::VecDeque;

    const PERIOD_S: f64 = 0.01;
    const LIMIT_MPS2: f64 = 5.0;
    const START_MPS: f64 = 15.0;

    fn law(changes: &[(&'static str, f64)]) -> Calibrating {
        let values = changes.iter().fold(Values::default(), |v, (key, x)| v.with(key, *x));
        let mut law = Calibrating::new(Law::new(&CalibratingKeys::from_values(&values), PERIOD_S));
        (0..LANES).for_each(|slot| law.reset(slot, START_MPS));
        law
    }

    /// Sixteen vehicles ẏ = F + ρv behind actuators with limits and a dead time.
    struct World {
        scale: Lanes,
        force_mps2: f64,
        delay: VecDeque<Lanes>,
        speed_mps: Lanes,
        noise: Option<Stream>,
    }

    impl World {
        fn new(scale: Lanes, delay_periods: usize, noisy: bool) -> Self {
            Self {
                scale,
                force_mps2: 0.0,
                delay: vec![[0.0; LANES]; delay_periods].into(),
                speed_mps: [START_MPS; LANES],
                noise: noisy.then(|| Stream::new(4, "noise", "calibrating")),
            }
        }

        fn period(&mut self, law: &mut Calibrating, reference_mps: f64, rate_mps2: f64) {
            let noise = &mut self.noise;
            let measured = self.speed_mps.map(|y| y + noise.as_mut().map_or(0.0, |n| 0.5 * n.normal()));
            let observation = Observation {
                measured_mps: measured,
                reference_mps: [reference_mps; LANES],
                reference_rate_mps2: [rate_mps2; LANES],
                nominal_nm_per_mps2: [1.0; LANES],
            };
            let mut command = Command::default();
            law.command(&observation, &mut command);
            let limit = |i: usize| LIMIT_MPS2 / self.scale[i];
            let sent: Lanes = std::array::from_fn(|i| command.torque_nm[i].clamp(-limit(i), limit(i)));
            self.delay.push_back(sent);
            let acts = self.delay.pop_front().unwrap();
            law.feedback(&Actuation { commanded_mps2: command.torque_nm, saturated_mps2: sent, applied_mps2: acts });
            for ((y, scale), v) in self.speed_mps.iter_mut().zip(&self.scale).zip(&acts) {
                *y += PERIOD_S * (self.force_mps2 + scale * v);
            }
        }

        /// Follows 15 m/s + 5 m/s sin(2πt/20 s).
        fn follow_sine(&mut self, law: &mut Calibrating, seconds: u32) {
            let omega = std::f64::consts::TAU / 20.0;
            for k in 0..100 * seconds {
                let phase = omega * PERIOD_S * f64::from(k);
                self.period(law, 15.0 + 5.0 * libm::sin(phase), 5.0 * omega * libm::cos(phase));
            }
        }
    }

    /// 2^(−4) to 2^(3.5).
    fn scales() -> Lanes {
        std::array::from_fn(|i| libm::exp2(0.5 * i as f64 - 4.0))
    }

    #[test]
    fn law_finds_the_torque_scale_whatever_the_first_guess() {
        for (delay, force) in [(0, 0.0), (0, -1.0), (25, -0.3)] {
            let mut law = law(&[]);
            let mut world = World::new(scales(), delay, false);
            world.force_mps2 = force;
            world.follow_sine(&mut law, 60);
            for i in 0..LANES {
                let ratio = law.alpha_ratio(i) / world.scale[i];
                assert!((ratio - 1.0).abs() < 0.03, "delay {delay}, F {force}, scale {}: {ratio}", world.scale[i]);
            }
        }
    }

    #[test]
    fn law_noise_in_the_loop_does_not_bias_the_scale() {
        for scale in [0.25, 1.0, 4.0] {
            let mut law = law(&[]);
            let mut world = World::new([scale; LANES], 0, true);
            world.follow_sine(&mut law, 60);
            let ratios: Lanes = std::array::from_fn(|i| law.alpha_ratio(i) / scale);
            let mean = ratios.iter().sum::<f64>() / LANES as f64;
            println!("{scale}: {mean} {ratios:?}");
            assert!((mean - 1.0).abs() < 0.01, "scale {scale}: mean {mean}");
            assert!(ratios.iter().all(|r| (r - 1.0).abs() < 0.04), "scale {scale}: {ratios:?}");
        }
    }

    #[test]
    fn law_finds_the_delay_and_none_where_there_is_none() {
        for delay in [0, 10, 25, 40] {
            let mut law = law(&[]);
            let mut world = World::new(scales(), delay, true);
            world.follow_sine(&mut law, 60);
            for found in law.known.delay_s {
                let expected = PERIOD_S * delay as f64;
                println!("{found}");
                assert!((found - expected).abs() <= 0.03 * expected, "{found} for {expected}");
            }
        }
    }

    #[test]
    fn law_what_is_on_its_way_is_what_the_speed_will_gain() {
        let mut law = law(&[]);
        let mut world = World::new([1.0; LANES], 25, true);
        world.follow_sine(&mut law, 7);
        let (pending, before) = (law.motion.pending_mps, world.speed_mps);
        for _ in 0..25 {
            world.period(&mut law, 15.0, 0.0);
        }
        for i in 0..LANES {
            assert!((world.speed_mps[i] - before[i] - pending[i]).abs() < 1e-9, "slot {i}");
        }
    }

    #[test]
    fn law_slope_and_noise_at_constant_speed_teach_nothing() {
        let mut law = law(&[]);
        let mut world = World::new([0.5; LANES], 0, true);
        world.follow_sine(&mut law, 40);
        for _ in 0..1_000 {
            world.period(&mut law, 15.0, 0.0);
        }
        let known = law.known.scale;
        for k in 0..20_000 {
            world.force_mps2 = if (k / 500) % 2 == 0 { 0.5 } else { -0.5 };
            world.period(&mut law, 15.0, 0.0);
        }
        assert!((0..LANES).all(|i| (law.alpha_ratio(i) / known[i] - 1.0).abs() < 1e-6));
    }

    #[test]
    fn law_steps_do_not_overshoot_with_dead_time_and_a_wrong_scale() {
        let mut law = law(&[]);
        let mut world = World::new(scales(), 25, false);
        let mut highest = [0.0_f64; LANES];
        for _ in 0..3_000 {
            world.period(&mut law, 25.0, 0.0);
            highest = std::array::from_fn(|i| highest[i].max(world.speed_mps[i]));
        }
        println!("{highest:?}");
        assert!(highest.iter().all(|y| (24.9..25.05).contains(y)), "{highest:?}");
    }

    #[test]
    fn law_a_scale_guessed_too_low_by_four_does_not_swing_over_a_delay() {
        for delay in [10, 25, 50] {
            let mut law = law(&[]);
            let mut world = World::new([4.0; LANES], delay, true);
            let mut mean_square = 0.0;
            for k in 0..9_000 {
                world.period(&mut law, START_MPS, 0.0);
                let square = world.speed_mps.map(|y| (y - START_MPS).powi(2)).iter().sum::<f64>() / LANES as f64;
                mean_square += if k < 3_000 { 0.0 } else { square / 6_000.0 };
            }
            assert!(mean_square.sqrt() < 0.3, "{delay} periods: {} m/s", mean_square.sqrt());
        }
    }

    #[test]
    fn law_a_scale_guessed_far_too_low_is_stable_where_nothing_can_be_learned() {
        let mut law = law(&[]);
        let mut world = World::new(scales(), 0, true);
        let mut squares = [0.0; LANES];
        for _ in 0..6_000 {
            world.period(&mut law, START_MPS, 0.0);
            squares = std::array::from_fn(|i| squares[i] + (world.speed_mps[i] - START_MPS).powi(2) / 6_000.0);
        }
        assert_eq!(law.known.scale, [1.0; LANES]);
        assert!(squares.iter().all(|s| s.sqrt() < 0.25), "{squares:?}");
    }

    #[test]
    fn rest_keeps_what_was_learned_and_reset_does_not() {
        let mut law = law(&[]);
        let mut world = World::new([2.0; LANES], 25, false);
        world.follow_sine(&mut law, 30);
        let (scale, delay) = (law.known.scale, law.known.delay_s);
        law.rest(3);
        law.reset(4, 0.0);
        assert_eq!((law.alpha_ratio(3), law.known.delay_s[3], law.f_hat_mps2(3)), (scale[3], delay[3], 0.0));
        assert_eq!((law.alpha_ratio(4), law.known.delay_s[4], law.f_hat_mps2(4)), (1.0, 0.0, 0.0));
        assert_eq!((law.alpha_ratio(5), law.known.delay_s[5]), (scale[5], delay[5]));
        let mut command = Command::default();
        law.command(&Observation { nominal_nm_per_mps2: [1.0; LANES], ..Observation::default() }, &mut command);
        assert_eq!((command.torque_nm[3], command.torque_nm[4]), (0.0, 0.0));
    }
}
