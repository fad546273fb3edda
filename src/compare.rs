//! Controllers side by side: the same scenario, seeds, vehicles and noise streams under each of them.
//!
//! A run enters with its [`Summary`]. Every number is first taken per run ([`METRICS`]), then averaged over the seeds.
//! The difference to the first controller is paired: taken seed by seed, because two runs of one seed share demand,
//! vehicles and noise, and differ less than two seeds do. Its spread is the standard deviation of those differences
//! (n − 1) and the half width of their 95 % Student t interval, t₀.₉₇₅,ₙ₋₁·sd/√n: both need two seeds. The interval
//! takes seeds as independent and the differences as about normal; with a handful of seeds it is a guide, not a proof.
//!
//! The tracking error never stands alone: the reference's bounded memory censors large errors, so the RMS of V_x − v*
//! and the share of steps in which the bound was hit stand beside it.

mod seeds;
mod student;
mod table;

use crate::run::{Spread, Summary};
pub use seeds::{SeedsError, parse_seeds};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
pub use table::{COMPARISON, terminal_table, write_comparison};

/// One number of a run that controllers are compared by.
pub struct Metric {
    /// Its column in `comparison.csv`.
    pub name: &'static str,
    /// Its name on the terminal.
    pub title: &'static str,
    /// Its unit, empty if it has none.
    pub unit: &'static str,
    /// Decimals on the terminal.
    pub decimals: usize,
    /// How it is read off a run.
    pub read: fn(&Summary) -> Option<f64>,
}

const fn metric(
    name: &'static str,
    title: &'static str,
    unit: &'static str,
    decimals: usize,
    read: fn(&Summary) -> Option<f64>,
) -> Metric {
    Metric { name, title, unit, decimals, read }
}

fn fleet(run: &Summary, column: &str, read: fn(&Spread) -> f64) -> Option<f64> {
    run.fleet.get(column).map(read)
}

/// How many metrics there are.
pub const METRIC_COUNT: usize = 10;

/// The metrics in the order of the tables.
pub static METRICS: [Metric; METRIC_COUNT] = [
    metric("vehicles", "vehicles", "", 1, |r| Some(r.count("vehicles") as f64)),
    metric("arrived", "arrived", "", 1, |r| Some(r.count("arrived") as f64)),
    metric("error_rms_mean", "error RMS, mean", "m/s", 3, |r| fleet(r, "error_rms", |s| s.mean)),
    metric("error_rms_p95", "error RMS, p95", "m/s", 3, |r| fleet(r, "error_rms", |s| s.p95)),
    metric("speed_gap_rms_mean", "speed gap RMS, mean", "m/s", 3, |r| fleet(r, "speed_gap_rms", |s| s.mean)),
    metric("lead_limited_mean", "lead limited, mean", "", 4, |r| fleet(r, "lead_limited", |s| s.mean)),
    metric("overshoot_mean", "overshoot, mean", "m/s", 3, |r| fleet(r, "overshoot_max", |s| s.mean)),
    metric("jerk_rms_mean", "jerk RMS, mean", "m/s³", 3, |r| fleet(r, "jerk_rms", |s| s.mean)),
    metric("timeloss_mean", "time loss, mean", "s", 2, |r| r.sumo.time_loss_mean_s),
    metric("collisions", "collisions", "", 1, |r| Some(r.sumo.collisions as f64)),
];

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
        let half_width = sd.map(|sd| student::t_975(n - 1) * sd / (n as f64).sqrt());
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

/// One controller in a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct ControllerRow {
    /// Its name.
    pub controller: String,
    /// With how many seeds it ran.
    pub seeds: u64,
    /// As [`METRICS`].
    pub metrics: [Measured; METRIC_COUNT],
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

/// A run of a comparison failed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the run of {controller} with seed {seed} failed")]
pub struct RunFailed<E: std::error::Error + 'static> {
    /// The controller.
    pub controller: String,
    /// The seed.
    pub seed: u64,
    /// Why.
    pub source: E,
}

/// Runs every controller with every seed, `jobs` of them at a time, and compares them. After a failure no further run is
/// started. The result does not depend on `jobs`.
///
/// # Errors
/// [`RunFailed`] with the first failure, in the order seed by seed, controller by controller.
pub fn run_all<E: std::error::Error + Send + 'static>(
    controllers: &[String],
    seeds: &[u64],
    jobs: usize,
    run: impl Fn(&str, u64) -> Result<Summary, E> + Sync,
) -> Result<Vec<ControllerRow>, RunFailed<E>> {
    let all: Vec<(&String, u64)> = seeds.iter().flat_map(|s| controllers.iter().map(move |c| (c, *s))).collect();
    let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
    let results = Mutex::new(Vec::with_capacity(all.len()));
    let work = || {
        while !failed.load(Ordering::Relaxed) {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some((controller, seed)) = all.get(place) else { break };
            let result = run(controller, *seed);
            failed.fetch_or(result.is_err(), Ordering::Relaxed);
            results.lock().unwrap_or_else(PoisonError::into_inner).push((place, result));
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..jobs.min(all.len()) {
            scope.spawn(work);
        }
        work();
    });
    let mut results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.sort_by_key(|(place, _)| *place);
    let mut runs: Vec<(String, Vec<Summary>)> = controllers.iter().map(|c| (c.clone(), Vec::new())).collect();
    for (place, result) in results {
        let (controller, seed) = all[place];
        let summary = result.map_err(|source| RunFailed { controller: controller.clone(), seed, source })?;
        runs[place % controllers.len()].1.push(summary);
    }
    Ok(compare(&runs))
}

#[cfg(test)]
mod tests;
