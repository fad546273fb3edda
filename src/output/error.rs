//! Why a file could not be written.

use crate::missing::did_you_mean;
use crate::registry::UnknownName;
use std::io;
use std::path::{Path, PathBuf};

/// Why something could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The operating system refused: no permission, disk full, no such file.
    #[error("cannot {action} {}: {source}{}", .path.display(), meant(action, .path))]
    File {
        /// "create", "write", "read", ...
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The suffix of an output file names no format.
    #[error("{}: {source}", .path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The suffix and the known ones.
        source: UnknownName,
    },
}

/// The nearest name, of a file that was to be read.
pub(crate) fn meant(action: &str, path: &Path) -> String {
    if action == "read" { did_you_mean(path) } else { String::new() }
}

/// Names the file in an error of the operating system.
pub(crate) fn file_error(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> OutputError {
    move |source| OutputError::File { action, path: path.to_owned(), source }
}
