//! The experiments of Polack et al. 2017, without SUMO: each test under each preset, next to the published numbers.
//!
//! The paper leaves much open (vehicle, control period, K_P, torque scale and limits, the steps, the recording). A *preset* is one
//! choice of all that; every test runs under every preset, so that nothing is picked test by test. The vehicles drive in
//! the fleet that `run` uses ([`crate::offline`]). One file per test; [`TESTS`] lists them.

pub mod claims;
pub mod disturb;
pub mod driver;
pub mod figure;
pub mod heat;
pub mod law;
pub mod library;
pub mod map;
pub mod map_page;
pub mod map_summary;
pub mod page;
pub mod results;
pub mod series;
pub mod sine;
pub mod step;

use crate::control;
use crate::offline::OfflineError;
use crate::registry::{Entry, UnknownName, find};
use crate::scenario::{Override, ScenarioError};
use figure::Figure;
use library::{Library, Preset};
use map_summary::Summary;
use results::{Results, Row};
use series::Series;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The controllers that the paper compares.
pub const CONTROLLERS: [&str; 2] = ["classic", "adaptive"];
/// Every law that drives a body, those that are not the paper's included.
pub fn every_law() -> impl Iterator<Item = &'static str> {
    control::CONTROLLERS.iter().map(|entry| entry.name).filter(|name| *name != "ideal")
}

/// Seeds of the noise.
pub const SEEDS: usize = 20;

/// Runs a test under one preset.
pub type Run = fn(&Lab, &Preset) -> Result<Finding, PaperError>;

/// All tests that run under every preset, in the order of the paper.
pub static TESTS: &[Entry<Run>] = &[
    Entry { name: "step", summary: "steps of position, Section 5.1", keys: &[], build: step::run },
    Entry { name: "sine", summary: "a sinusoid of position, Section 5.2", keys: &[], build: sine::run },
    Entry { name: "driver", summary: "a driver's recording, Section 5.3", keys: &[], build: driver::run },
    Entry {
        name: "delay",
        summary: "the recording with 250 ms of input delay, Section 5.4",
        keys: &[],
        build: driver::run_delayed,
    },
    Entry {
        name: "disturb",
        summary: "mass, tyres, friction, slope, wind and bank change on the way",
        keys: &[],
        build: disturb::run,
    },
];

/// What the tests are given.
#[derive(Debug)]
pub struct Lab {
    /// Scenario files and presets.
    pub library: Library,
    /// Somebody's own recording, in place of ours.
    pub driver: Option<PathBuf>,
}

/// What came out of a test.
#[derive(Debug, Clone, Default)]
pub struct Finding {
    /// Numbers.
    pub rows: Vec<Row>,
    /// Figures.
    pub figures: Vec<Figure>,
    /// What the figures show, as numbers.
    pub series: Vec<Series>,
    /// What the map says, if it was made or is there.
    pub map: Option<Summary>,
}

impl Finding {
    /// Adds another one behind it.
    pub fn extend(&mut self, other: Self) {
        self.rows.extend(other.rows);
        self.figures.extend(other.figures);
        self.series.extend(other.series);
        self.map = self.map.take().or(other.map);
    }
}

/// What is asked for.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// A name of [`TESTS`], or `all`.
    pub test: String,
    /// Folder of the results.
    pub out_dir: PathBuf,
    /// Only this preset; none = all.
    pub preset: Option<String>,
    /// A recording in place of ours.
    pub driver: Option<PathBuf>,
    /// Changes to the scenarios.
    pub sets: Vec<Override>,
    /// The map on a coarse grid.
    pub coarse: bool,
    /// Show a progress bar while the map is computed.
    pub progress: bool,
}

