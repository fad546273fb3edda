//! States that SUMO has saved (<https://sumo.dlr.de/docs/Simulation/SaveAndLoad.html>).

use super::error::SumoFileError;
use super::settings::{Settings, as_configured};
use super::setup::SumoSetup;
use super::xml::Xml;
use std::ops::ControlFlow;
use std::path::Path;

/// The time of a saved state \[s\], as SUMO wrote it.
///
/// # Errors
/// [`SumoFileError`] if the file cannot be read or is no state.
pub(super) fn state_time(path: &Path) -> Result<String, SumoFileError> {
    let mut time = None;
    Xml::open(path)?.each(|element| {
        time = element.attribute("time").filter(|_| element.name() == "snapshot");
        Ok(ControlFlow::Break(()))
    })?;
    time.ok_or_else(|| SumoFileError::Content {
        path: path.to_owned(),
        line: 1,
        what: "no state that SUMO has saved".to_owned(),
    })
}

/// When a simulation begins, and when it ends if that is set \[s\].
///
/// # Errors
/// [`SumoFileError`] if the configuration cannot be read.
pub fn span_s(setup: &SumoSetup) -> Result<(f64, Option<f64>), SumoFileError> {
    let settings = Settings::read(setup)?;
    let end_s = setup.end_s.or(settings.time_s("end")).filter(|end_s| *end_s >= 0.0);
    Ok((settings.time_s("begin").unwrap_or(0.0), end_s))
}

/// SUMO without us until this time \[s\], as its configuration has it.
///
/// # Errors
/// [`SumoFileError`] if the configuration cannot be read.
pub fn plain_until(setup: &SumoSetup, until_s: f64) -> Result<SumoSetup, SumoFileError> {
    let plain = as_configured(setup)?;
    // A state of the very end is not written.
    let end_s = Some(until_s + plain.step_length_s);
    Ok(SumoSetup { end_s, safety: false, ..plain })
}

/// The options with which SUMO saves its state at that time \[s\] to that file, so that it goes on from there as if it had
/// not been stopped.
pub fn saving(until_s: f64, file: &Path) -> Vec<String> {
    let pairs = [
        ("--save-state.times", until_s.to_string()),
        ("--save-state.files", file.display().to_string()),
        ("--save-state.rng", "true".to_owned()),
        ("--save-state.precision", "17".to_owned()),
    ];
    pairs.into_iter().flat_map(|(option, value)| [option.to_owned(), value]).collect()
}
