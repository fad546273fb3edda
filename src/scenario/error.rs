//! What can be wrong with a scenario, and where.

use std::{fmt, ops::Range, path::PathBuf, sync::Arc};

use miette::{Diagnostic, LabeledSpan, SourceCode, SourceSpan};

use crate::registry::UnknownName;

/// A text that was read: a file, or an argument of the command line.
#[derive(Debug)]
pub(crate) struct Origin {
    /// File name or argument, as the user wrote it.
    pub name: String,
    /// What it says.
    pub text: String,
    /// The folder to which its file names are relative.
    pub folder: PathBuf,
    /// True for arguments, which have no line numbers worth naming.
    pub argument: bool,
}

/// A stretch of a file, or an argument of the command line.
#[derive(Debug, Clone)]
pub struct Place {
    pub(crate) origin: Arc<Origin>,
    pub(crate) span: Range<usize>,
}

impl Place {
    /// The line, from 1.
    pub fn line(&self) -> usize {
        let end = self.span.start.min(self.origin.text.len());
        1 + self.origin.text.as_bytes()[..end].iter().filter(|b| **b == b'\n').count()
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.origin.argument {
            write!(f, "{}", self.origin.name)
        } else {
            write!(f, "{}:{}", self.origin.name, self.line())
        }
    }
}

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
    /// A file or folder cannot be written.
    #[error("{}: cannot be written: {reason}", path.display())]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        reason: std::io::Error,
    },
    /// Not TOML, or not XML.
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
    /// A network without traffic.
    #[error("{}: a network without routes has no traffic", net.display())]
    NoRoutes {
        /// The network.
        net: PathBuf,
    },
    /// Route files in which nobody drives.
    #[error("{place}: {key}: no vehicle, trip or flow in {files}")]
    EmptyDemand {
        /// Where the files are named.
        place: Place,
        /// By which key or option.
        key: String,
        /// The files.
        files: String,
    },
}

impl ScenarioError {
    fn place(&self) -> Option<&Place> {
        match self {
            Self::Unreadable { .. } | Self::Unwritable { .. } | Self::NoSource(_) | Self::NoRoutes { .. } => None,
            Self::Syntax { place, .. }
            | Self::UnknownKey { place, .. }
            | Self::WrongValue { place, .. }
            | Self::UnknownName { place, .. }
            | Self::MissingFile { place, .. }
            | Self::EmptyDemand { place, .. } => Some(place),
        }
    }
}

impl SourceCode for Place {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn miette::SpanContents<'a> + 'a>, miette::MietteError> {
        let inner = self.origin.text.read_span(span, before, after)?;
        Ok(Box::new(miette::MietteSpanContents::new_named(
            self.origin.name.clone(),
            inner.data(),
            *inner.span(),
            inner.line(),
            inner.column(),
            inner.line_count(),
        )))
    }
}

impl Diagnostic for ScenarioError {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.place().filter(|p| !p.origin.argument).map(|p| p as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
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
            Self::NoRoutes { net } => Some(Box::new(random_trips(net))),
            _ => None,
        }
    }
}

/// The commands that give a bare network some traffic.
fn random_trips(net: &std::path::Path) -> String {
    let name = net.to_string_lossy();
    let stem = name.strip_suffix(".gz").unwrap_or(&name);
    let stem = stem.strip_suffix(".net.xml").or_else(|| stem.strip_suffix(".xml")).unwrap_or(stem);
    format!(
        "make random trips and run them:\n  python3 \"$SUMO_HOME/tools/randomTrips.py\" -n {name} -o {stem}.trips.xml -e 600\n  \
         sumo-mfc run --net {name} --routes {stem}.trips.xml"
    )
}
