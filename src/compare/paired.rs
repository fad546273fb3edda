//! Means over the seeds, and differences to the first controller that are paired by seed.

use super::metrics::{METRIC_COUNT, METRICS};
use super::student::t_975;
use crate::run::Summary;
use crate::table::{Cell, Column, Columns, Field, Kind, record};

/// How a metric differs from the first controller's, over the seeds in which both have it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Mean of the differences seed by seed.
    pub mean: f64,
    /// Their standard deviation, divided by n − 1; needs two seeds.
    pub sd: Option<f64>,
    /// Half the width of their 95 % t interval; needs two seeds.
    pub half_width: Option<f64>,
}

impl Difference {
    /// Of the paired differences of all seeds; `None` if there are none.
    pub fn of(differences: &[f64]) -> Option<Self> {
        let n = differences.len();
        let mean = mean(differences)?;
        let squares: f64 = differences.iter().map(|d| (d - mean) * (d - mean)).sum();
        let sd = (n > 1).then(|| (squares / (n - 1) as f64).sqrt());
        let half_width = sd.map(|sd| t_975(n - 1) * sd / (n as f64).sqrt());
        Some(Self { mean, sd, half_width })
    }
}

/// One metric of one controller.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Measured {
    /// Mean over the seeds that have a value.
    pub mean: Option<f64>,
    /// The paired difference to the first controller; none for the first controller itself.
    pub difference: Option<Difference>,
}

record! {
    /// One controller in a comparison.
    #[derive(Debug, Clone, PartialEq)]
    pub struct ControllerRow {
        controller: String = "The controller";
        seeds: u64 = "Seeds that it ran with";
        /// As [`METRICS`].
        metrics: [Measured; METRIC_COUNT];
    }
}

/// A column of a metric: the end of its name, its meaning, and how it is read.
type Part = (&'static str, &'static str, fn(&Measured) -> Option<f64>);

/// Four columns per metric.
impl Field for [Measured; METRIC_COUNT] {
    fn columns<R: 'static>(_: Column, find: impl Fn(&R) -> &Self + Clone + Send + Sync + 'static) -> Columns<R> {
        let parts: [Part; 4] = [
            ("", "mean over the seeds", |m| m.mean),
            ("_diff", "mean paired difference to the first controller", |m| Some(m.difference?.mean)),
            ("_diff_sd", "standard deviation of the paired difference", |m| m.difference?.sd),
            ("_diff_ci95", "half width of the 95 % t interval of the difference", |m| m.difference?.half_width),
        ];
        let mut columns: Columns<R> = Vec::new();
        for (k, metric) in METRICS.iter().enumerate() {
            for (suffix, what, read) in parts {
                let (name, meaning) = (format!("{}{suffix}", metric.name), format!("{}: {what}", metric.title));
                let unit = Some(metric.unit).filter(|unit| !unit.is_empty());
                let find = find.clone();
                let value = move |row: &R| read(&find(row)[k]).filter(|x| x.is_finite());
                let column = Column::new(name, Kind::Number, unit, meaning);
                columns.push((column, Box::new(move |row| Cell::Number(value(row)))));
            }
        }
        columns
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Compares controllers. Each comes with its runs, one per seed, all in the same order of seeds.
pub fn compare(runs: &[(String, Vec<Summary>)]) -> Vec<ControllerRow> {
    let row = |(i, (controller, summaries)): (usize, &(String, Vec<Summary>))| {
        let metrics = std::array::from_fn(|k| {
            let read = METRICS[k].read;
            let values: Vec<f64> = summaries.iter().filter_map(read).collect();
            let pairs = summaries.iter().zip(&runs[0].1);
            let differences: Vec<f64> = pairs.filter_map(|(own, first)| Some(read(own)? - read(first)?)).collect();
            Measured { mean: mean(&values), difference: if i == 0 { None } else { Difference::of(&differences) } }
        });
        ControllerRow { controller: controller.clone(), seeds: summaries.len() as u64, metrics }
    };
    runs.iter().enumerate().map(row).collect()
}
