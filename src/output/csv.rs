//! Comma-separated text: `\n` at line ends, quotes only where a value needs them.

use super::atomic::PartFile;
use super::sink::Sink;
use super::text::append;
use crate::table::{Cell, Shape};
use std::io;

struct CsvSink {
    writer: csv::Writer<PartFile>,
    text: String,
}

/// Writes the header.
pub(super) fn open(file: PartFile, shape: &Shape) -> io::Result<Box<dyn Sink>> {
    let mut writer = csv::WriterBuilder::new().terminator(csv::Terminator::Any(b'\n')).from_writer(file);
    writer.write_record(shape.columns.iter().map(|column| &column.name))?;
    Ok(Box::new(CsvSink { writer, text: String::new() }))
}

impl Sink for CsvSink {
    fn row(&mut self, cells: &mut dyn Iterator<Item = Cell<'_>>) -> io::Result<()> {
        for cell in cells {
            self.text.clear();
            append(&mut self.text, cell);
            self.writer.write_field(&self.text)?;
        }
        Ok(self.writer.write_record(None::<&[u8]>)?)
    }

    fn end(self: Box<Self>) -> io::Result<PartFile> {
        self.writer.into_inner().map_err(csv::IntoInnerError::into_error)
    }
}
