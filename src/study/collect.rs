//! The tables of a study, from the folders of its cases.

use super::case::State;
use super::comparison::{ComparisonRow, Samples, compare, comparison_layout, key_columns};
use super::error::StudyError;
use super::joined::{JOINED, JoinedTable, joined_layout};
use super::metrics::{METRIC_COUNT, METRICS};
use super::pairs::pairs;
use super::plan::{Case, Plan};
use super::result::CaseResult;
use crate::output::{write_json, write_table};
use crate::run::{FileSchema, Schema};
use crate::table::{Cell, Column, Columns, Field, Kind, Layout, record};
use rayon::prelude::*;
use std::fs::{File, TryLockError};
use std::path::Path;
use std::time::Duration;

record! {
    /// A case in front of its metrics.
    #[derive(Debug, Clone, PartialEq)]
    pub struct CaseHead {
        case: u64 = "Number of the case: its folder in cases/";
        seed: u64 = "Seed";
        status: &'static str = "done, failed, or missing: not run yet, or stopped on the way";
        reason: String = "Why it failed";
    }
}

/// A row of `cases.csv`.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseRow {
    head: CaseHead,
    values: Vec<String>,
    metrics: [Option<f64>; METRIC_COUNT],
}

/// `cases.csv` of a study that varies these keys.
pub fn case_layout(keys: &[String]) -> Layout<CaseRow> {
    let mut columns: Columns<CaseRow> = key_columns(keys, |row: &CaseRow| &row.values);
    columns.extend(CaseHead::columns(Column::new("", Kind::Number, None, ""), |row: &CaseRow| &row.head));
    for (k, metric) in METRICS.iter().enumerate() {
        let unit = Some(metric.unit).filter(|unit| !unit.is_empty());
        let column = Column::new(metric.name, Kind::Number, unit, metric.meaning);
        columns.push((column, Box::new(move |row: &CaseRow| Cell::Number(row.metrics[k]))));
    }
    Layout::new(["cases", "case"], "One row per case, seed by seed, after a column per varied key", columns)
}

/// The tables of a study.
#[derive(Debug)]
pub struct Tables {
    /// A row per case.
    pub cases: Vec<CaseRow>,
    /// A row per setting and metric.
    pub comparison: Vec<ComparisonRow>,
    /// Cases that are done, failed, missing.
    pub counts: [usize; 3],
}

/// How long to wait for another call that writes the same tables.
const OTHERS: Duration = Duration::from_secs(60);

/// The tables of a study, and its page, are written by one call at a time: that with this value.
#[derive(Debug)]
pub struct Turn {
    /// The folder, locked; the system lets go of it even if the process is killed.
    _lock: Option<File>,
}

impl Turn {
    /// Waits until no other call writes the tables in this folder. On systems where a folder cannot be locked, does
    /// without.
    ///
    /// # Errors
    /// [`StudyError::Collecting`] if another one takes longer than a minute.
    pub fn wait(dir: &Path) -> Result<Self, StudyError> {
        Self::wait_for(dir, OTHERS)
    }

    fn wait_for(dir: &Path, limit: Duration) -> Result<Self, StudyError> {
        let Ok(folder) = File::open(dir) else { return Ok(Self { _lock: None }) };
        let mut left = limit;
        loop {
            match folder.try_lock() {
                Ok(()) => return Ok(Self { _lock: Some(folder) }),
                Err(TryLockError::Error(_)) => return Ok(Self { _lock: None }),
                Err(TryLockError::WouldBlock) if left.is_zero() => {
                    return Err(StudyError::Collecting { dir: dir.to_owned() });
                }
                Err(TryLockError::WouldBlock) => {
                    std::thread::sleep(LOOK);
                    left = left.saturating_sub(LOOK);
                }
            }
        }
    }
}

/// How often to look whether it is our turn.
const LOOK: Duration = Duration::from_millis(50);

