//! A run step by step, between whose steps Python looks at the egos and gives orders.

use crate::error::{plain, raised};
use crate::plan::Plan;
use crate::views::Views;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use rayon::ThreadPool;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use sumo_mfc::cosim::OrderError;
use sumo_mfc::run::{self, RunError, RunResult, terminal_text};
use tokio::runtime::Runtime;

/// How often Python's signals are looked after while SUMO computes.
const LOOK: Duration = Duration::from_millis(100);

/// A run step by step.
#[pyclass(module = "sumo_mfc._core")]
pub struct Session {
    /// Behind a lock because laws and open files stay in one thread at a time; in a box because columns are aligned
    /// for vectors, which Python's memory does not heed.
    session: Mutex<Option<Box<run::Session>>>,
    views: Views,
    pool: ThreadPool,
    runtime: Runtime,
}

/// Waits for what SUMO does, and for a signal that Python answers with an exception.
async fn unless_signalled<T: Send>(work: impl Future<Output = Result<T, RunError>>) -> PyResult<T> {
    let mut work = std::pin::pin!(work);
    loop {
        tokio::select! {
            done = &mut work => return done.map_err(raised),
            () = tokio::time::sleep(LOOK) => Python::attach(|py| py.check_signals())?,
        }
    }
}

#[pymethods]
impl Session {
    /// Starts or joins SUMO.
    #[new]
    fn new(py: Python<'_>, plan: &Plan) -> PyResult<Self> {
        let planned = &plan.planned;
        let threads = planned.options.threads.unwrap_or(0);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(plain)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(plain)?;
        let open =
            || runtime.block_on(unless_signalled(run::Session::open(&planned.scenario, &planned.options.session)));
        let session = py.detach(|| pool.install(open))?;
        Ok(Self { session: Mutex::new(Some(Box::new(session))), views: Views::new(py), pool, runtime })
    }

    /// One step. False if the run was over before it, and nothing was done.
    fn step(&mut self, py: Python<'_>) -> PyResult<bool> {
        let Self { session, views, pool, runtime } = self;
        let session = session.get_mut().unwrap_or_else(PoisonError::into_inner);
        let Some(open) = session else { return Err(plain(RunError::Ended)) };
        if open.is_over() {
            return Ok(false);
        }
        let stepped = py.detach(|| pool.install(|| runtime.block_on(unless_signalled(open.step()))));
        if let Err(error) = stepped {
            // A step that was left in the middle cannot be gone on from.
            *session = None;
            return Err(error);
        }
        views.fill(py, &open.egos().collect::<Vec<_>>())?;
        Ok(true)
    }

    /// Leaves SUMO and writes the result: folder, summary and notes as `Plan.run` gives them.
    fn finish(&mut self, py: Python<'_>) -> PyResult<(PathBuf, String, Vec<String>)> {
        let session = self.open().take().ok_or_else(|| plain(RunError::Ended))?;
        let (pool, runtime) = (&self.pool, &self.runtime);
        let finished = py.detach(|| pool.install(|| runtime.block_on(unless_signalled(session.finish()))));
        let RunResult { dir, summary, remarkable, files, notes, .. } = finished?;
        let text = terminal_text(&summary, &remarkable, &dir, &files);
        Ok((dir, text, notes))
    }

    /// Begin, now and end (s); the end is None if only the traffic decides.
    #[getter]
    fn times(&mut self) -> PyResult<(f64, f64, Option<f64>)> {
        let times = self.open().as_ref().ok_or_else(|| plain(RunError::Ended))?.times();
        Ok((times.begin_s, times.now_s, times.end_s))
    }

    /// The ids of the egos on the road.
    #[getter]
    fn ids<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.views.ids(py)
    }

    /// A number of every ego on the road, in the order of the ids: a column of `trace.csv`, or `error`.
    fn column<'py>(&mut self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.views.column(py, name)
    }

    /// An ego is to drive at this speed (m/s) from the next step on; None gives it back to its target.
    fn set_reference(&mut self, id: &str, speed_mps: Option<f64>) -> PyResult<()> {
        self.order(|session| session.set_reference(id, speed_mps))
    }

    /// A torque (N·m) acts on the wheels of an ego beside that of the actuators, from the next step on.
    fn set_torque_disturbance(&mut self, id: &str, torque_nm: f64) -> PyResult<()> {
        self.order(|session| session.set_torque_disturbance(id, torque_nm))
    }

    /// An ego has another value of a `mfc.*` parameter from the next step on; None takes that back.
    fn set_parameter(&mut self, id: &str, name: &str, value: Option<&str>) -> PyResult<()> {
        self.order(|session| session.set_parameter(id, name, value))
    }
}

impl Session {
    fn open(&mut self) -> &mut Option<Box<run::Session>> {
        self.session.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    fn order(&mut self, order: impl FnOnce(&mut run::Session) -> Result<(), OrderError>) -> PyResult<()> {
        order(self.open().as_mut().ok_or_else(|| plain(RunError::Ended))?).map_err(plain)
    }
}
