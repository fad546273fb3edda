//! Errors as the exception `sumo_mfc.Error`: the text that the command line prints, and the places that it points to.

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, Report};
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use sumo_mfc::cli::Usage;

pyo3::create_exception!(
    sumo_mfc,
    Error,
    PyException,
    "What the command line would tell: str() is its text, `message` the first line of it, `spans` the places in files that \
     it points to, as (file, line, column), counted from 1."
);

/// An error of any part of the library.
pub fn raised(error: impl Into<Report>) -> PyErr {
    let report = error.into();
    let text = if report.downcast_ref::<Usage>().is_some() { report.to_string() } else { drawn(&report) };
    Python::attach(|py| {
        let error = Error::new_err(text);
        let value = error.value(py);
        let _ = value.setattr("message", first_line(&report));
        let _ = value.setattr("spans", spans(&*report));
        error
    })
}

/// An error that is no diagnostic.
pub fn plain(error: impl std::fmt::Display) -> PyErr {
    raised(miette::miette!("{error}"))
}

/// The report as the command line prints it, without colours.
fn drawn(report: &Report) -> String {
    let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor());
    let mut text = String::new();
    match handler.with_wrap_lines(false).without_cause_chain().render_report(&mut text, report.as_ref()) {
        Ok(()) => text.trim_end().to_owned(),
        Err(_) => report.to_string(),
    }
}

/// The message without what explains it.
pub fn first_line(report: &Report) -> String {
    report.to_string().lines().next().unwrap_or_default().to_owned()
}

/// File, line and column of every label, those of related errors included.
pub fn spans(report: &dyn Diagnostic) -> Vec<(String, usize, usize)> {
    let labels = report.labels().into_iter().flatten();
    let own = labels.filter_map(|label| {
        let found = report.source_code()?.read_span(label.inner(), 0, 0).ok()?;
        Some((found.name().unwrap_or_default().to_owned(), found.line() + 1, found.column() + 1))
    });
    own.chain(report.related().into_iter().flatten().flat_map(spans)).collect()
}
