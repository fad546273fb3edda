//! A run in this process, from arguments to its result folder.

use crate::controller::catalog;
use crate::error::{plain, raised};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use sumo_mfc::cli::Planned;
use sumo_mfc::report;
use sumo_mfc::run::{Remote, RunResult, Signal, run_remote, terminal_text};

/// Time between two looks at signals, and two calls of the watcher.
const LOOK: Duration = Duration::from_millis(10);
const TELL: Duration = Duration::from_millis(100);

/// A run as the arguments of `sumo-mfc run` ask for it; checked, and not begun.
#[pyclass(frozen, module = "sumo_mfc._core")]
pub struct Plan {
    /// The scenario and how it is run.
    pub planned: Planned,
}

#[pymethods]
impl Plan {
    #[new]
    fn new(arguments: Vec<OsString>) -> PyResult<Self> {
        Planned::parse(&arguments, &catalog()).map(|planned| Self { planned }).map_err(raised)
    }

    /// The resolved scenario, in SI units, as TOML.
    fn toml(&self) -> String {
        self.planned.scenario.to_toml()
    }

    /// What the user should be told of the scenario.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.planned.scenario.notes.clone()
    }

    /// Runs to the end. `watch(begin_s, now_s, end_s)` is called ten times a second. A signal that Python answers with an
    /// exception ends the run: what was computed is in its folder, marked incomplete, and the exception goes on.
    ///
    /// Returns the folder, the summary as the command line prints it, and notes.
    #[pyo3(signature = (watch=None))]
    fn run(&self, py: Python<'_>, watch: Option<&Bound<'_, PyAny>>) -> PyResult<(PathBuf, String, Vec<String>)> {
        let Planned { scenario, options, report } = &self.planned;
        let remote = Remote::default();
        let mut stopped = None;
        let ended = std::thread::scope(|scope| {
            let run = scope.spawn(|| run_remote(scenario, options, &remote));
            let mut told = Instant::now();
            while !run.is_finished() {
                py.detach(|| std::thread::sleep(LOOK));
                if stopped.is_some() {
                    continue;
                }
                let mut looked = py.check_signals();
                if let (Ok(()), Some(watch), true) = (&looked, watch, told.elapsed() > TELL) {
                    told = Instant::now();
                    looked = tell(watch, &remote);
                }
                if let Err(error) = looked {
                    remote.raise(Signal::Interrupt);
                    stopped = Some(error);
                }
            }
            run.join()
        });
        if let Some(stopped) = stopped {
            return Err(stopped);
        }
        let RunResult { dir, summary, remarkable, files, notes, .. } =
            ended.map_err(|_| PyRuntimeError::new_err("the run has panicked"))?.map_err(raised)?;
        if *report {
            let request = report::Request { dirs: vec![dir.clone()], ..report::Request::default() };
            py.detach(|| report::report(&request))
                .map_err(|error| plain(format!("the result is whole, but its report could not be written: {error}")))?;
        }
        let text = terminal_text(&summary, &remarkable, &dir, &files);
        Ok((dir, text, notes))
    }
}

fn tell(watch: &Bound<'_, PyAny>, remote: &Remote) -> PyResult<()> {
    match remote.times() {
        Some(times) => watch.call1((times.begin_s, times.now_s, times.end_s)).map(drop),
        None => Ok(()),
    }
}
