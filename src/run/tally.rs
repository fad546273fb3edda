//! What the rows of a run come to: counts by reason, the spread of every column, and what the terminal shows. Memory does
//! not grow with the number of rows.

use super::noted::Texts;
use super::rows::{QUALITY, VEHICLES};
use super::spread::Spread;
use crate::output::{Numbers, OutputError, file_error};
use crate::table::{Layout, Shape};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// As many vehicles are named as worth a look.
const NAMED: usize = 3;

/// Egos that `run` speaks of at its end.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Remarkable {
    /// How many were clamped.
    pub clamped: u64,
    /// In how many steps.
    pub clamped_steps: u64,
    /// Those with the largest error RMS \[m/s\], the largest first.
    pub worst: Vec<(String, f64)>,
}

/// All rows, summed up.
#[derive(Debug, Clone, Default)]
pub struct Tallied {
    /// How many there are.
    pub vehicles: u64,
    /// How many ended for each reason.
    pub reasons: BTreeMap<String, u64>,
    /// The spread of every column that has numbers.
    pub fleet: BTreeMap<String, Spread>,
    /// Who is worth a word.
    pub remarkable: Remarkable,
}

/// Rows being summed up.
pub struct Tally {
    layouts: [Layout<Vec<String>>; 2],
    /// The columns that have a spread: table and place.
    columns: Vec<(usize, usize)>,
    numbers: Numbers,
    folder: PathBuf,
    places: [usize; 3],
    so_far: Tallied,
}

impl Tally {
    /// No row yet; what does not fit into memory will go to an unnamed file in `folder`.
    pub fn new(folder: &Path) -> Self {
        let shapes: [&Shape; 2] = [&VEHICLES.shape, &QUALITY.shape];
        let of_table = |table: usize| {
            let columns = shapes[table].columns.iter().enumerate().filter(|(_, column)| column.in_summary);
            columns.map(move |(place, _)| (table, place))
        };
        let columns: Vec<_> = (0..2).flat_map(of_table).collect();
        let numbers = Numbers::new(folder, columns.len());
        let place = |name| VEHICLES.place(name).expect("the table of vehicles has this column");
        let places = ["error_rms", "clamped_steps", "reason"].map(place);
        let layouts = shapes.map(Layout::of_texts);
        Self { layouts, columns, numbers, folder: folder.to_owned(), places, so_far: Tallied::default() }
    }

    /// Takes the rows of a vehicle.
    ///
    /// # Errors
    /// [`OutputError::File`], e.g. when the disk is full.
    pub fn add(&mut self, texts: &Texts) -> Result<(), OutputError> {
        for (column, (table, place)) in self.columns.iter().enumerate() {
            if let Some(number) = self.layouts[*table].cell(&texts[*table], *place).number() {
                self.numbers.push(column, number).map_err(file_error("write a file in", &self.folder))?;
            }
        }
        let [vehicle, _] = texts;
        let [error_rms, clamped_steps, reason] = self.places.map(|place| vehicle[place].as_str());
        let Tallied { vehicles, reasons, remarkable: Remarkable { clamped, clamped_steps: steps, worst }, .. } =
            &mut self.so_far;
        *vehicles += 1;
        *reasons.entry(reason.to_owned()).or_default() += 1;
        let its_steps: u64 = clamped_steps.parse().unwrap_or(0);
        *clamped += u64::from(its_steps > 0);
        *steps += its_steps;
        if let Some(rms) = error_rms.parse::<f64>().ok().filter(|rms| *rms > 0.0) {
            // Of equals the first is named.
            let place = worst.partition_point(|(_, theirs)| *theirs >= rms);
            worst.insert(place, (vehicle[0].clone(), rms));
            worst.truncate(NAMED);
        }
        Ok(())
    }

    /// What they come to.
    ///
    /// # Errors
    /// [`OutputError::File`] if the file cannot be read.
    pub fn finish(mut self) -> Result<Tallied, OutputError> {
        for (column, (table, place)) in self.columns.iter().enumerate() {
            let count = self.numbers.count(column);
            let spread = self.numbers.sorted(column).and_then(|numbers| Spread::of_sorted(count, numbers));
            let spread = spread.map_err(file_error("read a file in", &self.folder))?;
            let name = &self.layouts[*table].shape.columns[*place].name;
            self.so_far.fleet.extend(spread.map(|spread| (name.clone(), spread)));
        }
        Ok(self.so_far)
    }
}
