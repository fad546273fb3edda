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

use crate::lanes::{LANES, Lanes};
use multiversion::multiversion;

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

/// Adds the weighted samples to `sum`, oldest first whatever the ring's phase: the same bits every time.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2+fma"))]
fn weighted_sum(weights: &[Weight], samples: &[Sample], sum: &mut Lanes) {
    let mut total = *sum;
    for (weight, sample) in weights.iter().zip(samples) {
        for (total, (y, v)) in total.iter_mut().zip(sample.y.iter().zip(&sample.v)) {
            *total += weight.y * y + weight.v * v;
        }
    }
    *sum = total;
}
