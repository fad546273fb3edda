//! The vehicles of a run, from its tables and SUMO's outputs.

use super::vehicle::{OWN, Own, VEHICLE, Vehicle};
use crate::output::{OutputError, file_error};
use crate::sumo_files::{Conflicts, Trips};
use std::collections::BTreeMap;
use std::path::Path;

/// The column that SUMO's tripinfo has of vehicles that are no egos, too.
pub const TIME_LOSS: &str = "timeloss";

/// The vehicles of a run, by id; an id that is used again is another vehicle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Vehicles(BTreeMap<(String, usize), Vehicle>);

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

    /// Takes what SUMO's devices saw. If `all` vehicles have one, those that it does not mention were in no conflict. An id
    /// that is used again has one log, of which nobody knows to whom it belongs.
    pub fn take_conflicts(&mut self, conflicts: &BTreeMap<String, Conflicts>, all: bool) {
        let again: Vec<String> = self.0.keys().filter(|(_, again)| *again > 0).map(|(id, _)| id.clone()).collect();
        for vehicle in self.0.values_mut().filter(|vehicle| !again.contains(&vehicle.id)) {
            let seen = conflicts.get(&vehicle.id).copied().or(all.then(Conflicts::default));
            seen.iter().for_each(|seen| vehicle.sumo.take_conflicts(seen));
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

    /// A vehicle by its id and the number of earlier ones with it.
    pub fn get(&self, id: &(String, usize)) -> Option<&Vehicle> {
        self.0.get(id)
    }

    /// All vehicles, each with its id and the number of earlier ones with it.
    pub fn iter(&self) -> impl Iterator<Item = (&(String, usize), &Vehicle)> {
        self.0.iter()
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
        mean(&self.numbers(column))
    }

    /// Mean time loss of all that have one \[s\]: for egos that of our table, which is right also where bodies lead.
    pub fn time_loss_mean_s(&self) -> Option<f64> {
        mean(&self.0.values().filter_map(time_loss_s).collect::<Vec<f64>>())
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The time loss of a vehicle \[s\].
pub fn time_loss_s(vehicle: &Vehicle) -> Option<f64> {
    let ours = VEHICLE.place(TIME_LOSS).and_then(|place| VEHICLE.cell(vehicle, place).number());
    ours.or(vehicle.sumo.time_loss)
}
