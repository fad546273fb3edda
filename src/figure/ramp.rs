//! Values as steps of colour.

use super::escape::escape;
use super::style::STEPS;
use std::fmt::Write;

/// The values that the steps of colour divide.
#[derive(Debug, Clone, PartialEq)]
pub struct Ramp {
    low: f64,
    high: f64,
    above: bool,
}

impl Ramp {
    /// From the least of the values to the quantile 0.98: what few have does not take the colours of the others.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.into_iter().filter(|x| x.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        let (Some(&low), Some(&top)) = (values.first(), values.last()) else {
            return Self { low: 0.0, high: 1.0, above: false };
        };
        let high = values[((values.len() - 1) as f64 * 0.98) as usize];
        let high = if high > low { high } else { top };
        let high = if high > low { high } else { low + low.abs().max(1e-9) };
        Self { low, high, above: top > high }
    }

    /// The step of a value.
    pub fn step(&self, value: f64) -> usize {
        let share = ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0);
        ((share * STEPS as f64) as usize).min(STEPS - 1)
    }

    /// The decimals that tell its values apart.
    pub fn digits(&self) -> usize {
        (2.0 - libm::floor(libm::log10(self.high.abs().max(self.low.abs()).max(1e-9)))).max(0.0) as usize
    }

    /// Draws the steps with their values, and what they are; 40 units high.
    pub fn draw(&self, out: &mut String, x: f64, y: f64, label: &str) {
        const WIDE: f64 = 34.0;
        for step in 0..STEPS {
            let left = x + WIDE * step as f64;
            let _ = write!(
                out,
                "<g class=\"v{step}\"><rect class=\"full\" x=\"{left}\" y=\"{y}\" width=\"{WIDE}\" height=\"10\"/></g>"
            );
        }
        let digits = self.digits();
        for part in [0.0, 0.5, 1.0] {
            let (at, value) = (x + part * WIDE * STEPS as f64, self.low + part * (self.high - self.low));
            let more = if part == 1.0 && self.above { "≥ " } else { "" };
            let _ = write!(
                out,
                "<text class=\"soft\" x=\"{at}\" y=\"{}\" text-anchor=\"middle\">{more}{value:.digits$}</text>",
                y + 24.0
            );
        }
        let _ =
            write!(out, "<text x=\"{}\" y=\"{}\">{}</text>", x + WIDE * STEPS as f64 + 26.0, y + 10.0, escape(label));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_more_is_never_a_lower_step_and_all_steps_are_used() {
        let ramp = Ramp::of((0..=1000).map(f64::from));
        let steps: Vec<usize> = (0..=1000).map(|x| ramp.step(f64::from(x))).collect();
        assert!(steps.is_sorted());
        assert_eq!((steps[0], steps[1000]), (0, STEPS - 1));
        assert!((0..STEPS).all(|step| steps.contains(&step)));
    }

    #[test]
    fn equal_values_and_none_have_a_step() {
        assert_eq!(Ramp::of([3.0, 3.0]).step(3.0), 0);
        assert_eq!(Ramp::of([f64::NAN]).step(0.5), STEPS / 2);
    }
}
