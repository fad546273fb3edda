//! What can be wrong with a profile.

use crate::missing::did_you_mean;
use std::path::PathBuf;

/// Why a profile cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum ReferenceError {
    /// The file cannot be read.
    #[error("{}: {source}{}", .file.display(), did_you_mean(.file))]
    Read {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file's content is not a profile.
    #[error("{}:{line}: {column}: found {found}, wanted {wanted}", .file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: u64,
        /// The column's name in the file, or "header".
        column: String,
        /// What is there.
        found: String,
        /// What should be there.
        wanted: String,
    },
    /// A key's value does not make a profile.
    #[error("{key}: found {found}, wanted {wanted}")]
    Value {
        /// The key.
        key: &'static str,
        /// Its value.
        found: String,
        /// What it should be.
        wanted: &'static str,
    },
}
