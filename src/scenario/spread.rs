//! Values that differ from vehicle to vehicle: `mass_kg = { distribution = "normal", mean = 1719, std = 200 }`.

use std::fmt;

use crate::{
    keys::{Value, Values},
    random::Stream,
};

/// How often a normal draw outside its bounds is repeated before it is put on the bound.
const REDRAWS: usize = 64;

/// A distribution of one key, in the key's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distribution {
    /// Normal, cut off at `min` and `max`.
    Normal {
        /// Mean before cutting.
        mean: f64,
        /// Standard deviation before cutting.
        std: f64,
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
    },
    /// Uniform from `min` to `max`.
    Uniform {
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
    },
}

impl Distribution {
    /// Reads `normal(mean, std)`, `normal(mean, std, min, max)` or `uniform(min, max)`, with all values in a range; SUMO's
    /// own `norm` and `normc` mean the same.
    pub(super) fn parse(text: &str, (low, high): (f64, f64)) -> Option<Self> {
        let (kind, numbers) = text.trim().strip_suffix(')')?.split_once('(')?;
        let numbers: Vec<f64> = numbers.split(',').map(|x| x.trim().parse().ok()).collect::<Option<_>>()?;
        let (drawn, rising) = match (kind.trim(), &numbers[..]) {
            ("uniform", &[min, max]) => (Self::Uniform { min, max }, [low, min, max, high]),
            ("normal" | "norm", &[mean, std]) if (0.0..f64::INFINITY).contains(&std) => {
                (Self::Normal { mean, std, min: low, max: high }, [low, mean, mean, high])
            }
            ("normal" | "normc", &[mean, std, min, max]) if (0.0..f64::INFINITY).contains(&std) => {
                let bounds = if (min..=max).contains(&mean) { [low, min, max, high] } else { return None };
                (Self::Normal { mean, std, min, max }, bounds)
            }
            _ => return None,
        };
        rising.is_sorted().then_some(drawn)
    }

    /// The largest value.
    pub(super) fn largest(&self) -> f64 {
        match *self {
            Self::Normal { max, .. } | Self::Uniform { max, .. } => max,
        }
    }

    /// The value in the middle.
    fn middle(&self) -> f64 {
        match *self {
            Self::Normal { mean, .. } => mean,
            Self::Uniform { min, max } => 0.5 * (min + max),
        }
    }

    /// Draws the value of `key` for the vehicle `id` in a run with `seed`. The same vehicle gets the same value whatever
    /// else is in the run.
    pub fn draw(&self, seed: u64, key: &str, id: &str) -> f64 {
        let mut stream = Stream::new(seed, key, id);
        match *self {
            Self::Uniform { min, max } => min + (max - min) * stream.uniform(),
            Self::Normal { mean, std, min, max } => (0..REDRAWS)
                .map(|_| mean + std * stream.normal())
                .find(|x| (min..=max).contains(x))
                .unwrap_or_else(|| mean.clamp(min, max)),
        }
    }
}

impl fmt::Display for Distribution {
    /// The inline TOML table that reads back as the same distribution.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Normal { mean, std, min, max } => write!(
                f,
                "{{ distribution = \"normal\", mean = {mean:?}, std = {std:?}, min = {min:?}, max = {max:?} }}"
            ),
            Self::Uniform { min, max } => {
                write!(f, "{{ distribution = \"uniform\", min = {min:?}, max = {max:?} }}")
            }
        }
    }
}

/// Keys of a vehicle, some of them drawn per vehicle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PerVehicle {
    /// What all vehicles of the group have in common.
    pub values: Values,
    /// What is drawn.
    pub spread: Vec<(&'static str, Distribution)>,
}

impl PerVehicle {
    /// The values that the vehicle `id` draws in a run with `seed`.
    pub fn draw(&self, seed: u64, id: &str) -> Values {
        let draw = |(key, distribution): &(&'static str, Distribution)| {
            (*key, Value::Number(distribution.draw(seed, key, id)))
        };
        Values(self.spread.iter().map(draw).collect())
    }

    /// The largest values that a vehicle can get.
    pub fn largest(&self) -> Values {
        self.all(Distribution::largest)
    }

    /// What is to be expected of a vehicle of which nothing is known.
    pub fn middle(&self) -> Values {
        self.all(Distribution::middle)
    }

    /// All values, with one of its distribution for each that is drawn.
    fn all(&self, one: impl Fn(&Distribution) -> f64) -> Values {
        let mut values = self.values.clone();
        values.0.extend(self.spread.iter().map(|(key, drawn)| (*key, Value::Number(one(drawn)))));
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_draws_follow_their_distribution_and_bounds() {
        let normal = Distribution::Normal { mean: 10.0, std: 2.0, min: 6.0, max: 14.0 };
        let draws: Vec<f64> = (0..4000).map(|i| normal.draw(1, "mass_kg", &format!("v{i}"))).collect();
        assert!(draws.iter().all(|x| (6.0..=14.0).contains(x)));
        let mean = draws.iter().sum::<f64>() / 4000.0;
        let std = (draws.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 4000.0).sqrt();
        // Cut off at ±2σ, a normal distribution keeps 0.880 of its standard deviation.
        assert!((mean - 10.0).abs() < 0.1 && (std - 1.76).abs() < 0.06, "mean {mean}, std {std}");

        let uniform = Distribution::Uniform { min: -1.0, max: 3.0 };
        let mean = (0..4000).map(|i| uniform.draw(1, "mass_kg", &format!("v{i}"))).sum::<f64>() / 4000.0;
        assert!((mean - 1.0).abs() < 0.1, "mean {mean}");
    }

    #[test]
    fn law_a_draw_belongs_to_seed_key_and_vehicle() {
        let spread = PerVehicle {
            values: Values::default().with("lag_s", 0.25),
            spread: vec![("delay_s", Distribution::Uniform { min: 0.0, max: 1.0 })],
        };
        let drawn = |seed, id| spread.draw(seed, id).get::<f64>("delay_s").unwrap();
        assert_eq!(drawn(1, "a"), drawn(1, "a"));
        assert_ne!(drawn(1, "a"), drawn(2, "a"));
        assert_ne!(drawn(1, "a"), drawn(1, "b"));
        let uniform = spread.spread[0].1;
        assert_ne!(uniform.draw(1, "delay_s", "a"), uniform.draw(1, "lag_s", "a"));
        assert_eq!(spread.largest(), Values::default().with("delay_s", 1.0).with("lag_s", 0.25));
    }
}
