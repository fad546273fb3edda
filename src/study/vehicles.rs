//! The vehicles of a run, to be paired with those of another: same seed, same demand, same id.

use super::metrics::{METRIC_COUNT, METRICS, TIME_LOSS};
use super::vehicle::{OWN, Own, VEHICLE, Vehicle};
use crate::output::{OutputError, file_error};
use crate::sumo_files::{Conflicts, Trips};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

/// The place in [`VEHICLE`] of the column that each metric averages.
static PLACES: LazyLock<[Option<usize>; METRIC_COUNT]> =
    LazyLock::new(|| METRICS.each_ref().map(|metric| metric.column.and_then(|column| VEHICLE.place(column))));

/// The vehicles of a run, by id; an id that is used again is another vehicle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Vehicles(BTreeMap<(String, usize), Vehicle>);

/// How the vehicles that arrived in both of two runs compare in a metric.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Pairs {
    /// How many.
    pub count: u64,
    /// How many have less of it.
    pub better: u64,
    /// The sum of their differences.
    pub difference: f64,
}

impl Vehicles {
    /// Takes what SUMO tells of all vehicles.
    pub fn of_trips(trips: &Trips) -> Self {
        let mut all = Self::default();
        for (id, trips) in &trips.by_id {
            for (again, trip) in trips.iter().enumerate() {
                let vehicle = all.entry(id, again);
                vehicle.arrived = trip.arrival_s.is_some();
                vehicle.sumo.take_trip(trip);
            }
        }
        all
    }

    fn entry(&mut self, id: &str, again: usize) -> &mut Vehicle {
        let new = || Vehicle { id: id.to_owned(), again, ..Vehicle::default() };
        self.0.entry((id.to_owned(), again)).or_insert_with(new)
    }

    /// Takes what SUMO's devices saw: those of all vehicles if they are on at all. An id that is used again has one log, of
    /// which nobody knows to whom it belongs.
    pub fn take_conflicts(&mut self, conflicts: &BTreeMap<String, Conflicts>) {
        let again: Vec<String> = self.0.keys().filter(|(_, again)| *again > 0).map(|(id, _)| id.clone()).collect();
        for vehicle in self.0.values_mut().filter(|vehicle| !again.contains(&vehicle.id)) {
            vehicle.sumo.take_conflicts(&conflicts.get(&vehicle.id).copied().unwrap_or_default());
        }
    }

    /// Takes a table of egos. A second one adds its columns.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the table.
    pub fn take_table(&mut self, table: &Path) -> Result<(), OutputError> {
        self.take_rows(table).map_err(|error| file_error("read", table)(error.into()))
    }

    fn take_rows(&mut self, table: &Path) -> Result<(), csv::Error> {
        let mut reader = csv::Reader::from_path(table)?;
        let headers = reader.headers()?.clone();
        let id = headers.iter().position(|header| header == "id").unwrap_or(0);
        let complete = headers.iter().position(|header| header == "complete");
        let own = |header: &str| OWN.iter().position(|column| column.name == header);
        let columns: Vec<Option<usize>> = headers.iter().map(own).collect();
        let (mut seen, mut row) = (BTreeMap::<String, usize>::new(), csv::StringRecord::new());
        while reader.read_record(&mut row)? {
            let id = row.get(id).unwrap_or_default();
            let again = *seen.entry(id.to_owned()).and_modify(|n| *n += 1).or_insert(0);
            let vehicle = self.entry(id, again);
            vehicle.arrived |= complete.and_then(|complete| row.get(complete)) == Some("true");
            let own = vehicle.own.get_or_insert_with(Own::empty);
            for (column, value) in columns.iter().zip(&row) {
                column.iter().for_each(|column| own.set(*column, value));
            }
        }
        Ok(())
    }

    /// All vehicles, in order of their ids.
    pub fn into_all(self) -> impl Iterator<Item = Vehicle> {
        self.0.into_values()
    }

    /// The values of a column.
    pub fn numbers(&self, column: &str) -> Vec<f64> {
        let place = VEHICLE.place(column);
        self.0.values().filter_map(|vehicle| VEHICLE.cell(vehicle, place?).number()).collect()
    }

    /// Mean of a column over the vehicles that have a value in it.
    pub fn mean(&self, column: &str) -> Option<f64> {
        let values = self.numbers(column);
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }

    /// Mean time loss of all that have one \[s\]: for egos that of our table, which is right also where bodies lead.
    pub fn time_loss_mean_s(&self) -> Option<f64> {
        let losses: Vec<f64> = self.0.values().filter_map(time_loss_s).collect();
        (!losses.is_empty()).then(|| losses.iter().sum::<f64>() / losses.len() as f64)
    }

