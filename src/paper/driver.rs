//! A driver's recording as the reference (Sections 5.3 and 5.4): mean, standard deviation and RMS of the error, without and
//! with 250 ms between command and torque, straight and along the reconstructed path.

use super::compared::{CONTROLLERS, every_law};
use super::error::PaperError;
use super::lab::{Finding, Lab, SEEDS};
use super::library::{DEFAULT, Preset};
use super::row::{Row, Rows};
use super::series::Series;
use crate::figure::{Chart, Curve, Figure};
use crate::offline::{Moment, Road};
use crate::scenario::Override;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::path::Path;

/// What is driven: the name behind the test's, the file of `data/` or none for the test's own, along its track or straight.
const ROUTES: &[Route] = &[
    Route { suffix: "", file: None, along_track: false },
    Route { suffix: "_path", file: None, along_track: true },
    Route { suffix: "_racing", file: Some("data/racing_lap.csv"), along_track: false },
    Route { suffix: "_racing_path", file: Some("data/racing_lap.csv"), along_track: true },
    Route { suffix: "_udds", file: Some("data/udds.csv"), along_track: false },
    Route { suffix: "_hwfet", file: Some("data/hwfet.csv"), along_track: false },
];

/// Of the drive without noise, so much time is between two moments of the series and figures \[s\].
const SERIES_EVERY_S: f64 = 0.05;

struct Route {
    suffix: &'static str,
    file: Option<&'static str>,
    along_track: bool,
}

/// What one controller made of a route.
struct Driven {
    suffix: &'static str,
    controller: &'static str,
    rows: Vec<Row>,
    exact: Vec<Moment>,
    by_time: bool,
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
    let jobs = laws(preset).into_iter().flat_map(|law| [false, true].map(|along_track| (law, along_track)));
    let driven: Vec<Vec<Driven>> = jobs
        .collect::<Vec<_>>()
        .par_iter()
        .map(|(controller, along_track)| drive(lab, preset, test, controller, *along_track))
        .collect::<Result<_, _>>()?;
    let mut driven: Vec<Driven> = driven.into_iter().flatten().collect();
    let mut finding = Finding::default();
    for Route { suffix, .. } in ROUTES {
        let (mine, others): (Vec<_>, Vec<_>) = driven.into_iter().partition(|d| d.suffix == *suffix);
        driven = others;
        let by_time = mine.iter().any(|d| d.by_time);
        let (rows, mut drives): (Vec<_>, Vec<_>) = mine.into_iter().map(|d| (d.rows, (d.controller, d.exact))).unzip();
        drives.retain(|(law, _)| CONTROLLERS.contains(law));
        if !drives.is_empty() {
            let name = format!("{test}{suffix}");
            let (figures, series) = (figures(preset, &name, &drives, by_time), Series::all(&name, preset, &drives));
            finding.extend(Finding { rows: rows.concat(), figures, series, ..Finding::default() });
        }
    }
    Ok(finding)
}

/// The laws that drive: the paper's, whose figures are drawn; under the default preset the others as well, with their own default
/// gains, for their place in the table.
pub fn laws(preset: &Preset) -> Vec<&'static str> {
    let others = every_law().filter(|law| preset.name == DEFAULT && !CONTROLLERS.contains(law));
    CONTROLLERS.into_iter().chain(others).collect()
}

/// How somebody's own recording is smoothed, in a line.
pub fn note(lab: &Lab, preset: &Preset, own: &Path) -> Result<String, PaperError> {
    let file = Override::text("--driver", "target.file", &own.to_string_lossy());
    let scenario = lab.library.scenario("driver", preset, "classic", &[file])?;
    let road = Road::new(&scenario)?;
    Ok(road.profile.note().map(|note| format!("{note}\n")).unwrap_or_default())
}

