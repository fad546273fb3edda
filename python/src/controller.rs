//! Speed controllers written in Python: classes that command all vehicles of a group in one call.

use crate::error::plain;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, Mutex, PoisonError};
use sumo_mfc::control::{Build, GroupController, GroupPeriod, Law};
use sumo_mfc::keys::{Key, Kind, Value, Values};
use sumo_mfc::registry::Entry;
use sumo_mfc::scenario::Catalog;

/// The controllers that Python has registered.
static REGISTERED: Mutex<Vec<Entry<Build>>> = Mutex::new(Vec::new());

/// What can be chosen by name: what is installed, and what Python has registered.
pub fn catalog() -> Catalog {
    let registered = REGISTERED.lock().unwrap_or_else(PoisonError::into_inner);
    registered.iter().cloned().fold(Catalog::installed(), |catalog, entry| {
        catalog.with_controller(entry).expect("register() refuses names that are taken")
    })
}

/// Registers a controller under a name, in place of the one that Python registered under it before. `keys` are names, defaults
/// and one line of help each; `make(period_s, keys)` gives what is called once per control period.
#[pyfunction]
pub fn register(name: &str, summary: &str, keys: Vec<(String, f64, String)>, make: Py<PyAny>) -> PyResult<()> {
    let make = Arc::new(make);
    let build: Build = Arc::new(move |values, period_s| {
        Law::Group(Box::new(PythonLaw { make: make.clone(), values: values.clone(), period_s, called: None }))
    });
    let mut registered = REGISTERED.lock().unwrap_or_else(PoisonError::into_inner);
    // An entry lives as long as the process; so few are registered that what is replaced need not be freed.
    let keep = |text: String| -> &'static str { Box::leak(text.into_boxed_str()) };
    let key = |(name, default, help): (String, f64, String)| Key {
        name: keep(name),
        kind: Kind::Number { unit: "-", min: f64::MIN, max: f64::MAX },
        default: Some(Value::Number(default)),
        help: keep(help),
    };
    let keys: Vec<Key> = keys.into_iter().map(key).collect();
    let entry =
        Entry { name: keep(name.to_owned()), summary: keep(summary.to_owned()), keys: Box::leak(keys.into()), build };
    Catalog::installed().with_controller(entry.clone()).map_err(plain)?;
    registered.retain(|other| other.name != entry.name);
    registered.push(entry);
    Ok(())
}

/// One controller of one group. Its Python object is made when it is first called: a scenario is also built to be looked at.
struct PythonLaw {
    make: Arc<Py<PyAny>>,
    values: Values,
    period_s: f64,
    called: Option<Py<PyAny>>,
}

impl GroupController for PythonLaw {
    fn command(&mut self, group: &mut GroupPeriod) -> Result<(), String> {
        Python::attach(|py| self.call(py, group).map_err(|error| told(py, &error)))
    }
}

impl PythonLaw {
    fn call(&mut self, py: Python<'_>, group: &mut GroupPeriod) -> PyResult<()> {
        let called = match &self.called {
            Some(called) => called.clone_ref(py),
            None => {
                let keys = PyDict::new(py);
                for (name, value) in &self.values.0 {
                    if let Value::Number(value) = value {
                        keys.set_item(name, value)?;
                    }
                }
                let made = self.make.call1(py, (self.period_s, keys))?;
                self.called.insert(made).clone_ref(py)
            }
        };
        let flags = |column: &[bool]| PyArray1::from_slice(py, column);
        let numbers = |column: &[f64]| PyArray1::from_slice(py, column);
        let answer = called.bind(py).call1((
            flags(&group.drives),
            flags(&group.starts),
            numbers(&group.measured_mps),
            numbers(&group.reference_mps),
            numbers(&group.reference_rate_mps2),
            numbers(&group.nominal_nm_per_mps2),
            numbers(&group.commanded_mps2),
            numbers(&group.saturated_mps2),
            numbers(&group.applied_mps2),
        ))?;
        let torques_nm: PyReadonlyArray1<'_, f64> = answer.extract()?;
        for (i, torque_nm) in torques_nm.as_array().iter().enumerate() {
            if let (true, Some(slot)) = (group.drives[i], group.torque_nm.get_mut(i)) {
                *slot = *torque_nm;
            }
        }
        Ok(())
    }
}

/// The exception as Python prints it.
fn told(py: Python<'_>, error: &PyErr) -> String {
    let trace = error.traceback(py).and_then(|trace| trace.format().ok()).unwrap_or_default();
    format!("{trace}{error}")
}
