//! What is asked for.

use crate::scenario::{self, Override};
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

/// A name, and what differs from the scenario.
#[derive(Debug, Clone)]
pub struct Condition {
    /// Its name.
    pub name: String,
    /// The keys that differ.
    pub sets: Vec<Override>,
}

impl Condition {
    /// Reads `NAME: KEY=VALUE KEY=VALUE ...`; the values have no blanks.
    ///
    /// # Errors
    /// What was wanted.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wanted = || format!("found \"{text}\", wanted \"NAME: KEY=VALUE KEY=VALUE\"");
        let (name, sets) = text.split_once(':').ok_or_else(wanted)?;
        let sets: Option<Vec<Override>> = sets.split_whitespace().map(Override::set).collect();
        let name = Some(name.trim()).filter(|name| !name.is_empty());
        Ok(Self { name: name.ok_or_else(wanted)?.to_owned(), sets: sets.ok_or_else(wanted)? })
    }
}
