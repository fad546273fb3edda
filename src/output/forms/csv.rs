//! Comma-separated text.

use crate::output::csv::{header, line};
use crate::table::{Cell, Column};

/// A header line, then a line per row.
pub fn text(columns: &[Column], rows: &[Vec<Cell<'_>>]) -> String {
    let lines = rows.iter().map(|row| line(&mut row.iter().copied()));
    let bytes: std::io::Result<Vec<_>> = std::iter::once(header(columns)).chain(lines).collect();
    String::from_utf8(bytes.expect("memory takes all rows").concat()).expect("cells are UTF-8")
}
