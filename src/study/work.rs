//! What an executor is given, and how it ends. Nothing of it reaches the tables.

use super::error::StudyError;
use super::plan::{Case, Plan};
use super::process::Program;
use super::slurm::SlurmKeys;
use crate::run::{Backend, Signal};
use std::collections::BTreeMap;
use std::ffi::OsString;

/// What is to be run, and how.
pub struct Work<'a> {
    /// The study.
    pub plan: &'a Plan,
    /// The cases to run, in order.
    pub cases: &'a [&'a Case],
    /// Cases at the same time, if the user says.
    pub jobs: Option<usize>,
    /// How the cases reach SUMO.
    pub backend: Backend,
    /// The program, which runs a case with `run --from`.
    pub program: &'a Program,
    /// The arguments with which the program writes the tables.
    pub tables: &'a [OsString],
    /// Finished cases are run again.
    pub force: bool,
    /// Stay until all cases have ended, also where others run them.
    pub wait: bool,
    /// What Slurm is asked for.
    pub slurm: &'a SlurmKeys,
    /// Tell nothing.
    pub quiet: bool,
}

/// How an executor ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ended {
    /// Every case was run, well or not.
    All,
    /// A signal came.
    Interrupted(Signal),
    /// These jobs of a scheduler run them; the last of them writes the tables.
    Queued(Vec<String>),
}

/// What a scheduler knows of a case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Standing {
    /// It waits for its turn.
    Pending,
    /// It is run now.
    Running,
    /// A call was stopped while it submitted it, and the scheduler does not show it.
    Uncertain,
    /// Its job has ended, for this reason, and it has not.
    Lost(String),
}

/// Who runs cases.
#[derive(Clone, Copy)]
pub struct Executor {
    /// Runs them.
    pub execute: fn(&Work<'_>) -> Result<Ended, StudyError>,
    /// What it knows of cases, by their numbers, beyond what their folders say.
    pub standing: fn(&Plan) -> Result<BTreeMap<usize, Standing>, StudyError>,
}
