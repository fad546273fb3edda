//! A sinusoid of position (Section 5.2): the first oscillation's overshoot and where the error has converged.

use super::figure::{Chart, Curve, Figure};
use super::library::Preset;
use super::results::Rows;
use super::series::Series;
use super::world::{End, Moment, World};
use super::{CONTROLLERS, Finding, Lab, PaperError, SEEDS};

/// Length of the test \[m\].
const LENGTH_M: f64 = 1000.0;
/// The first oscillation: from the start to here \[m\].
const FIRST_M: f64 = 200.0;
/// The error has converged when it stays below this share of the reference.
const BAND: f64 = 0.05;

/// What one vehicle did.
#[derive(Debug, Clone, Copy, Default)]
struct Course {
    reached: bool,
    /// Largest (V_x − y_r)/y_r in the first oscillation after the reference was reached.
    over: f64,
    converged_m: Option<f64>,
}

impl Course {
    fn see(&mut self, m: &Moment) {
        let relative = m.speed_mps / m.reference_mps - 1.0;
        self.reached |= relative >= 0.0;
        if self.reached && m.distance_m < FIRST_M {
            self.over = self.over.max(relative);
        }
        match (relative.abs() <= BAND, self.converged_m) {
            (true, None) => self.converged_m = Some(m.distance_m),
            (false, Some(_)) => self.converged_m = None,
            _ => {}
        }
    }
}

/// The test under one preset.
///
/// # Errors
/// [`PaperError`] if the scenario cannot be read.
pub fn run(lab: &Lab, preset: &Preset) -> Result<Finding, PaperError> {
    let (mut drives, mut rows) = (Vec::new(), Vec::new());
    for controller in CONTROLLERS {
        let scenario = lab.library.scenario("sine", preset, controller, &[])?;
        let world = World::new(&scenario)?;
        let mut exact = Vec::new();
        let mut courses = vec![Course::default(); SEEDS + 1];
        let outcomes =
            world.drive(&world.trips(SEEDS, 0.0, End::Distance(LENGTH_M))?, |vehicle, block, lane, time_s| {
                let moment = Moment::of(block, lane, time_s);
                courses[vehicle].see(&moment);
                if vehicle == 0 {
                    exact.push(moment);
                }
            })?;
        let named = Rows { test: "sine", preset: &preset.name, controller };
        let overshoot: Vec<_> = courses.iter().map(|c| Some(100.0 * c.over)).collect();
        let converged: Vec<_> = courses.iter().map(|c| c.converged_m).collect();
        rows.extend(named.of("overshoot_1", "%", &overshoot));
        rows.extend(named.of("settling_1", "m", &converged));
        rows.extend(super::driver::errors(&named, &outcomes));
        drives.push((controller, exact));
    }
    Ok(Finding { rows, figures: figures(preset, &drives), series: Series::all("sine", preset, &drives) })
}

fn figures(preset: &Preset, drives: &[(&'static str, Vec<Moment>)]) -> Vec<Figure> {
    let title = |what: &str| format!("{what}, sinusoid of position, preset {}", preset.name);
    let mut speeds =
        vec![Curve::of("reference", drives[0].1.iter().map(|m| (m.distance_m, m.reference_mps)).collect())];
    let mut errors = Vec::new();
    for (name, moments) in drives {
        speeds.push(Curve::of(name, moments.iter().map(|m| (m.distance_m, m.speed_mps)).collect()));
        errors.push(Curve::of(name, moments.iter().map(|m| (m.distance_m, m.speed_mps - m.reference_mps)).collect()));
    }
    let chart = |what: &str, title: String, y, curves| {
        let chart = Chart { title, x: "distance s [m]", y, curves, isotropic: false };
        Figure::chart(&format!("{}_sine_{what}", preset.name), &chart)
    };
    vec![
        chart("speed", title("Speed"), "speed [m/s]", speeds),
        chart("error", title("Speed error"), "error [m/s]", errors),
    ]
}
