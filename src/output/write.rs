//! Rows to a file, in the format that the suffix names.

use super::atomic::PartFile;
use super::error::{OutputError, file_error};
use super::sink::Sink;
use super::{csv, parquet, xml};
use crate::registry::{self, Entry};
use crate::table::{Layout, Shape};
use std::io;
use std::path::{Path, PathBuf};

/// Opens a format on a file.
pub type OpenSink = fn(PartFile, &Shape) -> io::Result<Box<dyn Sink>>;

/// The formats by suffix.
pub static FORMATS: &[Entry<OpenSink>] = &[
    Entry {
        name: "csv",
        summary: "comma-separated text, one header line, empty field = no value",
        keys: &[],
        build: csv::open,
    },
    Entry { name: "parquet", summary: "Apache Parquet, Snappy-compressed columns", keys: &[], build: parquet::open },
    Entry { name: "xml", summary: "XML in the manner of SUMO's tripinfo and FCD", keys: &[], build: xml::open },
];

/// A table being written, row by row; memory does not grow with the number of rows.
pub struct Table<'l, R: 'static> {
    layout: &'l Layout<R>,
    path: PathBuf,
    sink: Box<dyn Sink>,
}

impl<'l, R> Table<'l, R> {
    /// Starts the table at `path`, whose suffix chooses the format.
    ///
    /// # Errors
    /// [`OutputError::Format`] if no format has this suffix, [`OutputError::File`] if the file cannot be made.
    pub fn create(path: &Path, layout: &'l Layout<R>) -> Result<Self, OutputError> {
        format_of(path)?;
        Self::open(PartFile::create(path)?, layout)
    }

    /// Starts the table in a file.
    pub(super) fn open(file: PartFile, layout: &'l Layout<R>) -> Result<Self, OutputError> {
        let path = file.path().to_owned();
        let sink = (format_of(&path)?)(file, &layout.shape).map_err(file_error("write", &path))?;
        Ok(Self { layout, path, sink })
    }

    /// Appends a row.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the file, e.g. when the disk is full.
    pub fn write(&mut self, row: &R) -> Result<(), OutputError> {
        self.sink.row(&mut self.layout.cells(row)).map_err(file_error("write", &self.path))
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the file.
    pub fn finish(self) -> Result<PathBuf, OutputError> {
        self.sink.end().map_err(file_error("write", &self.path))?.finish()
    }
}

fn format_of(path: &Path) -> Result<OpenSink, OutputError> {
    let suffix = path.extension().unwrap_or_default().to_string_lossy();
    let format = registry::find("table format", FORMATS, &suffix);
    format.map(|format| format.build).map_err(|source| OutputError::Format { path: path.to_owned(), source })
}

/// Writes a whole table.
///
/// # Errors
/// As [`Table::create`] and [`Table::write`].
pub fn write_table<'a, R: 'static>(
    path: &Path,
    layout: &Layout<R>,
    rows: impl IntoIterator<Item = &'a R>,
) -> Result<PathBuf, OutputError> {
    let mut table = Table::create(path, layout)?;
    for row in rows {
        table.write(row)?;
    }
    table.finish()
}