    /// Compares the vehicles that arrived in both runs, metric by metric.
    pub fn pairs(&self, reference: &Self) -> [Pairs; METRIC_COUNT] {
        let mut pairs = [Pairs::default(); METRIC_COUNT];
        let own = self.0.iter().filter(|(_, vehicle)| vehicle.arrived);
        let both = own.filter_map(|(id, v)| Some((v, reference.0.get(id).filter(|other| other.arrived)?)));
        for (own, other) in both {
            for (pairs, (own, other)) in pairs.iter_mut().zip(values(own).zip(values(other))) {
                let (Some(own), Some(other)) = (own, other) else { continue };
                pairs.count += 1;
                pairs.better += u64::from(own < other);
                pairs.difference += own - other;
            }
        }
        pairs
    }
}

/// The time loss of a vehicle \[s\].
fn time_loss_s(vehicle: &Vehicle) -> Option<f64> {
    let ours = VEHICLE.place(TIME_LOSS).and_then(|place| VEHICLE.cell(vehicle, place).number());
    ours.or(vehicle.sumo.time_loss)
}

/// What the metrics average, as [`METRICS`].
fn values(vehicle: &Vehicle) -> impl Iterator<Item = Option<f64>> {
    PLACES.iter().zip(&METRICS).map(move |(place, metric)| match metric.column {
        Some(TIME_LOSS) => time_loss_s(vehicle),
        _ => place.and_then(|place| VEHICLE.cell(vehicle, place).number()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(table: &str, trips: &[(&str, f64, bool)]) -> Vehicles {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("vehicles.csv"), table).unwrap();
        let trips = trips.iter().map(|(id, loss, arrived)| {
            let arrival = if *arrived { 9 } else { -1 };
            format!(
                r#"<tripinfo id="{id}" depart="0" arrival="{arrival}" duration="9" timeLoss="{loss}" routeLength="1"/>"#
            )
        });
        let text = format!("<tripinfos>{}</tripinfos>", trips.collect::<String>());
        std::fs::write(path("trips.xml"), text).unwrap();
        let mut all = Vehicles::of_trips(&Trips::read(&path("trips.xml")).unwrap());
        all.take_table(&path("vehicles.csv")).unwrap();
        all
    }

    fn place(name: &str) -> usize {
        METRICS.iter().position(|metric| metric.name == name).unwrap()
    }

    #[test]
    fn only_vehicles_that_arrived_in_both_runs_are_paired() {
        let ours = "id,error_rms,complete\na,0.5,true\nb,0.1,true\nc,0.2,false\n";
        let own = read(ours, &[("a", 3.0, true), ("b", 2.0, true), ("c", 0.0, false), ("d", 1.0, true)]);
        let theirs = "id,error_rms,complete\na,0.25,true\nb,0.4,true\nc,0.9,true\n";
        let reference = read(theirs, &[("a", 3.0, true), ("b", 5.0, true), ("c", 8.0, true), ("d", 0.0, false)]);
        let pairs = own.pairs(&reference);
        let error = pairs[place("error_rms_mean")];
        assert_eq!((error.count, error.better), (2, 1));
        assert!((error.difference - (0.25 - 0.3)).abs() < 1e-12);
        assert_eq!(pairs[place("timeloss_mean")], Pairs { count: 2, better: 1, difference: -3.0 });
        assert_eq!(pairs[place("arrived")], Pairs::default());
        assert_eq!(own.pairs(&own)[place("timeloss_mean")], Pairs { count: 3, better: 0, difference: 0.0 });
    }

    #[test]
    fn an_ego_has_the_time_loss_of_our_table() {
        let own = read("id,timeloss,complete\na,5,true\n", &[("a", 900.0, true), ("b", 1.0, true)]);
        assert_eq!(own.time_loss_mean_s(), Some(3.0));
        let reference = read("id,timeloss,complete\na,7,true\n", &[("a", 1.0, true), ("b", 1.0, true)]);
        assert_eq!(own.pairs(&reference)[place("timeloss_mean")], Pairs { count: 2, better: 1, difference: -2.0 });
        assert_eq!(read("id,complete\n", &[]).time_loss_mean_s(), None);
    }

    #[test]
    fn an_id_that_is_used_again_is_another_vehicle() {
        let table = "id,error_rms,complete\na,1,true\na,2,true\n";
        let own = read(table, &[("a", 3.0, true), ("a", 4.0, true)]);
        let second = &own.0[&("a".to_owned(), 1)];
        assert_eq!(values(second).nth(place("error_rms_mean")), Some(Some(2.0)));
        assert_eq!(own.pairs(&own)[place("timeloss_mean")].count, 2);
    }
}
