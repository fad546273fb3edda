//! What the cases of a job drive: a noisy recording and the first step. One block carries sixteen cases: a torque scale that
//! is wrong by a factor is a vehicle whose nominal N·m per m/s² is.

use super::cell::{Cell, Job};
use super::grid::{Grid, two_gains};
use crate::offline::{End, Road, Trip};
use crate::paper::library::{Preset, has};
use crate::paper::step::{Plateau, plateaus, response};
use crate::paper::{Lab, PaperError};
use crate::scenario::Override;

/// The key of the torque scale, which not every law has.
const SCALE: &str = "accel_per_unit_mps2";
/// How long the step test lasts here \[s\].
const STEP_S: f64 = 60.0;

/// All cases of this controller, side by side for every delay: laws with a model are told it.
pub fn carry_out(job: &Job, lab: &Lab, preset: &Preset, grid: &Grid) -> Result<Vec<Cell>, PaperError> {
    let Job { controller, period_s, gain_1, gain_2 } = *job;
    let mut all = Vec::new();
    for &delay_s in &grid.delays_s {
        let mut cells = Vec::new();
        for scale in grid.scales_of(controller, gain_2) {
            for &limit_mps2 in &grid.limits_mps2 {
                let (error_rms, overshoot) = (None, None);
                cells.push(Cell {
                    controller,
                    period_s,
                    gain_1,
                    gain_2,
                    scale,
                    limit_mps2,
                    delay_s,
                    error_rms,
                    overshoot,
                });
            }
        }
        let settings = settings(job, delay_s);
        drive_recording(job, lab, preset, &settings, &mut cells)?;
        drive_step(job, lab, preset, &settings, &mut cells)?;
        all.append(&mut cells);
    }
    Ok(all)
}

fn settings(job: &Job, delay_s: f64) -> Vec<Override> {
    let number = |path: &str, value: f64| Override::literal("map", path, format!("{value:?}"));
    let mut settings = vec![number("coupling.control_period_s", job.period_s), number("actuator.delay_s", delay_s)];
    let gains = two_gains(job.controller).expect("laws on the map have two gains");
    let gains = gains.iter().zip([job.gain_1, job.gain_2]);
    settings.extend(gains.map(|(gain, value)| number(&format!("controller.{}", gain.name), value)));
    if has(job.controller, SCALE) {
        // The cases have their scales in what the vehicle is taken for.
        settings.push(number(&format!("controller.{SCALE}"), 1.0));
    }
    settings
}

fn drive_recording(
    job: &Job,
    lab: &Lab,
    preset: &Preset,
    settings: &[Override],
    cells: &mut [Cell],
) -> Result<(), PaperError> {
    let mut settings = settings.to_vec();
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

fn drive_step(
    job: &Job,
    lab: &Lab,
    preset: &Preset,
    settings: &[Override],
    cells: &mut [Cell],
) -> Result<(), PaperError> {
    let scenario = lab.library.scenario("step", preset, job.controller, settings)?;
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