/// Why there is no result.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum PaperError {
    /// A file cannot be read or written.
    #[error("cannot {action} {}: {source}", .path.display())]
    File {
        /// "read" or "write".
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file of the library is not a fragment of a scenario.
    #[error("{}: {what}", .path.display())]
    Fragment {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// A test or preset that does not exist.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// The scenario.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scenario(Box<ScenarioError>),
    /// The drive.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Offline(Box<OfflineError>),
}

impl From<ScenarioError> for PaperError {
    fn from(error: ScenarioError) -> Self {
        Self::Scenario(Box::new(error))
    }
}

impl From<OfflineError> for PaperError {
    fn from(error: OfflineError) -> Self {
        Self::Offline(Box::new(error))
    }
}

impl PaperError {
    /// Names the file in an error of the operating system.
    pub fn reading(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::File { action: "read", path: path.to_owned(), source }
    }
}

/// Runs what is asked for and writes `results.csv`, `series/`, `figures/` and `index.html` into the folder, of the map `map.csv`
/// and `map_summary.csv` as well.
///
/// # Errors
/// [`PaperError`]
pub fn run(request: &Request) -> Result<Results, PaperError> {
    let tests: Vec<&Entry<Run>> = match request.test.as_str() {
        "all" => TESTS.iter().collect(),
        "map" => Vec::new(),
        name => vec![find("test", TESTS, name)?],
    };
    let library = Library::open(&request.out_dir.join("scenarios"), &request.sets)?;
    let lab = Lab { library, driver: request.driver.clone() };
    let presets: Vec<&Preset> = match &request.preset {
        Some(name) => vec![lab.library.find(name)?],
        None => lab.library.presets.iter().collect(),
    };
    let mut whole = Finding::default();
    for finding in all(&lab, &tests, &presets)? {
        whole.extend(finding);
    }
    whole.rows.extend(driver::beside_prompt(&whole.rows));
    if tests.iter().any(|t| t.name == "step") {
        let results = Results { rows: whole.rows.clone(), map: None };
        whole.extend(law::run(&lab, &lab.library.presets[0], &results)?);
    }
    let grid = if request.coarse { map::Grid::coarse() } else { map::Grid::whole() };
    // Everything takes no minutes: a map that is there already costs nothing to show again, another one is not begun.
    let shown = request.test == "all" && map::is_there(&lab, presets[0], &request.out_dir, &grid)?;
    if request.test == "map" || shown {
        whole.extend(map(request, &lab, presets[0], &grid)?);
    }
    write_all(request, &lab, &presets, whole)
}

/// Every test under every preset, in that order, on all cores. What takes longest begins first, so that no core waits
/// for the last one.
fn all(lab: &Lab, tests: &[&Entry<Run>], presets: &[&Preset]) -> Result<Vec<Finding>, PaperError> {
    let mut jobs = Vec::new();
    for test in tests {
        for preset in presets {
            jobs.push((
                test.build,
                *preset,
                lab.library.scenario("step", preset, "adaptive", &[])?.coupling.control_period_s,
            ));
        }
    }
    let found: Vec<OnceLock<Result<Finding, PaperError>>> = jobs.iter().map(|_| OnceLock::new()).collect();
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    order.sort_by(|a, b| jobs[*a].2.total_cmp(&jobs[*b].2));
    rayon::scope_fifo(|scope| {
        for job in order {
            let ((run, preset, _), found) = (&jobs[job], &found[job]);
            scope.spawn_fifo(move |_| {
                let _ = found.set(run(lab, preset));
            });
        }
    });
    found.into_iter().map(|f| f.into_inner().expect("every job ran")).collect()
}

/// The map around a preset.
fn map(request: &Request, lab: &Lab, preset: &Preset, grid: &map::Grid) -> Result<Finding, PaperError> {
    let map = map::run(lab, preset, &request.out_dir, grid, request.progress)?;
    let scenario = lab.library.scenario("step", preset, "adaptive", &[])?;
    let values = &scenario.groups[0].controller.values;
    let mark = [Some(scenario.coupling.control_period_s), values.get("k_p"), values.get("accel_per_unit_mps2")]
        .map(|x| x.unwrap_or(f64::NAN));
    Ok(map.finding(&preset.name, mark))
}

fn write_all(request: &Request, lab: &Lab, presets: &[&Preset], whole: Finding) -> Result<Results, PaperError> {
    let dir = &request.out_dir;
    for series in &whole.series {
        write(&dir.join("series").join(format!("{}.csv", series.name)), &series.csv)?;
    }
    for figure in &whole.figures {
        write(&dir.join("figures").join(format!("{}.svg", figure.name)), &figure.file())?;
    }
    if let Some(summary) = &whole.map {
        write(&dir.join("map_summary.csv"), &summary.to_csv())?;
    }
    let results = Results { rows: whole.rows.clone(), map: whole.map.clone() };
    write(&dir.join("results.csv"), &results.to_csv())?;
    write(&dir.join("index.html"), &page::page(lab, presets, &results, &whole))?;
    Ok(results)
}

/// Writes a whole file; missing folders above it are made.
fn write(path: &Path, text: &str) -> Result<(), PaperError> {
    let failed = |source| PaperError::File { action: "write", path: path.to_owned(), source };
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(failed)?;
    }
    std::fs::write(path, text).map_err(failed)
}
