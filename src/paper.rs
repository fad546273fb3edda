//! The experiments of Polack et al. 2017, without SUMO: each test under each preset, next to the published numbers.
//!
//! The paper leaves much open (vehicle, control period, K_P, torque scale and limits, the steps, the recording). A *preset* is one
//! choice of all that; every test runs under every preset, so that nothing is picked test by test. The vehicles drive in
//! the fleet that `run` uses ([`crate::offline`]). One file per test; [`TESTS`] lists them.

mod circuit;
mod claims;
mod compared;
pub mod demand;
mod disturb;
mod driver;
mod error;
mod fourteen;
pub mod human;
mod lab;
pub mod law;
mod layout;
pub mod library;
mod overview;
mod page;
mod published;
mod reason;
mod rest;
pub mod results;
pub mod row;
mod series;
mod sine;
pub mod step;
pub mod tally;
mod verdict;

use crate::output::{write_json, write_table};
use crate::registry::{Entry, find};
use crate::run::{FileSchema, Schema};
use crate::scenario::Override;
pub use compared::{CONTROLLERS, every_law};
pub use demand::Demand;
pub use error::{PaperError, write};
pub use lab::{Finding, Lab, SEEDS};
use library::{Library, Preset};
use results::Results;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
pub use verdict::Verdict;

/// What the command leaves in its folder: name, meaning, when.
pub const FILES: [[&str; 3]; 9] = [
    ["index.html", "The figures and tables of the paper beside ours, with a verdict for every number", "always"],
    ["results.csv", "Every number: test, preset, controller, ours, the paper's, verdict", "always"],
    ["counts.csv", "How many of the paper's numbers, facts and claims came out, by preset and recording", "always"],
    ["schema.json", "What the columns of these two tables are", "always"],
    ["figures/", "The figures of the page, as SVG", "always"],
    ["series/", "The curves of the figures, as CSV", "always"],
    ["scenarios/", "The scenarios of the tests, to be changed", "unless the working directory has `scenarios/paper`"],
    ["lap.csv", "The lap that was recorded, and nothing else of this", "with `record`"],
    ["map.csv", "Every case of the map", "with `map`"],
];

/// Runs a test under one preset.
pub type Run = fn(&Lab, &Preset) -> Result<Finding, PaperError>;

/// A test.
#[derive(Debug, Clone, Copy)]
pub struct Test {
    run: Run,
    /// The laws that it drives under a preset.
    laws: fn(&Preset) -> Vec<&'static str>,
}

/// The paper's laws alone.
const PAPERS: fn(&Preset) -> Vec<&'static str> = |_| CONTROLLERS.to_vec();

/// All tests that run under every preset, in the order of the paper.
pub static TESTS: &[Entry<Test>] = &[
    Entry {
        name: "step",
        summary: "steps of position, Section 5.1",
        keys: &[],
        build: Test { run: step::run, laws: PAPERS },
    },
    Entry {
        name: "sine",
        summary: "a sinusoid of position, Section 5.2",
        keys: &[],
        build: Test { run: sine::run, laws: PAPERS },
    },
    Entry {
        name: "driver",
        summary: "a driver's recording, Section 5.3",
        keys: &[],
        build: Test { run: driver::run, laws: driver::laws },
    },
    Entry {
        name: "delay",
        summary: "the recording with 250 ms of input delay, Section 5.4",
        keys: &[],
        build: Test { run: driver::run_delayed, laws: driver::laws },
    },
    Entry {
        name: "disturb",
        summary: "mass, tyres, friction, slope, wind and bank change on the way",
        keys: &[],
        build: Test { run: disturb::run, laws: |_| every_law().collect() },
    },
];

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

/// What goes beyond the paper: its finding around a preset, or none if it is not asked for.
pub type Beyond = fn(&Request, &Lab, &Preset) -> Result<Option<Finding>, PaperError>;

