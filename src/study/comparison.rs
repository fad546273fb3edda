//! `comparison.csv`: a row per setting and metric.

use super::bootstrap::interval;
use super::metrics::{METRIC_COUNT, METRICS};
use super::pairs::Pairs;
use super::plan::Plan;
use super::statistics::{Estimate, holm, seeds_for};

use crate::table::{Cell, Column, Columns, Field, Kind, Layout, record};

/// A difference of this share of the reference's mean is worth finding.
const WORTH: f64 = 0.05;

record! {
    /// One metric of one setting.
    #[derive(Debug, Clone, PartialEq)]
    pub struct Compared {
        metric: &'static str = "The metric; its unit follows";
        unit: &'static str = "Unit of the metric";
        seeds: u64 = "Seeds whose case is done and has the metric";
        mean: Option<f64> = "Mean over the seeds";
        ci95: Option<f64> = "Half width of the 95 % t interval of the mean; needs two seeds";
        paired_seeds: u64 = "Seeds of which the reference has the metric, too";
        diff: Option<f64> = "Mean over these of the paired difference to the reference; empty for the reference itself";
        diff_sd: Option<f64> = "Standard deviation of the paired difference";
        diff_ci95: Option<f64> = "Half width of the 95 % t interval of the difference";
        diff_boot_low: Option<f64> = "Lower end of the 95 % interval of the difference by the studentised bootstrap, on request";
        diff_boot_high: Option<f64> = "Its upper end";
        p_holm: Option<f64> = "Two-sided p of the difference, after Holm over all settings and metrics; empty where all differences are the same";
        completed: u64 = "Vehicles that arrived in both runs and have the metric, over all seeds";
        completed_diff: Option<f64> = "Mean over the seeds of the mean difference of these vehicles";
        completed_diff_ci95: Option<f64> = "Half width of its 95 % t interval";
        share_better: Option<f64> = "Share of these vehicles with less of the metric than in the reference";
        seeds_for_5pct: Option<f64> = "Seeds that find a difference of 5 % of the reference's mean with a probability of 80 %";
    }
}

/// A row of `comparison.csv`.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparisonRow {
    /// Which setting.
    pub setting: usize,
    /// The values of the varied keys.
    pub values: Vec<String>,
    /// What is compared.
    pub compared: Compared,
}

/// The columns of the varied keys, in front of those of a table.
pub fn key_columns<R: 'static>(keys: &[String], values: fn(&R) -> &[String]) -> Columns<R> {
    let column = |(index, key): (usize, &String)| -> (Column, crate::table::Read<R>) {
        let meaning = "Value of the varied key".to_owned();
        (
            Column::new(key, Kind::Text, None, meaning),
            Box::new(move |row| Cell::Text(values(row).get(index).map(|v| &**v))),
        )
    };
    keys.iter().enumerate().map(column).collect()
}

/// `comparison.csv` of a study that varies these keys.
pub fn comparison_layout(keys: &[String]) -> Layout<ComparisonRow> {
    let mut columns = key_columns(keys, |row: &ComparisonRow| &row.values);
    columns.extend(Compared::columns(Column::new("", Kind::Number, None, ""), |row: &ComparisonRow| &row.compared));
    Layout::new(["comparison", "metric"], "One row per setting and metric, after a column per varied key", columns)
}

/// What the seeds of one setting say of one metric.
#[derive(Debug, Clone, Default)]
pub struct Samples {
    /// The metric, seed by seed.
    pub values: Vec<Option<f64>>,
    /// The vehicles that arrived in both runs, seed by seed.
    pub pairs: Vec<Pairs>,
}

/// All rows, from the samples by setting and metric.
pub fn compare(plan: &Plan, samples: &[[Samples; METRIC_COUNT]]) -> Vec<ComparisonRow> {
    let (mut rows, mut p) = (Vec::new(), Vec::new());
    for (index, setting) in plan.settings.iter().enumerate() {
        for (k, metric) in METRICS.iter().enumerate() {
            let own = &samples[index][k];
            let reference = setting.reference.map(|reference| &samples[reference][k]);
            let (mut compared, own_p) = compared(own, reference);
            (compared.metric, compared.unit) = (metric.name, metric.unit);
            if let Some(reference) = reference.filter(|_| plan.bootstrap > 0) {
                let name = format!("{} {}", setting.values.join("\n"), metric.name);
                let ends = interval(&differences(own, reference), plan.bootstrap, &name);
                [compared.diff_boot_low, compared.diff_boot_high] = ends.map_or([None; 2], |ends| ends.map(Some));
            }
            rows.push(ComparisonRow { setting: index, values: setting.values.clone(), compared });
            p.push(own_p);
        }
    }
    holm(&mut p);
    for (row, p) in rows.iter_mut().zip(p) {
        row.compared.p_holm = p;
    }
    rows
}

/// The paired differences to the reference.
fn differences(own: &Samples, reference: &Samples) -> Vec<f64> {
    own.values.iter().zip(&reference.values).filter_map(|(own, other)| Some((*own)? - (*other)?)).collect()
}

