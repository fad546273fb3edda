//! Which gains of a law are free, and within which range they are looked for.

use super::error::TuneError;
use crate::keys::{Key, Kind};
use crate::registry::find;
use crate::scenario::{Catalog, Scenario};

/// What counts as a gain, the most usual first. What a law believes about the vehicle (`accel_per_unit_mps2`, `model_delay_s`), and bounds,
/// are none: they are part of the condition.
const GAINS: [&str; 8] = ["k_p", "window_s", "k_i", "epsilon", "memory_s", "k_d", "error_time_s", "integral_time_s"];
/// How far from its default a gain is looked for, as a factor.
const FAR: f64 = 100.0;
/// What a gain whose default is 0 is looked for around.
const NEAR_ZERO: f64 = 0.01;

/// One free gain.
#[derive(Debug, Clone, PartialEq)]
pub struct Gain {
    /// Its key in the section `[controller]`.
    pub key: &'static str,
    /// Where the search begins.
    pub begin: f64,
    /// Smallest and largest value that are tried.
    pub range: [f64; 2],
}

/// The first `count` gains of a law. They begin at the scenario's values.
pub fn gains(catalog: &Catalog, controller: &str, count: usize, scenario: &Scenario) -> Result<Vec<Gain>, TuneError> {
    let [(kind, laws), ..] = catalog.registries();
    let law = find(kind, &laws, controller)?;
    let has = |name: &&'static str| law.keys.iter().find(|key| key.name == *name);
    let all: Vec<&Key> = GAINS.iter().filter_map(has).collect();
    if count == 0 || count > all.len() {
        let known = all.iter().map(|key| key.name).collect();
        return Err(TuneError::Gains { controller: controller.to_owned(), wanted: count, known });
    }
    let values = &scenario.groups[0].controller.values;
    let period_s = scenario.coupling.control_period_s;
    let gain = |key: &&Key| {
        let Kind::Number { unit, min, max } = key.kind else { unreachable!("{} is a number", key.name) };
        let begin = values.get(key.name).filter(|value| *value > 0.0).unwrap_or(NEAR_ZERO);
        // A window of fewer than two periods holds nothing that could be estimated from.
        let least = if unit == "s" { 2.0 * period_s } else { 0.0 };
        Gain { key: key.name, begin, range: [(begin / FAR).max(min).max(least), (begin * FAR).min(max)] }
    };
    Ok(all[..count].iter().map(gain).collect())
}

impl Gain {
    /// The value at a place of the logarithmic axis on which the gain is looked for: 0 is the beginning.
    pub fn at(&self, place: f64) -> f64 {
        (self.begin * libm::exp(place)).clamp(self.range[0], self.range[1])
    }

    /// True at an end of the range: a better value may lie beyond.
    pub fn is_at_edge(&self, value: f64) -> bool {
        self.range.iter().any(|end| (value / end - 1.0).abs() < 1e-3)
    }

    /// The ends of the logarithmic axis.
    pub fn ends(&self) -> [f64; 2] {
        self.range.map(|end| libm::log(end / self.begin))
    }
}
