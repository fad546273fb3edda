//! The rows of egos while the run goes on: on disk from the end of the step in which a vehicle has left, in the order of
//! leaving. Memory does not grow with them.

use super::result_dir::ResultDir;
use super::rows::{QUALITY, QualityRow, VEHICLES, VehicleRow, milliseconds};
use crate::cosim::Finished;
use crate::output::{Journal, OutputError};
use crate::scenario::{Scenario, Trace};
use std::collections::BTreeSet;

/// The texts of a vehicle's row, and of that of its drive quality.
pub type Texts = [Vec<String>; 2];

/// The rows so far.
pub struct Noted {
    vehicles: Journal<VehicleRow>,
    quality: Journal<QualityRow>,
    /// Whether there is a table of drive quality; the summary has it in any case.
    shows_quality: bool,
    /// Rows that could not be written, and those of vehicles on the road at the end.
    rest: Vec<Finished>,
    /// How many there are.
    pub count: u64,
    /// The groups that drove any of them.
    pub groups: BTreeSet<usize>,
    /// Ids of the trace that none of them has had.
    pub untraced: BTreeSet<String>,
}

impl Noted {
    /// Opens the journals.
    pub fn create(scenario: &Scenario, dir: &ResultDir) -> Result<Self, OutputError> {
        let output = &scenario.output;
        let vehicles = Journal::create(&dir.file(&output.vehicles), &VEHICLES)?;
        let open = if output.quality { Journal::create } else { Journal::unnamed };
        let quality = open(&dir.file("quality.csv"), &QUALITY)?;
        let untraced = match &output.trace {
            Trace::Ids(ids) => ids.iter().cloned().collect(),
            _ => BTreeSet::new(),
        };
        let (rest, groups) = (Vec::new(), BTreeSet::new());
        Ok(Self { vehicles, quality, shows_quality: output.quality, rest, count: 0, groups, untraced })
    }

    /// Rows of vehicles that have left: whatever happens now, they are kept.
    ///
    /// # Errors
    /// [`OutputError::File`]; then they are kept in memory.
    pub fn note(&mut self, new: Vec<Finished>, scenario: &Scenario, time_s: f64) -> Result<(), OutputError> {
        if new.is_empty() {
            return Ok(());
        }
        let rows: Vec<_> = new.iter().map(|record| first_row(record, scenario, time_s)).collect();
        let quality: Vec<_> = new.iter().zip(&rows).map(|(record, row)| quality_row(record, row)).collect();
        // Both or none, so that the journals go together.
        let before = self.vehicles.len();
        let written = self.vehicles.append(&rows).and_then(|()| self.quality.append(&quality));
        match written {
            Ok(()) => self.count(&new),
            Err(_) => {
                self.vehicles.cut(before);
                self.note_rest(new);
            }
        }
        written
    }

    /// Rows of vehicles that are on the road at the end.
    pub fn note_rest(&mut self, rest: Vec<Finished>) {
        self.count(&rest);
        self.rest.extend(rest);
    }

    fn count(&mut self, new: &[Finished]) {
        self.count += new.len() as u64;
        for record in new {
            self.groups.insert(record.group);
            self.untraced.remove(&*record.id);
        }
    }

    /// Calls `visit` with every row, in the order of leaving.
    ///
    /// # Errors
    /// [`OutputError::File`] if a journal cannot be read, and those of `visit`.
    pub fn each(
        &self,
        scenario: &Scenario,
        time_s: f64,
        mut visit: impl FnMut(Texts) -> Result<(), OutputError>,
    ) -> Result<(), OutputError> {
        for (vehicle, quality) in self.vehicles.texts().zip(self.quality.texts()) {
            visit([vehicle?, quality?])?;
        }
        for record in &self.rest {
            let row = first_row(record, scenario, time_s);
            visit([self.vehicles.texts_of(&row), self.quality.texts_of(&quality_row(record, &row))])?;
        }
        Ok(())
    }

    /// Writes the tables, which take the place of the journals.
    ///
    /// # Errors
    /// [`OutputError`]; the journals stay then.
    pub fn finish<I>(&self, rows: impl Fn() -> I) -> Result<(), OutputError>
    where
        I: Iterator<Item = Result<Texts, OutputError>>,
    {
        self.vehicles.finish(rows().map(|row| row.map(|[vehicle, _]| vehicle)))?;
        if self.shows_quality {
            self.quality.finish(rows().map(|row| row.map(|[_, quality]| quality)))?;
        }
        Ok(())
    }
}

/// The drive quality of an ego, beside its row.
fn quality_row(record: &Finished, row: &VehicleRow) -> QualityRow {
    let (id, depart) = (row.id.clone(), row.depart);
    QualityRow { id, depart, quality: record.quality, string_gain: record.string_gain }
}

/// The row of an ego as far as it is known without SUMO's tripinfo.
fn first_row(record: &Finished, scenario: &Scenario, end_s: f64) -> VehicleRow {
    let group = &scenario.groups[record.group];
    let depart = milliseconds(record.depart_s);
    VehicleRow {
        id: record.id.to_string(),
        vehicle_type: record.type_id.as_str().into(),
        controller: group.controller.name(),
        target: group.target.name(),
        depart,
        arrival: record.arrival_s.map(milliseconds),
        duration: Some(milliseconds(record.arrival_s.unwrap_or(end_s) - depart)),
        timeloss: record.time_loss_s,
        distance: Some(record.distance_m),
        stats: record.stats,
        odometer_gap: record.odometer_gap_m,
        collisions: u64::from(record.collisions),
        reason: record.reason,
    }
}
