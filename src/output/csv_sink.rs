//! Comma-separated text: `\n` at line ends, quotes only where a value needs them.

use super::PartFile;
use super::table::{Cell, Shape, Sink};
use std::io;

struct CsvSink {
    writer: csv::Writer<PartFile>,
    text: String,
}

/// Writes the header.
pub(super) fn open(file: PartFile, shape: &Shape) -> io::Result<Box<dyn Sink>> {
    let mut writer = csv::WriterBuilder::new().terminator(csv::Terminator::Any(b'\n')).from_writer(file);
    writer.write_record(shape.columns.iter().map(|(name, _)| name))?;
    Ok(Box::new(CsvSink { writer, text: String::new() }))
}

impl Sink for CsvSink {
    fn cell(&mut self, _column: usize, cell: Cell<'_>) -> io::Result<()> {
        self.text.clear();
        cell.append_to(&mut self.text);
        Ok(self.writer.write_field(&self.text)?)
    }

    fn end_row(&mut self) -> io::Result<()> {
        Ok(self.writer.write_record(None::<&[u8]>)?)
    }

    fn end(self: Box<Self>) -> io::Result<PartFile> {
        self.writer.into_inner().map_err(csv::IntoInnerError::into_error)
    }
}
