//! The numbers of a run that controllers are compared by.

use crate::run::{Spread, Summary};

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