/// Runs what is asked for and writes `results.csv`, `series/`, `figures/`, `index.html` and the files of `beyond` into the
/// folder.
///
/// # Errors
/// [`PaperError`]
pub fn run(request: &Request, beyond: Beyond) -> Result<Results, PaperError> {
    let tests: Vec<&Entry<Test>> = match request.test.as_str() {
        "all" => TESTS.iter().collect(),
        "map" => Vec::new(),
        name => vec![find("test", TESTS, name).map_err(|unknown| unknown.or_known(&["map", "record", "all"]))?],
    };
    if let Some(own) = &request.driver {
        // Before anything is written.
        let unreadable = |source| PaperError::File { action: "read", path: own.clone(), source };
        std::fs::File::open(own).map_err(unreadable)?;
    }
    let library = Library::open(&request.out_dir.join("scenarios"), &request.sets)?;
    let lab = Lab { library, driver: request.driver.clone() };
    let presets: Vec<&Preset> = match &request.preset {
        Some(name) => vec![lab.library.find(name)?],
        None => lab.library.presets.iter().collect(),
    };
    let driven: BTreeSet<&str> = match tests[..] {
        // The map drives the paper's.
        [] => BTreeSet::from(CONTROLLERS),
        _ => tests.iter().flat_map(|test| presets.iter().flat_map(|preset| (test.build.laws)(preset))).collect(),
    };
    let driven: Vec<&str> = every_law().filter(|law| driven.contains(law)).collect();
    let mut whole = Finding::default();
    for line in lab.library.reached(&driven)? {
        whole.text += &format!("{line}\n");
    }
    for finding in all(&lab, &tests, &presets)? {
        whole.extend(finding);
    }
    whole.rows.extend(driver::beside_prompt(&whole.rows));
    if tests.iter().any(|t| t.name == "step") {
        let results = Results { rows: whole.rows.clone(), ..Results::default() };
        whole.extend(law::run(&lab, &lab.library.presets[0], &results)?);
    }
    if let Some(own) = &request.driver {
        whole.text += &driver::note(&lab, presets[0], own)?;
    }
    if let Some(found) = beyond(request, &lab, presets[0])? {
        whole.extend(found);
    }
    write_all(request, &lab, &presets, whole)
}

/// Every test under every preset, in that order, on all cores. What takes longest begins first, so that no core waits
/// for the last one.
fn all(lab: &Lab, tests: &[&Entry<Test>], presets: &[&Preset]) -> Result<Vec<Finding>, PaperError> {
    let mut jobs = Vec::new();
    for test in tests {
        for preset in presets {
            jobs.push((
                test.build.run,
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

/// Records the lap of a seed as `lap.csv` in the folder. Returns the file and what the lap asks for, beside other recordings.
///
/// # Errors
/// [`PaperError::File`] if it cannot be written.
pub fn record(dir: &Path, seed: u64) -> Result<(PathBuf, Vec<Demand>), PaperError> {
    let (file, samples) = (dir.join("lap.csv"), human::lap(seed));
    write(&file, &demand::to_csv(&samples))?;
    let mine = demand::of_lap(&format!("lap of seed {seed}"), &samples);
    Ok((file, std::iter::once(mine).chain(demand::all()).collect()))
}

/// What the columns of the tables are.
pub fn schema() -> Schema {
    let (results, counts) = (results::layout().shape, tally::layout().shape);
    Schema::new([("results.csv", FileSchema::of_table(&results)), ("counts.csv", FileSchema::of_table(&counts))])
}

fn write_all(request: &Request, lab: &Lab, presets: &[&Preset], whole: Finding) -> Result<Results, PaperError> {
    let dir = &request.out_dir;
    for series in &whole.series {
        write(&dir.join("series").join(format!("{}.csv", series.name)), &series.csv)?;
    }
    for figure in &whole.figures {
        write(&dir.join("figures").join(format!("{}.svg", figure.name)), &figure.file())?;
    }
    let results = Results { rows: whole.rows.clone(), text: whole.text.clone() };
    write(&dir.join("results.csv"), &results.to_csv())?;
    write_table(&dir.join("counts.csv"), &tally::layout(), &results.counts())?;
    write_json(&dir.join("schema.json"), &schema())?;
    let page = page::page(&request.test, lab, presets, &results, &whole)?;
    write(&dir.join("index.html"), &page)?;
    Ok(results)
}
