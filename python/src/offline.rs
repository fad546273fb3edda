//! One vehicle on one profile, without SUMO.

use crate::controller::catalog;
use crate::error::{plain, raised};
use crate::table::Table;
use pyo3::prelude::*;
use std::collections::HashMap;
use sumo_mfc::offline::{Drive, Moment};
use sumo_mfc::reference::{Axis, Profile};
use toml_edit::Value;

/// The end of every control period, the statistics, and whether the end was reached.
type Driven = (Table, HashMap<&'static str, Option<f64>>, bool);

/// Drives. `keys` are keys of the scenario with their values as TOML; `profile` is how it goes on, with places (m) or times
/// (s) and speeds (m/s), in place of the profile of the keys.
#[pyfunction]
#[pyo3(signature = (keys, profile=None, start_mps=None, seconds=None, metres=None))]
pub fn drive(
    py: Python<'_>,
    keys: Vec<(String, String)>,
    profile: Option<(String, String, Vec<f64>, Vec<f64>)>,
    start_mps: Option<f64>,
    seconds: Option<f64>,
    metres: Option<f64>,
) -> PyResult<Driven> {
    let mut drive = Drive::new(&catalog());
    for (key, text) in keys {
        let value = text.parse::<Value>().map_err(|_| plain(format!("{key}: found {text}, wanted a value of TOML")))?;
        drive = drive.set(&key, value);
    }
    if let Some((shape, by, at, speeds_mps)) = profile {
        let by = if by == "position" { Axis::Position } else { Axis::Time };
        let made = match shape.as_str() {
            "steps" => Profile::step(by, &at, &speeds_mps),
            _ => Profile::lines(by, &at, &speeds_mps),
        };
        drive = drive.follow(made.map_err(plain)?);
    }
    if let Some(start_mps) = start_mps {
        drive = drive.starting_at(start_mps);
    }
    if let Some(seconds) = seconds {
        drive = drive.for_s(seconds);
    }
    if let Some(metres) = metres {
        drive = drive.for_m(metres);
    }
    let driven = py.detach(|| drive.run()).map_err(raised)?;
    let stats = driven.stats;
    let statistics = [
        ("error_mean", stats.error_mean),
        ("error_std", stats.error_std),
        ("error_rms", stats.error_rms),
        ("error_max_abs", stats.error_max_abs),
        ("overshoot_max", stats.overshoot_max),
    ];
    Ok((series(&driven.series)?, HashMap::from(statistics), driven.finished))
}

fn series(moments: &[Moment]) -> PyResult<Table> {
    let column = |read: fn(&Moment) -> f64| moments.iter().map(read).collect::<Vec<f64>>();
    Table::of_numbers(vec![
        ("time", "s", "Time since the start", column(|m| m.time_s)),
        ("distance", "m", "Driven distance", column(|m| m.distance_m)),
        ("reference", "m/s", "Reference speed y_r", column(|m| m.reference_mps)),
        ("speed", "m/s", "True speed V_x", column(|m| m.speed_mps)),
        ("measured_speed", "m/s", "Measured speed, with noise", column(|m| m.measured_mps)),
        ("torque", "N·m", "Applied torque, sum over the wheels", column(|m| m.torque_nm)),
        ("front_wheel_torque", "N·m", "Applied torque on one front wheel", column(|m| m.front_wheel_nm)),
        ("alpha_hat", "", "Estimate of α over its nominal value", column(|m| m.alpha_ratio)),
        ("f_hat", "m/s²", "Estimate of F", column(|m| m.f_hat_mps2)),
    ])
}
