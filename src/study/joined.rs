//! `vehicles.parquet`: all vehicles of all cases that are done.

use super::comparison::key_columns;
use super::plan::{Case, Plan};
use super::vehicle::Vehicle;
use super::vehicles::Vehicles;
use crate::output::{OutputError, Table};
use crate::table::{Cell, Column, Field, Kind, Layout};
use std::path::Path;
use std::sync::Arc;

/// Its name.
pub const JOINED: &str = "vehicles.parquet";

/// A vehicle and its case.
pub struct JoinedRow {
    case: u64,
    seed: u64,
    values: Arc<[String]>,
    vehicle: Vehicle,
}

/// `vehicles.parquet` of a study that varies these keys.
pub fn joined_layout(keys: &[String]) -> Layout<JoinedRow> {
    let mut columns = key_columns(keys, |row: &JoinedRow| &row.values);
    let count = |name: &str, meaning: &str| Column::new(name, Kind::Count, None, meaning);
    columns.push((count("case", "Number of the case"), Box::new(|row| Cell::Count(row.case))));
    columns.push((count("seed", "Seed"), Box::new(|row| Cell::Count(row.seed))));
    columns.extend(Vehicle::columns(count("", ""), |row: &JoinedRow| &row.vehicle));
    let meaning = "One row per vehicle of a case, case by case and by id, after a column per varied key; columns sumo_* are SUMO's own";
    Layout::new(["vehicles", "vehicle"], meaning, columns)
}

/// The table being written, case by case.
pub struct JoinedTable<'l>(Table<'l, JoinedRow>);

impl<'l> JoinedTable<'l> {
    /// Starts the table in the folder of a study.
    ///
    /// # Errors
    /// [`OutputError::File`] if it cannot be made.
    pub fn create(dir: &Path, layout: &'l Layout<JoinedRow>) -> Result<Self, OutputError> {
        Ok(Self(Table::create(&dir.join(JOINED), layout)?))
    }

    /// Adds the vehicles of a case.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the file, e.g. when the disk is full.
    pub fn add(&mut self, plan: &Plan, case: &Case, vehicles: Vehicles) -> Result<(), OutputError> {
        let values: Arc<[String]> = plan.settings[case.setting].values.clone().into();
        for vehicle in vehicles.into_all() {
            let row = JoinedRow { case: case.number as u64, seed: case.seed, values: values.clone(), vehicle };
            self.0.write(&row)?;
        }
        Ok(())
    }

    /// Completes the table.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the file.
    pub fn finish(self) -> Result<(), OutputError> {
        self.0.finish().map(drop)
    }
}
