//! The rows of `results.csv`.

use super::published::{Published, Weight, published, weight};
use crate::offline::Outcome;

/// The test with the short sinusoid: how much hangs on what the paper leaves open.
pub const SHORT_SINE: &str = "sine_200m";

/// One number.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// `step`, `sine`, `driver`, `driver_udds`, ...
    pub test: String,
    /// The preset.
    pub preset: String,
    /// Whether the speed was measured with noise.
    pub noise: bool,
    /// The controller.
    pub controller: &'static str,
    /// `overshoot_1`, `error_rms`, ...
    pub quantity: &'static str,
    /// The value, with noise the mean over the seeds; none if there is none (never settled, never arrived).
    pub value: Option<f64>,
    /// Standard deviation over the seeds.
    pub spread: Option<f64>,
    /// Unit of value and spread.
    pub unit: &'static str,
}

impl Row {
    /// What the paper says about this quantity; `driver_udds` is held against the paper's `driver`.
    pub fn published(&self) -> Option<Published> {
        published(self.family(), self.controller, self.quantity)
    }

    /// What that says that the paper's other numbers do not.
    pub fn weight(&self) -> Option<Weight> {
        weight(self.family(), self.controller, self.quantity)
    }

    /// `_udds` of `driver_udds`; empty for what is driven on no recording, or on the first one.
    pub fn recording(&self) -> &str {
        if is_on_road(self.family()) { &self.test[self.family().len()..] } else { "" }
    }

    /// `driver` of `driver_udds`.
    pub fn family(&self) -> &str {
        family(&self.test)
    }

    /// Whether this row stands for what the paper shows. Of the steps, the sine and the disturbances that is the single drive
    /// without noise; of the recordings, which go on for long, the mean over the noise. The short sine is beside the paper.
    pub fn is_shown(&self) -> bool {
        self.noise == is_on_road(self.family()) && self.test != SHORT_SINE
    }
}

/// Whether a family of tests drives along a recording.
pub fn is_on_road(family: &str) -> bool {
    ["driver", "delay"].contains(&family)
}

/// `driver` of `driver_udds`.
pub fn family(test: &str) -> &str {
    test.split('_').next().unwrap_or(test)
}

/// The row of a quantity.
pub fn find<'a>(
    rows: &'a [Row],
    test: &str,
    preset: &str,
    noise: bool,
    controller: &str,
    quantity: &str,
) -> Option<&'a Row> {
    let wanted = (test, preset, noise, controller, quantity);
    rows.iter().find(|r| (r.test.as_str(), r.preset.as_str(), r.noise, r.controller, r.quantity) == wanted)
}

/// Mean and standard deviation (divided by n − 1) of the values; none if one is missing.
pub fn mean_and_spread(values: &[Option<f64>]) -> (Option<f64>, Option<f64>) {
    let Some(values) = values.iter().copied().collect::<Option<Vec<f64>>>().filter(|v| !v.is_empty()) else {
        return (None, None);
    };
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
    (Some(mean), (values.len() > 1).then(|| (squares / (n - 1.0)).sqrt()))
}

/// Names the rows of one controller in one test under one preset.
pub struct Rows<'a> {
    /// The test.
    pub test: &'a str,
    /// The preset.
    pub preset: &'a str,
    /// The controller.
    pub controller: &'static str,
}

impl Rows<'_> {
    /// The two rows of a quantity. `values` are those of the vehicle without noise, then of one vehicle per seed.
    pub fn of(&self, quantity: &'static str, unit: &'static str, values: &[Option<f64>]) -> Vec<Row> {
        let row = |noise, value, spread| Row {
            test: self.test.to_owned(),
            preset: self.preset.to_owned(),
            noise,
            controller: self.controller,
            quantity,
            value,
            spread,
            unit,
        };
        let [exact, noisy @ ..] = values else { return Vec::new() };
        let mut rows = vec![row(false, *exact, None)];
        if !noisy.is_empty() {
            let (mean, spread) = mean_and_spread(noisy);
            rows.push(row(true, mean, spread));
        }
        rows
    }

    /// The table of the paper, and the largest error.
    pub fn errors(&self, outcomes: &[Outcome]) -> Vec<Row> {
        let column =
            |of: fn(&Outcome) -> Option<f64>| outcomes.iter().map(|o| of(o).filter(|_| o.finished)).collect::<Vec<_>>();
        [
            self.of("error_mean", "m/s", &column(|o| o.stats.error_mean)),
            self.of("error_std", "m/s", &column(|o| o.stats.error_std)),
            self.of("error_rms", "m/s", &column(|o| o.stats.error_rms)),
            self.of("error_max_abs", "m/s", &column(|o| o.stats.error_max_abs)),
            self.of("jerk_rms", "m/s3", &column(|o| o.stats.jerk_rms)),
        ]
        .concat()
    }
}
