//! How far a case is, read from its folder alone.

use super::plan::{Case, Plan};
use crate::output::{OutputError, write_json};
use crate::run::{MANIFEST, Manifest, ResultDir, RunError, Signal, Status};

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
        let dir = plan.case_dir(case);
        let Ok(manifest) = Manifest::read(&dir.join(MANIFEST)) else { return Self::Missing };
        if manifest.identity(&plan.sumo_version) != case.identity {
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
}

/// Makes the folder of a case ready: `run.json` says what is to be run, and nothing is left of an earlier attempt.
///
/// # Errors
/// [`RunError::Busy`] if somebody else runs it at this moment.
pub fn prepare(plan: &Plan, case: &Case) -> Result<(), RunError> {
    let dir = ResultDir::create(&plan.case_dir(case), true)?;
    dir.write_manifest(&plan.manifest(case))?;
    Ok(())
}

/// Writes down why a case failed, unless the run itself has.
///
/// # Errors
/// [`OutputError::File`] if `run.json` cannot be written.
pub fn note_failure(plan: &Plan, case: &Case, reason: &str) -> Result<(), OutputError> {
    if State::of(plan, case) != State::Missing {
        return Ok(());
    }
    let reason = Some(reason.to_owned());
    let manifest = Manifest { status: Status::Incomplete, reason, ..plan.manifest(case) };
    write_json(&plan.case_dir(case).join(MANIFEST), &manifest).map(drop)
}
