//! Submits what is to be run, and the job that writes the tables after it.

use super::super::case::State;
use super::super::error::StudyError;
use super::super::plan::Case;
use super::super::warming::{missing, warm_up};
use super::super::work::{Ended, Standing, Work};
use super::command::{Row, cancel, queue, submit, tasks_of_array, would_submit};
use super::keys::SlurmKeys;
use super::queue::{of_rows, standing};
use super::submission::{Submission, Submissions};
use crate::output::file_error;
use std::collections::BTreeSet;
use std::fs::{File, TryLockError};
use std::path::Path;
use std::time::Duration;

/// Warm-ups at the same time: they run where the call does, on a login node that many share.
const WARM_UPS: usize = 2;
/// What is said where Slurm has taken no job.
const NOTHING: &str = ". Nothing was submitted";
/// Time between two questions while we stay.
const PERIOD: Duration = Duration::from_secs(2);
/// So many questions may be unanswered in a row: controllers are restarted.
const UNANSWERED: usize = 100;

/// Submits the cases that are not in the queue.
///
/// # Errors
/// [`StudyError::NoSlurm`], and [`StudyError::Slurm`] with Slurm's words; nothing is then left in the queue by this call.
pub fn execute(work: &Work<'_>) -> Result<Ended, StudyError> {
    let largest = tasks_of_array()?;
    if !missing(work.plan, work.cases).is_empty() {
        // Nothing is simulated for a job that is refused afterwards.
        would_submit(&asked(work.slurm)).map_err(nothing_submitted)?;
    }
    // One simulation per seed, for all cases of it: too little for jobs of its own.
    let warmed = warm_up(work.plan, work.cases, WARM_UPS, work.quiet)?;
    if warmed != Ended::All {
        return Ok(warmed);
    }
    let folder = work.plan.dir.join("slurm");
    let new = !folder.exists();
    std::fs::create_dir_all(&folder).map_err(file_error("create", &folder))?;
    let lock = lock(&folder, &work.plan.dir)?;
    let submitted = Desk::open(work).and_then(|desk| desk.submit(largest));
    drop(lock);
    if submitted.is_err() && new {
        // A refused study leaves nothing behind; what is not empty stays.
        let _ = std::fs::remove_dir(&folder).and_then(|()| std::fs::remove_dir(&work.plan.dir));
    }
    let jobs = submitted?;
    work.plan.write()?;
    match jobs {
        jobs if jobs.is_empty() => Ok(Ended::All),
        jobs if work.wait => stay(work).map(|()| Ended::All).inspect_err(|_| eprintln!("jobs: {}", jobs.join(" "))),
        jobs => Ok(Ended::Queued(jobs)),
    }
}

/// Held while one call submits; the system lets go of it even if the process is killed.
fn lock(folder: &Path, study: &Path) -> Result<Option<File>, StudyError> {
    let Ok(file) = File::open(folder) else { return Ok(None) };
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => Err(StudyError::Submitting { dir: study.to_owned() }),
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

/// Where jobs are handed in.
struct Desk<'a> {
    work: &'a Work<'a>,
    submissions: Submissions,
    rows: Vec<Row>,
    /// The submissions of this call.
    own: Vec<usize>,
}

impl<'a> Desk<'a> {
    /// Finds out what became of earlier calls.
    fn open(work: &'a Work<'a>) -> Result<Self, StudyError> {
        let submissions = Submissions::read(work.plan)?;
        let rows = queue(&submissions.names())?;
        let mut desk = Self { work, submissions, rows, own: Vec::new() };
        desk.find_unknown()?;
        Ok(desk)
    }

    /// A call that was stopped between its file and Slurm's answer leaves a job that may or may not be there.
    fn find_unknown(&mut self) -> Result<(), StudyError> {
        let unknown: Vec<(usize, Submission)> = self.submissions.all.clone().into_iter().collect();
        for (number, submission) in unknown.into_iter().filter(|(_, submission)| submission.job.is_none()) {
            if let Some(row) = self.rows.iter().find(|row| row.name == submission.name) {
                let job = Some(row.job.clone());
                self.submissions.write(number, Submission { job, ..submission })?;
                continue;
            }
            // It runs nothing if it turns up from now on, and what it may have begun is ended.
            self.submissions.forget(number)?;
            cancel(&[&submission.name])?;
        }
        Ok(())
    }

