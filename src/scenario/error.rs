//! What can be wrong with a scenario, and where.

use std::{fmt, path::PathBuf};

use miette::{Diagnostic, LabeledSpan, SourceCode};

use crate::{place::Place, registry::UnknownName, sumo_files::SumoFileError};

/// Why a scenario cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// A file cannot be read.
    #[error("{}: cannot be read: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: std::io::Error,
    },
    /// Not TOML.
    #[error("{place}: {message}")]
    Syntax {
        /// Where.
        place: Place,
        /// What the parser says.
        message: String,
    },
    /// A key or section that does not exist.
    #[error("{place}: unknown key {key}{}", suggestion.as_ref().map(|s| format!("; did you mean {s}?")).unwrap_or_default())]
    UnknownKey {
        /// Where.
        place: Place,
        /// The full path of the key.
        key: String,
        /// The nearest known key, if one is near.
        suggestion: Option<String>,
        /// All keys known there.
        known: Vec<String>,
    },
    /// A value of the wrong type, unit or range.
    #[error("{place}: {key}: found {found}, wanted {wanted}")]
    WrongValue {
        /// Where.
        place: Place,
        /// The full path of the key.
        key: String,
        /// What stands there.
        found: String,
        /// What could.
        wanted: String,
    },
    /// A name that no registry has.
    #[error("{place}: {key}: {unknown}")]
    UnknownName {
        /// Where.
        place: Place,
        /// The full path of the key.
        key: String,
        /// The name, the nearest one, all known ones.
        unknown: Box<UnknownName>,
    },
    /// A file that is named but is not there.
    #[error("{place}: {key}: {} does not exist", path.display())]
    MissingFile {
        /// Where it is named.
        place: Place,
        /// By which key or option.
        key: String,
        /// The file.
        path: PathBuf,
    },
    /// Neither configuration nor network.
    #[error("{0}: neither a SUMO configuration nor a network is named (sumo.config, or sumo.net and sumo.routes)")]
    NoSource(String),
    /// SUMO's own files.
    #[error(transparent)]
    SumoFiles(#[from] SumoFileError),
}

impl ScenarioError {
    fn place(&self) -> Option<&Place> {
        match self {
            Self::Unreadable { .. } | Self::NoSource(_) | Self::SumoFiles(_) => None,
            Self::Syntax { place, .. }
            | Self::UnknownKey { place, .. }
            | Self::WrongValue { place, .. }
            | Self::UnknownName { place, .. }
            | Self::MissingFile { place, .. } => Some(place),
        }
    }
}

impl Diagnostic for ScenarioError {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        match self {
            Self::SumoFiles(error) => error.source_code(),
            _ => self.place().filter(|p| !p.origin.argument).map(|p| p as &dyn SourceCode),
        }
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        if let Self::SumoFiles(error) = self {
            return error.labels();
        }
        let place = self.place().filter(|p| !p.origin.argument)?;
        Some(Box::new(std::iter::once(LabeledSpan::underline(place.span.clone()))))
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        match self {
            Self::UnknownKey { known, .. } if !known.is_empty() => {
                Some(Box::new(format!("known here: {}", known.join(", "))))
            }
            Self::MissingFile { path, .. } if path.to_string_lossy().contains("${") => {
                Some(Box::new("the environment variable is not set"))
            }
            Self::SumoFiles(error) => error.help(),
            _ => None,
        }
    }
}
