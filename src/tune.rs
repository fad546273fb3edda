//! Gains that suit each law best, found the same way for all: as many gains, the same drives, the same number of trials.
//!
//! A comparison of laws says little if one of them was tuned more than the others. So every law gets the same number of
//! free gains, is tuned by the same search on the same recordings, and is judged on other recordings with other noise.
//! Vehicles drive without SUMO, in the fleet that `run` uses.

mod condition;
mod drives;
mod error;
mod gains;
mod request;
mod row;
mod search;
mod tuned;

use crate::scenario::Catalog;
pub use condition::{Condition, Slope};
use drives::{Drives, Trial};
pub use error::TuneError;
pub use gains::Gain;
use gains::gains;
use indicatif::ProgressBar;
use rayon::prelude::*;
pub use request::Request;
use row::{Tested, row};
pub use row::{TunedRow, layout};
pub use search::{Found, search};
use tuned::Tuned;

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
