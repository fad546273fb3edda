//! XML as SUMO writes it: values are attributes, a missing value is a missing attribute, rows of one time stand in one
//! `<timestep>`. There the attributes that SUMO's FCD output has too come first and in its order: SUMO's tools read with
//! patterns of it.

use super::atomic::PartFile;
use super::sink::Sink;
use super::text::append;
use crate::table::{Cell, Shape};
use quick_xml::escape::escape;
use std::io::{self, Write};

/// What SUMO's FCD output has, in its order.
const FCD: [&str; 6] = ["id", "x", "y", "angle", "speed", "lane"];

struct XmlSink {
    file: PartFile,
    shape: Shape,
    /// The places of the columns, in the order of the attributes.
    order: Vec<usize>,
    /// The time of the open `<timestep>`.
    time: Option<String>,
    text: String,
}

/// Writes the declaration and opens the root element.
pub(super) fn open(mut file: PartFile, shape: &Shape) -> io::Result<Box<dyn Sink>> {
    writeln!(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<{}>", shape.table)?;
    let rank = |name: &str| FCD.iter().position(|known| *known == name).unwrap_or(FCD.len());
    let mut order: Vec<usize> = (usize::from(shape.by_time)..shape.columns.len()).collect();
    if shape.by_time {
        order.sort_by_key(|place| rank(&shape.columns[*place].name));
    }
    Ok(Box::new(XmlSink { file, shape: shape.clone(), order, time: None, text: String::new() }))
}

impl Sink for XmlSink {
    fn row(&mut self, cells: &mut dyn Iterator<Item = Cell<'_>>) -> io::Result<()> {
        let cells: Vec<Cell<'_>> = cells.collect();
        if self.shape.by_time
            && let Some(time) = cells.first()
        {
            self.text.clear();
            append(&mut self.text, *time);
            if self.time.as_ref() != Some(&self.text) {
                self.end_timestep()?;
                writeln!(self.file, "    <timestep time=\"{}\">", self.text)?;
                self.time = Some(self.text.clone());
            }
        }
        let indent = if self.shape.by_time { "        " } else { "    " };
        write!(self.file, "{indent}<{}", self.shape.row)?;
        for place in &self.order {
            self.text.clear();
            append(&mut self.text, cells[*place]);
            if !self.text.is_empty() {
                let name = &self.shape.columns[*place].name;
                write!(self.file, " {name}=\"{}\"", escape(self.text.as_str()))?;
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
