//! Reader of SUMO's `--tripinfo-output`
//! (<https://sumo.dlr.de/docs/Simulation/Output/TripInfo.html>), SUMO 1.15 to 1.28.

use super::error::SumoFileError;
use super::records::{self, Record};
use std::collections::{BTreeMap, VecDeque};
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
    /// By whom it was taken out before its end: `calibrator`, `collision`, `teleport`, `traci`, ...
    pub taken_out: Option<String>,
    /// Time since departure, up to arrival or to the end of the simulation \[s\].
    pub duration_s: f64,
    /// SUMO's time loss \[s\].
    pub time_loss_s: f64,
    /// Length driven \[m\].
    pub route_length_m: f64,
    /// Time slower than 0.1 m/s \[s\].
    pub waiting_time_s: Option<f64>,
    /// How often it became slower than 0.1 m/s.
    pub waiting_count: Option<f64>,
    /// Time at planned stops \[s\].
    pub stop_time_s: Option<f64>,
    /// Its speed over that of the limit, where nothing hinders it.
    pub speed_factor: Option<f64>,
    /// What it emitted and used, as [`EMISSIONS`], if SUMO was told to compute that.
    pub emissions: [Option<f64>; EMISSIONS.len()],
}

/// Attributes of the element `emissions`: sums over the trip in mg, electricity in Wh.
pub const EMISSIONS: [&str; 7] = ["CO_abs", "CO2_abs", "HC_abs", "PMx_abs", "NOx_abs", "fuel_abs", "electricity_abs"];

/// Calls `visit` with every trip of a file and its id, in the order of the file, without what it emitted. True if the file
/// is whole: it breaks off where SUMO was killed.
///
/// # Errors
/// [`SumoFileError::Unreadable`] if it cannot be read, [`SumoFileError::Content`] with the place if it is not what SUMO
/// writes, or `visit` says what is wrong.
pub fn each_trip(
    path: &Path,
    mut visit: impl FnMut(String, TripInfo) -> Result<(), String>,
) -> Result<bool, SumoFileError> {
    records::each(path, &["tripinfo"], |_, record| trip(record).and_then(|(id, trip)| visit(id, trip)))
}

/// All trips of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trips {
    /// The trips by vehicle, in the order of the file: an id may be used again once its vehicle has left.
    pub by_id: BTreeMap<String, VecDeque<TripInfo>>,
}

impl Trips {
    /// Reads a file as a stream.
    ///
    /// # Errors
    /// [`SumoFileError::Unreadable`] if it cannot be read, [`SumoFileError::Content`] with the place if it is not what SUMO writes.
    pub fn read(path: &Path) -> Result<Self, SumoFileError> {
        let mut trips = Self::default();
        let mut last = None;
        records::each(path, &["tripinfo", "emissions"], |element, record| {
            if element == "emissions" {
                // They stand inside the trip that was read last.
                let trip = last.as_ref().and_then(|id| trips.by_id.get_mut(id)?.back_mut());
                let found = EMISSIONS.map(|name| record.number(name).ok());
                if let Some(trip) = trip.filter(|_| found.iter().any(Option::is_some)) {
                    trip.emissions = found;
                }
                return Ok(());
            }
            let (id, trip) = trip(record)?;
            last = Some(id.clone());
            trips.by_id.entry(id).or_default().push_back(trip);
            Ok(())
        })?;
        Ok(trips)
    }

    /// All trips.
    pub fn all(&self) -> impl Iterator<Item = &TripInfo> {
        self.by_id.values().flatten()
    }
}

/// SUMO marks an unfinished trip by arrival −1 and one that was taken out by `vaporized`.
fn trip(record: &Record<'_>) -> Result<(String, TripInfo), String> {
    let arrival = record.number("arrival")?;
    let taken_out = record.text("vaporized");
    let trip = TripInfo {
        vehicle_type: record.text("vType").unwrap_or_default(),
        depart_s: record.number("depart")?,
        arrival_s: (arrival >= 0.0 && taken_out.is_none()).then_some(arrival),
        taken_out,
        duration_s: record.number("duration")?,
        time_loss_s: record.number("timeLoss")?,
        route_length_m: record.number("routeLength")?,
        waiting_time_s: record.number("waitingTime").ok(),
        waiting_count: record.number("waitingCount").ok(),
        stop_time_s: record.number("stopTime").ok(),
        speed_factor: record.number("speedFactor").ok(),
        emissions: Default::default(),
    };
    Ok((record.text("id").ok_or("no id")?, trip))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_are_none_are_refused_or_missing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.xml");
        let trip = |duration: &str, waiting: &str| {
            let numbers = "arrival=\"9\" depart=\"0\" timeLoss=\"0\" routeLength=\"1\"";
            let text =
                format!("<t>\n<tripinfo id=\"a\" {numbers} duration=\"{duration}\" waitingTime=\"{waiting}\"/></t>");
            std::fs::write(&path, text).unwrap();
            Trips::read(&path).map(|trips| trips.all().next().unwrap().waiting_time_s)
        };
        assert_eq!(trip("9", "1").unwrap(), Some(1.0));
        for none in ["nan", "-inf", "1e400", "1:nan:0"] {
            assert_eq!(trip("9", none).unwrap(), None);
            let error = trip(none, "1").unwrap_err().to_string();
            assert!(error.ends_with(&format!("a.xml:2: duration=\"{none}\" is no number in tripinfo")), "{error}");
        }
    }

    /// A byte of SUMO's own Parquet file is another one: some of these lengths make the crate panic.
    #[test]
    fn damaged_parquet_files_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.parquet");
        let whole = include_bytes!("../../tests/data/fuzz/tripinfo.parquet");
        let read = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            Trips::read(&path)
        };
        assert_eq!(read(whole).unwrap().all().count(), 1);
        let damaged = (4..whole.len()).step_by(3).filter(|at| {
            let mut bytes = whole.to_vec();
            bytes[*at] ^= 0x81;
            read(&bytes).is_err_and(|error| {
                let said = error.to_string();
                assert!(!said.contains("Some(") && !said.contains('{'), "for programmers: {said}");
                said.contains("a.parquet:")
            })
        });
        assert!(damaged.count() > 100);
    }
}
