//! Where does adaptation help? The classic, the adaptive, the calibrating and the PID law over torque scale, gains, control period,
//! torque limit and delay, on a noisy recording (RMS error) and the first step (overshoot).
//!
//! **Equal tuning.** Each law has two values to choose: K_P and the torque scale b for the paper's laws, K_P and T for the one that finds
//! its scale itself, k_p and k_i for the PID. For all the optimiser is the same exhaustive search over a logarithmic grid of 9 × 9, and the cost is the same RMS error. What the
//! best choice is worth when the torque scale is wrong by a factor is then read from the same table.
//!
//! A torque scale that is wrong by a factor is a vehicle whose nominal N·m per m/s² is, so that one block carries sixteen cases
//! and a job is one controller with one choice of gains. Finished jobs are appended to `map.csv.part`; a second call goes on there.

use super::library::Preset;
use super::step::{Plateau, response};
use super::{Lab, PaperError, map_page};
use crate::offline::{End, Road, Trip};
use crate::scenario::Override;
use indicatif::ProgressBar;
use rayon::prelude::*;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// How long the step test lasts here \[s\].
const STEP_S: f64 = 60.0;
/// The laws on the map.
pub const LAWS: [&str; 4] = ["classic", "adaptive", "calibrating", "pid"];
const HEADER: &str = "controller,period_s,gain_1,gain_2,scale,limit_mps2,delay_s,error_rms,overshoot_1";

/// The key of a law's second value; none where it is the torque scale itself. The torque scale of a law with two keys is
/// right, but for the factors.
pub fn second_key(law: &str) -> Option<&'static str> {
    match law {
        "pid" => Some("k_i"),
        "calibrating" => Some("window_s"),
        _ => None,
    }
}

/// The axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Control periods Δt \[s\].
    pub periods_s: Vec<f64>,
    /// K_P of the model-free laws, k_p of the PID [1/s].
    pub gains: Vec<f64>,
    /// k_i of the PID [1/s²].
    pub integral_gains: Vec<f64>,
    /// T of the calibrating law \[s\].
    pub windows_s: Vec<f64>,
    /// Torque scales b of the paper's laws [m/s² per u].
    pub scales: Vec<f64>,
    /// Factors by which the torque scale of the others is wrong.
    pub factors: Vec<f64>,
    /// Torque limits as accelerations [m/s²].
    pub limits_mps2: Vec<f64>,
    /// Delays \[s\].
    pub delays_s: Vec<f64>,
}

impl Grid {
    /// A minute or two on two cores.
    pub fn whole() -> Self {
        Self {
            periods_s: vec![0.001, 0.002, 0.005, 0.01, 0.02],
            gains: powers(0.25, 9),
            integral_gains: powers(0.0625, 9),
            windows_s: vec![0.1, 0.14, 0.2, 0.28, 0.4, 0.56, 0.8, 1.12, 1.6],
            scales: powers(0.0125, 9),
            factors: powers(0.25, 5),
            limits_mps2: vec![3.0, 5.3],
            delays_s: vec![0.0, 0.25],
        }
    }

    /// Seconds, to see that it works.
    pub fn coarse() -> Self {
        Self {
            periods_s: vec![0.01, 0.02],
            gains: vec![1.0, 4.0],
            integral_gains: vec![0.5, 1.0],
            windows_s: vec![0.2, 0.5],
            scales: vec![0.1, 0.4],
            factors: vec![0.5, 1.0],
            limits_mps2: vec![5.3],
            delays_s: vec![0.0, 0.25],
        }
    }

    /// The second values of a law.
    fn second_gains(&self, law: &str) -> &[f64] {
        match second_key(law) {
            Some("k_i") => &self.integral_gains,
            Some(_) => &self.windows_s,
            None => &[0.0],
        }
    }

    /// The torque scales that one job of a law tries.
    fn scales_of(&self, law: &str) -> &[f64] {
        if second_key(law).is_some() { &self.factors } else { &self.scales }
    }
}

/// `count` powers of two times `first`.
fn powers(first: f64, count: u32) -> Vec<f64> {
    (0..count).map(|k| first * f64::from(1_u32 << k)).collect()
}

/// One controller with its gains.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Job {
    controller: &'static str,
    period_s: f64,
    gain_1: f64,
    /// The value of [`second_key`], 0 where it is the scale.
    gain_2: f64,
}

