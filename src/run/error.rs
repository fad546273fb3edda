//! Why there is no whole result.

use super::signals::Signal;
use crate::cosim::CosimError;
use crate::output::OutputError;
use crate::reference::ReferenceError;
use crate::scenario::ScenarioError;
use crate::sumo_files::SumoFileError;
use crate::traci;
use std::path::PathBuf;
use std::process::ExitStatus;

/// Why there is no whole result.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum RunError {
    /// The scenario.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scenario(#[from] ScenarioError),
    /// SUMO's own files.
    #[error(transparent)]
    #[diagnostic(transparent)]
    SumoFiles(#[from] SumoFileError),
    /// The files.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The folder holds a result that nobody allowed to overwrite.
    #[error("{} already holds a result ({found}); --force overwrites it, -o chooses another folder", .dir.display())]
    Finished {
        /// The folder.
        dir: PathBuf,
        /// What was found there.
        found: String,
    },
    /// The files of a run that is to be repeated have changed.
    #[error("{}: the run cannot be repeated: {what}", .manifest.display())]
    Changed {
        /// Its `run.json`.
        manifest: PathBuf,
        /// What is not as it was.
        what: String,
    },
    /// There is nothing to recover.
    #[error("{}: nothing to recover: {why}", .dir.display())]
    NothingToRecover {
        /// The folder.
        dir: PathBuf,
        /// Why.
        why: String,
    },
    /// Another run writes to the same folder at this moment.
    #[error("another run is writing to {}", .dir.display())]
    Busy {
        /// The folder.
        dir: PathBuf,
    },
    /// SUMO and the connection to it.
    #[error(transparent)]
    Traci(#[from] traci::Error),
    /// SUMO cannot be run in this process.
    #[error("--backend libsumo: {0}; --backend traci runs SUMO in a process of its own")]
    Backend(String),
    /// The coupling.
    #[error(transparent)]
    Cosim(#[from] CosimError),
    /// The profile.
    #[error("[target]: {0}")]
    Reference(#[from] ReferenceError),
    /// The system refuses threads or sockets.
    #[error("cannot start the run: {0}")]
    System(String),
    /// SUMO ended, but not well.
    #[error("SUMO has ended with {0}: its outputs may not be whole")]
    SumoFailed(ExitStatus),
    /// SUMO's outputs are not whole.
    #[error("{0}; the rows are written, and marked incomplete")]
    Outputs(String),
    /// Somebody has deleted the folder of the result, or that of SUMO's outputs.
    #[error("{} was deleted while the run was under way: what SUMO wrote is lost; the rows are written, and marked incomplete", .0.display())]
    Deleted(PathBuf),
    /// A run without egos shows nothing.
    #[error("no vehicle has become an ego: {0}; the tables are written, and the result is marked incomplete")]
    NoEgos(String),
    /// A signal ended the run before its end.
    #[error("ended by a signal ({0:?})")]
    Interrupted(Signal),
    /// The session has ended: an error before has broken it off.
    #[error("the session has ended")]
    Ended,
    /// A run that broke off; what was computed is in the folder.
    #[error("{source}; the run broke off at {time_s} s, {kept}")]
    Broken {
        /// Simulation time \[s\].
        time_s: f64,
        /// What of it is kept, and where, in words.
        kept: String,
        /// What happened.
        source: Box<RunError>,
    },
}
