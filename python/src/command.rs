//! The command line, and what of it needs no run.

use crate::controller::catalog;
use crate::error::{first_line, raised, spans};
use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;
use sumo_mfc::cli::{Call, main_of};
use sumo_mfc::report::{Request, report as write};
use sumo_mfc::study::Program;

/// Does what `sumo-mfc ARGUMENTS` does, and returns the exit code. `program` are the words that start this program again,
/// for the cases of studies. An error that ends it is also written into `errors`, if that is given, as JSON: its message, and the
/// places in files that it points to. Takes the process's signals for itself.
#[pyfunction]
#[pyo3(signature = (arguments, program, errors=None))]
pub fn main(py: Python<'_>, arguments: Vec<OsString>, program: Vec<OsString>, errors: Option<PathBuf>) -> u8 {
    let mut words = program.into_iter();
    let program = words.next().map(|file| Program::new(PathBuf::from(file), words.collect()));
    let note = move |report: &miette::Report| {
        let told = serde_json::json!({ "message": first_line(report), "spans": spans(report.as_ref()) });
        // Without the file the error has its text all the same.
        let _ = errors.as_ref().map(|file| std::fs::write(file, told.to_string()));
    };
    py.detach(|| main_of(&Call { program, arguments, catalog: &catalog(), failed: Some(&note) }))
}

/// What scenarios can choose from: (kind, name, summary), as `sumo-mfc list`.
#[pyfunction]
pub fn choices() -> Vec<(&'static str, &'static str, &'static str)> {
    let registries = catalog().registries();
    let of_kind = |(kind, entries): (_, Vec<sumo_mfc::registry::Entry<()>>)| {
        entries.into_iter().map(move |entry| (kind, entry.name, entry.summary))
    };
    registries.into_iter().flat_map(of_kind).collect()
}

/// Writes the page of one result folder, or of two side by side, and returns its path.
#[pyfunction]
#[pyo3(signature = (dirs, out=None, vehicle=None))]
pub fn report(py: Python<'_>, dirs: Vec<PathBuf>, out: Option<PathBuf>, vehicle: Option<String>) -> PyResult<PathBuf> {
    let request = Request { dirs, out, vehicle };
    py.detach(|| write(&request)).map(|written| written.page).map_err(raised)
}
