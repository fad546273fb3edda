//! What can be wrong with SUMO's files, and where.

use std::{
    fmt, io,
    path::{Path, PathBuf},
};

use miette::{Diagnostic, LabeledSpan, SourceCode};

use crate::{missing::did_you_mean, place::Place};

/// Why SUMO's files cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SumoFileError {
    /// A file cannot be read.
    #[error("{}: cannot be read: {reason}{}", path.display(), did_you_mean(path))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: io::Error,
    },
    /// A file or folder cannot be written.
    #[error("{}: cannot be written: {reason}", path.display())]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        reason: io::Error,
    },
    /// SUMO cannot write into a folder of such a name.
    #[error("{}: SUMO takes a path with a colon for a network address; choose another folder (-o)", .0.display())]
    Colon(PathBuf),
    /// The configuration is not XML.
    #[error("{place}: {message}")]
    Syntax {
        /// Where.
        place: Place,
        /// What the parser says.
        message: String,
    },
    /// A file that is named but does not exist.
    #[error("{place}: {key}: {} does not exist{}", path.display(), did_you_mean(path))]
    MissingFile {
        /// Where it is named.
        place: Place,
        /// By which key or option.
        key: String,
        /// The file.
        path: PathBuf,
    },
    /// An option that cannot hold.
    #[error("{place}: {key}: found {found}, wanted {wanted}")]
    Setting {
        /// Where it is set.
        place: Place,
        /// By which key or option.
        key: String,
        /// What it says.
        found: String,
        /// What it should say.
        wanted: String,
    },
    /// The configuration names no network.
    #[error("{}: neither a SUMO configuration nor a network is named (sumo.config, or sumo.net and sumo.routes)", .0.display())]
    NoNetwork(PathBuf),
    /// A network without traffic.
    #[error("{}: a network without routes has no traffic", net.display())]
    NoRoutes {
        /// The network.
        net: PathBuf,
    },
    /// Route files without vehicles.
    #[error("{place}: {key}: no vehicle, trip or flow in {files}")]
    EmptyDemand {
        /// Where the files are named.
        place: Place,
        /// By which key or option.
        key: String,
        /// The files.
        files: String,
    },
    /// A file is not what SUMO reads or writes.
    #[error("{}:{line}: {what}", .path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// Files that include each other without end.
    #[error("{}: {what}: {chain}", .path.display())]
    Include {
        /// The last file.
        path: PathBuf,
        /// What is wrong.
        what: String,
        /// All files from the first one on.
        chain: String,
    },
}

impl SumoFileError {
    fn place(&self) -> Option<&Place> {
        match self {
            Self::Syntax { place, .. }
            | Self::MissingFile { place, .. }
            | Self::Setting { place, .. }
            | Self::EmptyDemand { place, .. } => Some(place),
            _ => None,
        }
    }
}

impl Diagnostic for SumoFileError {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.place().filter(|p| !p.origin.argument).map(|p| p as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.place().filter(|p| !p.origin.argument)?;
        Some(Box::new(std::iter::once(LabeledSpan::underline(place.span.clone()))))
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        match self {
            Self::MissingFile { path, .. } if path.to_string_lossy().contains("${") => {
                Some(Box::new("the environment variable is not set"))
            }
            Self::NoRoutes { net } => Some(Box::new(random_trips(net))),
            _ => None,
        }
    }
}

/// The commands that give a bare network some traffic.
fn random_trips(net: &Path) -> String {
    let name = net.to_string_lossy();
    let stem = name.strip_suffix(".gz").unwrap_or(&name);
    let stem = stem.strip_suffix(".net.xml").or_else(|| stem.strip_suffix(".xml")).unwrap_or(stem);
    format!(
        "make random trips and run them:\n  python3 \"$SUMO_HOME/tools/randomTrips.py\" -n {name} -o {stem}.trips.xml -e 600\n  \
         sumo-mfc run --net {name} --routes {stem}.trips.xml"
    )
}

/// Names the file in an error of the operating system.
pub(super) fn unreadable(path: &Path) -> impl FnOnce(io::Error) -> SumoFileError {
    move |reason| SumoFileError::Unreadable { path: path.to_owned(), reason }
}
