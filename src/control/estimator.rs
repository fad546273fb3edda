//! The algebraic estimator of F in the ultra-local model ẏ = F + v (Polack et al. 2017, Section 2.2).
//!
//! ```text
//! F̂ = −(6/T³) ∫₀ᵀ [(T − 2τ) y(τ) + τ(T − τ) v(τ)] dτ        τ = 0 oldest, τ = T newest sample
//! ```
//! Over N = ⌊T/Δt⌋ intervals, that is N + 1 samples, the trapezoidal rule turns this into a sum of weighted samples. It
//! overrates the slope of y by 1 + 2/N² and underrates a constant input by 1 − 1/N²; the weights are divided by these
//! factors, so that an affine y gives its slope and a constant input its negative, to rounding.
//!
//! The sum is taken anew over the window in every period. A running sum would save a few nanoseconds and drift.

use crate::lanes::{LANES, Lanes, vectorised};

/// One sample of a block: the measured speed [m/s] and the input that led to it [m/s²].
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Sample {
    y: Lanes,
    v: Lanes,
}

/// Weights of one sample: of y [1/s] and of v [-].
#[derive(Debug, Clone, Copy)]
struct Weight {
    y: f64,
    v: f64,
}

/// The last N + 1 samples of a block of vehicles and the weights that turn them into F̂.
#[derive(Debug, Clone)]
pub(super) struct Window {
    /// Oldest first.
    weights: Vec<Weight>,
    /// A ring; `oldest` is overwritten next.
    samples: Vec<Sample>,
    oldest: usize,
}

impl Window {
    /// A window of ⌊`window_s`/`period_s`⌋ intervals, at least one, filled with zeros. A single interval gives the two-point
    /// estimate F̂ = (y_k − y_{k−1})/Δt − v_{k−1} of the paper's Section 2.2.
    pub(super) fn new(window_s: f64, period_s: f64) -> Self {
        // A quotient like 0.3/0.1 falls just short of the whole number that is meant.
        let intervals = ((window_s / period_s + 1e-6).floor() as usize).max(1);
        let weights = weights(intervals, period_s);
        let samples = vec![Sample { y: [0.0; LANES], v: [0.0; LANES] }; intervals + 1];
        Self { weights, samples, oldest: 0 }
    }

    /// Takes in y_k [m/s] and v_{k−1} [m/s²] and returns F̂_k [m/s²].
    pub(super) fn estimate(&mut self, y_mps: &Lanes, v_mps2: &Lanes) -> Lanes {
        self.samples[self.oldest] = Sample { y: *y_mps, v: *v_mps2 };
        self.oldest = (self.oldest + 1) % self.samples.len();
        let (newer, older) = self.samples.split_at(self.oldest);
        let mut f_hat = [0.0; LANES];
        weighted_sum(&self.weights[..older.len()], older, &mut f_hat);
        weighted_sum(&self.weights[older.len()..], newer, &mut f_hat);
        f_hat
    }

    /// Fills the window of one slot with a constant speed and zero input, for which F̂ = 0.
    pub(super) fn fill(&mut self, slot: usize, y_mps: f64) {
        for sample in &mut self.samples {
            sample.y[slot] = y_mps;
            sample.v[slot] = 0.0;
        }
    }
}

/// Corrected trapezoidal weights over `intervals` of `period_s`, oldest first.
fn weights(intervals: usize, period_s: f64) -> Vec<Weight> {
    if intervals == 1 {
        // τ(T − τ) vanishes on both samples; the input that acted between them is the newer one.
        return vec![Weight { y: -1.0 / period_s, v: 0.0 }, Weight { y: 1.0 / period_s, v: -1.0 }];
    }
    let n = intervals as f64;
    let slope_gain = 1.0 + 2.0 / (n * n);
    let input_gain = 1.0 - 1.0 / (n * n);
    (0..=intervals)
        .map(|i| {
            let tau = i as f64; // in units of Δt
            let end = if i == 0 || i == intervals { 0.5 } else { 1.0 };
            Weight {
                y: -6.0 / (n * n * n * period_s) * (n - 2.0 * tau) * end / slope_gain,
                v: -6.0 / (n * n * n) * tau * (n - tau) * end / input_gain,
            }
        })
        .collect()
}

