//! Reader of SUMO's `--statistic-output`
//! (<https://sumo.dlr.de/docs/Simulation/Output/StatisticOutput.html>), SUMO 1.15 to 1.28.

use super::error::SumoFileError;
use super::xml::Xml;
use std::ops::ControlFlow;
use std::path::Path;

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
        let mut xml = Xml::open(path)?;
        xml.each(|element| {
            let count = |name| {
                let value = element.number(name)?;
                value.map(|x| x as u64).ok_or_else(|| format!("no {name} in {}", element.name()))
            };
            match element.name() {
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
                _ => return Ok(ControlFlow::Continue(())),
            }
            found += 1;
            Ok(ControlFlow::Continue(()))
        })?;
        if found < 3 {
            return Err(xml.error("vehicles, teleports or safety is missing".to_owned()));
        }
        Ok(statistics)
    }
}

#[cfg(test)]
mod tests;
