//! What a file format is.

use super::atomic::PartFile;
use crate::table::Cell;
use std::io;

/// A file format: takes the rows of a table one by one.
pub trait Sink: Send {
    /// Appends a row, the cells in the order of the columns.
    ///
    /// # Errors
    /// When the file cannot be written.
    fn row(&mut self, cells: &mut dyn Iterator<Item = Cell<'_>>) -> io::Result<()>;

    /// Writes what is left after the last row, and hands the file back.
    ///
    /// # Errors
    /// When the file cannot be written.
    fn end(self: Box<Self>) -> io::Result<PartFile>;
}
