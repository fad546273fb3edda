//! XML as SUMO writes it: values are attributes, a missing value is a missing attribute, rows of one time stand in one
//! `<timestep>`.

use super::PartFile;
use super::table::{Cell, Shape, Sink};
use quick_xml::escape::escape;
use std::io::{self, Write};

struct XmlSink {
    file: PartFile,
    table: &'static str,
    row: &'static str,
    by_time: bool,
    names: Vec<&'static str>,
    /// The time of the open `<timestep>`.
    time: Option<String>,
    /// The attributes of the present row.
    attributes: String,
    text: String,
}

/// Writes the declaration and opens the root element.
pub(super) fn open(mut file: PartFile, shape: &Shape) -> io::Result<Box<dyn Sink>> {
    writeln!(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<{}>", shape.table)?;
    Ok(Box::new(XmlSink {
        file,
        table: shape.table,
        row: shape.row,
        by_time: shape.by_time,
        names: shape.columns.iter().map(|(name, _)| *name).collect(),
        time: None,
        attributes: String::new(),
        text: String::new(),
    }))
}

impl Sink for XmlSink {
    fn cell(&mut self, column: usize, cell: Cell<'_>) -> io::Result<()> {
        self.text.clear();
        cell.append_to(&mut self.text);
        if column == 0 && self.by_time {
            if self.time.as_deref() != Some(self.text.as_str()) {
                self.end_timestep()?;
                writeln!(self.file, "    <timestep time=\"{}\">", self.text)?;
                self.time = Some(self.text.clone());
            }
        } else if !self.text.is_empty() {
            for part in [" ", self.names[column], "=\"", &escape(self.text.as_str()), "\""] {
                self.attributes.push_str(part);
            }
        }
        Ok(())
    }

    fn end_row(&mut self) -> io::Result<()> {
        let indent = if self.by_time { "        " } else { "    " };
        writeln!(self.file, "{indent}<{}{}/>", self.row, self.attributes)?;
        self.attributes.clear();
        Ok(())
    }

    fn end(mut self: Box<Self>) -> io::Result<PartFile> {
        self.end_timestep()?;
        writeln!(self.file, "</{}>", self.table)?;
        Ok(self.file)
    }
}

impl XmlSink {
    fn end_timestep(&mut self) -> io::Result<()> {
        if self.time.take().is_some() { writeln!(self.file, "    </timestep>") } else { Ok(()) }
    }
}
