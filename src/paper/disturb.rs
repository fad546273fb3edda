//! Disturbances as steps: the claim behind model-free control is that no vehicle data is needed and that wind, slope and
//! bank are rejected as part of F (Section 2). Every controller of the registry that drives a body is tried.

use super::error::PaperError;
use super::lab::{Finding, Lab, SEEDS, every_law};
use super::library::Preset;
use super::row::{Row, Rows};
use crate::figure::{Bars, Figure};
use crate::offline::{End, Road, Vehicle};
use crate::plant::Body;

/// Length of the test \[m\].
const LENGTH_M: f64 = 600.0;
/// Where the disturbance sets in \[m\].
const FROM_M: f64 = 200.0;

/// What changes at [`FROM_M`]: the name behind the test's, and the change.
type Disturbance = (&'static str, fn(&mut Vehicle));

const DISTURBANCES: &[Disturbance] = &[
    ("", |_| {}),
    ("_mass_plus_50", |vehicle| vehicle.change_body(|body| load(body, 1.5))),
    ("_mass_minus_50", |vehicle| vehicle.change_body(|body| load(body, 0.5))),
    ("_stiffness_plus_30", |vehicle| vehicle.change_body(|body| stiffen(body, 1.3))),
    ("_stiffness_minus_30", |vehicle| vehicle.change_body(|body| stiffen(body, 0.7))),
    ("_friction_0.5", |vehicle| vehicle.change_body(|body| body.friction = [0.5; 4])),
    ("_friction_0.2", |vehicle| vehicle.change_body(|body| body.friction = [0.2; 4])),
    ("_grade_plus_5", |vehicle| vehicle.set_grade(libm::atan(0.05))),
    ("_grade_minus_5", |vehicle| vehicle.set_grade(libm::atan(-0.05))),
    ("_headwind_15", |vehicle| vehicle.set_headwind(15.0)),
    ("_tailwind_15", |vehicle| vehicle.set_headwind(-15.0)),
    ("_bank_5", |vehicle| vehicle.set_bank(libm::atan(0.05))),
];

fn load(body: &mut Body, factor: f64) {
    body.mass_kg *= factor;
    body.yaw_inertia_kgm2 *= factor;
}

fn stiffen(body: &mut Body, factor: f64) {
    for tyre in body.longitudinal.iter_mut().chain(&mut body.lateral) {
        tyre.b *= factor;
    }
}

/// The error of one vehicle from the disturbance on.
#[derive(Debug, Clone, Copy, Default)]
struct Error {
    samples: u32,
    squares: f64,
    largest: f64,
}

/// The test under one preset.
///
/// # Errors
/// [`PaperError`] if the scenario cannot be read.
pub fn run(lab: &Lab, preset: &Preset) -> Result<Finding, PaperError> {
    let mut rows = Vec::new();
    let names: Vec<&'static str> = every_law().collect();
    for controller in &names {
        let scenario = lab.library.scenario("disturb", preset, controller, &[])?;
        let road = Road::new(&scenario)?;
        rows.extend(numbers(&road, preset, controller)?);
    }
    let figures = vec![figure(preset, &names, &rows)];
    Ok(Finding { rows, figures, ..Finding::default() })
}

fn numbers(road: &Road, preset: &Preset, controller: &'static str) -> Result<Vec<Row>, PaperError> {
    let start_mps = road.first_speed_mps();
    let mut trips = Vec::new();
    for _ in DISTURBANCES {
        trips.extend(road.trips(SEEDS, start_mps, End::Distance(LENGTH_M))?);
    }
    let mut errors = vec![Error::default(); trips.len()];
    let outcomes = road.drive(&trips, |vehicle| {
        if vehicle.distance_m() < FROM_M {
            return;
        }
        let error = &mut errors[vehicle.trip];
        if error.samples == 0 {
            DISTURBANCES[vehicle.trip / (SEEDS + 1)].1(vehicle);
        }
        let e = vehicle.moment().error_mps();
        error.samples += 1;
        error.squares += e * e;
        error.largest = error.largest.max(e.abs());
    })?;
    let mut rows = Vec::new();
    for (d, (suffix, _)) in DISTURBANCES.iter().enumerate() {
        let mine = d * (SEEDS + 1)..(d + 1) * (SEEDS + 1);
        let column = |of: fn(&Error) -> f64| {
            mine.clone().map(|i| outcomes[i].finished.then(|| of(&errors[i]))).collect::<Vec<_>>()
        };
        let test = format!("disturb{suffix}");
        let named = Rows { test: &test, preset: &preset.name, controller };
        rows.extend(named.of("error_rms", "m/s", &column(|e| (e.squares / f64::from(e.samples)).sqrt())));
        rows.extend(named.of("error_max_abs", "m/s", &column(|e| e.largest)));
    }
    Ok(rows)
}

fn figure(preset: &Preset, names: &[&'static str], rows: &[Row]) -> Figure {
    let groups = DISTURBANCES.iter().map(|(suffix, _)| {
        let test = format!("disturb{suffix}");
        let value = |name: &str| {
            rows.iter().find(|r| r.test == test && !r.noise && r.controller == name && r.quantity == "error_rms")?.value
        };
        let label = suffix.trim_start_matches('_').replace('_', " ");
        let label = if label.is_empty() { "undisturbed".to_owned() } else { label };
        (label, names.iter().map(|name| (*name, value(name))).collect())
    });
    Figure::bars(
        &format!("{}_disturb_rms", preset.name),
        &Bars {
            title: format!("RMS error after a disturbance, without noise, preset {}", preset.name),
            unit: "error RMS [m/s]",
            groups: groups.collect(),
        },
    )
}
