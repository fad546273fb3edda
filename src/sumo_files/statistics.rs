//! Reader of SUMO's `--statistic-output`
//! (<https://sumo.dlr.de/docs/Simulation/Output/StatisticOutput.html>), SUMO 1.15 to 1.28, and what both readers of
//! SUMO's XML share.

use super::error::{SumoFileError, unreadable};
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// SUMO's own counts at the end of a simulation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SumoStatistics {
    /// Vehicles read from the demand.
    pub loaded: u64,
    /// Vehicles that entered the road.
    pub inserted: u64,
    /// Vehicles on the road at the end.
    pub running: u64,
    /// Vehicles that found no place to enter.
    pub waiting: u64,
    /// Teleports.
    pub teleports: u64,
    /// Collisions.
    pub collisions: u64,
    /// Emergency stops.
    pub emergency_stops: u64,
}

impl SumoStatistics {
    /// Reads a file.
    ///
    /// # Errors
    /// [`SumoFileError::Unreadable`] if it cannot be read, [`SumoFileError::Content`] with the place if it is not what SUMO writes.
    pub fn read(path: &Path) -> Result<Self, SumoFileError> {
        let mut statistics = Self::default();
        let mut found = 0;
        let mut elements = Elements::open(path)?;
        elements.each(|element| {
            let count = |name| {
                let value = attribute_number(element, name)?;
                value.map(|x| x as u64).ok_or_else(|| format!("no {name} in {}", element.name().as_ref()))
            };
            match element.name().as_ref() {
                "vehicles" => {
                    statistics.loaded = count("loaded")?;
                    statistics.inserted = count("inserted")?;
                    statistics.running = count("running")?;
                    statistics.waiting = count("waiting")?;
                }
                "teleports" => statistics.teleports = count("total")?,
                "safety" => {
                    statistics.collisions = count("collisions")?;
                    statistics.emergency_stops = count("emergencyStops")?;
                }
                _ => return Ok(()),
            }
            found += 1;
            Ok(())
        })?;
        if found < 3 {
            return Err(elements.error("vehicles, teleports or safety is missing".into()));
        }
        Ok(statistics)
    }
}

/// A number among an element's attributes.
pub(super) fn attribute_number(element: &BytesStart<'_>, name: &str) -> Result<Option<f64>, String> {
    let Some(attribute) = element.try_get_attribute(name).map_err(|e| e.to_string())? else { return Ok(None) };
    let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|e| e.to_string())?;
    value.parse().map(Some).map_err(|_| format!("{name}=\"{value}\" is not a number"))
}

/// The elements of an XML file, one after the other.
pub(super) struct Elements {
    path: PathBuf,
    reader: Reader<BufReader<File>>,
}

impl Elements {
    pub fn open(path: &Path) -> Result<Self, SumoFileError> {
        let file = File::open(path).map_err(unreadable(path))?;
        Ok(Self { path: path.to_owned(), reader: Reader::from_reader(BufReader::new(file)) })
    }

    /// Calls `visit` with every element. False if the file breaks off before its root is closed.
    pub fn each(
        &mut self,
        mut visit: impl FnMut(&BytesStart<'_>) -> Result<(), String>,
    ) -> Result<bool, SumoFileError> {
        let (mut buffer, mut depth, mut seen) = (Vec::new(), 0_usize, false);
        loop {
            buffer.clear();
            let visited = match self.reader.read_event_into(&mut buffer) {
                Ok(Event::Start(element)) => {
                    depth += 1;
                    seen = true;
                    visit(&element)
                }
                Ok(Event::Empty(element)) => visit(&element),
                Ok(Event::End(_)) => {
                    depth -= 1;
                    Ok(())
                }
                Ok(Event::Eof) => return Ok(seen && depth == 0),
                Ok(_) => Ok(()),
                Err(quick_xml::Error::Io(source)) => {
                    let source = std::io::Error::new(source.kind(), source);
                    return Err(unreadable(&self.path)(source));
                }
                // A tag, comment or quote that the file does not end: it was cut there.
                Err(quick_xml::Error::Syntax(_)) => return Ok(false),
                Err(other) => Err(other.to_string()),
            };
            visited.map_err(|what| self.error(what))?;
        }
    }

    pub fn error(&self, what: String) -> SumoFileError {
        SumoFileError::Content { path: self.path.clone(), offset: self.reader.buffer_position(), what }
    }
}

#[cfg(test)]
mod tests;
