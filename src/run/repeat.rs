//! A run once more, from its `run.json`.

use super::error::RunError;
use super::manifest::{Input, Manifest};
use crate::scenario::{Catalog, Scenario};
use std::path::{Path, PathBuf};

/// The scenario that a manifest describes, with the same inputs.
///
/// # Errors
/// [`RunError::Changed`] if this program or an input is not what it was; or a manifest that cannot be read.
pub fn repeated(manifest: &Path, catalog: &Catalog) -> Result<Scenario, RunError> {
    let run = Manifest::read(manifest)?;
    let changed = |what: String| RunError::Changed { manifest: manifest.to_owned(), what };
    let own = env!("CARGO_PKG_VERSION");
    if run.version != own {
        return Err(changed(format!("it is of version {}, and this is {own}", run.version)));
    }
    for input in &run.inputs {
        let now = Input::of(Path::new(&input.path)).map_err(|error| changed(error.to_string()))?;
        if now.sha256 != input.sha256 {
            return Err(changed(format!(
                "{} has changed since (SHA-256 {}, was {})",
                now.path, now.sha256, input.sha256
            )));
        }
    }
    let scenario = Scenario::from_toml(&manifest.display().to_string(), &run.scenario, catalog)?;
    let inputs = run.inputs.iter().map(|input| PathBuf::from(&input.path)).collect();
    Ok(Scenario { inputs, ..scenario })
}
