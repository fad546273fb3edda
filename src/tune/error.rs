//! Why nothing can be tuned.

use crate::{offline::OfflineError, registry::UnknownName, scenario::ScenarioError};

/// Why nothing can be tuned.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum TuneError {
    /// No recording.
    #[error("{0}: found no recording, wanted at least one")]
    NoRecording(&'static str),
    /// A law with too few gains.
    #[error("--gains: found {wanted}, but the controller {controller} has {} to tune: {}", known.len(), known.join(", "))]
    Gains {
        /// The law.
        controller: String,
        /// How many were asked for.
        wanted: usize,
        /// Those that it has.
        known: Vec<&'static str>,
    },
    /// A law that is not known.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// The scenario.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scenario(#[from] ScenarioError),
    /// A vehicle cannot drive.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Offline(#[from] OfflineError),
    /// The search itself.
    #[error("the search: {0}")]
    Search(String),
}