/// One metric of one setting, and its p before Holm.
fn compared(own: &Samples, reference: Option<&Samples>) -> (Compared, Option<f64>) {
    let values: Vec<f64> = own.values.iter().flatten().copied().collect();
    let mean = Estimate::of(&values);
    let differences = reference.map_or_else(Vec::new, |reference| differences(own, reference));
    let both = reference.into_iter().flat_map(|reference| own.values.iter().zip(&reference.values));
    let others: Vec<f64> = both.filter_map(|(own, other)| own.and(*other)).collect();
    let difference = Estimate::of(&differences);
    let worth = Estimate::of(&others).map(|other| WORTH * other.mean.abs());
    let seeds = difference.and_then(|difference| seeds_for(worth?, difference.sd?));
    let completed: u64 = own.pairs.iter().map(|pairs| pairs.count).sum();
    let better: u64 = own.pairs.iter().map(|pairs| pairs.better).sum();
    let means = own.pairs.iter().filter(|pairs| pairs.count > 0).map(|pairs| pairs.difference / pairs.count as f64);
    let vehicles = Estimate::of(&means.collect::<Vec<f64>>());
    let compared = Compared {
        metric: "",
        unit: "",
        seeds: values.len() as u64,
        mean: mean.map(|mean| mean.mean),
        ci95: mean.and_then(|mean| mean.half_width()),
        paired_seeds: differences.len() as u64,
        diff: difference.map(|difference| difference.mean),
        diff_sd: difference.and_then(|difference| difference.sd),
        diff_ci95: difference.and_then(|difference| difference.half_width()),
        diff_boot_low: None,
        diff_boot_high: None,
        p_holm: None,
        completed,
        completed_diff: vehicles.map(|vehicles| vehicles.mean),
        completed_diff_ci95: vehicles.and_then(|vehicles| vehicles.half_width()),
        share_better: (completed > 0).then(|| better as f64 / completed as f64),
        seeds_for_5pct: seeds.map(|seeds| seeds as f64),
    };
    (compared, difference.and_then(|difference| difference.p()))
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// The rows of two settings whose metrics are these over the seeds; the second is compared with the first.
    pub fn rows(first: &[f64], second: &[f64]) -> Vec<ComparisonRow> {
        let samples =
            |values: &[f64]| Samples { values: values.iter().copied().map(Some).collect(), pairs: Vec::new() };
        let (first, second) = (samples(first), samples(second));
        let row = |setting: usize, own: &Samples, reference: Option<&Samples>| {
            METRICS.each_ref().map(|metric| {
                let compared = Compared { metric: metric.name, unit: metric.unit, ..compared(own, reference).0 };
                ComparisonRow { setting, values: vec![["ideal", "classic"][setting].to_owned()], compared }
            })
        };
        [row(0, &first, None), row(1, &second, Some(&first))].concat()
    }

    fn near(got: Option<f64>, wanted: f64) {
        assert!((got.unwrap() - wanted).abs() < 1e-8, "{got:?} instead of {wanted}");
    }

    #[test]
    fn differences_are_paired_seed_by_seed() {
        // The values spread by 1.1 over the seeds, the differences 0.1, 0.2, 0.3 only by 0.1.
        let rows = rows(&[1.0, 2.0, 3.0], &[1.1, 2.2, 3.3]);
        let (first, second) = (&rows[0].compared, &rows[METRIC_COUNT].compared);
        assert_eq!((first.diff, first.paired_seeds), (None, 0));
        near(second.mean, 2.2);
        near(second.ci95, 4.302_652_729_7 * 1.1 / 3f64.sqrt());
        near(second.diff, 0.2);
        near(second.diff_sd, 0.1);
        near(second.diff_ci95, 4.302_652_729_7 * 0.1 / 3f64.sqrt());
        // 5 % of 2 is as much as the spread: 10 seeds by t, 7.85 by the normal distribution.
        assert_eq!(second.seeds_for_5pct, Some(10.0));
    }

    #[test]
    fn a_seed_without_its_pair_counts_for_the_mean_alone() {
        let samples = |values: [Option<f64>; 3]| Samples { values: values.to_vec(), pairs: Vec::new() };
        let own = samples([Some(1.0), Some(2.0), Some(9.0)]);
        let (row, _) = compared(&own, Some(&samples([Some(0.5), Some(1.5), None])));
        assert_eq!((row.seeds, row.mean, row.paired_seeds, row.diff), (3, Some(4.0), 2, Some(0.5)));
    }

    #[test]
    fn vehicles_that_arrived_in_both_runs_are_counted_over_all_seeds() {
        let pairs = [Pairs { count: 3, better: 2, difference: -1.5 }, Pairs { count: 1, better: 0, difference: 0.5 }];
        let (row, _) = compared(&Samples { values: Vec::new(), pairs: pairs.to_vec() }, None);
        assert_eq!((row.completed, row.share_better), (4, Some(0.5)));
        // Each seed counts once: the mean of -0.5 and 0.5.
        assert_eq!(row.completed_diff, Some(0.0));
    }
}
