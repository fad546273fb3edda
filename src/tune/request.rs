//! What is asked for.

use super::condition::Condition;
use crate::scenario;
use std::path::PathBuf;

/// What is tuned, and on what.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Body, actuators, noise, and whatever else the scenario says. Its target is replaced by the recordings.
    pub scenario: scenario::Request,
    /// The laws; ratios are to the first.
    pub controllers: Vec<String>,
    /// How many gains of each law are free.
    pub gains: usize,
    /// Recordings to tune on.
    pub train: Vec<PathBuf>,
    /// Recordings to judge on.
    pub test: Vec<PathBuf>,
    /// Vehicles per recording, each with its own noise and its own draws of the body.
    pub seeds: usize,
    /// Sets of gains that are tried per law and condition.
    pub trials: usize,
    /// The conditions; the first is the one whose gains are also tried under all others.
    pub conditions: Vec<Condition>,
    /// Show a progress bar.
    pub progress: bool,
}
