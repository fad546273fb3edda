//! What the egos show at the end of a step, in memory that NumPy looks into: filled once a step, not copied when it is looked at.

use crate::error::plain;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PySlice, PyTuple};
use std::sync::Arc;
use sumo_mfc::run::TraceRow;

/// A column, and how it is read off an ego.
type Column = (&'static str, fn(&TraceRow) -> f64);

/// The columns of numbers of `trace.csv`, and `error`.
const COLUMNS: [Column; 13] = [
    ("target", |ego| ego.target),
    ("reference", |ego| ego.reference),
    ("speed", |ego| ego.speed),
    ("error", |ego| ego.speed - ego.reference),
    ("measured_speed", |ego| ego.measured_speed),
    ("lateral_speed", |ego| ego.lateral_speed),
    ("yaw_rate", |ego| ego.yaw_rate),
    ("slip_front", |ego| ego.slip_front),
    ("slip_rear", |ego| ego.slip_rear),
    ("torque", |ego| ego.torque),
    ("alpha_hat", |ego| ego.alpha_hat),
    ("f_hat", |ego| ego.f_hat),
    ("distance", |ego| ego.distance),
];

/// Egos for which there is room at first.
const ROOM: usize = 64;

/// The columns, and the arrays that look into them.
///
/// The memory is an array of NumPy's own, one row per column, so that an array that somebody holds keeps it alive. When there are more
/// egos than fit, a larger one takes its place, and arrays of the old one stay as they were.
pub struct Views {
    memory: Py<PyArray2<f64>>,
    room: usize,
    ids: Vec<Arc<str>>,
    told_ids: Option<Py<PyTuple>>,
    /// Made when they are first asked for, and used until the number of egos changes.
    arrays: [Option<Py<PyArray1<f64>>>; COLUMNS.len()],
}

impl Views {
    /// Nobody is on the road.
    pub fn new(py: Python<'_>) -> Self {
        let arrays = [const { None }; COLUMNS.len()];
        Self { memory: memory(py, ROOM), room: ROOM, ids: Vec::new(), told_ids: None, arrays }
    }

    /// Takes what the egos show now.
    pub fn fill(&mut self, py: Python<'_>, egos: &[TraceRow]) -> PyResult<()> {
        if egos.len() != self.ids.len() {
            self.arrays = [const { None }; COLUMNS.len()];
        }
        if egos.len() > self.room {
            self.room = egos.len().next_power_of_two();
            self.memory = memory(py, self.room);
        }
        let mut memory = self.memory.bind(py).try_readwrite().map_err(plain)?;
        let numbers = memory.as_slice_mut().map_err(plain)?;
        for (row, (_, read)) in numbers.chunks_exact_mut(self.room).zip(COLUMNS) {
            row.iter_mut().zip(egos).for_each(|(number, ego)| *number = read(ego));
        }
        if !egos.iter().map(|ego| &ego.id).eq(&self.ids) {
            self.ids = egos.iter().map(|ego| ego.id.clone()).collect();
            self.told_ids = None;
        }
        Ok(())
    }

    /// The ids of the egos.
    pub fn ids<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        if self.told_ids.is_none() {
            self.told_ids = Some(PyTuple::new(py, self.ids.iter().map(|id| &**id))?.unbind());
        }
        Ok(self.told_ids.as_ref().expect("it was made").bind(py).clone())
    }

    /// The array that looks at a column.
    pub fn column<'py>(&mut self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let Some(place) = COLUMNS.iter().position(|(known, _)| *known == name) else {
            let known: Vec<&str> = COLUMNS.iter().map(|(known, _)| *known).collect();
            return Err(plain(format!("found the column {name}, wanted one of {}", known.join(", "))));
        };
        if let Some(array) = &self.arrays[place] {
            return Ok(array.bind(py).clone());
        }
        let taken = PySlice::new(py, 0, isize::try_from(self.ids.len())?, 1);
        let array = self.memory.bind(py).get_item((place, taken))?.cast_into::<PyArray1<f64>>()?;
        array.try_readwrite().map_err(plain)?.make_nonwriteable();
        self.arrays[place] = Some(array.clone().unbind());
        Ok(array)
    }
}

fn memory(py: Python<'_>, room: usize) -> Py<PyArray2<f64>> {
    PyArray2::zeros(py, [COLUMNS.len(), room], false).unbind()
}
