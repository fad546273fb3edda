//! Disturbances as steps: the claim behind model-free control is that no vehicle data is needed and that wind, slope and
//! bank are rejected as part of F (Section 2). Every controller of the registry that drives a body is tried, and every disturbance
//! under which the preset's torque and the tyres can do what the sinusoid asks for.

use super::compared::every_law;
use super::error::PaperError;
use super::lab::{Finding, Lab, SEEDS};
use super::library::Preset;
use super::row::{Row, Rows};
use crate::figure::{Bars, Figure};
use crate::offline::{End, Road, Vehicle};
use crate::plant::Body;
use crate::plant::body::GRAVITY_MPS2;

/// Length of the test \[m\].
const LENGTH_M: f64 = 600.0;
/// Where the disturbance sets in \[m\].
const FROM_M: f64 = 200.0;

/// What changes at [`FROM_M`].
#[derive(Clone, Copy)]
struct Disturbance {
    /// The name behind the test's.
    suffix: &'static str,
    body: Option<fn(&mut Body)>,
    /// Rise over run, uphill positive.
    grade: f64,
    headwind_mps: f64,
    /// Likewise to the side.
    bank: f64,
}

const NONE: Disturbance = Disturbance { suffix: "", body: None, grade: 0.0, headwind_mps: 0.0, bank: 0.0 };

const fn other_body(suffix: &'static str, change: fn(&mut Body)) -> Disturbance {
    Disturbance { suffix, body: Some(change), ..NONE }
}

const DISTURBANCES: &[Disturbance] = &[
    NONE,
    other_body("_mass_plus_50", |body| load(body, 1.5)),
    other_body("_mass_minus_50", |body| load(body, 0.5)),
    other_body("_stiffness_plus_30", |body| stiffen(body, 1.3)),
    other_body("_stiffness_minus_30", |body| stiffen(body, 0.7)),
    other_body("_friction_0.5", |body| body.friction = [0.5; 4]),
    Disturbance { suffix: "_grade_plus_5", grade: 0.05, ..NONE },
    Disturbance { suffix: "_grade_minus_5", grade: -0.05, ..NONE },
    Disturbance { suffix: "_headwind_15", headwind_mps: 15.0, ..NONE },
    Disturbance { suffix: "_tailwind_15", headwind_mps: -15.0, ..NONE },
    Disturbance { suffix: "_bank_5", bank: 0.05, ..NONE },
];

impl Disturbance {
    fn act(&self, vehicle: &mut Vehicle) {
        if let Some(change) = self.body {
            vehicle.change_body(change);
        }
        vehicle.set_grade(libm::atan(self.grade));
        vehicle.set_headwind(self.headwind_mps);
        vehicle.set_bank(libm::atan(self.bank));
    }

    /// Whether torque and tyres can do what the profile asks for while this acts. What no law can do says nothing about any.
    fn is_feasible(&self, road: &Road, body: &Body) -> bool {
        let mut body = body.clone();
        if let Some(change) = self.body {
            change(&mut body);
        }
        let [accel_max_mps2, decel_max_mps2] = body.acceleration_max_mps2();
        let metres = (FROM_M as u32..=LENGTH_M as u32).map(f64::from);
        metres.map(|s| self.asks_mps2(road, &body, s)).all(|a| (-decel_max_mps2..=accel_max_mps2).contains(&a))
    }

    /// What the profile asks the wheels for at a place, as an acceleration on a flat road [m/s²].
    fn asks_mps2(&self, road: &Road, body: &Body, s: f64) -> f64 {
        let at = |s: f64| road.profile.at(s, 0.0, 0.0).0;
        let (speed_mps, slope) = (at(s), 0.5 * (at(s + 1.0) - at(s - 1.0)));
        let air_mps = speed_mps + self.headwind_mps;
        let weight_n = body.mass_kg * GRAVITY_MPS2 * libm::sin(libm::atan(self.grade));
        let against_n = body.rolling_n() + body.drag_ns2pm2() * air_mps * air_mps.abs() + weight_n;
        speed_mps * slope + against_n / body.effective_mass_kg()
    }
}

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
    let body = road.trip(0, start_mps, End::Distance(LENGTH_M))?.vehicle.body;
    let cases: Vec<&Disturbance> = DISTURBANCES.iter().filter(|case| case.is_feasible(road, &body)).collect();
    let mut trips = Vec::new();
    for _ in &cases {
        trips.extend(road.trips(SEEDS, start_mps, End::Distance(LENGTH_M))?);
    }
    let mut errors = vec![Error::default(); trips.len()];
    let outcomes = road.drive(&trips, |vehicle| {
        if vehicle.distance_m() < FROM_M {
            return;
        }
        let error = &mut errors[vehicle.trip];
        if error.samples == 0 {
            cases[vehicle.trip / (SEEDS + 1)].act(vehicle);
        }
        let e = vehicle.moment().error_mps();
        error.samples += 1;
        error.squares += e * e;
        error.largest = error.largest.max(e.abs());
    })?;
    let mut rows = Vec::new();
    for (d, case) in cases.iter().enumerate() {
        let mine = d * (SEEDS + 1)..(d + 1) * (SEEDS + 1);
        let column = |of: fn(&Error) -> f64| {
            mine.clone().map(|i| outcomes[i].finished.then(|| of(&errors[i]))).collect::<Vec<_>>()
        };
        let test = format!("disturb{}", case.suffix);
        let named = Rows { test: &test, preset: &preset.name, controller };
        rows.extend(named.of("error_rms", "m/s", &column(|e| (e.squares / f64::from(e.samples)).sqrt())));
        rows.extend(named.of("error_max_abs", "m/s", &column(|e| e.largest)));
    }
    Ok(rows)
}

fn figure(preset: &Preset, names: &[&'static str], rows: &[Row]) -> Figure {
    let driven = |case: &&Disturbance| rows.iter().any(|r| r.test == format!("disturb{}", case.suffix));
    let groups = DISTURBANCES.iter().filter(driven).map(|Disturbance { suffix, .. }| {
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
