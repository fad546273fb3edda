//! A law behind the step test: where the torque scale b is far below α, the overshoots of the adaptive and the classic law
//! are in the ratio 2·√(Δt/T), whatever mass, K_P, α and torque limit. `docs/overshoot-ratio.md` derives it; here it is measured.

use super::compared::CONTROLLERS;
use super::error::PaperError;
use super::lab::{Finding, Lab};
use super::library::Preset;
use super::results::Results;
use super::row::Rows;
use super::step::{Plateau, response};
use crate::figure::{Chart, Curve, Figure};
use crate::offline::{End, Road};
use crate::scenario::Override;

/// Room for the slowest loop's first overshoot \[m\].
const LENGTH_M: f64 = 1500.0;
const TARGET_MPS: f64 = 10.0;
/// Torque scale over α: small enough for the law's limit.
const RATIO: f64 = 0.004;

/// One pair of step tests: what it is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Control period Δt \[s\].
    pub period_s: f64,
    /// Window T \[s\].
    pub window_s: f64,
    /// K_P [1/s].
    pub k_p: f64,
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Torque limit as an acceleration [m/s²].
    pub limit_mps2: f64,
    /// α_nominal; b is `RATIO` times this.
    pub alpha: f64,
}

/// What the law is tested with.
pub fn points() -> Vec<Point> {
    let base = Point { period_s: 0.005, window_s: 0.2, k_p: 8.0, mass_kg: 1719.0, limit_mps2: 4.0, alpha: 1.0 };
    let mut points = Vec::new();
    for window_s in [0.1, 0.2, 0.4] {
        for period_s in [0.001, 0.002, 0.005, 0.01, 0.02] {
            if window_s / period_s > 9.0 {
                points.push(Point { period_s, window_s, ..base });
            }
        }
    }
    points.extend([4.0, 16.0].map(|k_p| Point { k_p, ..base }));
    points.extend([800.0, 3000.0].map(|mass_kg| Point { mass_kg, ..base }));
    points.extend([2.5, 6.0].map(|limit_mps2| Point { limit_mps2, ..base }));
    points.extend([0.3, 3.0].map(|alpha| Point { alpha, ..base }));
    points
}

impl Point {
    /// √(Δt/T), which is what the ratio depends on.
    pub fn root(&self) -> f64 {
        (self.period_s / self.window_s).sqrt()
    }

    /// What the law says.
    pub fn predicted(&self) -> f64 {
        2.0 * self.root()
    }

    /// The measured ratio of overshoots, adaptive over classic.
    ///
    /// # Errors
    /// [`PaperError`] if the scenario cannot be read.
    pub fn measured(&self, lab: &Lab, preset: &Preset) -> Result<f64, PaperError> {
        let torque_nm = self.limit_mps2 * self.mass_kg * 0.3;
        let number = |path: &str, value: f64| Override::literal("law", path, format!("{value:?}"));
        let settings = [
            number("coupling.control_period_s", self.period_s),
            number("controller.window_s", self.window_s),
            number("controller.k_p", self.k_p),
            number("controller.alpha_nominal", self.alpha),
            number("controller.accel_per_unit_mps2", RATIO * self.alpha),
            Override::text("law", "controller.input_estimate", "saturated"),
            number("vehicle.mass_kg", self.mass_kg),
            number("vehicle.drive_torque_max_nm", torque_nm),
            number("vehicle.brake_torque_max_nm", torque_nm),
            Override::text("law", "target.step_at", "0"),
            Override::text("law", "target.step_speeds_mps", &format!("{TARGET_MPS}")),
        ];
        let mut overshoots = [0.0; 2];
        for (controller, overshoot) in CONTROLLERS.iter().zip(&mut overshoots) {
            let scenario = lab.library.scenario("step", preset, controller, &settings)?;
            let road = Road::new(&scenario)?;
            let mut path = Vec::new();
            road.drive(&road.trips(0, 0.0, End::Distance(LENGTH_M))?, |vehicle| {
                path.push((vehicle.distance_m(), vehicle.speed_mps()));
            })?;
            let plateau = Plateau { from_m: 0.0, to_m: LENGTH_M, target_mps: TARGET_MPS };
            *overshoot = response(&path, &plateau).overshoot;
        }
        let [classic, adaptive] = overshoots;
        Ok(adaptive / classic)
    }
}

/// Measures all points and draws them with the paper's own, whose Δt nobody knows, and those of the presets. What a point
/// does not say is as in `preset`: an ε or a lag that is not small shifts the ratio.
///
/// # Errors
/// [`PaperError`] if the scenario cannot be read.
pub fn run(lab: &Lab, preset: &Preset, results: &Results) -> Result<Finding, PaperError> {
    use rayon::prelude::*;
    let points = points();
    let ratios: Vec<f64> = points.par_iter().map(|p| p.measured(lab, preset)).collect::<Result<_, _>>()?;
    let mut rows = Vec::new();
    for (p, ratio) in points.iter().zip(&ratios) {
        let test = format!(
            "law_dt{}_T{}_kp{}_m{}_a{}_alpha{}",
            p.period_s, p.window_s, p.k_p, p.mass_kg, p.limit_mps2, p.alpha
        );
        let named = Rows { test: &test, preset: "none", controller: "adaptive" };
        rows.extend(named.of("overshoot_ratio", "1", &[Some(*ratio)]));
        rows.extend(named.of("overshoot_ratio_predicted", "1", &[Some(p.predicted())]));
    }
    let line = (0..=50).map(|k| 0.01 * f64::from(k)).map(|root| (root, 2.0 * root)).collect();
    let measured = points.iter().zip(&ratios).map(|(p, ratio)| (p.root(), *ratio)).collect();
    // 8/19.5 and 3.9/9.5 on the law's line: the Δt/T that the paper would have had.
    let published = [8.0 / 19.5, 3.9 / 9.5].map(|ratio| (0.5 * ratio, ratio)).to_vec();
    let presets = of_presets(lab, results)?;
    let chart = Chart {
        title: "Ratio of overshoots, adaptive over classic".to_owned(),
        x: "square root of dt/T",
        y: "ratio",
        curves: vec![
            Curve::of("law 2 sqrt(dt/T)", line).in_style("law"),
            Curve::dots("measured, b/alpha = 0.004", measured).in_style("adaptive"),
            Curve::dots("presets", presets).in_style("pid"),
            Curve::dots("published", published).in_style("mark"),
        ],
        ..Chart::default()
    };
    Ok(Finding { rows, figures: vec![Figure::chart("law_overshoot_ratio", &chart)], ..Finding::default() })
}

/// The presets' own step tests, in which b is not small against α.
fn of_presets(lab: &Lab, results: &Results) -> Result<Vec<(f64, f64)>, PaperError> {
    let mut points = Vec::new();
    for preset in &lab.library.presets {
        let overshoot = |controller| results.get("step", &preset.name, false, controller, "overshoot_1")?.value;
        let (Some(classic), Some(adaptive)) = (overshoot("classic"), overshoot("adaptive")) else { continue };
        let scenario = lab.library.scenario("step", preset, "adaptive", &[])?;
        let window_s = scenario.groups[0].controller.values.get("window_s").unwrap_or(f64::NAN);
        points.push(((scenario.coupling.control_period_s / window_s).sqrt(), adaptive / classic));
    }
    Ok(points)
}
