//! Why a report cannot be made.

use crate::missing::did_you_mean;
use crate::output::OutputError;
use crate::sumo_files::SumoFileError;
use std::path::PathBuf;

/// Why a report cannot be made. A file that is missing is no such reason: the page says so.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ReportError {
    /// The folder is none of a run or a study.
    #[error(
        "{}: found neither run.json nor study.json, wanted the result folder of run, compare or sweep{}",
        .0.display(), did_you_mean(.0)
    )]
    NoResult(PathBuf),
    /// More than two results.
    #[error("found {0} results, wanted one, or two to compare")]
    Many(usize),
    /// A run beside a study.
    #[error("{} is the result of a run, {} that of a study: wanted two of a kind", .0.display(), .1.display())]
    Mixed(PathBuf, PathBuf),
    /// A table that is not as its schema says.
    #[error("{}:{line}: {what}", .path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Its line.
        line: usize,
        /// What was found and what was wanted.
        what: String,
    },
    /// A vehicle that is not there.
    #[error("--vehicle: found {id}, which is in no table{near}")]
    Vehicle {
        /// The vehicle.
        id: String,
        /// The nearest name in words.
        near: String,
    },
    /// A file.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A table in one of the formats of SUMO.
    #[error(transparent)]
    Sumo(#[from] SumoFileError),
    /// The page's own template.
    #[error("the page's template: {0}")]
    Template(#[from] minijinja::Error),
}
