//! What an executor is given, and how it ends. Nothing of it reaches the tables.

use super::error::StudyError;
use super::plan::{Case, Plan};
use crate::run::Signal;
use std::path::Path;

/// What is to be run, and how.
pub struct Work<'a> {
    /// The study.
    pub plan: &'a Plan,
    /// The cases to run, in order.
    pub cases: &'a [&'a Case],
    /// Cases at the same time.
    pub jobs: usize,
    /// The program, which runs a case with `run --from`.
    pub program: &'a Path,
    /// Tell nothing.
    pub quiet: bool,
}

/// How an executor ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// Every case was run, well or not.
    All,
    /// A signal came.
    Interrupted(Signal),
}

/// Runs cases.
pub type Execute = fn(&Work<'_>) -> Result<Ended, StudyError>;
