//! A sinusoid of position (Section 5.2): the first oscillation's overshoot and where the error has converged.

use super::compared::CONTROLLERS;
use super::error::PaperError;
use super::lab::{Finding, Lab, SEEDS};
use super::library::Preset;
use super::row::{Row, Rows, SHORT_SINE};
use super::series::Series;
use crate::figure::{Chart, Curve, Figure};
use crate::offline::{End, Moment, Road};
use crate::scenario::{Override, Scenario};
use rayon::prelude::*;

/// Length of the test, in wavelengths; the first one is the first oscillation.
const WAVES: f64 = 3.0;
/// The error has converged when it stays below this share of the reference for the rest of the first oscillation.
const BAND: f64 = 0.05;

/// What one vehicle did.
#[derive(Debug, Clone, Copy, Default)]
struct Course {
    reached: bool,
    /// Largest (V_x − y_r)/y_r in the first oscillation after the reference was reached.
    over: f64,
    converged_m: Option<f64>,
    /// Periods since then, and the sum of their squared errors [m²/s²].
    periods: u32,
    squares: f64,
}

impl Course {
    /// Takes a moment; the first oscillation decides where the error has converged.
    fn see(&mut self, m: &Moment, is_first: bool) {
        if is_first {
            self.see_first(m);
        }
        if self.converged_m.is_some() {
            self.periods += 1;
            self.squares += m.error_mps() * m.error_mps();
        }
    }

    fn see_first(&mut self, m: &Moment) {
        let relative = m.speed_mps / m.reference_mps - 1.0;
        self.reached |= relative >= 0.0;
        if self.reached {
            self.over = self.over.max(relative);
        }
        match (relative.abs() <= BAND, self.converged_m) {
            (true, None) => self.converged_m = Some(m.distance_m),
            (false, Some(_)) => (self.converged_m, self.periods, self.squares) = (None, 0, 0.0),
            _ => {}
        }
    }

    /// RMS error from where it has converged on [m/s].
    fn rms_mps(&self) -> Option<f64> {
        self.converged_m.map(|_| (self.squares / f64::from(self.periods.max(1))).sqrt())
    }
}

/// The sinusoid of `sine.toml`, and a short one: how much hangs on what the paper leaves open.
const WAVELENGTHS: &[(&str, Option<f64>)] = &[("sine", None), (SHORT_SINE, Some(200.0))];

/// The test under one preset.
///
/// # Errors
/// [`PaperError`] if the scenario cannot be read.
pub fn run(lab: &Lab, preset: &Preset) -> Result<Finding, PaperError> {
    let mut finding = Finding::default();
    for (test, wavelength_m) in WAVELENGTHS {
        let more: Vec<Override> =
            wavelength_m.map(|m| Override::literal(test, "target.sine_wavelength_m", m)).into_iter().collect();
        let driven: Vec<(Vec<Row>, Vec<Moment>)> = CONTROLLERS
            .par_iter()
            .map(|controller| {
                drive(test, preset, &lab.library.scenario("sine", preset, controller, &more)?, controller)
            })
            .collect::<Result<_, _>>()?;
        let (rows, moments): (Vec<_>, Vec<_>) = driven.into_iter().unzip();
        let drives: Vec<_> = CONTROLLERS.into_iter().zip(moments).collect();
        let (figures, series) = (figures(test, preset, &drives), Series::all(test, preset, &drives));
        finding.extend(Finding { rows: rows.concat(), figures, series, ..Finding::default() });
    }
    Ok(finding)
}

fn drive(
    test: &str,
    preset: &Preset,
    scenario: &Scenario,
    controller: &'static str,
) -> Result<(Vec<Row>, Vec<Moment>), PaperError> {
    let road = Road::new(scenario)?;
    let wave_m = scenario.groups[0].target.values.get("sine_wavelength_m").unwrap_or(f64::NAN);
    let mut exact = Vec::new();
    let mut courses = vec![Course::default(); SEEDS + 1];
    let trips = road.trips(SEEDS, 0.0, End::Distance(WAVES * wave_m))?;
    let outcomes = road.drive(&trips, |vehicle| {
        let moment = vehicle.moment();
        courses[vehicle.trip].see(&moment, moment.distance_m < wave_m);
        if vehicle.trip == 0 {
            exact.push(moment);
        }
    })?;
    let named = Rows { test, preset: &preset.name, controller };
    let overshoot: Vec<_> = courses.iter().map(|c| Some(100.0 * c.over)).collect();
    let converged: Vec<_> = courses.iter().map(|c| c.converged_m).collect();
    let rms: Vec<_> = courses.iter().zip(&outcomes).map(|(c, o)| c.rms_mps().filter(|_| o.finished)).collect();
    let rows = [
        named.of("overshoot_1", "%", &overshoot),
        named.of("settling_1", "m", &converged),
        named.of("error_rms_converged", "m/s", &rms),
        named.errors(&outcomes),
    ];
    Ok((rows.concat(), exact))
}

fn figures(test: &str, preset: &Preset, drives: &[(&'static str, Vec<Moment>)]) -> Vec<Figure> {
    let title = |what: &str| format!("{what}, {test}, preset {}", preset.name);
    let mut speeds =
        vec![Curve::of("reference", drives[0].1.iter().map(|m| (m.distance_m, m.reference_mps)).collect())];
    let mut errors = Vec::new();
    for (name, moments) in drives {
        speeds.push(Curve::of(name, moments.iter().map(|m| (m.distance_m, m.speed_mps)).collect()));
        errors.push(Curve::of(name, moments.iter().map(|m| (m.distance_m, m.speed_mps - m.reference_mps)).collect()));
    }
    let chart = |what: &str, title: String, y, curves| {
        let chart = Chart { title, x: "distance s [m]", y, curves, ..Chart::default() };
        Figure::chart(&format!("{}_{test}_{what}", preset.name), &chart)
    };
    vec![
        chart("speed", title("Speed"), "speed [m/s]", speeds),
        chart("error", title("Speed error"), "error [m/s]", errors),
    ]
}
