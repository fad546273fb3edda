//! Frequency weightings of ISO 2631-1:1997 (Annex A, Table A.1) as digital filters: how much of an acceleration is felt.
//!
//! - [`Weighting::driving`], W_d: discomfort by horizontal acceleration. Its upper band limit of 100 Hz is left out: no
//!   control period is short enough to hold such frequencies.
//! - [`Weighting::sickness`], W_f: motion sickness, 0.1 to 0.5 Hz.
//!
//! Sections of second order, made digital by the bilinear transformation that maps each section's own frequency exactly.

use crate::columns::Slots;
use crate::lanes::{LANES, Lanes};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Values this small are zero: without a signal a filter's memory would fade into numbers that processors are slow with.
const NOTHING: f64 = 1e-60;

/// One section, b(z)/a(z) with a₀ = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

impl Section {
    /// H(s) = (n₀ + n₁ p + n₂ p²)/(1 + d₁ p + d₂ p²) with p = s/(2π f), for signals sampled every `period_s`.
    fn new(frequency_hz: f64, n: [f64; 3], d: [f64; 2], period_s: f64) -> Self {
        let k = 1.0 / libm::tan(PI * frequency_hz * period_s);
        let d = [1.0, d[0], d[1]];
        let digital =
            |c: [f64; 3]| [c[0] + c[1] * k + c[2] * k * k, 2.0 * (c[0] - c[2] * k * k), c[0] - c[1] * k + c[2] * k * k];
        let (b, a) = (digital(n), digital(d));
        Self { b: b.map(|b| b / a[0]), a: [a[1] / a[0], a[2] / a[0]] }
    }
}

/// A weighting of `N` sections for the vehicles of a block.
#[derive(Debug, Clone)]
pub(super) struct Weighting<const N: usize> {
    sections: [Section; N],
    /// Two values of memory per section.
    memory: [[Lanes; 2]; N],
}

impl Weighting<2> {
    /// W_d for accelerations sampled every `period_s` \[s\].
    pub fn driving(period_s: f64) -> Self {
        Self::new([
            Section::new(0.4, [0.0, 0.0, 1.0], [1.0 / FRAC_1_SQRT_2, 1.0], period_s),
            Section::new(2.0, [1.0, 1.0, 0.0], [1.0 / 0.63, 1.0], period_s),
        ])
    }
}

impl Weighting<4> {
    /// W_f for accelerations sampled every `period_s` \[s\].
    pub fn sickness(period_s: f64) -> Self {
        // The upward step, (1 + p₅/Q₅ + p₅²)/(1 + p₆/Q₆ + p₆²)·(ω₅/ω₆)², in terms of p₆ = s/ω₆.
        let ratio = 0.1 / 0.0625;
        let gain = 1.0 / (ratio * ratio);
        let step = [gain, gain * ratio / 0.8, 1.0];
        Self::new([
            Section::new(0.08, [0.0, 0.0, 1.0], [1.0 / FRAC_1_SQRT_2, 1.0], period_s),
            Section::new(0.63, [1.0, 0.0, 0.0], [1.0 / FRAC_1_SQRT_2, 1.0], period_s),
            Section::new(0.25, [1.0, 0.0, 0.0], [1.0 / 0.86, 1.0], period_s),
            Section::new(0.1, step, [1.0 / 0.8, 1.0], period_s),
        ])
    }
}

impl<const N: usize> Weighting<N> {
    fn new(sections: [Section; N]) -> Self {
        Self { sections, memory: [[[0.0; LANES]; 2]; N] }
    }

    /// The weighted values of new ones, which are finite in every slot.
    #[inline(always)]
    pub fn weigh(&mut self, values: &Lanes) -> Lanes {
        let mut x = *values;
        for (Section { b, a }, [first, second]) in self.sections.iter().zip(&mut self.memory) {
            for i in 0..LANES {
                let y = b[0] * x[i] + first[i];
                first[i] = b[1] * x[i] - a[0] * y + second[i];
                second[i] = b[2] * x[i] - a[1] * y;
                x[i] = y;
            }
        }
        x
    }

    /// Lets memory that has faded be zero. Both values of a section go at once: one without the other would be a push.
    #[inline(always)]
    pub fn settle(&mut self) {
        for [first, second] in &mut self.memory {
            for i in 0..LANES {
                let faded = first[i].abs().max(second[i].abs()) < NOTHING;
                first[i] = if faded { 0.0 } else { first[i] };
                second[i] = if faded { 0.0 } else { second[i] };
            }
        }
    }
}

impl<const N: usize> Slots for Weighting<N> {
    fn clear(&mut self, slot: usize) {
        self.memory.as_flattened_mut().iter_mut().for_each(|column| column[slot] = 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 0.01;

    impl<const N: usize> Weighting<N> {
        /// True if nothing is left of what was weighed.
        pub(in crate::stats) fn has_faded(&self) -> bool {
            self.memory.as_flattened().iter().flatten().all(|value| *value == 0.0)
        }
    }

    /// The gain for a sine, by its RMS over whole periods after it has settled.
    fn gain<const N: usize>(mut weighting: Weighting<N>, frequency_hz: f64) -> f64 {
        let settle = (60.0 / PERIOD_S) as usize;
        let measured = (20.0 / frequency_hz / PERIOD_S).round() as usize;
        let mut squared = 0.0;
        for k in 0..settle + measured {
            let x = (2.0 * PI * frequency_hz * PERIOD_S * k as f64).sin();
            let y = weighting.weigh(&[x; LANES])[0];
            squared += if k < settle { 0.0 } else { y * y };
        }
        (2.0 * squared / measured as f64).sqrt()
    }

    /// Table 3 of ISO 2631-1:1997, in thousandths.
    #[test]
    fn law_gains_are_those_of_the_standard() {
        for (frequency_hz, wanted) in [(0.5, 853.0), (1.0, 1011.0), (2.0, 890.0), (4.0, 512.0), (8.0, 253.0)] {
            let got = 1000.0 * gain(Weighting::driving(PERIOD_S), frequency_hz);
            assert!((got - wanted).abs() < 0.02 * wanted, "W_d at {frequency_hz} Hz: {got} instead of {wanted}");
        }
        for (frequency_hz, wanted) in [(0.1, 695.0), (0.16, 1006.0), (0.25, 854.0), (0.4, 384.0), (0.63, 116.0)] {
            let got = 1000.0 * gain(Weighting::sickness(PERIOD_S), frequency_hz);
            assert!((got - wanted).abs() < 0.02 * wanted, "W_f at {frequency_hz} Hz: {got} instead of {wanted}");
        }
    }
}
