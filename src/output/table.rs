//! A table is a list of columns; every format is written from it.

use super::{OutputError, PartFile, csv_sink, file_error, parquet_sink, xml_sink};
use crate::registry::{self, Entry};
use std::io;
use std::path::{Path, PathBuf};

/// How a column is read off a row of type `R`; `None` = no value.
pub enum Read<R> {
    /// A text.
    Text(fn(&R) -> Option<&str>),
    /// A number; one that is not finite counts as no value.
    Number(fn(&R) -> Option<f64>),
    /// A count.
    Count(fn(&R) -> u64),
    /// `true` or `false`.
    Flag(fn(&R) -> bool),
}

/// One column of a table of rows `R`.
pub struct Column<R> {
    /// Its header.
    pub name: &'static str,
    /// Its values.
    pub read: Read<R>,
}

impl<R> Column<R> {
    /// A column of texts.
    pub const fn text(name: &'static str, read: fn(&R) -> Option<&str>) -> Self {
        Self { name, read: Read::Text(read) }
    }

    /// A column of numbers.
    pub const fn number(name: &'static str, read: fn(&R) -> Option<f64>) -> Self {
        Self { name, read: Read::Number(read) }
    }

    /// A column of counts.
    pub const fn count(name: &'static str, read: fn(&R) -> u64) -> Self {
        Self { name, read: Read::Count(read) }
    }

    /// A column of `true` and `false`.
    pub const fn flag(name: &'static str, read: fn(&R) -> bool) -> Self {
        Self { name, read: Read::Flag(read) }
    }

    /// The value in `row`.
    pub fn cell<'a>(&self, row: &'a R) -> Cell<'a> {
        match self.read {
            Read::Text(read) => Cell::Text(read(row)),
            Read::Number(read) => Cell::Number(read(row).filter(|x| x.is_finite())),
            Read::Count(read) => Cell::Count(read(row)),
            Read::Flag(read) => Cell::Flag(read(row)),
        }
    }

    /// The value in `row` as a number, if it is one.
    pub fn value(&self, row: &R) -> Option<f64> {
        match self.cell(row) {
            Cell::Number(value) => value,
            Cell::Count(value) => Some(value as f64),
            Cell::Text(_) | Cell::Flag(_) => None,
        }
    }

    fn empty(&self) -> Cell<'static> {
        match self.read {
            Read::Text(_) => Cell::Text(None),
            Read::Number(_) => Cell::Number(None),
            Read::Count(_) => Cell::Count(0),
            Read::Flag(_) => Cell::Flag(false),
        }
    }
}

/// A table of rows `R`.
pub struct Layout<R: 'static> {
    /// The table, e.g. "vehicles": the root element of XML.
    pub table: &'static str,
    /// One row, e.g. "vehicle": the row element of XML.
    pub row: &'static str,
    /// Whether consecutive rows of the same time, the first column, share one `<timestep>` in XML as in SUMO's FCD output.
    pub by_time: bool,
    /// The columns in order.
    pub columns: &'static [Column<R>],
}

impl<R> Layout<R> {
    fn shape(&self) -> Shape {
        let columns = self.columns.iter().map(|c| (c.name, c.empty())).collect();
        Shape { table: self.table, row: self.row, by_time: self.by_time, columns }
    }
}

/// One value of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell<'a> {
    /// A text.
    Text(Option<&'a str>),
    /// A finite number.
    Number(Option<f64>),
    /// A count.
    Count(u64),
    /// `true` or `false`.
    Flag(bool),
}

impl Cell<'_> {
    /// Appends the value as text; nothing if there is none.
    pub(super) fn append_to(self, text: &mut String) {
        match self {
            Cell::Text(None) | Cell::Number(None) => {}
            Cell::Text(Some(value)) => text.push_str(value),
            Cell::Number(Some(value)) => super::number::append(text, value),
            Cell::Count(value) => text.push_str(&value.to_string()),
            Cell::Flag(value) => text.push_str(if value { "true" } else { "false" }),
        }
    }
}

/// A [`Layout`] without its row type: what a format needs to know before the first row.
pub struct Shape {
    /// The table's name.
    pub table: &'static str,
    /// A row's name.
    pub row: &'static str,
    /// See [`Layout::by_time`].
    pub by_time: bool,
    /// Each column's name and an empty cell of its kind.
    pub columns: Vec<(&'static str, Cell<'static>)>,
}

/// A file format: takes cells from left to right, row by row.
pub trait Sink: Send {
    /// The next value of the present row, in column `column`.
    ///
    /// # Errors
    /// When the file cannot be written.
    fn cell(&mut self, column: usize, cell: Cell<'_>) -> io::Result<()>;

    /// The present row is complete.
    ///
    /// # Errors
    /// When the file cannot be written.
    fn end_row(&mut self) -> io::Result<()>;

    /// No more rows: writes what is left and hands the file back.
    ///
    /// # Errors
    /// When the file cannot be written.
    fn end(self: Box<Self>) -> io::Result<PartFile>;
}

/// Opens a format on a file.
pub type OpenSink = fn(PartFile, &Shape) -> io::Result<Box<dyn Sink>>;

/// The formats by suffix.
pub static FORMATS: &[Entry<OpenSink>] = &[
    Entry {
        name: "csv",
        summary: "comma-separated text, one header line, empty field = no value",
        keys: &[],
        build: csv_sink::open,
    },
    Entry {
        name: "parquet",
        summary: "Apache Parquet, Snappy-compressed columns",
        keys: &[],
        build: parquet_sink::open,
    },
    Entry { name: "xml", summary: "XML in the manner of SUMO's tripinfo and FCD", keys: &[], build: xml_sink::open },
];

/// A table being written, row by row; memory does not grow with the number of rows.
pub struct Table<R: 'static> {
    layout: &'static Layout<R>,
    path: PathBuf,
    sink: Box<dyn Sink>,
}

impl<R> Table<R> {
    /// Starts the table at `path`, whose suffix chooses the format.
    ///
    /// # Errors
    /// [`OutputError::Format`] if no format has this suffix, [`OutputError::File`] if the file cannot be made.
    pub fn create(path: &Path, layout: &'static Layout<R>) -> Result<Self, OutputError> {
        let suffix = path.extension().unwrap_or_default().to_string_lossy();
        let format = registry::find("table format", FORMATS, &suffix)
            .map_err(|source| OutputError::Format { path: path.to_owned(), source })?;
        let file = PartFile::create(path)?;
        let sink = (format.build)(file, &layout.shape()).map_err(file_error("write", path))?;
        Ok(Self { layout, path: path.to_owned(), sink })
    }

    /// Appends a row.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the file, e.g. when the disk is full.
    pub fn write(&mut self, row: &R) -> Result<(), OutputError> {
        let mut write = || {
            for (i, column) in self.layout.columns.iter().enumerate() {
                self.sink.cell(i, column.cell(row))?;
            }
            self.sink.end_row()
        };
        write().map_err(file_error("write", &self.path))
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the file.
    pub fn finish(self) -> Result<PathBuf, OutputError> {
        self.sink.end().map_err(file_error("write", &self.path))?.finish()
    }
}

/// Writes a whole table.
///
/// # Errors
/// As [`Table::create`] and [`Table::write`].
pub fn write_table<'a, R: 'static>(
    path: &Path,
    layout: &'static Layout<R>,
    rows: impl IntoIterator<Item = &'a R>,
) -> Result<PathBuf, OutputError> {
    let mut table = Table::create(path, layout)?;
    for row in rows {
        table.write(row)?;
    }
    table.finish()
}

#[cfg(test)]
mod tests;
