//! Why a vehicle cannot drive without SUMO.

use crate::{cosim::CosimError, fleet::LawFailure, reference::ReferenceError, scenario::ScenarioError};

/// Why a vehicle cannot drive without SUMO.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum OfflineError {
    /// The target is not a profile, or is a profile without an end where an end is needed.
    #[error("target: wanted a profile with an end (target.name = \"profile\")")]
    NoProfile,
    /// The scenario.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scenario(#[from] ScenarioError),
    /// The profile.
    #[error("[target]: {0}")]
    Reference(#[from] ReferenceError),
    /// The law gave up.
    #[error(transparent)]
    Law(#[from] LawFailure),
    /// The vehicle.
    #[error(transparent)]
    Vehicle(#[from] CosimError),
}
