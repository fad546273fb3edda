//! Reader of SUMO's `--tripinfo-output`
//! (<https://sumo.dlr.de/docs/Simulation/Output/TripInfo.html>), SUMO 1.15 to 1.28.

use super::error::SumoFileError;
use super::xml::{Element, Xml};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

/// One trip as SUMO tells it.
#[derive(Debug, Clone, PartialEq)]
pub struct TripInfo {
    /// The vehicle's type.
    pub vehicle_type: String,
    /// When it departed \[s\].
    pub depart_s: f64,
    /// When it arrived; `None` if it was still under way or was taken out before its end \[s\].
    pub arrival_s: Option<f64>,
    /// Time since departure, up to arrival or to the end of the simulation \[s\].
    pub duration_s: f64,
    /// SUMO's time loss \[s\].
    pub time_loss_s: f64,
    /// Length driven \[m\].
    pub route_length_m: f64,
}

/// All trips of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trips {
    /// The trips by vehicle.
    pub by_id: BTreeMap<String, TripInfo>,
    /// False if the file breaks off, because SUMO was killed: then the last trips are missing.
    pub whole: bool,
}

impl Trips {
    /// Reads a file as a stream.
    ///
    /// # Errors
    /// [`SumoFileError::Unreadable`] if it cannot be read, [`SumoFileError::Content`] with the place if it is not what SUMO writes.
    pub fn read(path: &Path) -> Result<Self, SumoFileError> {
        let mut trips = Self::default();
        let mut xml = Xml::open(path)?;
        xml.each(|element| {
            if element.name() == "tripinfo" {
                let (id, trip) = trip(element)?;
                trips.by_id.insert(id, trip);
            }
            Ok(ControlFlow::Continue(()))
        })?;
        trips.whole = xml.is_whole();
        Ok(trips)
    }

    /// Vehicles that arrived, and their mean time loss \[s\] if there are any.
    pub fn arrivals(&self) -> (u64, Option<f64>) {
        let losses = || self.by_id.values().filter(|t| t.arrival_s.is_some()).map(|t| t.time_loss_s);
        let count = losses().count();
        (count as u64, (count > 0).then(|| losses().sum::<f64>() / count as f64))
    }
}

/// SUMO marks an unfinished trip by arrival −1 and one that was taken out by `vaporized`.
fn trip(element: &Element<'_>) -> Result<(String, TripInfo), String> {
    let number = |name| element.number(name)?.ok_or_else(|| format!("tripinfo without {name}"));
    let vaporized = element.attribute("vaporized").is_some_and(|v| !v.is_empty());
    let arrival = number("arrival")?;
    let trip = TripInfo {
        vehicle_type: element.attribute("vType").unwrap_or_default(),
        depart_s: number("depart")?,
        arrival_s: (arrival >= 0.0 && !vaporized).then_some(arrival),
        duration_s: number("duration")?,
        time_loss_s: number("timeLoss")?,
        route_length_m: number("routeLength")?,
    };
    Ok((element.attribute("id").ok_or("tripinfo without id")?, trip))
}