vectorised! {
    /// Adds the weighted samples to `sum`, oldest first whatever the ring's phase: the same bits every time.
    fn weighted_sum(weights: &[Weight], samples: &[Sample], sum: &mut Lanes) {
        let mut total = *sum;
        for (weight, sample) in weights.iter().zip(samples) {
            for (total, (y, v)) in total.iter_mut().zip(sample.y.iter().zip(&sample.v)) {
                *total += weight.y * y + weight.v * v;
            }
        }
        *sum = total;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    const PERIOD_S: f64 = 0.01;

    /// F̂ in slot 0 after a whole window of the signals y(k), v(k).
    fn estimate(window: &mut Window, y: impl Fn(f64) -> f64, v: impl Fn(f64) -> f64) -> f64 {
        let mut f_hat = 0.0;
        for k in 0..window.samples.len() {
            f_hat = window.estimate(&[y(k as f64); LANES], &[v(k as f64); LANES])[0];
        }
        f_hat
    }

    #[test]
    fn the_window_has_as_many_intervals_as_meant() {
        for (window_s, period_s, intervals) in
            [(0.2, 0.01, 20), (0.3, 0.1, 3), (0.7, 0.1, 7), (0.209, 0.01, 20), (0.2, 0.001, 200), (0.005, 0.01, 1)]
        {
            assert_eq!(Window::new(window_s, period_s).samples.len(), intervals + 1, "{window_s}/{period_s}");
        }
    }

    #[test]
    fn law_affine_speed_and_constant_input_are_exact() {
        for intervals in [1, 2, 3, 5, 20, 200] {
            let mut window = Window::new(intervals as f64 * PERIOD_S, PERIOD_S);
            let slope = estimate(&mut window, |k| 17.0 - 3.25 * k * PERIOD_S, |_| 0.0);
            assert!((slope + 3.25).abs() < 1e-9, "N = {intervals}: {slope}");
            let input = estimate(&mut window, |_| 17.0, |_| 2.5);
            assert!((input + 2.5).abs() < 1e-9, "N = {intervals}: {input}");
        }
    }

    #[test]
    fn law_noise_on_the_estimate_is_what_the_weights_say() {
        for intervals in [5, 10, 20, 200] {
            let mut window = Window::new(intervals as f64 * PERIOD_S, PERIOD_S);
            let gain = window.weights.iter().map(|w| w.y * w.y).sum::<f64>().sqrt();
            if intervals == 200 {
                let large_n = (12.0 * PERIOD_S / (intervals as f64 * PERIOD_S).powi(3)).sqrt();
                assert!((gain / large_n - 1.0).abs() < 0.02, "closed form {large_n}, weights {gain}");
            }
            let mut noise = Stream::new(1, "noise", "estimator");
            let (mut sum, mut count) = (0.0, 0);
            // Estimates within a window hang together, so that a long one needs more of them.
            for k in 0..4_000 + 400 * intervals {
                let y = std::array::from_fn(|_| 0.5 * noise.normal());
                let f_hat = window.estimate(&y, &[0.0; LANES]);
                if k >= intervals {
                    sum += f_hat.iter().map(|f| f * f).sum::<f64>();
                    count += LANES;
                }
            }
            let ratio = (sum / count as f64).sqrt() / (0.5 * gain);
            assert!((ratio - 1.0).abs() < 0.02, "N = {intervals}: measured/expected = {ratio}");
        }
    }

    #[test]
    fn law_twenty_four_hours_leave_no_trace() {
        // Fewer periods in unoptimised builds: the law is the same, the estimate depends on the last window only.
        let periods: u32 = if cfg!(debug_assertions) { 200_003 } else { 8_640_003 };
        let signal = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 8) / 1e6;
        let mut old = Window::new(0.2, PERIOD_S);
        let mut fresh = Window::new(0.2, PERIOD_S);
        let mut last = [0.0; LANES];
        for k in 0..periods {
            last = old.estimate(&[signal(k); LANES], &[signal(k + 1); LANES]);
        }
        let mut expected = [0.0; LANES];
        for k in periods - 21..periods {
            expected = fresh.estimate(&[signal(k); LANES], &[signal(k + 1); LANES]);
        }
        assert_eq!(last, expected);
    }

    #[test]
    fn law_vector_code_gives_the_bits_of_scalar_arithmetic() {
        let mut window = Window::new(0.2, PERIOD_S);
        let mut random = Stream::new(2, "bits", "estimator");
        let mut history = vec![];
        for k in 0..100 {
            let y: Lanes = std::array::from_fn(|_| 30.0 * random.normal());
            let v: Lanes = std::array::from_fn(|_| 3.0 * random.normal());
            let f_hat = window.estimate(&y, &v);
            history.push((y, v));
            for i in (0..LANES).filter(|_| k >= 20) {
                let samples = window.weights.iter().zip(&history[k - 20..]);
                let expected = samples.fold(0.0, |sum, (w, (y, v))| sum + (w.y * y[i] + w.v * v[i]));
                assert_eq!(f_hat[i].to_bits(), expected.to_bits(), "slot {i} k {k}");
            }
        }
    }

    #[test]
    fn a_filled_window_estimates_nothing_and_leaves_other_slots_alone() {
        let mut window = Window::new(0.2, PERIOD_S);
        estimate(&mut window, |k| k, |k| -k);
        let mut untouched = window.clone();
        window.fill(3, 13.9);
        let y: Lanes = std::array::from_fn(|i| if i == 3 { 13.9 } else { 20.0 });
        let (with, without) = (window.estimate(&y, &[0.0; LANES]), untouched.estimate(&y, &[0.0; LANES]));
        assert!(with[3].abs() < 1e-9, "{}", with[3]);
        assert!((0..LANES).filter(|i| *i != 3).all(|i| with[i] == without[i]));
    }
}
