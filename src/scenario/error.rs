//! What can be wrong with a scenario, and where.

use std::{fmt, path::PathBuf};

use miette::{Diagnostic, LabeledSpan, SourceCode};

use crate::{missing::did_you_mean, place::Place, registry::UnknownName, sumo_files::SumoFileError};

/// Why a scenario cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// A file cannot be read.
    #[error("{}: cannot be read: {reason}{}", path.display(), did_you_mean(path))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: std::io::Error,
    },
    /// Neither configuration nor network.
    #[error(
        "nothing to run: neither a SUMO configuration nor a network is named (sumo.config, or sumo.net and sumo.routes)"
    )]
    NoSource,
    /// The scenario file or the command line is wrong.
    #[error("{first}{}", if more.is_empty() { String::new() } else { format!(" (and {} more)", more.len()) })]
    Mistakes {
        /// The first mistake.
        first: Box<Mistake>,
        /// All others.
        more: Vec<Mistake>,
    },
    /// A tyre curve.
    #[error("vehicle.tyre_curve, {}: {what}", path.display())]
    Tyre {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// SUMO's own files.
    #[error(transparent)]
    SumoFiles(#[from] SumoFileError),
}

impl ScenarioError {
    /// What explains the error, if it is about a file that the user wrote.
    fn inner(&self) -> Option<&dyn Diagnostic> {
        match self {
            Self::Mistakes { first, .. } => Some(first.as_ref()),
            Self::SumoFiles(error) => Some(error),
            Self::Unreadable { .. } | Self::NoSource | Self::Tyre { .. } => None,
        }
    }
}

impl Diagnostic for ScenarioError {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.inner()?.source_code()
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.inner()?.labels()
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.inner()?.help()
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        let Self::Mistakes { more, .. } = self else { return None };
        Some(Box::new(more.iter().map(|mistake| mistake as &dyn Diagnostic)))
    }
}

/// A mistake in a scenario file, or in an argument that overrides it.
#[derive(Debug)]
pub struct Mistake {
    /// Where.
    pub place: Place,
    /// The full path of the key.
    pub key: String,
    /// What is wrong.
    pub what: Wrong,
}

/// What is wrong with a key.
#[derive(Debug, thiserror::Error)]
pub enum Wrong {
    /// The file is not TOML.
    #[error("{0}")]
    Syntax(String),
    /// The key or section does not exist.
    #[error("{}", suggestion.as_ref().map(|s| format!("; did you mean {s}?")).unwrap_or_default())]
    UnknownKey {
        /// The nearest known key, if one is near.
        suggestion: Option<String>,
        /// All keys known there.
        known: Vec<String>,
    },
    /// The value has the wrong type or form, or is out of range.
    #[error("found {found}, wanted {wanted}")]
    Value {
        /// What stands there.
        found: String,
        /// What could.
        wanted: String,
    },
    /// No entry has this name.
    #[error(transparent)]
    Name(Box<UnknownName>),
    /// The file does not exist.
    #[error("{} does not exist{}", .0.display(), did_you_mean(.0))]
    MissingFile(PathBuf),
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, key, what } = self;
        match what {
            Wrong::Syntax(message) => write!(f, "{place}: {message}"),
            Wrong::UnknownKey { .. } => write!(f, "{place}: unknown key {key}{what}"),
            _ => write!(f, "{place}: {key}: {what}"),
        }
    }
}

impl std::error::Error for Mistake {}

impl Diagnostic for Mistake {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        (!self.place.origin.argument).then_some(&self.place as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.source_code()?;
        Some(Box::new(std::iter::once(LabeledSpan::underline(self.place.span.clone()))))
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        match &self.what {
            Wrong::UnknownKey { known, .. } if !known.is_empty() => {
                Some(Box::new(format!("known here: {}", known.join(", "))))
            }
            Wrong::MissingFile(path) if path.to_string_lossy().contains("${") => {
                Some(Box::new("the environment variable is not set"))
            }
            _ => None,
        }
    }
}
