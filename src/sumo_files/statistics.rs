//! Reader of SUMO's `--statistic-output`
//! (<https://sumo.dlr.de/docs/Simulation/Output/StatisticOutput.html>), SUMO 1.15 to 1.28.

use super::error::SumoFileError;
use super::records;
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
        records::each(path, &["vehicles", "teleports", "safety"], |element, record| {
            let count = |name| record.number(name).map(|x| x as u64);
            match element {
                "vehicles" => {
                    statistics.loaded = count("loaded")?;
                    statistics.inserted = count("inserted")?;
                    statistics.running = count("running")?;
                    statistics.waiting = count("waiting")?;
                }
                "teleports" => statistics.teleports = count("total")?,
                _ => {
                    statistics.collisions = count("collisions")?;
                    statistics.emergency_stops = count("emergencyStops")?;
                }
            }
            found += 1;
            Ok(())
        })?;
        if found < 3 {
            let what = "vehicles, teleports or safety is missing".to_owned();
            return Err(SumoFileError::Content { path: path.to_owned(), line: 1, what });
        }
        Ok(statistics)
    }
}

#[cfg(test)]
mod tests;
