//! Gains that suit each law best, found the same way for all: as many gains, the same drives, the same number of trials.
//!
//! A comparison of laws says little if one of them was tuned more than the others. So every law gets the same number of
//! free gains, is tuned by the same search on the same recordings, and is judged on other recordings with other noise.
//! Vehicles drive without SUMO, in the fleet that `run` uses.

mod drives;
mod error;
mod gains;
mod row;
mod search;

use crate::scenario::{self, Catalog, Override};
use drives::{Drives, Trial};
pub use error::TuneError;
use gains::{Gain, gains};
use indicatif::ProgressBar;
use rayon::prelude::*;
use row::{Tested, row};
pub use row::{TunedRow, layout};
use search::search;
use std::path::PathBuf;

/// What is tuned, and on what.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Body, actuators, noise, and whatever else the scenario says. Its target is replaced by the recordings.
    pub scenario: scenario::Request,
    /// The laws; ratios are to the first.
    pub controllers: Vec<String>,
    /// How many gains of each law are free.
    pub gains: usize,
    /// Recordings to tune on.
    pub train: Vec<PathBuf>,
    /// Recordings to judge on.
    pub test: Vec<PathBuf>,
    /// Vehicles per recording, each with its own noise and its own draws of the body.
    pub seeds: usize,
    /// Sets of gains that are tried per law and condition.
    pub trials: usize,
    /// The conditions; the first is the one whose gains are also tried under all others.
    pub conditions: Vec<Condition>,
    /// Show a progress bar.
    pub progress: bool,
}

/// A name, and what differs from the scenario.
#[derive(Debug, Clone)]
pub struct Condition {
    /// Its name.
    pub name: String,
    /// The keys that differ.
    pub sets: Vec<Override>,
}

impl Condition {
    /// Reads `NAME: KEY=VALUE KEY=VALUE ...`; the values have no blanks.
    ///
    /// # Errors
    /// What was wanted.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wanted = || format!("found \"{text}\", wanted \"NAME: KEY=VALUE KEY=VALUE\"");
        let (name, sets) = text.split_once(':').ok_or_else(wanted)?;
        let sets: Option<Vec<Override>> = sets.split_whitespace().map(Override::set).collect();
        let name = Some(name.trim()).filter(|name| !name.is_empty());
        Ok(Self { name: name.ok_or_else(wanted)?.to_owned(), sets: sets.ok_or_else(wanted)? })
    }
}

/// A law in a condition, tuned.
struct Tuned<'a> {
    condition: &'a Condition,
    controller: &'a str,
    gains: Vec<Gain>,
    /// The best values of the gains.
    best: Vec<f64>,
    trials: usize,
    /// What they cost on the recordings to tune on.
    train: Trial,
    drives: Drives<'a>,
}

/// Tunes every law in every condition, and judges it there.
///
/// # Errors
/// [`TuneError`] if the scenario or a recording is wrong, or a law has fewer gains than are to be tuned.
pub fn tune(request: &Request, catalog: &Catalog) -> Result<Vec<TunedRow>, TuneError> {
    for (name, files) in [("--train", &request.train), ("--test", &request.test)] {
        if files.is_empty() {
            return Err(TuneError::NoRecording(name));
        }
    }
    let mut jobs = Vec::new();
    for condition in &request.conditions {
        for controller in &request.controllers {
            let drives = Drives::new(request, catalog, condition, controller)?;
            let gains = gains(catalog, controller, request.gains, drives.scenario())?;
            jobs.push((condition, controller.as_str(), gains, drives));
        }
    }
    let bar = if request.progress { ProgressBar::new(jobs.len() as u64) } else { ProgressBar::hidden() };
    let tuned = jobs.into_par_iter().map(|(condition, controller, gains, drives)| {
        let found = search(&gains, request.trials, |values| Ok(drives.train(&gains, values)?.cost()))?;
        let train = drives.train(&gains, &found.best)?;
        bar.inc(1);
        Ok(Tuned { condition, controller, gains, best: found.best, trials: found.trials, train, drives })
    });
    let tuned: Vec<Tuned> = tuned.collect::<Result<_, TuneError>>()?;
    bar.finish_and_clear();
    let laws = request.controllers.len();
    let tested = tuned.par_iter().enumerate().map(|(place, law)| {
        // The same law's gains of the first condition, under this one.
        let once = &tuned[place % laws];
        Ok([law.drives.test(&law.gains, &law.best)?, law.drives.test(&law.gains, &once.best)?])
    });
    let tested: Vec<[Trial; 2]> = tested.collect::<Result<_, TuneError>>()?;
    let rows = tuned.iter().zip(&tested).enumerate().map(|(place, (law, [here, once]))| {
        let [reference_here, reference_once] = &tested[place - place % laws];
        let is_reference = place % laws == 0;
        let of = |trial, reference| Tested { trial, reference: (!is_reference).then_some(reference) };
        row(law, of(here, reference_here), of(once, reference_once))
    });
    Ok(rows.collect())
}
