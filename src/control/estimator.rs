//! The algebraic estimator of F in the ultra-local model ẏ = F + v (Polack et al. 2017, Section 2.2).
//!
//! ```text
//! F̂ = −(6/T³) ∫₀ᵀ [(T − 2τ) y(τ) + τ(T − τ) v(τ)] dτ        τ = 0 oldest, τ = T newest sample
//! ```
//! Over N = ⌊T/Δt⌋ intervals, that is N + 1 samples, the trapezoidal rule turns this into a sum of weighted samples. It
//! overrates the slope of y by 1 + 2/N² and underrates a constant input by 1 − 1/N²; the weights are divided by these
//! factors, so that an affine y gives its slope and a constant input its negative, to rounding.
//!
//! The sum is taken anew over the window in every period. A running sum would save time and drift. A long window is read
//! by chunks of sixteen samples (`chunks.rs`), which are no running sums either.

use super::chunks::{self, Chunks, Sample};
use crate::columns::Slots;
use crate::lanes::{LANES, Lanes, vectorised};

/// Windows of so many intervals and more are read by chunks.
const LONG: usize = 64;

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
    /// How many of the oldest samples are counted one by one: all, unless there are chunks for the others but the newest.
    singles: usize,
    chunks: Option<Chunks>,
}

impl Window {
    /// A window of ⌊`window_s`/`period_s`⌋ intervals, at least one, filled with zeros. A single interval gives the two-point
    /// estimate F̂ = (y_k − y_{k−1})/Δt − v_{k−1} of the paper's Section 2.2.
    pub(super) fn new(window_s: f64, period_s: f64) -> Self {
        // A quotient like 0.3/0.1 falls just short of the whole number that is meant.
        let intervals = ((window_s / period_s + 1e-6).floor() as usize).max(1);
        let weights = weights(intervals, period_s);
        let samples = vec![Sample { y: [0.0; LANES], v: [0.0; LANES] }; intervals + 1];
        // Both ends, which count half, are single samples.
        let singles = if intervals < LONG { intervals + 1 } else { 1 + (intervals - 1) % chunks::LENGTH };
        let chunks = (intervals >= LONG).then(|| {
            let n = intervals as f64;
            let (slope_gain, input_gain) = trapezoidal_gains(n);
            let (c, d) = (-6.0 / (n * n * n * period_s) / slope_gain, -6.0 / (n * n * n) / input_gain);
            Chunks::new(intervals, singles, c, d)
        });
        Self { weights, samples, oldest: 0, singles, chunks }
    }

    /// Takes in y_k [m/s] and v_{k−1} [m/s²] and returns F̂_k [m/s²].
    pub(super) fn estimate(&mut self, y_mps: &Lanes, v_mps2: &Lanes) -> Lanes {
        let (newest, count) = (self.oldest, self.samples.len());
        self.samples[newest] = Sample { y: *y_mps, v: *v_mps2 };
        self.oldest = if newest + 1 < count { newest + 1 } else { 0 };
        let (newer, older) = self.samples.split_at(self.oldest);
        let before_end = self.singles.min(older.len());
        let mut f_hat = [0.0; LANES];
        weighted_sum(&self.weights, &older[..before_end], &mut f_hat);
        weighted_sum(&self.weights[before_end..], &newer[..self.singles - before_end], &mut f_hat);
        if let Some(chunks) = &mut self.chunks {
            chunks.take(&self.samples, newest);
            chunks.add(newest, &mut f_hat);
            weighted_sum(&self.weights[count - 1..], &self.samples[newest..=newest], &mut f_hat);
        }
        f_hat
    }

    /// Fills the window of one slot with a constant speed and zero input, for which F̂ = 0.
    pub(super) fn fill(&mut self, slot: usize, y_mps: f64) {
        for sample in &mut self.samples {
            sample.y[slot] = y_mps;
            sample.v[slot] = 0.0;
        }
        if let Some(chunks) = &mut self.chunks {
            chunks.fill(slot, y_mps);
        }
    }
}

/// F̂ [m/s²] at every sample of one vehicle, as laws compute it: from the measured speed y_k [m/s] and the input v_{k−1}
/// [m/s²] that acted before it, over a window of `window_s`, with samples every `period_s`. Before the first sample the
/// vehicle went on at its speed without input.
pub fn f_hat(speeds_mps: &[f64], inputs_mps2: &[f64], window_s: f64, period_s: f64) -> Vec<f64> {
    let mut window = Window::new(window_s, period_s);
    window.fill(0, speeds_mps.first().copied().unwrap_or_default());
    let samples = speeds_mps.iter().zip(inputs_mps2);
    samples.map(|(y_mps, v_mps2)| window.estimate(&[*y_mps; LANES], &[*v_mps2; LANES])[0]).collect()
}

impl Slots for Window {
    fn clear(&mut self, slot: usize) {
        self.fill(slot, 0.0);
    }
}