    /// Submits what is not in the queue. Returns the jobs that are to end, that of the tables last.
    fn submit(mut self, largest: usize) -> Result<Vec<String>, StudyError> {
        let standing = of_rows(&self.submissions, &self.rows);
        let queued = |case: &&&Case| matches!(standing.get(&case.number), Some(Standing::Pending | Standing::Running));
        // A case may have ended, and its task left the queue, since the study was looked at.
        let done = |case: &&&Case| !self.work.force && State::of(self.work.plan, case) == State::Done;
        let todo: Vec<&Case> = self.work.cases.iter().filter(|case| !queued(case) && !done(case)).copied().collect();
        let live: BTreeSet<&str> = self.rows.iter().filter(|row| row.is_live()).map(|row| &*row.name).collect();
        let live = |tables: bool| {
            let of = |s: &&Submission| s.tasks.is_empty() == tables && live.contains(&*s.name);
            self.submissions.all.values().filter(of).filter_map(|s| s.job.clone()).collect::<Vec<String>>()
        };
        let (arrays, tables) = (live(false), live(true));
        if todo.is_empty() && (arrays.is_empty() || !tables.is_empty()) {
            return Ok([arrays, tables].concat());
        }
        let submitted = self.hand_in(&todo, largest, arrays, tables);
        submitted.map_err(|error| self.withdraw(error))
    }

    fn hand_in(
        &mut self,
        todo: &[&Case],
        largest: usize,
        mut jobs: Vec<String>,
        tables: Vec<String>,
    ) -> Result<Vec<String>, StudyError> {
        let keys = self.work.slurm;
        let throttle = self.work.jobs.or(keys.throttle.map(|throttle| throttle as usize));
        let per_task = keys.cases_per_task as usize;
        for cases in todo.chunks(largest.saturating_mul(per_task)) {
            let tasks: Vec<Vec<usize>> =
                cases.chunks(per_task).map(|cases| cases.iter().map(|case| case.number).collect()).collect();
            let mut array = format!("--array=0-{}", tasks.len() - 1);
            let mut after = Vec::new();
            if let Some(throttle) = throttle {
                // A throttle holds for one array, so one array waits for the others.
                array += &format!("%{throttle}");
                after.clone_from(&jobs);
            }
            jobs.push(self.hand_in_one(tasks, cases, &[array], &after)?);
        }
        let after = [&jobs[..], &tables].concat();
        jobs.extend(tables);
        jobs.push(self.hand_in_one(Vec::new(), &[], &[], &after)?);
        Ok(jobs)
    }

    /// Writes a submission down, submits it, and writes its number down.
    fn hand_in_one(
        &mut self,
        tasks: Vec<Vec<usize>>,
        cases: &[&Case],
        more: &[String],
        after: &[String],
    ) -> Result<String, StudyError> {
        let (work, number) = (self.work, self.submissions.all.keys().next_back().map_or(1, |last| last + 1));
        let submission = Submission::new(work.plan, number, (work.force, work.backend), tasks);
        self.own.push(number);
        self.submissions.write(number, submission.clone())?;
        self.submissions.write_tickets(number, work.plan, cases)?;
        let intent = std::path::absolute(self.submissions.path(number))?;
        let mut arguments = asked(work.slurm);
        arguments.push(format!("--job-name={}", submission.name));
        arguments.extend_from_slice(more);
        if !after.is_empty() {
            arguments.push(format!("--dependency=afterany:{}", after.join(":")));
        }
        let tables = submission.tasks.is_empty();
        let log = if tables { intent.with_extension("log") } else { intent.with_extension("").join("%a.log") };
        // A % of the folder's name is no sign for Slurm.
        let folder = log.parent().map(|folder| folder.display().to_string().replace('%', "%%")).unwrap_or_default();
        let name = log.file_name().unwrap_or_default().to_string_lossy();
        arguments.extend([format!("--output={folder}/{name}"), "--open-mode=append".to_owned()]);
        let mut words: Vec<String> = work.program.words().collect();
        if tables {
            words.extend(work.tables.iter().map(|word| word.to_string_lossy().into_owned()));
        } else {
            words.extend(["slurm-task".to_owned(), intent.display().to_string(), submission.name.clone()]);
        }
        let words: Vec<String> = words.iter().map(|word| quoted(word)).collect();
        let sumo = quoted(&work.plan.sumo.path.display().to_string());
        let job = submit(&arguments, &format!("#!/bin/sh\nSUMO_BINARY={sumo} exec {}\n", words.join(" ")))?;
        self.submissions.write(number, Submission { job: Some(job.clone()), ..submission })?;
        for case in cases {
            self.submissions.revoke(case.number, number)?;
        }
        Ok(job)
    }

