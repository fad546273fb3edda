//! Comma-separated text.

use crate::output::text::append;
use crate::table::{Cell, Column};

/// A header line, then a line per row.
pub fn text(columns: &[Column], rows: &[Vec<Cell<'_>>]) -> String {
    let mut writer = csv::WriterBuilder::new().terminator(csv::Terminator::Any(b'\n')).from_writer(Vec::new());
    let field = |cell: &Cell<'_>| {
        let mut text = String::new();
        append(&mut text, *cell);
        text
    };
    let head = columns.iter().map(|column| column.name.clone()).collect::<Vec<_>>();
    let records = std::iter::once(head).chain(rows.iter().map(|row| row.iter().map(field).collect()));
    let written = records.into_iter().try_for_each(|record| writer.write_record(record));
    let bytes = written.ok().and_then(|()| writer.into_inner().ok());
    String::from_utf8(bytes.expect("memory takes all rows")).expect("cells are UTF-8")
}
