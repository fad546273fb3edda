//! Where does adaptation help? The paper's two laws with the same gains over torque scale, K_P, control period, torque limit and delay,
//! on a noisy recording (RMS error) and the first step (overshoot). Laws at gains of their own are compared by `tune`.
//!
//! A torque scale is a vehicle whose nominal N·m per m/s² is another, so that one block carries sixteen cases and a job is one
//! controller with one K_P. Finished jobs are appended to `map.csv.part`; a second call goes on there.

mod cell;
mod drives;
mod figures;
mod grid;
mod heat;
mod part;

use crate::paper::library::Preset;
use crate::paper::{Finding, Lab, PaperError, Request, write};
use cell::{Cell, Job, Map};
pub use grid::Grid;
use grid::LAWS;
use indicatif::ProgressBar;
use part::{HEADER, Part};
use rayon::prelude::*;
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::path::Path;

/// The map around a preset if the request asks for the test `map`. If it asks for everything, a map that is there already
/// is shown again, because that costs nothing; another one is not begun, because it takes minutes.
///
/// # Errors
/// [`PaperError`] if a scenario or the file of finished jobs cannot be read or written.
pub fn finding(request: &Request, lab: &Lab, preset: &Preset) -> Result<Option<Finding>, PaperError> {
    let grid = if request.coarse { Grid::coarse() } else { Grid::whole() };
    let is_shown = request.test == "all" && is_there(lab, preset, &request.out_dir, &grid)?;
    if request.test != "map" && !is_shown {
        return Ok(None);
    }
    let map = run(lab, preset, &request.out_dir, &grid, request.progress)?;
    let scenario = lab.library.scenario("step", preset, "adaptive", &[])?;
    let values = &scenario.groups[0].controller.values;
    let mark = [Some(scenario.coupling.control_period_s), values.get("k_p"), values.get("accel_per_unit_mps2")]
        .map(|x| x.unwrap_or(f64::NAN));
    Ok(Some(figures::finding(&map, &preset.name, mark)))
}

/// Computes the map and writes `map.csv`.
///
/// # Errors
/// [`PaperError`] if a scenario or the file of finished jobs cannot be read or written.
pub fn run(lab: &Lab, preset: &Preset, dir: &Path, grid: &Grid, progress: bool) -> Result<Map, PaperError> {
    let jobs = jobs(grid);
    let file = dir.join("map.csv");
    let key = key(lab, preset, grid)?;
    let part = Part::open(&file, &key, grid)?;
    let done: BTreeSet<String> = part.cells.iter().map(Cell::job).collect();
    let left: Vec<&Job> = jobs.iter().filter(|job| !done.contains(&job.name())).collect();
    let bar = if progress { ProgressBar::new(left.len() as u64) } else { ProgressBar::hidden() };
    let fresh: Vec<Vec<Cell>> = left
        .par_iter()
        .map(|job| {
            let cells = drives::carry_out(job, lab, preset, grid)?;
            part.append(&cells)?;
            bar.inc(1);
            Ok(cells)
        })
        .collect::<Result<_, PaperError>>()?;
    bar.finish_and_clear();
    let mut cells: Vec<Cell> = part.cells.iter().copied().chain(fresh.into_iter().flatten()).collect();
    cells.sort_by(|a, b| a.place().partial_cmp(&b.place()).expect("axes are numbers"));
    let text: String = cells.iter().map(Cell::line).collect();
    write(&file, &format!("# {key}\n{HEADER}\n{text}"))?;
    std::fs::remove_file(&part.path).map_err(PaperError::reading(&part.path))?;
    Ok(Map { grid: grid.clone(), cells })
}

/// True if the folder has this very map, so that [`run`] has nothing left to compute.
///
/// # Errors
/// [`PaperError`] if a scenario cannot be read.
pub fn is_there(lab: &Lab, preset: &Preset, dir: &Path, grid: &Grid) -> Result<bool, PaperError> {
    let mine = format!("# {}", key(lab, preset, grid)?);
    Ok(std::fs::read_to_string(dir.join("map.csv")).is_ok_and(|text| text.lines().next() == Some(&mine)))
}

fn jobs(grid: &Grid) -> Vec<Job> {
    let mut jobs = Vec::new();
    for &period_s in &grid.periods_s {
        for &k_p in &grid.gains {
            jobs.extend(LAWS.map(|controller| Job { controller, period_s, k_p }));
        }
    }
    jobs
}

/// What a finished job depends on besides its own numbers.
fn key(lab: &Lab, preset: &Preset, grid: &Grid) -> Result<String, PaperError> {
    let mut text = format!("{grid:?}");
    for controller in LAWS {
        for test in ["driver", "step"] {
            text += &lab.library.scenario(test, preset, controller, &[])?.to_toml();
        }
    }
    let digest = Sha256::digest(text.as_bytes());
    Ok(digest.iter().map(|byte| format!("{byte:02x}")).collect())
}
