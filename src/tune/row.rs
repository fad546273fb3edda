//! `tune.csv`: a row per condition and law.

use super::drives::Trial;
use super::tuned::Tuned;
use crate::study::Estimate;
use crate::table::{Layout, record, rounded};

record! {
    /// A law in a condition.
    #[derive(Debug, Clone, PartialEq)]
    pub struct TunedRow {
        condition: String = "The condition";
        controller: String = "The law";
        gains: String = "The gains that were tuned here, as arguments of --set";
        at_edge: bool = "Whether one of them is at an end of the range that was searched";
        trials: u64 = "Sets of gains that were tried";
        train_rms: f64 = "Mean RMS error of these gains on the recordings that they were tuned on" ["m/s"];
        test_rms: Option<f64> = "The same on the other recordings with other noise: mean over the seeds" ["m/s"];
        test_ci95: Option<f64> = "Half width of its 95 % t interval over the seeds" ["m/s"];
        test_ratio: Option<f64> = "Mean over the seeds of the ratio to the first law; empty for the first law itself";
        test_ratio_ci95: Option<f64> = "Half width of its 95 % t interval";
        once_rms: Option<f64> = "As test_rms, with the gains that were tuned in the first condition" ["m/s"];
        once_ratio: Option<f64> = "Ratio of that to the first law's, likewise with the gains of the first condition";
        once_ratio_ci95: Option<f64> = "Half width of its 95 % t interval";
        unfinished: u64 = "Vehicles of both tests that did not come to the end; their seeds count nowhere";
    }
}

/// The columns.
pub fn layout() -> Layout<TunedRow> {
    Layout::of_record(["tuning", "law"], "One row per condition and law")
}

/// How gains did on the recordings to judge on, and how the first law's did.
pub struct Tested<'a> {
    pub trial: &'a Trial,
    /// None for the first law itself.
    pub reference: Option<&'a Trial>,
}

impl Tested<'_> {
    fn rms(&self) -> Option<Estimate> {
        let finished: Vec<f64> = self.trial.by_seed().into_iter().flatten().collect();
        Estimate::of(&finished)
    }

    /// The ratio to the first law, seed by seed: both had the same noise.
    fn ratio(&self) -> Option<Estimate> {
        let pairs = self.trial.by_seed().into_iter().zip(self.reference?.by_seed());
        let ratios: Vec<f64> = pairs.filter_map(|(mine, other)| Some(mine? / other?)).collect();
        Estimate::of(&ratios)
    }
}

pub fn row(law: &Tuned, here: Tested, once: Tested) -> TunedRow {
    let pairs = || law.gains.iter().zip(&law.best);
    let gains: Vec<String> =
        pairs().map(|(gain, value)| format!("controller.{}={}", gain.key, rounded(*value))).collect();
    let (rms, ratio, once_ratio) = (here.rms(), here.ratio(), once.ratio());
    let half = |estimate: Option<Estimate>| estimate?.half_width();
    let mean = |estimate: Option<Estimate>| Some(estimate?.mean);
    TunedRow {
        condition: law.condition.name.clone(),
        controller: law.controller.to_owned(),
        gains: gains.join(" "),
        at_edge: pairs().any(|(gain, value)| gain.is_at_edge(*value)),
        trials: law.trials as u64,
        train_rms: law.train.cost(),
        test_rms: mean(rms),
        test_ci95: half(rms),
        test_ratio: mean(ratio),
        test_ratio_ci95: half(ratio),
        once_rms: mean(once.rms()),
        once_ratio: mean(once_ratio),
        once_ratio_ci95: half(once_ratio),
        unfinished: (here.trial.unfinished() + once.trial.unfinished()) as u64,
    }
}
