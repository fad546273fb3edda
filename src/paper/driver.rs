//! A driver's recording as the reference (Sections 5.3 and 5.4): mean, standard deviation and RMS of the error, without and
//! with 250 ms between command and torque, straight and along the reconstructed path.

use super::figure::{Chart, Curve, Figure};
use super::library::Preset;
use super::results::{Row, Rows};
use super::series::Series;
use super::world::{End, Moment, Outcome, World};
use super::{CONTROLLERS, Finding, Lab, PaperError, SEEDS};
use crate::scenario::Override;

/// What is driven: the name behind the test's, the file of `data/` or none for the test's own, along its track or straight.
const ROUTES: &[Route] = &[
    Route { suffix: "", file: None, along_track: false },
    Route { suffix: "_path", file: None, along_track: true },
    Route { suffix: "_udds", file: Some("data/udds.csv"), along_track: false },
    Route { suffix: "_hwfet", file: Some("data/hwfet.csv"), along_track: false },
];

struct Route {
    suffix: &'static str,
    file: Option<&'static str>,
    along_track: bool,
}

/// The driver test under one preset.
///
/// # Errors
/// [`PaperError`] if a scenario or recording cannot be read.
pub fn run(lab: &Lab, preset: &Preset) -> Result<Finding, PaperError> {
    test(lab, preset, "driver")
}

/// The same with the delay.
///
/// # Errors
/// [`PaperError`] if a scenario or recording cannot be read.
pub fn run_delayed(lab: &Lab, preset: &Preset) -> Result<Finding, PaperError> {
    test(lab, preset, "delay")
}

fn test(lab: &Lab, preset: &Preset, test: &str) -> Result<Finding, PaperError> {
    let mut finding = Finding::default();
    // Somebody's own recording is driven instead of all of ours.
    let cycles = lab.driver.is_none() && preset.cycles;
    for route in ROUTES.iter().filter(|r| cycles || r.file.is_none()) {
        let file = match (&lab.driver, route.file) {
            (Some(own), _) => Some(own.clone()),
            (None, file) => file.map(|f| lab.library.folder().join(f)),
        };
        let more: Vec<Override> =
            file.map(|f| Override::text("--driver", "target.file", &f.to_string_lossy())).into_iter().collect();
        let name = format!("{test}{}", route.suffix);
        finding.extend(drive(lab, preset, test, &name, &more, route.along_track)?);
    }
    Ok(finding)
}

fn drive(
    lab: &Lab,
    preset: &Preset,
    test: &str,
    name: &str,
    more: &[Override],
    along_track: bool,
) -> Result<Finding, PaperError> {
    let (mut drives, mut rows) = (Vec::new(), Vec::new());
    for controller in CONTROLLERS {
        let scenario = lab.library.scenario(test, preset, controller, more)?;
        let mut world = World::new(&scenario)?;
        if along_track && world.profile.track().is_none() {
            return Ok(Finding::default()); // no yaw rate, no path
        }
        world.along_track = along_track;
        let length = world.profile.length().ok_or(PaperError::NoProfile)?;
        let end = if world.profile.is_by_time() { End::Time(length) } else { End::Distance(length) };
        let mut exact = Vec::new();
        let start_mps = world.profile.at(0.0, 0.0, 0.0).0;
        let vehicles = world.vehicles(SEEDS, start_mps)?;
        let outcomes = world.drive(vehicles, end, |vehicle, block, lane, time_s| {
            if vehicle == 0 {
                exact.push(Moment::of(block, lane, time_s));
            }
        })?;
        rows.extend(errors(&Rows { test: name, preset: &preset.name, controller }, &outcomes));
        drives.push((controller, exact));
    }
    Ok(Finding { rows, figures: figures(preset, name, &drives), series: Series::all(name, preset, &drives) })
}

/// The table of the paper, and the largest error.
pub fn errors(rows: &Rows, outcomes: &[Outcome]) -> Vec<Row> {
    let column =
        |of: fn(&Outcome) -> Option<f64>| outcomes.iter().map(|o| of(o).filter(|_| o.finished)).collect::<Vec<_>>();
    [
        rows.of("error_mean", "m/s", &column(|o| o.stats.error_mean)),
        rows.of("error_std", "m/s", &column(|o| o.stats.error_std)),
        rows.of("error_rms", "m/s", &column(|o| o.stats.error_rms)),
        rows.of("error_max_abs", "m/s", &column(|o| o.stats.error_max_abs)),
    ]
    .concat()
}

fn figures(preset: &Preset, name: &str, drives: &[(&'static str, Vec<Moment>)]) -> Vec<Figure> {
    let (mut speeds, mut errors) = (Vec::new(), Vec::new());
    if let Some((_, moments)) = drives.first() {
        speeds.push(Curve::of("reference", moments.iter().map(|m| (m.time_s, m.reference_mps)).collect()));
    }
    for (controller, moments) in drives {
        speeds.push(Curve::of(controller, moments.iter().map(|m| (m.time_s, m.speed_mps)).collect()));
        errors.push(Curve::of(controller, moments.iter().map(|m| (m.time_s, m.speed_mps - m.reference_mps)).collect()));
    }
    let chart = |what: &str, y, curves| {
        let title = format!("Speed{}, {name}, preset {}", if what == "error" { " error" } else { "" }, preset.name);
        let chart = Chart { title, x: "time [s]", y, curves, isotropic: false };
        Figure::chart(&format!("{}_{name}_{what}", preset.name), &chart)
    };
    vec![chart("speed", "speed [m/s]", speeds), chart("error", "error [m/s]", errors)]
}