/// One case of a job, and what came out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// The law.
    pub controller: &'static str,
    /// Δt \[s\].
    pub period_s: f64,
    /// K_P or k_p.
    pub gain_1: f64,
    /// The value of [`second_key`], 0 where it is the scale.
    pub gain_2: f64,
    /// b of the paper's laws, the factor of the others.
    pub scale: f64,
    /// Torque limit [m/s²].
    pub limit_mps2: f64,
    /// Delay \[s\].
    pub delay_s: f64,
    /// RMS error on the recording with noise [m/s]; none if it diverged.
    pub error_rms: Option<f64>,
    /// Overshoot of the first step without noise [%].
    pub overshoot: Option<f64>,
}

/// Computes the map and writes `map.csv`.
///
/// # Errors
/// [`PaperError`] if a scenario or the file of finished jobs cannot be read or written.
pub fn run(lab: &Lab, preset: &Preset, dir: &Path, grid: &Grid, progress: bool) -> Result<map_page::Map, PaperError> {
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
            let cells = job.carry_out(lab, preset, grid)?;
            part.append(&cells)?;
            bar.inc(1);
            Ok(cells)
        })
        .collect::<Result<_, PaperError>>()?;
    bar.finish_and_clear();
    let mut cells: Vec<Cell> = part.cells.iter().copied().chain(fresh.into_iter().flatten()).collect();
    cells.sort_by(|a, b| a.place().partial_cmp(&b.place()).expect("axes are numbers"));
    let text: String = cells.iter().map(Cell::line).collect();
    super::write(&file, &format!("# {key}\n{HEADER}\n{text}"))?;
    std::fs::remove_file(&part.path).map_err(PaperError::reading(&part.path))?;
    Ok(map_page::Map { grid: grid.clone(), cells })
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
        for &gain_1 in &grid.gains {
            for controller in LAWS {
                for &gain_2 in grid.second_gains(controller) {
                    jobs.push(Job { controller, period_s, gain_1, gain_2 });
                }
            }
        }
    }
    jobs
}

impl Job {
    fn name(&self) -> String {
        format!("{},{},{},{}", self.controller, self.period_s, self.gain_1, self.gain_2)
    }