    /// Takes back what this call has submitted, and says why.
    fn withdraw(&mut self, error: StudyError) -> StudyError {
        let StudyError::Slurm { program, said, .. } = error else { return error };
        let names: Vec<&str> = self.own.iter().map(|number| &*self.submissions.all[number].name).collect();
        let jobs: Vec<&str> = self.own.iter().filter_map(|n| self.submissions.all[n].job.as_deref()).collect();
        let undone = cancel(&names);
        let then = match (&undone, jobs.is_empty()) {
            (Ok(()), true) => NOTHING.to_owned(),
            (Ok(()), false) => format!(". What it had taken of this call was cancelled: {}", jobs.join(" ")),
            (Err(_), _) => ". Whether it has taken a job is not certain: --status shows it".to_owned(),
        };
        if undone.is_ok() {
            for number in self.own.clone() {
                if let Err(error) = self.submissions.forget(number) {
                    return error.into();
                }
            }
        }
        StudyError::Slurm { program, said, then }
    }
}

/// Says so of a refusal before the first job.
fn nothing_submitted(error: StudyError) -> StudyError {
    match error {
        StudyError::Slurm { program, said, .. } => StudyError::Slurm { program, said, then: NOTHING.to_owned() },
        other => other,
    }
}

/// The arguments of sbatch that the user chooses.
fn asked(keys: &SlurmKeys) -> Vec<String> {
    let named =
        [("partition", &keys.partition), ("account", &keys.account), ("time", &keys.time), ("mem", &keys.memory)];
    let named = named.iter().filter_map(|(option, value)| Some(format!("--{option}={}", value.as_ref()?)));
    ["--ntasks=1".to_owned()].into_iter().chain(named).chain(keys.sbatch.iter().cloned()).collect()
}

/// A word for the shell.
fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// Waits until nothing of the study is in the queue.
fn stay(work: &Work<'_>) -> Result<(), StudyError> {
    let (mut unanswered, mut told) = (0, None);
    loop {
        std::thread::sleep(PERIOD);
        let names = Submissions::read(work.plan)?;
        match queue(&names.names()) {
            Ok(rows) if !rows.iter().any(Row::is_live) => return Ok(()),
            Ok(_) => unanswered = 0,
            Err(error) if unanswered >= UNANSWERED => return Err(error),
            Err(_) => unanswered += 1,
        }
        let standing = standing(work.plan).unwrap_or_default();
        let left = work.cases.iter().filter(|case| standing.contains_key(&case.number)).count();
        let running = standing.values().filter(|standing| **standing == Standing::Running).count();
        let now = (left, running);
        if !work.quiet && told != Some(now) {
            eprintln!("[{}/{}] cases have ended, {running} run", work.cases.len() - left, work.cases.len());
            told = Some(now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_of_sbatch_come_from_the_keys() {
        let (partition, memory) = (Some("short".to_owned()), Some("2G".to_owned()));
        let keys = SlurmKeys { partition, memory, sbatch: vec!["--qos=low".to_owned()], ..SlurmKeys::default() };
        assert_eq!(asked(&keys), ["--ntasks=1", "--partition=short", "--mem=2G", "--qos=low"]);
    }

    #[test]
    fn words_stay_words_in_the_shell() {
        assert_eq!(quoted("it's $HOME"), r"'it'\''s $HOME'");
    }
}
