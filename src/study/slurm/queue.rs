//! What Slurm knows of the cases of a study.

use super::super::error::StudyError;
use super::super::plan::Plan;
use super::super::work::Standing;
use super::command::{Row, queue};
use super::submission::{Submission, Submissions, ticket};
use std::collections::BTreeMap;

/// Asks for all cases that have a ticket, by their numbers.
///
/// # Errors
/// [`StudyError`] if Slurm does not answer, or what was submitted cannot be read.
pub fn standing(plan: &Plan) -> Result<BTreeMap<usize, Standing>, StudyError> {
    let submissions = Submissions::read(plan)?;
    let rows = queue(&submissions.names())?;
    Ok(of_rows(&submissions, &rows))
}

/// The same from an answer of Slurm's. Where a case has several tickets, the newest counts, unless an older one still runs.
pub fn of_rows(submissions: &Submissions, rows: &[Row]) -> BTreeMap<usize, Standing> {
    let known: BTreeMap<(&str, Option<usize>), &Row> = rows.iter().map(|row| ((&*row.name, row.index), row)).collect();
    let mut all = BTreeMap::new();
    for (number, submission) in &submissions.all {
        let intent = submissions.path(*number);
        for (index, cases) in submission.tasks.iter().enumerate() {
            let row = known.get(&(&*submission.name, Some(index))).copied();
            for case in cases.iter().filter(|case| ticket(&intent, **case).is_file()) {
                let before = all.get(case);
                if !matches!(before, Some(Standing::Pending | Standing::Running)) {
                    all.insert(*case, of_task(*number, submission, index, row));
                }
            }
        }
    }
    all
}

fn of_task(number: usize, submission: &Submission, index: usize, row: Option<&Row>) -> Standing {
    match (row, &submission.job) {
        (Some(row), _) if row.is_live() => {
            if row.state == "PENDING" {
                Standing::Pending
            } else {
                Standing::Running
            }
        }
        (None, None) => Standing::Uncertain,
        (row, job) => {
            let task = job.as_ref().or(row.map(|row| &row.job)).map(|job| format!("{job}_{index}")).unwrap_or_default();
            let state = row.map_or("ended, Slurm does not say how", |row| &*row.state);
            Standing::Lost(format!("task {task}: {state}, see slurm/{number:04}/{index}.log"))
        }
    }
}
