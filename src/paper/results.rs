//! `results.csv`: every number that came out, beside the published one where there is one, with a verdict that is computed.

use super::map_summary::Summary;
use super::{claims, sine};
use std::fmt;
use std::fmt::Write;

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

/// What the paper says about a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Published {
    /// This number; ours is the same if it is no further away than `within`.
    Number {
        /// The number.
        value: f64,
        /// How far away ours may be.
        within: f64,
    },
    /// A bound.
    AtMost(f64),
}

impl Published {
    /// The number printed in the paper.
    pub fn number(self) -> f64 {
        match self {
            Self::Number { value, .. } | Self::AtMost(value) => value,
        }
    }

    fn agrees(self, ours: f64) -> bool {
        match self {
            Self::Number { value, within } => (ours - value).abs() <= within,
            Self::AtMost(bound) => ours <= bound,
        }
    }
}

/// How a number compares with the published one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// It agrees.
    Reproduced,
    /// It does not, but the adaptive law is better than the classic one by at least half as much as published; of a claim
    /// in words, as its criterion says.
    Partly,
    /// Neither.
    NotReproduced,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Reproduced => "reproduced",
            Self::Partly => "partly",
            Self::NotReproduced => "not reproduced",
        })
    }
}

/// How many verdicts of each kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Count {
    /// Reproduced.
    pub reproduced: usize,
    /// Partly.
    pub partly: usize,
    /// Not reproduced.
    pub not: usize,
}

impl Count {
    /// How many verdicts.
    pub fn all(&self) -> usize {
        self.reproduced + self.partly + self.not
    }
}

/// Tolerance on published errors, relative: the recordings are not the paper's own.
const ERROR_WITHIN: f64 = 0.15;

/// The paper's numbers (Section 5, Table 2 and text): test, controller, quantity.
const PUBLISHED: &[(&str, &str, &str, Published)] = &[
    ("step", "classic", "overshoot_1", Published::Number { value: 19.5, within: 1.0 }),
    ("step", "classic", "overshoot_2", Published::Number { value: 9.5, within: 0.7 }),
    ("step", "adaptive", "overshoot_1", Published::Number { value: 8.0, within: 0.7 }),
    ("step", "adaptive", "overshoot_2", Published::Number { value: 3.9, within: 0.5 }),
    ("step", "adaptive", "settling_1", Published::AtMost(100.0)),
    ("step", "adaptive", "settling_2", Published::AtMost(100.0)),
    ("driver", "classic", "error_mean", Published::Number { value: -0.01, within: 0.05 }),
    ("driver", "classic", "error_std", Published::Number { value: 0.77, within: ERROR_WITHIN * 0.77 }),
    ("driver", "classic", "error_rms", Published::Number { value: 0.78, within: ERROR_WITHIN * 0.78 }),
    ("driver", "adaptive", "error_mean", Published::Number { value: -0.02, within: 0.05 }),
    ("driver", "adaptive", "error_std", Published::Number { value: 0.35, within: ERROR_WITHIN * 0.35 }),
    ("driver", "adaptive", "error_rms", Published::Number { value: 0.35, within: ERROR_WITHIN * 0.35 }),
    ("delay", "classic", "error_rms", Published::Number { value: 2.27, within: ERROR_WITHIN * 2.27 }),
    ("delay", "adaptive", "error_rms", Published::Number { value: 0.68, within: ERROR_WITHIN * 0.68 }),
];

impl Row {
    /// What the paper says about this quantity; `driver_udds` is held against the paper's `driver`.
    pub fn published(&self) -> Option<Published> {
        published(self.family(), self.controller, self.quantity)
    }

    /// `driver` of `driver_udds`.
    pub fn family(&self) -> &str {
        family(&self.test)
    }

    /// Whether this row stands for what the paper shows. Of the steps, the sine and the disturbances that is the single drive
    /// without noise; of the recordings, which go on for long, the mean over the noise. The short sine is beside the paper.
    pub fn is_shown(&self) -> bool {
        self.noise == ["driver", "delay"].contains(&self.family()) && self.test != sine::SHORT
    }
}

