//! XML as SUMO writes it: values are attributes, a missing value is a missing attribute, rows of one time stand in one
//! `<timestep>`.

use super::atomic::PartFile;
use super::sink::Sink;
use super::text::append;
use crate::table::{Cell, Shape};
use quick_xml::escape::escape;
use std::io::{self, Write};

struct XmlSink {
    file: PartFile,
    shape: Shape,
    /// The time of the open `<timestep>`.
    time: Option<String>,
    text: String,
}

/// Writes the declaration and opens the root element.
pub(super) fn open(mut file: PartFile, shape: &Shape) -> io::Result<Box<dyn Sink>> {
    writeln!(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<{}>", shape.table)?;
    Ok(Box::new(XmlSink { file, shape: shape.clone(), time: None, text: String::new() }))
}

impl Sink for XmlSink {
    fn row(&mut self, cells: &mut dyn Iterator<Item = Cell<'_>>) -> io::Result<()> {
        if self.shape.by_time
            && let Some(time) = cells.next()
        {
            self.text.clear();
            append(&mut self.text, time);
            if self.time.as_ref() != Some(&self.text) {
                self.end_timestep()?;
                writeln!(self.file, "    <timestep time=\"{}\">", self.text)?;
                self.time = Some(self.text.clone());
            }
        }
        let indent = if self.shape.by_time { "        " } else { "    " };
        write!(self.file, "{indent}<{}", self.shape.row)?;
        let columns = &self.shape.columns[usize::from(self.shape.by_time)..];
        for (column, cell) in columns.iter().zip(cells) {
            self.text.clear();
            append(&mut self.text, cell);
            if !self.text.is_empty() {
                write!(self.file, " {}=\"{}\"", column.name, escape(self.text.as_str()))?;
            }
        }
        writeln!(self.file, "/>")
    }

    fn end(mut self: Box<Self>) -> io::Result<PartFile> {
        self.end_timestep()?;
        writeln!(self.file, "</{}>", self.shape.table)?;
        Ok(self.file)
    }
}

impl XmlSink {
    fn end_timestep(&mut self) -> io::Result<()> {
        if self.time.take().is_some() { writeln!(self.file, "    </timestep>") } else { Ok(()) }
    }
}