/// Reads all cases, and writes `vehicles.parquet` meanwhile. At any time only the vehicles of one seed are in memory.
///
/// # Errors
/// [`StudyError::Output`] naming the file of a whole result that cannot be read, or that cannot be written.
pub fn collect(plan: &Plan) -> Result<Tables, StudyError> {
    let mut tables = Tables { cases: Vec::with_capacity(plan.cases.len()), comparison: Vec::new(), counts: [0; 3] };
    let layout = joined_layout(&plan.keys);
    let mut joined = JoinedTable::create(&plan.dir, &layout)?;
    let mut samples: Vec<[Samples; METRIC_COUNT]> = vec![Default::default(); plan.settings.len()];
    for of_seed in plan.cases.chunks(plan.settings.len()) {
        let read = of_seed.par_iter().map(|case| CaseResult::read(plan, case));
        let results: Vec<CaseResult> = read.collect::<Result<_, _>>()?;
        for (index, (case, result)) in of_seed.iter().zip(&results).enumerate() {
            let reference = plan.settings[index].reference.map(|reference| &results[reference]);
            let pairs = reference.map(|reference| pairs(&result.vehicles, &reference.vehicles)).unwrap_or_default();
            for (k, samples) in samples[index].iter_mut().enumerate() {
                samples.values.push(result.values[k]);
                samples.pairs.push(pairs[k]);
            }
            tables.add(plan, case, result);
        }
        for (case, result) in of_seed.iter().zip(results) {
            joined.add(plan, case, result.vehicles)?;
        }
    }
    joined.finish()?;
    tables.comparison = compare(plan, &samples);
    Ok(tables)
}

impl Tables {
    fn add(&mut self, plan: &Plan, case: &Case, result: &CaseResult) {
        let (count, reason) = match &result.state {
            State::Done => (0, String::new()),
            State::Failed(reason) => (1, reason.replace('\n', " ")),
            State::Missing => (2, String::new()),
        };
        self.counts[count] += 1;
        let status = result.state.as_str();
        let head = CaseHead { case: case.number as u64, seed: case.seed, status, reason };
        let values = plan.settings[case.setting].values.clone();
        self.cases.push(CaseRow { head, values, metrics: result.values });
    }

    /// Writes `cases.csv` and `comparison.csv`, with `schema.json` beside them.
    ///
    /// # Errors
    /// [`StudyError::Output`] naming the file.
    pub fn write(&self, plan: &Plan) -> Result<(), StudyError> {
        let (cases, comparison) = (case_layout(&plan.keys), comparison_layout(&plan.keys));
        write_table(&plan.dir.join("cases.csv"), &cases, &self.cases)?;
        write_table(&plan.dir.join("comparison.csv"), &comparison, &self.comparison)?;
        // A study has the same tables and schema whoever ran it: what a cluster leaves behind is not listed.
        let schema = study_schema(&plan.keys, |folder| folder != SLURM && plan.dir.join(folder).is_dir());
        write_json(&plan.dir.join("schema.json"), &schema)?;
        Ok(())
    }
}

/// The folder of what was submitted to a cluster.
const SLURM: &str = "slurm/";

/// The schema of a study that varies these keys; `has` says which of the folders are there that not every study has.
pub fn study_schema(keys: &[String], has: impl Fn(&str) -> bool) -> Schema {
    let file = |meaning| FileSchema::of_file(meaning, Vec::new());
    let table = |shape| FileSchema::of_table(shape);
    let files = [
        ("cases.csv", table(&case_layout(keys).shape)),
        ("comparison.csv", table(&comparison_layout(keys).shape)),
        (JOINED, table(&joined_layout(keys).shape)),
        ("study.json", file("The plan: settings, cases with what makes each of them, versions, hashes of all inputs")),
        ("cases/", file("The result folder of every case")),
    ];
    let some = [
        ("warm_up/", file("The states of SUMO that the cases load").when("with a warm-up")),
        (SLURM, file("What was submitted to a cluster, and the logs of its tasks").when("with `--executor slurm`")),
    ];
    Schema::new(files.into_iter().chain(some.into_iter().filter(|(name, _)| has(name))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_written_by_one_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let first = Turn::wait(folder.path()).unwrap();
        let refused = Turn::wait_for(folder.path(), 2 * LOOK).unwrap_err().to_string();
        assert!(refused.contains("another call is writing the tables") && refused.contains("try again"), "{refused}");
        std::thread::scope(|scope| {
            let second = scope.spawn(|| Turn::wait(folder.path()).map(drop));
            std::thread::sleep(2 * LOOK);
            assert!(!second.is_finished());
            drop(first);
            second.join().unwrap().unwrap();
        });
        assert!(Turn::wait(&folder.path().join("none")).is_ok(), "what is not there is made later");
    }
}
