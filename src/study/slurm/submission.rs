//! What was submitted, on disk: written before Slurm is asked.

use super::super::error::StudyError;
use super::super::plan::{Case, Plan};
use crate::output::{OutputError, file_error, write_json};
use crate::run::Backend;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// A job array, or the job that writes the tables.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Submission {
    /// Version of this file's form.
    pub schema: u32,
    /// The name of the job, which no other job has.
    pub name: String,
    /// Slurm's number of it; none = the call that submits it has not heard of it.
    pub job: Option<String>,
    /// The SUMO that runs the cases.
    pub sumo: PathBuf,
    /// How they reach it.
    #[serde(default)]
    pub backend: Backend,
    /// Whether finished cases are run again.
    pub force: bool,
    /// The cases of every task, by its index; none = the job writes the tables.
    pub tasks: Vec<Vec<usize>>,
}

impl Submission {
    /// One that has not been submitted.
    pub fn new(plan: &Plan, number: usize, (force, backend): (bool, Backend), tasks: Vec<Vec<usize>>) -> Self {
        let folder = plan.dir.file_name().unwrap_or_default().to_string_lossy();
        let study: String =
            folder.chars().filter(|c| c.is_ascii_alphanumeric() || "-_".contains(*c)).take(30).collect();
        let now_ns = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |now| now.as_nanos());
        let name = format!("{study}-{number:04}-{now_ns:x}");
        Self { schema: 1, name, job: None, sumo: plan.sumo.path.clone(), backend, force, tasks }
    }

    /// Reads one.
    ///
    /// # Errors
    /// [`OutputError::File`] if it cannot be read, or is none.
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        let text = std::fs::read_to_string(path).map_err(file_error("read", path))?;
        serde_json::from_str(&text).map_err(|error| file_error("read", path)(error.into()))
    }
}

/// The ticket of a case: its planned `run.json`. `intent` is the file of a submission.
pub fn ticket(intent: &Path, case: usize) -> PathBuf {
    intent.with_extension("").join(format!("{case:04}.json"))
}

/// The submissions of a study.
pub struct Submissions {
    dir: PathBuf,
    /// By their numbers, the newest last.
    pub all: BTreeMap<usize, Submission>,
}

impl Submissions {
    /// Reads all.
    ///
    /// # Errors
    /// [`OutputError::File`] naming what cannot be read.
    pub fn read(plan: &Plan) -> Result<Self, OutputError> {
        let dir = plan.dir.join("slurm");
        let mut all = BTreeMap::new();
        if dir.is_dir() {
            for entry in std::fs::read_dir(&dir).map_err(file_error("read", &dir))? {
                let path = entry.map_err(file_error("read", &dir))?.path();
                let number = path.file_stem().and_then(|stem| stem.to_string_lossy().parse().ok());
                if let Some(number) = number.filter(|_| path.extension().is_some_and(|e| e == "json")) {
                    all.insert(number, Submission::read(&path)?);
                }
            }
        }
        Ok(Self { dir, all })
    }

    /// Their names.
    pub fn names(&self) -> Vec<&str> {
        self.all.values().map(|submission| submission.name.as_str()).collect()
    }

    /// The file of one.
    pub fn path(&self, number: usize) -> PathBuf {
        self.dir.join(format!("{number:04}.json"))
    }

    /// Writes one to the disk.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the file.
    pub fn write(&mut self, number: usize, submission: Submission) -> Result<(), OutputError> {
        write_json(&self.path(number), &submission)?;
        self.all.insert(number, submission);
        Ok(())
    }

    /// Writes the tickets of one.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the file.
    pub fn write_tickets(&self, number: usize, plan: &Plan, cases: &[&Case]) -> Result<(), StudyError> {
        let intent = self.path(number);
        for case in cases {
            write_json(&ticket(&intent, case.number), &plan.manifest(case))?;
        }
        Ok(())
    }

    /// Takes the tickets of a case away, except that of one submission. What has no ticket is not run.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the file.
    pub fn revoke(&self, case: usize, except: usize) -> Result<(), OutputError> {
        for number in self.all.keys().filter(|number| **number != except) {
            remove_file(&ticket(&self.path(*number), case))?;
        }
        Ok(())
    }

    /// Forgets one: its tickets first, then the file.
    ///
    /// # Errors
    /// [`OutputError::File`] naming what cannot be removed.
    pub fn forget(&mut self, number: usize) -> Result<(), OutputError> {
        let path = self.path(number);
        let tickets = path.with_extension("");
        if tickets.is_dir() {
            std::fs::remove_dir_all(&tickets).map_err(file_error("remove", &tickets))?;
        }
        remove_file(&path)?;
        self.all.remove(&number);
        Ok(())
    }
}

/// Removes a file, if it is there.
///
/// # Errors
/// [`OutputError::File`] naming the file.
pub fn remove_file(path: &Path) -> Result<(), OutputError> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(file_error("remove", path)(error)),
        _ => Ok(()),
    }
}
