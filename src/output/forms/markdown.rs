//! A table of GitHub Flavored Markdown (its specification, section 4.10).

use crate::output::text::append;
use crate::table::{Cell, Column, Kind, rounded};

/// Header, alignments, then a line per row: numbers to the right.
pub fn text(columns: &[Column], rows: &[Vec<Cell<'_>>]) -> String {
    let aligned = columns.iter().map(|column| if column.kind == Kind::Text { ":--" } else { "--:" }.to_owned());
    let mut text = line(columns.iter().map(title)) + &line(aligned);
    rows.iter().for_each(|row| text += &line(row.iter().map(cell)));
    text
}

fn line(cells: impl Iterator<Item = String>) -> String {
    format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "))
}

fn title(column: &Column) -> String {
    escaped(&column.unit.as_ref().map_or(column.name.clone(), |unit| format!("{} [{unit}]", column.name)))
}

/// Numbers to four digits.
fn cell(cell: &Cell<'_>) -> String {
    let mut text = String::new();
    append(&mut text, if let Cell::Number(number) = *cell { Cell::Number(number.map(rounded)) } else { *cell });
    escaped(&text)
}

/// What would end a cell or begin a tag.
fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('|', "\\|").replace('<', "&lt;").replace('\n', "<br>")
}
