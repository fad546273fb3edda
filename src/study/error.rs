//! Why a study cannot be run.

use crate::output::OutputError;
use crate::registry::UnknownName;
use crate::run::RunError;
use crate::scenario::ScenarioError;
use crate::traci;

/// Why a study cannot be run. That a case fails is no such reason.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum StudyError {
    /// The study, or the scenario of one of its settings.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scenario(#[from] ScenarioError),
    /// Two settings are one.
    #[error("duplicate case: {second} is the same scenario as {first}")]
    Duplicate {
        /// The one.
        first: String,
        /// The other.
        second: String,
    },
    /// The study asks for something that cannot be studied.
    #[error("{key}: found {found}, wanted {wanted}")]
    Unfit {
        /// The key of the scenario.
        key: &'static str,
        /// What it says.
        found: String,
        /// What a study needs.
        wanted: &'static str,
    },
    /// SUMO cannot simulate what is before the cases.
    #[error("warm-up of seed {seed}: {what}")]
    WarmUp {
        /// The seed.
        seed: u64,
        /// What SUMO said.
        what: String,
    },
    /// A file of SUMO.
    #[error(transparent)]
    #[diagnostic(transparent)]
    SumoFile(#[from] crate::sumo_files::SumoFileError),
    /// There is no such executor.
    #[error(transparent)]
    Executor(#[from] UnknownName),
    /// A command of the scheduler cannot be started.
    #[error("executor slurm: cannot start {program} ({source}); it needs Slurm's commands, as on a login node")]
    NoSlurm {
        /// The command.
        program: &'static str,
        /// Why.
        source: std::io::Error,
    },
    /// The scheduler refuses.
    #[error("executor slurm: {program} says: {said}{then}")]
    Slurm {
        /// The command.
        program: &'static str,
        /// Its words.
        said: String,
        /// What came of it.
        then: String,
    },
    /// Two calls submit one study.
    #[error("executor slurm: {}: another call is submitting this study at this moment", dir.display())]
    Submitting {
        /// The folder.
        dir: std::path::PathBuf,
    },
    /// Two calls write the tables of one study.
    #[error("{}: another call is writing the tables of this study; try again when it is done", dir.display())]
    Collecting {
        /// The folder.
        dir: std::path::PathBuf,
    },
    /// No SUMO.
    #[error(transparent)]
    Traci(#[from] traci::Error),
    /// A file.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The folder of a case.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(#[from] RunError),
    /// The system refuses processes.
    #[error("cannot run cases: {0}")]
    System(#[from] std::io::Error),
}
