//! Why nothing can be said about stability.

use crate::{offline::OfflineError, reference::ReferenceError, registry::UnknownName, scenario::ScenarioError};

/// Why nothing can be said about stability.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum StabilityError {
    /// A controller without a loop.
    #[error("--controllers: found {0}, which drives no body, wanted a law")]
    NoLaw(String),
    /// A target that follows nobody.
    #[error("--uppers: found {0}, which keeps no gap, wanted a target that does: ctg_acc, path_cacc")]
    NoGap(String),
    /// A name that is not known.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// The scenario.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scenario(#[from] ScenarioError),
    /// The profile of a leader, or the file of a target.
    #[error("[target]: {0}")]
    Reference(#[from] ReferenceError),
    /// A vehicle cannot drive.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Offline(#[from] OfflineError),
}
