//! One task of a job array, on its node.

use super::super::case::{State, note_failure, prepare};
use super::super::error::StudyError;
use super::super::plan::case_dir;
use super::super::process::{self, Program};
use super::submission::{Submission, remove_file, ticket};
use crate::run::{Backend, LINGER, Manifest, RunError, Signal};
use std::path::Path;
use std::time::{Duration, Instant};

/// Runs the cases of a task that have a ticket. Returns the reasons of those that failed. `name` is that of the submission:
/// a job of a call that was taken back finds another one there, or none.
///
/// # Errors
/// [`StudyError`] if the files of the study are not there, or somebody else runs the case. The ticket stays.
pub fn run_task(intent: &Path, name: &str, index: usize, program: &Program) -> Result<Vec<String>, StudyError> {
    let intent = std::path::absolute(intent)?;
    let submission = Submission::read(&intent)?;
    if submission.name != name {
        return Ok(Vec::new());
    }
    let study = intent.ancestors().nth(2).unwrap_or(&intent);
    let mut failed = Vec::new();
    for case in submission.tasks.get(index).into_iter().flatten() {
        let ticket = ticket(&intent, *case);
        if !ticket.exists() {
            continue;
        }
        let planned = Manifest::read(&ticket)?;
        let dir = case_dir(study, *case);
        // Somebody else may have run it while this task waited for its turn.
        if submission.force || State::of_planned(&dir, &planned) != State::Done {
            run_case(&dir, &planned, (&submission.sumo, submission.backend), program)?;
        }
        if let State::Failed(reason) = State::of_planned(&dir, &planned) {
            failed.push(format!("case {case:04}: {reason}"));
        }
        remove_file(&ticket)?;
    }
    Ok(failed)
}

fn run_case(dir: &Path, planned: &Manifest, sumo: (&Path, Backend), program: &Program) -> Result<(), StudyError> {
    let deadline = Instant::now() + LINGER;
    while let Err(error) = prepare(dir, planned) {
        if !matches!(error, RunError::Busy { .. }) || Instant::now() > deadline {
            return Err(error.into());
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    let mut child = process::command(program, sumo, dir).spawn()?;
    let tie = child.stdin.take();
    let output = child.wait_with_output()?;
    drop(tie);
    // What Slurm stops is no failure of the case.
    if let Some(signal) = Signal::ALL.into_iter().find(|s| output.status.code() == Some(s.exit_code().into())) {
        return Err(RunError::Interrupted(signal).into());
    }
    Ok(note_failure(dir, planned, &process::last_words(&output))?)
}