/// `driver` of `driver_udds`.
pub fn family(test: &str) -> &str {
    test.split('_').next().unwrap_or(test)
}

fn published(family: &str, controller: &str, quantity: &str) -> Option<Published> {
    PUBLISHED.iter().find(|(t, c, q, _)| (*t, *c, *q) == (family, controller, quantity)).map(|p| p.3)
}

/// All numbers.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Results {
    /// In the order in which they are written.
    pub rows: Vec<Row>,
    /// What the map says, if there is one.
    pub map: Option<Summary>,
}

impl Results {
    /// The row of a quantity.
    pub fn get(&self, test: &str, preset: &str, noise: bool, controller: &str, quantity: &str) -> Option<&Row> {
        self.rows.iter().find(|r| {
            (r.test.as_str(), r.preset.as_str(), r.noise, r.controller, r.quantity)
                == (test, preset, noise, controller, quantity)
        })
    }

    /// The verdict on a row that the paper has a number for, or a claim in words.
    pub fn verdict(&self, row: &Row) -> Option<Verdict> {
        let Some(ours) = row.published() else { return claims::about(row).map(|claim| claim.judge(row, self)) };
        if row.value.is_some_and(|v| ours.agrees(v)) {
            return Some(Verdict::Reproduced);
        }
        let both = |controller| {
            let here = self.get(&row.test, &row.preset, row.noise, controller, row.quantity)?.value?;
            let there = published(row.family(), controller, row.quantity)?.number();
            Some((here, there))
        };
        Some(match (both("classic"), both("adaptive")) {
            // The published gain is 1 − adaptive/classic; half of it or more is the effect, though not its size.
            (Some((classic, classic_there)), Some((adaptive, adaptive_there)))
                if classic_there > 0.0 && 1.0 - adaptive / classic >= 0.5 * (1.0 - adaptive_there / classic_there) =>
            {
                Verdict::Partly
            }
            _ => Verdict::NotReproduced,
        })
    }

    /// What stands for a published number, as a table for the terminal, and what the map says.
    pub fn table(&self) -> String {
        let mut text = String::new();
        for row in self.rows.iter().filter(|r| r.is_shown()) {
            let Some((published, verdict)) = row.published().zip(self.verdict(row)) else { continue };
            let value = row.value.map_or_else(|| "-".to_owned(), |v| format!("{v:.2}"));
            let _ = writeln!(
                text,
                "{:<14}{:<10}{:<10}{:<13}{value:>8} {:<4}published {:>6}  {verdict}",
                row.test,
                row.preset,
                row.controller,
                row.quantity,
                row.unit,
                published.number(),
            );
        }
        text + &self.map.as_ref().map(Summary::text).unwrap_or_default()
    }

    /// How many of what a preset's rows stand for came out: reproduced, partly, not; of numbers and of claims in words. The paper
    /// shows no disturbances, so these do not count.
    pub fn counts(&self, preset: &str) -> [Count; 2] {
        let mut counts = [Count::default(); 2];
        for row in self.rows.iter().filter(|r| r.preset == preset && r.is_shown() && r.family() != "disturb") {
            let Some(verdict) = self.verdict(row) else { continue };
            let count = &mut counts[usize::from(row.published().is_none())];
            match verdict {
                Verdict::Reproduced => count.reproduced += 1,
                Verdict::Partly => count.partly += 1,
                Verdict::NotReproduced => count.not += 1,
            }
        }
        counts
    }

    /// As `results.csv`.
    pub fn to_csv(&self) -> String {
        let mut csv = String::from("test,preset,noise,controller,quantity,value,spread,unit,published,verdict\n");
        let number = |x: Option<f64>| x.map(|x| x.to_string()).unwrap_or_default();
        for row in &self.rows {
            let verdict = self.verdict(row).map(|v| v.to_string()).unwrap_or_default();
            let published = number(row.published().map(Published::number));
            let noise = if row.noise { "on" } else { "off" };
            let _ = writeln!(
                csv,
                "{},{},{noise},{},{},{},{},{},{published},{verdict}",
                row.test,
                row.preset,
                row.controller,
                row.quantity,
                number(row.value),
                number(row.spread),
                row.unit,
            );
        }
        csv
    }
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
}