/// All routes along their tracks, or all straight ones, under one controller: they share a block.
fn drive(
    lab: &Lab,
    preset: &Preset,
    test: &str,
    controller: &'static str,
    along_track: bool,
) -> Result<Vec<Driven>, PaperError> {
    let mut scenarios = Vec::new();
    // Somebody's own recording is driven instead of all of ours.
    let ours = |r: &&Route| r.along_track == along_track && (lab.driver.is_none() || r.file.is_none());
    for route in ROUTES.iter().filter(ours) {
        let file = match (&lab.driver, route.file) {
            (Some(own), _) => Some(own.clone()),
            (None, file) => file.map(|f| lab.library.folder().join(f)),
        };
        let more: Vec<Override> =
            file.map(|f| Override::text("--driver", "target.file", &f.to_string_lossy())).into_iter().collect();
        scenarios.push((route.suffix, lab.library.scenario(test, preset, controller, &more)?));
    }
    let mut roads = Vec::new();
    for (suffix, scenario) in &scenarios {
        let mut road = Road::new(scenario)?;
        road.along_track = along_track;
        roads.push((*suffix, road));
    }
    // No yaw rate, no path.
    roads.retain(|(_, road)| !along_track || road.profile.track().is_some());
    roads.sort_by(|(_, a), (_, b)| b.profile.length().partial_cmp(&a.profile.length()).unwrap_or(Ordering::Equal));
    let Some((_, first)) = roads.first() else { return Ok(Vec::new()) };
    let mut trips = Vec::new();
    for (_, road) in &roads {
        trips.extend(road.whole_trips(SEEDS)?);
    }
    let every = (SERIES_EVERY_S / scenarios[0].1.coupling.control_period_s).round().max(1.0) as u32;
    let mut exact = vec![Vec::new(); roads.len()];
    let mut periods = vec![0_u32; roads.len()];
    let outcomes = first.drive(&trips, |vehicle| {
        let (route, seed) = (vehicle.trip / (SEEDS + 1), vehicle.trip % (SEEDS + 1));
        if seed == 0 {
            periods[route] += 1;
            if periods[route] % every == 0 {
                exact[route].push(vehicle.moment());
            }
        }
    })?;
    let mut driven = Vec::new();
    for (((suffix, road), outcomes), exact) in roads.iter().zip(outcomes.chunks(SEEDS + 1)).zip(exact) {
        let name = format!("{test}{suffix}");
        let rows = Rows { test: &name, preset: &preset.name, controller }.errors(outcomes);
        driven.push(Driven { suffix, controller, rows, exact, by_time: road.profile.is_by_time() });
    }
    Ok(driven)
}

/// What Section 5.4 compares: the adaptive law with delay and the classic one without.
pub fn beside_prompt(rows: &[Row]) -> Vec<Row> {
    let delayed = |r: &&Row| r.family() == "delay" && r.controller == "adaptive" && r.quantity == "error_rms";
    let beside = |row: &Row| {
        let test = row.test.replacen("delay", "driver", 1);
        let prompt = rows.iter().find(|r| {
            (r.test.as_str(), r.noise, r.controller, r.quantity) == (&*test, row.noise, "classic", "error_rms")
                && r.preset == row.preset
        })?;
        let value = row.value.zip(prompt.value).map(|(ours, classic)| ours / classic);
        Some(Row { quantity: "rms_over_prompt_classic", value, spread: None, unit: "1", ..row.clone() })
    };
    rows.iter().filter(delayed).filter_map(beside).collect()
}

/// Speed and error over what the recording is referenced by: the position, as in the paper, or the time where there are stops.
fn figures(preset: &Preset, name: &str, drives: &[(&'static str, Vec<Moment>)], by_time: bool) -> Vec<Figure> {
    let at = |m: &Moment| if by_time { m.time_s } else { m.distance_m };
    let x = if by_time { "time [s]" } else { "distance s [m]" };
    let (mut speeds, mut errors) = (Vec::new(), Vec::new());
    if let Some((_, moments)) = drives.first() {
        speeds.push(Curve::of("reference", moments.iter().map(|m| (at(m), m.reference_mps)).collect()));
    }
    for (controller, moments) in drives {
        speeds.push(Curve::of(controller, moments.iter().map(|m| (at(m), m.speed_mps)).collect()));
        errors.push(Curve::of(controller, moments.iter().map(|m| (at(m), m.speed_mps - m.reference_mps)).collect()));
    }
    let chart = |what: &str, y, curves| {
        let title = format!("Speed{}, {name}, preset {}", if what == "error" { " error" } else { "" }, preset.name);
        let chart = Chart { title, x, y, curves, ..Chart::default() };
        Figure::chart(&format!("{}_{name}_{what}", preset.name), &chart)
    };
    vec![chart("speed", "speed [m/s]", speeds), chart("error", "error [m/s]", errors)]
}
