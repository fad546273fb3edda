//! Why an experiment has no result.

use crate::offline::OfflineError;
use crate::output::{OutputError, meant};
use crate::registry::UnknownName;
use crate::scenario::ScenarioError;
use std::path::{Path, PathBuf};

/// Why there is no result.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum PaperError {
    /// A file cannot be read or written.
    #[error("cannot {action} {}: {source}{}", .path.display(), meant(action, .path))]
    File {
        /// "read" or "write".
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file of the library is not a fragment of a scenario.
    #[error("{}: {what}", .path.display())]
    Fragment {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// A test or preset that does not exist.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// A setting of the command line that no test can have.
    #[error("{shown}: {what}")]
    Setting {
        /// The argument.
        shown: String,
        /// What is wrong.
        what: String,
    },
    /// The scenario.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scenario(Box<ScenarioError>),
    /// The drive.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Offline(Box<OfflineError>),
    /// A table cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The page's own template.
    #[error("the page's template: {0}")]
    Template(#[from] minijinja::Error),
}

impl From<ScenarioError> for PaperError {
    fn from(error: ScenarioError) -> Self {
        Self::Scenario(Box::new(error))
    }
}

impl From<OfflineError> for PaperError {
    fn from(error: OfflineError) -> Self {
        Self::Offline(Box::new(error))
    }
}

impl PaperError {
    /// Names the file in an error of the operating system.
    pub fn reading(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::File { action: "read", path: path.to_owned(), source }
    }
}

/// Writes a whole file; missing folders above it are made.
pub fn write(path: &Path, text: &str) -> Result<(), PaperError> {
    let failed = |source| PaperError::File { action: "write", path: path.to_owned(), source };
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(failed)?;
    }
    std::fs::write(path, text).map_err(failed)
}
