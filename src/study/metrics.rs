//! The numbers of a run that settings are compared by, each declared once.

use super::vehicles::{TIME_LOSS, Vehicles};
use crate::run::{Spread, Summary};

/// A time to collision below this is counted as critical \[s\]. These three bounds are ours, at values that are common.
const CRITICAL_TTC_S: f64 = 1.5;
/// A deceleration to avoid a crash above this is counted as critical [m/s²].
const CRITICAL_DRAC_MPS2: f64 = 3.35;
/// A post-encroachment time below this is counted as critical \[s\].
const CRITICAL_PET_S: f64 = 1.0;

/// What a run says as a whole.
#[derive(Debug, Clone, Copy)]
pub struct Totals<'a> {
    /// Its summary.
    pub summary: &'a Summary,
    /// All its vehicles.
    pub vehicles: &'a Vehicles,
}

/// One number of a run that settings are compared by.
pub struct Metric {
    /// Its name in the tables.
    pub name: &'static str,
    /// Its name on the terminal, where it is shown if it has one.
    pub title: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Its unit, empty if it has none.
    pub unit: &'static str,
    /// Decimals on the terminal.
    pub decimals: usize,
    /// How it is read off a run.
    pub read: fn(Totals<'_>) -> Option<f64>,
    /// The column of the table of vehicles that it averages; a vehicle with less of it is better.
    pub column: Option<&'static str>,
}

type Read = fn(Totals<'_>) -> Option<f64>;

/// A number of the whole run.
const fn whole(name: &'static str, title: &'static str, meaning: &'static str, read: Read) -> Metric {
    Metric { name, title, meaning, unit: "", decimals: 1, read, column: None }
}

/// Declares metrics that are the mean of a column: over the egos for ours, over all vehicles for `sumo_*`.
macro_rules! mean {
    ($name:literal, $title:literal, $meaning:literal, $unit:literal, $decimals:literal, $column:literal) => {
        Metric {
            name: $name,
            title: $title,
            meaning: $meaning,
            unit: $unit,
            decimals: $decimals,
            read: |run| run.vehicles.mean($column),
            column: Some($column),
        }
    };
}

/// How many vehicles have a critical value, if any has been measured.
fn critical(run: Totals<'_>, column: &str, is_critical: fn(f64) -> bool) -> Option<f64> {
    let measured = !run.vehicles.numbers("sumo_conflicts").is_empty();
    measured.then(|| run.vehicles.numbers(column).into_iter().filter(|value| is_critical(*value)).count() as f64)
}

fn error_p95(run: Totals<'_>) -> Option<f64> {
    run.summary.fleet.get("error_rms").map(|spread: &Spread| spread.p95)
}

/// How many metrics there are.
pub const METRIC_COUNT: usize = 27;

/// The metrics in the order of the tables.
pub static METRICS: [Metric; METRIC_COUNT] = [
    whole("egos", "egos", "Egos that departed", |r| Some(r.summary.count("vehicles") as f64)),
    whole("inserted", "vehicles inserted", "Vehicles that entered the road", |r| Some(r.summary.sumo.inserted as f64)),
    whole("arrived", "vehicles arrived", "Throughput: vehicles that arrived until the end of the run", |r| {
        Some(r.summary.sumo.arrived as f64)
    }),
    whole("unfinished", "vehicles unfinished", "Vehicles inserted but not arrived", |r| {
        Some(r.summary.sumo.inserted as f64 - r.summary.sumo.arrived as f64)
    }),
    mean!("error_rms_mean", "error RMS, mean", "Tracking: error_rms", "m/s", 3, "error_rms"),
    Metric {
        read: error_p95,
        column: None,
        ..mean!("error_rms_p95", "error RMS, p95", "Tracking: 95th percentile of error_rms", "m/s", 3, "error_rms")
    },
    mean!(
        "speed_gap_rms_mean",
        "speed gap RMS, mean",
        "Tracking: speed_gap_rms, J2951's RMSSE",
        "m/s",
        3,
        "speed_gap_rms"
    ),
    mean!("lead_limited_mean", "lead limited, mean", "Tracking: lead_limited", "", 4, "lead_limited"),
    mean!("overshoot_mean", "overshoot, mean", "Tracking: overshoot_max", "m/s", 3, "overshoot_max"),
    mean!("energy_rating_mean", "", "Drive quality: energy_rating (ER)", "%", 2, "energy_rating"),
    mean!("speed_change_rating_mean", "", "Drive quality: speed_change_rating (ASCR)", "%", 2, "speed_change_rating"),
    mean!("inertial_work_rating_mean", "", "Drive quality: inertial_work_rating (IWR)", "%", 2, "inertial_work_rating"),
    mean!("jerk_rms_mean", "jerk RMS, mean", "Comfort: jerk_rms", "m/s³", 3, "jerk_rms"),
    mean!("high_jerk_share_mean", "", "Comfort: high_jerk_share", "", 4, "high_jerk_share"),
    mean!("comfort_accel_mean", "comfort acceleration, mean", "Comfort: comfort_accel", "m/s²", 3, "comfort_accel"),
    mean!("motion_sickness_mean", "", "Comfort: motion_sickness", "m/s^1.5", 3, "motion_sickness"),
    mean!("energy_per_km_mean", "energy at wheels, mean", "Effort: energy_per_km", "Wh/km", 1, "energy_per_km"),
    mean!(
        "stops_mean",
        "stops, mean",
        "Traffic: how often a vehicle became slower than 0.1 m/s",
        "",
        2,
        "sumo_waitingCount"
    ),
    Metric {
        unit: "s",
        decimals: 2,
        column: Some(TIME_LOSS),
        ..whole("timeloss_mean", "time loss, mean", "Traffic: mean time loss of all vehicles", |r| {
            r.vehicles.time_loss_mean_s()
        })
    },
    whole("collisions", "collisions", "Safety: contacts of two vehicles", |r| Some(r.summary.sumo.collisions as f64)),
    whole("teleports", "teleports", "Traffic: vehicles that SUMO carried on", |r| {
        Some(r.summary.sumo.teleports as f64)
    }),
    mean!(
        "string_gain_l2_mean",
        "string gain L2, mean",
        "String stability: string_gain_l2, with output.platoons",
        "",
        3,
        "string_gain_l2"
    ),
    mean!(
        "string_gain_linf_mean",
        "",
        "String stability: string_gain_linf, with output.platoons",
        "",
        3,
        "string_gain_linf"
    ),
    mean!("conflicts_mean", "conflicts, mean", "Safety: sumo_conflicts, with --safety", "", 3, "sumo_conflicts"),
    whole(
        "critical_ttc",
        "TTC below 1.5 s",
        "Safety: vehicles with a time to collision below 1.5 s, with --safety",
        |r| critical(r, "sumo_minTTC", |ttc_s| ttc_s < CRITICAL_TTC_S),
    ),
    whole(
        "critical_drac",
        "DRAC above 3.35 m/s²",
        "Safety: vehicles with a DRAC above 3.35 m/s², with --safety",
        |r| critical(r, "sumo_maxDRAC", |drac_mps2| drac_mps2 > CRITICAL_DRAC_MPS2),
    ),
    whole(
        "critical_pet",
        "PET below 1 s",
        "Safety: vehicles with a post-encroachment time below 1 s, with --safety",
        |r| critical(r, "sumo_PET", |pet_s| pet_s < CRITICAL_PET_S),
    ),
];
