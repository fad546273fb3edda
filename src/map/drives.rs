//! What the cases of a job drive: a noisy recording and the first step. One block carries sixteen cases: a torque scale that
//! is wrong by a factor is a vehicle whose nominal N·m per m/s² is.

use super::cell::{Cell, Job};
use super::grid::{Grid, WINDOW_S};
use crate::offline::{End, Road, Trip};
use crate::paper::library::Preset;
use crate::paper::step::{Plateau, plateaus, response};
use crate::paper::{Lab, PaperError};
use crate::scenario::Override;

/// How long the step test lasts here \[s\].
const STEP_S: f64 = 60.0;

/// All cases of this controller, side by side.
pub fn carry_out(job: &Job, lab: &Lab, preset: &Preset, grid: &Grid) -> Result<Vec<Cell>, PaperError> {
    let Job { controller, period_s, k_p } = *job;
    let mut cells = Vec::new();
    for &scale in &grid.scales {
        for &limit_mps2 in &grid.limits_mps2 {
            for &delay_s in &grid.delays_s {
                let (error_rms, overshoot) = (None, None);
                cells.push(Cell { controller, period_s, k_p, scale, limit_mps2, delay_s, error_rms, overshoot });
            }
        }
    }
    drive_recording(job, lab, preset, &mut cells)?;
    drive_step(job, lab, preset, &mut cells)?;
    Ok(cells)
}

fn settings(job: &Job, cells: &[Cell]) -> Vec<Override> {
    let number = |path: &str, value: f64| Override::literal("map", path, format!("{value:?}"));
    let longest_s = cells.iter().fold(0.0_f64, |longest, c| longest.max(c.delay_s));
    vec![
        number("coupling.control_period_s", job.period_s),
        number("actuator.delay_s", longest_s),
        number("controller.k_p", job.k_p),
        number("controller.window_s", WINDOW_S),
        // The cases have their scales in what the vehicle is taken for.
        number("controller.accel_per_unit_mps2", 1.0),
    ]
}

fn drive_recording(job: &Job, lab: &Lab, preset: &Preset, cells: &mut [Cell]) -> Result<(), PaperError> {
    let mut settings = settings(job, cells);
    // By time, so that a car that hardly moves ends as well.
    settings.push(Override::text("map", "target.by", "time"));
    // The hard lap, on which limits and delays tell the laws apart.
    let lap = lab.library.folder().join("data/racing_lap.csv");
    settings.push(Override::text("map", "target.file", &lap.to_string_lossy()));
    let scenario = lab.library.scenario("driver", preset, job.controller, &settings)?;
    let road = Road::new(&scenario)?;
    let noisy = road.whole_trips(1)?.remove(1);
    let trips: Vec<Trip> = cells.iter().map(|cell| trip(cell, &noisy)).collect();
    let outcomes = road.drive(&trips, |_| {})?;
    for (cell, outcome) in cells.iter_mut().zip(outcomes) {
        cell.error_rms = outcome.stats.error_rms.filter(|e| outcome.finished && e.is_finite());
    }
    Ok(())
}

fn drive_step(job: &Job, lab: &Lab, preset: &Preset, cells: &mut [Cell]) -> Result<(), PaperError> {
    let scenario = lab.library.scenario("step", preset, job.controller, &settings(job, cells))?;
    let road = Road::new(&scenario)?;
    let [first, _] = plateaus(&road);
    let exact = road.trips(0, 0.0, End::Time(STEP_S))?.remove(0);
    let trips: Vec<Trip> = cells.iter().map(|cell| trip(cell, &exact)).collect();
    let mut paths = vec![Vec::new(); cells.len()];
    let outcomes = road.drive(&trips, |vehicle| {
        if vehicle.distance_m() < first.to_m {
            paths[vehicle.trip].push((vehicle.distance_m(), vehicle.speed_mps()));
        }
    })?;
    for ((cell, outcome), path) in cells.iter_mut().zip(outcomes).zip(&paths) {
        cell.overshoot = outcome.finished.then(|| response(path, &Plateau { ..first }).overshoot);
    }
    Ok(())
}

/// The trip of a case.
fn trip(cell: &Cell, like: &Trip) -> Trip {
    let mut trip = like.clone();
    let vehicle = &mut trip.vehicle;
    let limit_nm = cell.limit_mps2 * vehicle.body.nominal_nm_per_mps2();
    vehicle.body.drive_torque_max_nm = limit_nm;
    vehicle.body.brake_torque_max_nm = limit_nm;
    vehicle.nominal_nm_per_mps2 *= cell.scale;
    vehicle.actuator.dead_time_s = cell.delay_s;
    trip
}
