//! Slurm's commands.

use super::super::error::StudyError;
use std::io::Write;
use std::process::{Command, Stdio};

/// A job, or a task of an array, as `squeue` shows it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// The name of the job.
    pub name: String,
    /// The number of the job or array.
    pub job: String,
    /// The index in the array.
    pub index: Option<usize>,
    /// Slurm's word for its state.
    pub state: String,
}

/// The states in which a job has ended. Slurm has many words for the others.
const ENDED: [&str; 10] = [
    "BOOT_FAIL",
    "CANCELLED",
    "COMPLETED",
    "DEADLINE",
    "FAILED",
    "NODE_FAIL",
    "OUT_OF_MEMORY",
    "PREEMPTED",
    "REVOKED",
    "TIMEOUT",
];

impl Row {
    /// Whether it has not ended.
    pub fn is_live(&self) -> bool {
        !ENDED.contains(&self.state.as_str())
    }

    /// Reads a line that was asked for with [`FORMAT`].
    fn read(line: &str) -> Option<Self> {
        let mut fields = line.trim().split('|').map(str::to_owned);
        let (name, job, index, state) = (fields.next()?, fields.next()?, fields.next()?, fields.next()?);
        Some(Self { name, job, index: index.parse().ok(), state })
    }
}

const FORMAT: &str = "--format=%j|%F|%K|%T";

/// The jobs of these names, those of the last minutes included that have ended.
///
/// # Errors
/// [`StudyError::NoSlurm`], [`StudyError::Slurm`].
pub fn queue(names: &[&str]) -> Result<Vec<Row>, StudyError> {
    if names.is_empty() {
        return Ok(Vec::new());
    }
    let said = call("squeue", &["--noheader", "--array", "--states=all", FORMAT, "--name", &names.join(",")], "")?;
    Ok(said.lines().filter_map(Row::read).collect())
}

/// The most tasks of one array. Indices stay below MaxArraySize, from 0.
///
/// # Errors
/// As [`queue`], and if this Slurm takes no arrays.
pub fn tasks_of_array() -> Result<usize, StudyError> {
    let config = call("scontrol", &["show", "config"], "")?;
    let size =
        config.lines().find_map(|line| line.strip_prefix("MaxArraySize")?.split('=').nth(1)?.trim().parse().ok());
    match size {
        Some(size @ 2..) => Ok(size - 1),
        _ => {
            let said = format!("MaxArraySize = {}: no job arrays", size.unwrap_or(0));
            Err(StudyError::Slurm { program: "scontrol", said, then: String::new() })
        }
    }
}

/// Asks whether Slurm would take a job with these arguments, and hands none in.
///
/// # Errors
/// As [`queue`].
pub fn would_submit(arguments: &[String]) -> Result<(), StudyError> {
    let arguments: Vec<&str> = ["--test-only"].into_iter().chain(arguments.iter().map(String::as_str)).collect();
    call("sbatch", &arguments, "#!/bin/sh\n").map(drop)
}

/// Submits a script. Returns the number of the job.
///
/// # Errors
/// As [`queue`].
pub fn submit(arguments: &[String], script: &str) -> Result<String, StudyError> {
    let arguments: Vec<&str> = ["--parsable"].into_iter().chain(arguments.iter().map(String::as_str)).collect();
    let said = call("sbatch", &arguments, script)?;
    // In a federation the cluster's name follows.
    Ok(said.trim().split(';').next().unwrap_or_default().to_owned())
}

/// Cancels the jobs of these names.
///
/// # Errors
/// As [`queue`].
pub fn cancel(names: &[&str]) -> Result<(), StudyError> {
    names.iter().try_for_each(|name| call("scancel", &["--name", name], "").map(drop))
}

fn call(program: &'static str, arguments: &[&str], input: &str) -> Result<String, StudyError> {
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let missing = |source| StudyError::NoSlurm { program, source };
    let mut child = command.spawn().map_err(missing)?;
    // One that refuses its arguments does not read on; its words say why.
    let _ = child.stdin.take().map(|mut stdin| stdin.write_all(input.as_bytes()));
    let output = child.wait_with_output().map_err(missing)?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    let prefix = format!("{program}: error: ");
    let said: Vec<&str> = said.lines().map(|line| line.trim_start_matches(&prefix).trim()).collect();
    let said = if said.is_empty() { output.status.to_string() } else { said.join("; ") };
    Err(StudyError::Slurm { program, said, then: String::new() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_queue_are_read() {
        let row = |line| Row::read(line).unwrap();
        let task = row("a-0001-1f|12|3|RUNNING");
        assert_eq!((&*task.name, &*task.job, task.index, task.is_live()), ("a-0001-1f", "12", Some(3), true));
        assert_eq!(row("a|13|N/A|PENDING").index, None);
        assert!(row("a|12|1|COMPLETING").is_live() && !row("a|12|1|TIMEOUT").is_live());
        assert_eq!(Row::read("slurm_load_jobs error"), None);
    }
}