/// By how much the trapezoidal rule overrates the slope of y and underrates a constant input.
fn trapezoidal_gains(n: f64) -> (f64, f64) {
    (1.0 + 2.0 / (n * n), 1.0 - 1.0 / (n * n))
}

/// Corrected trapezoidal weights over `intervals` of `period_s`, oldest first.
fn weights(intervals: usize, period_s: f64) -> Vec<Weight> {
    if intervals == 1 {
        // τ(T − τ) vanishes on both samples; the input that acted between them is the newer one.
        return vec![Weight { y: -1.0 / period_s, v: 0.0 }, Weight { y: 1.0 / period_s, v: -1.0 }];
    }
    let n = intervals as f64;
    let (slope_gain, input_gain) = trapezoidal_gains(n);
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
    use crate::lanes::InstructionSet;
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
    fn f_hat_of_a_recording_is_what_the_input_does_not_explain() {
        // A car that gains 1.25 m/s² under an input of 2 m/s² from the first sample on.
        let speeds_mps: Vec<f64> = (0..60).map(|k| 9.0 + 1.25 * PERIOD_S * f64::from(k)).collect();
        let f_hat_mps2 = f_hat(&speeds_mps, &[2.0; 60], 0.2, PERIOD_S);
        assert_eq!((f_hat_mps2.len(), f_hat(&[], &[], 0.2, PERIOD_S).len()), (60, 0));
        // Before it went on at its speed without input.
        let at_first = f_hat(&[9.0], &[0.0], 0.2, PERIOD_S)[0];
        assert!(at_first.abs() < 1e-12, "{at_first}");
        for f_mps2 in &f_hat_mps2[21..] {
            assert!((f_mps2 + 0.75).abs() < 1e-9, "{f_mps2}");
        }
    }

    #[test]
    fn a_cleared_slot_is_that_of_a_car_at_rest() {
        let mut window = Window::new(0.2, PERIOD_S);
        estimate(&mut window, |k| 17.0 - k, |_| 3.0);
        window.clear(0);
        let still = window.estimate(&[0.0; LANES], &[0.0; LANES]);
        assert_eq!(still[0], 0.0);
        assert!(still[1].abs() > 1.0, "the others stay: {}", still[1]);
    }

    #[test]
    fn law_affine_speed_and_constant_input_are_exact() {
        for intervals in [1, 2, 3, 5, 20, 63, 64, 65, 79, 80, 81, 200, 1800] {
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
        for intervals in [20, 70] {
            let mut old = Window::new(f64::from(intervals) * PERIOD_S, PERIOD_S);
            let mut fresh = old.clone();
            let mut last = [0.0; LANES];
            for k in 0..periods {
                last = old.estimate(&[signal(k); LANES], &[signal(k + 1); LANES]);
            }
            let mut expected = [0.0; LANES];
            for k in periods - intervals - 1..periods {
                expected = fresh.estimate(&[signal(k); LANES], &[signal(k + 1); LANES]);
            }
            assert_eq!(last, expected, "N = {intervals}");
        }
    }

    /// F̂ of one vehicle by scalar arithmetic, from its last N + 1 samples.
    fn scalar(intervals: usize, samples: &[(f64, f64)]) -> f64 {
        let weights = weights(intervals, PERIOD_S);
        let one = |sum: f64, i: usize| sum + (weights[i].y * samples[i].0 + weights[i].v * samples[i].1);
        if intervals < LONG {
            return (0..=intervals).fold(0.0, one);
        }
        let n = intervals as f64;
        let (c, d) =
            (-6.0 / (n * n * n * PERIOD_S) / (1.0 + 2.0 / (n * n)), -6.0 / (n * n * n) / (1.0 - 1.0 / (n * n)));
        let singles = 1 + (intervals - 1) % 16;
        let mut sum = (0..singles).fold(0.0, one);
        for first in (singles..intervals).step_by(16) {
            let [mut chunk, mut sums] = [[0.0; 2], [0.0; 2]];
            for k in 0..8 {
                let j = 7.5 - k as f64;
                let ((y, v), (y_older, v_older)) = (samples[first + 15 - k], samples[first + k]);
                chunk[0] += -2.0 * c * j * (y - y_older) + d * (0.5 * n * (0.5 * n) - j * j) * (v + v_older);
                chunk[1] += -2.0 * d * j * (v - v_older);
                sums = [sums[0] + (y + y_older), sums[1] + (v + v_older)];
            }
            let [slope, bend] = [-2.0 * c * sums[0] + chunk[1], -d * sums[1]];
            let p = first as f64 + 7.5 - 0.5 * n;
            sum += chunk[0] + p * (slope + p * bend);
        }
        one(sum, intervals)
    }

    #[test]
    fn law_vector_code_gives_the_bits_of_scalar_arithmetic() {
        for (set, intervals) in
            InstructionSet::available().into_iter().flat_map(|s| [20, 64, 79, 80, 200].map(|n| (s, n)))
        {
            let mut window = Window::new(intervals as f64 * PERIOD_S, PERIOD_S);
            let mut random = Stream::new(2, "bits", "estimator");
            let mut history: Vec<(Lanes, Lanes)> = vec![];
            for k in 0..2 * intervals + 60 {
                let y: Lanes = std::array::from_fn(|_| 30.0 * random.normal());
                let v: Lanes = std::array::from_fn(|_| 3.0 * random.normal());
                let f_hat = set.during(|| window.estimate(&y, &v));
                history.push((y, v));
                for i in (0..LANES).filter(|_| k >= intervals) {
                    let samples: Vec<_> = history[k - intervals..].iter().map(|(y, v)| (y[i], v[i])).collect();
                    let expected = scalar(intervals, &samples);
                    assert_eq!(f_hat[i].to_bits(), expected.to_bits(), "{set:?} N = {intervals} slot {i} k {k}");
                }
            }
        }
    }

    #[test]
    fn law_a_long_window_is_the_sum_of_its_weighted_samples() {
        for intervals in [64, 75, 79, 80, 81, 200, 1000] {
            let mut window = Window::new(intervals as f64 * PERIOD_S, PERIOD_S);
            let mut random = Stream::new(3, "sum", "estimator");
            let samples: Vec<(f64, f64)> =
                (0..=intervals).map(|_| (20.0 + random.normal(), 3.0 * random.normal())).collect();
            let mut f_hat = 0.0;
            for (y, v) in &samples {
                f_hat = window.estimate(&[*y; LANES], &[*v; LANES])[5];
            }
            let terms = window.weights.iter().zip(&samples).map(|(w, (y, v))| w.y * y + w.v * v);
            let (sum, size) = terms.fold((0.0, 0.0), |(sum, size), term| (sum + term, size + f64::abs(term)));
            assert!((f_hat - sum).abs() < 1e-14 * size, "N = {intervals}: {f_hat}, sum of the samples {sum}");
        }
    }

    /// One vehicle's estimates must not tell when its slot was filled, which slot that was, or who else is in the block.
    #[test]
    fn law_an_estimate_depends_on_the_vehicle_alone() {
        for intervals in [20, 64, 71, 80, 200] {
            let drive = |slot: usize, filled_after: usize, neighbours: f64| {
                let mut window = Window::new(intervals as f64 * PERIOD_S, PERIOD_S);
                let (mut others, mut own) = (Stream::new(4, "others", "estimator"), Stream::new(4, "own", "estimator"));
                let mut noise = || std::array::from_fn(|_| neighbours * others.normal());
                for _ in 0..filled_after {
                    window.estimate(&noise(), &noise());
                }
                window.fill(slot, 13.9);
                let estimates = (0..3 * intervals).map(|_| {
                    let (mut y, mut v): (Lanes, Lanes) = (noise(), noise());
                    (y[slot], v[slot]) = (13.9 + own.normal(), own.normal());
                    window.estimate(&y, &v)[slot].to_bits()
                });
                estimates.collect::<Vec<u64>>()
            };
            let expected = drive(0, 0, 0.0);
            for (slot, filled_after, neighbours) in
                [(0, 0, 50.0), (7, 0, 0.0), (15, 1, 9.0), (3, 17, 9.0), (3, 450, 1e6)]
            {
                assert!(
                    drive(slot, filled_after, neighbours) == expected,
                    "N = {intervals}, slot {slot}, {filled_after}"
                );
            }
        }
    }

    #[test]
    fn a_filled_window_is_one_that_saw_nothing_else() {
        for intervals in [20, 64, 200] {
            let mut filled = Window::new(intervals as f64 * PERIOD_S, PERIOD_S);
            let mut driven = filled.clone();
            (0..LANES).for_each(|slot| filled.fill(slot, 17.3));
            for _ in 0..2 * intervals {
                driven.estimate(&[17.3; LANES], &[0.0; LANES]);
            }
            for k in 0..intervals {
                let (y, v) = ([17.3 - 0.1 * k as f64; LANES], [0.01 * k as f64; LANES]);
                assert_eq!(filled.estimate(&y, &v), driven.estimate(&y, &v), "N = {intervals} k {k}");
            }
        }
    }

    #[test]
    fn a_filled_window_estimates_nothing_and_leaves_other_slots_alone() {
        for window_s in [0.2, 2.0] {
            fill_one_slot(Window::new(window_s, PERIOD_S));
        }
    }

    fn fill_one_slot(mut window: Window) {
        estimate(&mut window, |k| k, |k| -k);
        let mut untouched = window.clone();
        window.fill(3, 13.9);
        let y: Lanes = std::array::from_fn(|i| if i == 3 { 13.9 } else { 20.0 });
        let (with, without) = (window.estimate(&y, &[0.0; LANES]), untouched.estimate(&y, &[0.0; LANES]));
        assert!(with[3].abs() < 1e-9, "{}", with[3]);
        assert!((0..LANES).filter(|i| *i != 3).all(|i| with[i] == without[i]));
    }
}
