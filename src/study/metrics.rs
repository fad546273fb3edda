//! The numbers of a run that settings are compared by, each declared once.

use crate::run::{Spread, Summary};

/// What a run says as a whole.
#[derive(Debug, Clone, PartialEq)]
pub struct Totals {
    /// Its summary.
    pub summary: Summary,
    /// Mean time loss of all vehicles, also those that were under way at the end \[s\].
    pub time_loss_mean_s: Option<f64>,
}

/// One number of a run that settings are compared by.
pub struct Metric {
    /// Its name in the tables.
    pub name: &'static str,
    /// Its name on the terminal.
    pub title: &'static str,
    /// Its unit, empty if it has none.
    pub unit: &'static str,
    /// Decimals on the terminal.
    pub decimals: usize,
    /// How it is read off a run.
    pub read: fn(&Totals) -> Option<f64>,
    /// The column of `vehicles.csv` that it averages; a vehicle with less of it is better.
    pub column: Option<&'static str>,
}

/// The column that SUMO's tripinfo has of vehicles that are no egos, too.
pub const TIME_LOSS: &str = "timeloss";

type Read = fn(&Totals) -> Option<f64>;

/// A number of the whole run.
const fn whole(name: &'static str, title: &'static str, read: Read) -> Metric {
    Metric { name, title, unit: "", decimals: 1, read, column: None }
}

fn fleet(run: &Totals, column: &str, read: fn(&Spread) -> f64) -> Option<f64> {
    run.summary.fleet.get(column).map(read)
}

/// Declares metrics that are the mean of a column over the egos.
macro_rules! mean {
    ($name:literal, $title:literal, $unit:literal, $decimals:literal, $column:literal) => {
        Metric {
            name: $name,
            title: $title,
            unit: $unit,
            decimals: $decimals,
            read: |run| fleet(run, $column, |spread| spread.mean),
            column: Some($column),
        }
    };
}

/// How many metrics there are.
pub const METRIC_COUNT: usize = 13;

/// The metrics in the order of the tables.
pub static METRICS: [Metric; METRIC_COUNT] = [
    whole("egos", "egos", |r| Some(r.summary.count("vehicles") as f64)),
    whole("inserted", "vehicles inserted", |r| Some(r.summary.sumo.inserted as f64)),
    whole("arrived", "vehicles arrived", |r| Some(r.summary.sumo.arrived as f64)),
    whole("unfinished", "vehicles unfinished", |r| {
        Some(r.summary.sumo.inserted as f64 - r.summary.sumo.arrived as f64)
    }),
    mean!("error_rms_mean", "error RMS, mean", "m/s", 3, "error_rms"),
    Metric {
        read: |r| fleet(r, "error_rms", |s| s.p95),
        column: None,
        ..mean!("error_rms_p95", "error RMS, p95", "m/s", 3, "error_rms")
    },
    mean!("speed_gap_rms_mean", "speed gap RMS, mean", "m/s", 3, "speed_gap_rms"),
    mean!("lead_limited_mean", "lead limited, mean", "", 4, "lead_limited"),
    mean!("overshoot_mean", "overshoot, mean", "m/s", 3, "overshoot_max"),
    mean!("jerk_rms_mean", "jerk RMS, mean", "m/s³", 3, "jerk_rms"),
    Metric {
        unit: "s",
        decimals: 2,
        column: Some(TIME_LOSS),
        ..whole("timeloss_mean", "time loss, mean", |r| r.time_loss_mean_s)
    },
    whole("collisions", "collisions", |r| Some(r.summary.sumo.collisions as f64)),
    whole("teleports", "teleports", |r| Some(r.summary.sumo.teleports as f64)),
];