    /// All cases of this controller, side by side.
    fn carry_out(&self, lab: &Lab, preset: &Preset, grid: &Grid) -> Result<Vec<Cell>, PaperError> {
        let mut cells = Vec::new();
        for &scale in grid.scales_of(self.controller) {
            for &limit_mps2 in &grid.limits_mps2 {
                for &delay_s in &grid.delays_s {
                    let Self { controller, period_s, gain_1, gain_2 } = *self;
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
        }
        self.drive_recording(lab, preset, &mut cells)?;
        self.drive_step(lab, preset, &mut cells)?;
        Ok(cells)
    }

    fn settings(&self, cells: &[Cell]) -> Vec<Override> {
        let number = |path: &str, value: f64| Override::literal("map", path, format!("{value:?}"));
        let longest_s = cells.iter().fold(0.0_f64, |longest, c| longest.max(c.delay_s));
        let mut settings = vec![
            number("coupling.control_period_s", self.period_s),
            number("actuator.delay_s", longest_s),
            number("controller.k_p", self.gain_1),
        ];
        if let Some(key) = second_key(self.controller) {
            settings.push(number(&format!("controller.{key}"), self.gain_2));
        } else {
            settings.push(number("controller.accel_per_unit_mps2", 1.0));
        }
        settings
    }

    fn drive_recording(&self, lab: &Lab, preset: &Preset, cells: &mut [Cell]) -> Result<(), PaperError> {
        let mut settings = self.settings(cells);
        // By time, so that a car that hardly moves ends as well.
        settings.push(Override::text("map", "target.by", "time"));
        let scenario = lab.library.scenario("driver", preset, self.controller, &settings)?;
        let road = Road::new(&scenario)?;
        let noisy = road.whole_trips(1)?.remove(1);
        let trips: Vec<Trip> = cells.iter().map(|cell| cell.trip(&noisy)).collect();
        let outcomes = road.drive(&trips, |_| {});
        for (cell, outcome) in cells.iter_mut().zip(outcomes) {
            cell.error_rms = outcome.stats.error_rms.filter(|e| outcome.finished && e.is_finite());
        }
        Ok(())
    }

    fn drive_step(&self, lab: &Lab, preset: &Preset, cells: &mut [Cell]) -> Result<(), PaperError> {
        let scenario = lab.library.scenario("step", preset, self.controller, &self.settings(cells))?;
        let road = Road::new(&scenario)?;
        let [first, _] = super::step::plateaus(&road);
        let exact = road.trips(0, 0.0, End::Time(STEP_S))?.remove(0);
        let trips: Vec<Trip> = cells.iter().map(|cell| cell.trip(&exact)).collect();
        let mut paths = vec![Vec::new(); cells.len()];
        let outcomes = road.drive(&trips, |vehicle| {
            if vehicle.distance_m() < first.to_m {
                paths[vehicle.trip].push((vehicle.distance_m(), vehicle.speed_mps()));
            }
        });
        for ((cell, outcome), path) in cells.iter_mut().zip(outcomes).zip(&paths) {
            cell.overshoot = outcome.finished.then(|| response(path, &Plateau { ..first }).overshoot);
        }
        Ok(())
    }
}

impl Cell {
    /// The trip of this case.
    fn trip(&self, like: &Trip) -> Trip {
        let mut trip = like.clone();
        let vehicle = &mut trip.vehicle;
        let limit_nm = self.limit_mps2 * vehicle.body.nominal_nm_per_mps2();
        vehicle.body.drive_torque_max_nm = limit_nm;
        vehicle.body.brake_torque_max_nm = limit_nm;
        vehicle.nominal_nm_per_mps2 *= self.scale;
        vehicle.actuator.dead_time_s = self.delay_s;
        trip
    }

    fn job(&self) -> String {
        let Self { controller, period_s, gain_1, gain_2, .. } = *self;
        Job { controller, period_s, gain_1, gain_2 }.name()
    }

    fn place(&self) -> (&'static str, [f64; 6]) {
        (self.controller, [self.period_s, self.gain_1, self.gain_2, self.scale, self.limit_mps2, self.delay_s])
    }

    fn line(&self) -> String {
        let mut line = self.job();
        let number = |x: Option<f64>| x.map(|x| x.to_string()).unwrap_or_default();
        let (rms, overshoot) = (number(self.error_rms), number(self.overshoot));
        let _ = writeln!(line, ",{},{},{},{rms},{overshoot}", self.scale, self.limit_mps2, self.delay_s);
        line
    }

    fn read(line: &str) -> Option<Self> {
        let fields: Vec<&str> = line.split(',').collect();
        let [name, numbers @ .., rms, overshoot] = fields.as_slice() else { return None };
        let controller = LAWS.into_iter().find(|law| law == name)?;
        let numbers: Vec<f64> = numbers.iter().map(|n| n.parse().ok()).collect::<Option<_>>()?;
        let [period_s, gain_1, gain_2, scale, limit_mps2, delay_s] = numbers.try_into().ok()?;
        let optional = |text: &str| if text.is_empty() { Some(None) } else { text.parse().ok().map(Some) };
        let (error_rms, overshoot) = (optional(rms)?, optional(overshoot)?);
        Some(Self { controller, period_s, gain_1, gain_2, scale, limit_mps2, delay_s, error_rms, overshoot })
    }
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

/// The cells of all whole jobs in a file. A job or line that was cut off by the end of its program is not taken.
fn finished(text: &str, grid: &Grid) -> Vec<Cell> {
    let lines = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
    let mut cells: Vec<Cell> = lines.filter_map(|line| Cell::read(line.trim_end())).collect();
    let mut counts = BTreeMap::new();
    for cell in &cells {
        *counts.entry(cell.job()).or_insert(0) += 1;
    }
    let whole = |cell: &Cell| grid.scales_of(cell.controller).len() * grid.limits_mps2.len() * grid.delays_s.len();
    cells.retain(|cell| counts[&cell.job()] == whole(cell));
    cells
}

/// The file of finished jobs.
struct Part {
    path: PathBuf,
    cells: Vec<Cell>,
    file: Mutex<std::fs::File>,
}

impl Part {
    /// Takes over what an earlier call with the same key finished, whole or not.
    fn open(whole: &Path, key: &str, grid: &Grid) -> Result<Self, PaperError> {
        let path = whole.with_extension("csv.part");
        let mut cells = Vec::new();
        for old in [whole, &path] {
            let Ok(text) = std::fs::read_to_string(old) else { continue };
            if text.starts_with(&format!("# {key}\n")) {
                cells = finished(&text, grid);
            }
        }
        let text: String = cells.iter().map(Cell::line).collect();
        super::write(&path, &format!("# {key}\n{HEADER}\n{text}"))?;
        let file = std::fs::OpenOptions::new().append(true).open(&path).map_err(PaperError::reading(&path))?;
        Ok(Self { path, cells, file: Mutex::new(file) })
    }

    /// Adds the cells of one job in one write.
    fn append(&self, cells: &[Cell]) -> Result<(), PaperError> {
        let text: String = cells.iter().map(Cell::line).collect();
        let mut file = self.file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        file.write_all(text.as_bytes()).map_err(PaperError::reading(&self.path))
    }
}
