//! A run under way, seen and ended from another thread.

use super::signals::Signal;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// How far a run is, in simulation time \[s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// When it began.
    pub begin_s: f64,
    /// Now.
    pub now_s: f64,
    /// When it ends; `None` if only the traffic decides.
    pub end_s: Option<f64>,
}

/// What another thread sees of a run under way, and how it ends it. Clones are of the same run.
#[derive(Debug, Clone, Default)]
pub struct Remote {
    raised: Arc<AtomicU8>,
    times: Arc<Mutex<Option<Times>>>,
}

impl Remote {
    /// Ends the run as this signal would.
    pub fn raise(&self, signal: Signal) {
        self.raised.store(signal.exit_code(), Ordering::Relaxed);
    }

    /// How far the run is; `None` before its first step.
    pub fn times(&self) -> Option<Times> {
        *self.times.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The exit code of the signal, 0 if there is none.
    pub(super) fn raised(&self) -> Arc<AtomicU8> {
        Arc::clone(&self.raised)
    }

    /// Notes how far the run is.
    pub(super) fn show(&self, times: Times) {
        *self.times.lock().unwrap_or_else(PoisonError::into_inner) = Some(times);
    }
}
