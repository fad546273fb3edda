//! What a run leaves on disk: tables, summary and manifest.
//!
//! - A **table** is a [`Layout`]: a list of [`Column`]s, each a name and an accessor of the row. CSV, Parquet and XML
//!   all come from that list; the suffix of the path picks the format from [`FORMATS`].
//! - Every file is written as `.part` and renamed when whole ([`PartFile`]): a file without that suffix is complete.
//! - [`ResultDir`] is the folder of one run: it refuses to overwrite a finished result, keeps `run.json` up to date and
//!   lets one run write at a time.
//!
//! To add a format: one file with a [`Sink`], one line in [`FORMATS`]. To add a column: one line in `rows.rs`.

mod atomic;
mod csv_sink;
mod edges;
mod manifest;
mod number;
mod parquet_sink;
mod result_dir;
mod rows;
mod sampler;
mod spread;
mod summary;
mod table;
mod xml_sink;

pub use atomic::PartFile;
pub use edges::{EdgeRow, EdgeTable};
pub use manifest::{Input, Manifest, Status, sha256_of};
pub use result_dir::ResultDir;
pub use rows::{EDGES, Reason, SAMPLE, SampleRow, TRACE, TraceRow, VEHICLES, VehicleRow, sort_vehicles};
pub use sampler::{SAMPLED, Sampler};
pub use spread::Spread;
pub use summary::{Summary, SumoTotals, terminal_text};
pub use table::{Cell, Column, FORMATS, Layout, Read, Shape, Sink, Table, write_table};

use crate::registry::UnknownName;
use std::io;
use std::path::{Path, PathBuf};

/// Why something could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The operating system refused: no permission, disk full, no such file.
    #[error("cannot {action} {}: {source}", .path.display())]
    File {
        /// "create", "write", "read", ...
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The folder holds a result that nobody allowed to overwrite.
    #[error("{} already holds a result ({found}); --force overwrites it, -o chooses another folder", .dir.display())]
    Finished {
        /// The folder.
        dir: PathBuf,
        /// What was found there.
        found: String,
    },
    /// Another run writes to the same folder at this moment.
    #[error("another run is writing to {}", .dir.display())]
    Busy {
        /// The folder.
        dir: PathBuf,
    },
    /// The suffix of an output file names no format.
    #[error("{}: {source}", .path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The suffix and the known ones.
        source: UnknownName,
    },
    /// A file that SUMO or an earlier run wrote is not what it should be.
    #[error("{}, byte {offset}: {what}", .path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Where in it.
        offset: u64,
        /// What is wrong.
        what: String,
    },
}

/// Names the file in an error of the operating system.
fn file_error(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> OutputError {
    move |source| OutputError::File { action, path: path.to_owned(), source }
}
