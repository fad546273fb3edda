//! Comma-separated text: `\n` at line ends, quotes only where a value needs them.

use super::atomic::PartFile;
use super::sink::Sink;
use super::text::append;
use crate::table::{Cell, Column, Shape};
use std::io::{self, Write};

struct CsvSink(csv::Writer<PartFile>);

/// Writes the header.
pub(super) fn open(file: PartFile, shape: &Shape) -> io::Result<Box<dyn Sink>> {
    let mut writer = writer(file);
    writer.write_record(names(&shape.columns))?;
    Ok(Box::new(CsvSink(writer)))
}

impl Sink for CsvSink {
    fn row(&mut self, cells: &mut dyn Iterator<Item = Cell<'_>>) -> io::Result<()> {
        write_row(&mut self.0, cells)
    }

    fn end(self: Box<Self>) -> io::Result<PartFile> {
        self.0.into_inner().map_err(csv::IntoInnerError::into_error)
    }
}

/// The header alone.
pub(super) fn header(columns: &[Column]) -> io::Result<Vec<u8>> {
    let mut writer = writer(Vec::new());
    writer.write_record(names(columns))?;
    writer.into_inner().map_err(csv::IntoInnerError::into_error)
}

/// A row alone.
pub(super) fn line(cells: &mut dyn Iterator<Item = Cell<'_>>) -> io::Result<Vec<u8>> {
    let mut writer = writer(Vec::new());
    write_row(&mut writer, cells)?;
    writer.into_inner().map_err(csv::IntoInnerError::into_error)
}

fn writer<W: Write>(to: W) -> csv::Writer<W> {
    csv::WriterBuilder::new().terminator(csv::Terminator::Any(b'\n')).from_writer(to)
}

fn names(columns: &[Column]) -> impl Iterator<Item = &String> {
    columns.iter().map(|column| &column.name)
}

fn write_row<W: Write>(writer: &mut csv::Writer<W>, cells: &mut dyn Iterator<Item = Cell<'_>>) -> io::Result<()> {
    let mut text = String::new();
    for cell in cells {
        text.clear();
        append(&mut text, cell);
        writer.write_field(&text)?;
    }
    Ok(writer.write_record(None::<&[u8]>)?)
}
