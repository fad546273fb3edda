//! How far a case is, read from its folder alone.

use super::plan::{Case, Plan};
use crate::output::{OutputError, write_json};
use crate::run::{MANIFEST, Manifest, ResultDir, RunError, Signal, Status};
use std::path::Path;

/// How far a case is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum State {
    /// Its result is whole.
    Done,
    /// It was run and failed, for this reason.
    Failed(String),
    /// It was not run, or stopped on the way, or has changed since.
    Missing,
}

impl State {
    /// The word for it in tables.
    pub fn as_str(&self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Failed(_) => "failed",
            Self::Missing => "missing",
        }
    }

    /// How far a case is.
    pub fn of(plan: &Plan, case: &Case) -> Self {
        Self::read(&plan.case_dir(case), &case.identity, &plan.sumo_version)
    }

    /// How far the case in a folder is that has this [identity](Manifest::identity).
    pub fn read(dir: &Path, identity: &str, sumo_version: &str) -> Self {
        let Ok(manifest) = Manifest::read(&dir.join(MANIFEST)) else { return Self::Missing };
        if manifest.identity(sumo_version) != identity {
            return Self::Missing;
        }
        match manifest.status {
            Status::Complete if manifest.files.iter().all(|file| dir.join(file).is_file()) => Self::Done,
            Status::Incomplete => match manifest.reason.unwrap_or_default() {
                reason if Signal::ALL.iter().any(|s| reason == RunError::Interrupted(*s).to_string()) => Self::Missing,
                reason => Self::Failed(reason),
            },
            Status::Complete | Status::Planned | Status::Running => Self::Missing,
        }
    }

    /// How far the case in a folder is that was planned so.
    pub fn of_planned(dir: &Path, planned: &Manifest) -> Self {
        let sumo_version = planned.sumo_version.as_deref().unwrap_or_default();
        Self::read(dir, &planned.identity(sumo_version), sumo_version)
    }
}

/// Makes the folder of a case ready: `run.json` says what is to be run, and nothing is left of an earlier attempt.
///
/// # Errors
/// [`RunError::Busy`] if somebody else runs it at this moment.
pub fn prepare(dir: &Path, planned: &Manifest) -> Result<(), RunError> {
    ResultDir::create(dir, true)?.write_manifest(planned)?;
    Ok(())
}

/// Writes down why a case failed, unless the run itself has.
///
/// # Errors
/// [`OutputError::File`] if `run.json` cannot be written.
pub fn note_failure(dir: &Path, planned: &Manifest, reason: &str) -> Result<(), OutputError> {
    if State::of_planned(dir, planned) != State::Missing {
        return Ok(());
    }
    let reason = Some(reason.to_owned());
    let manifest = Manifest { status: Status::Incomplete, reason, ..planned.clone() };
    write_json(&dir.join(MANIFEST), &manifest).map(drop)
}
