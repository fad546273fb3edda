//! The result folder of a study, read.

use super::data::read_json;
use super::error::ReportError;
use super::table::{SchemaInfo, Table};
use crate::output::file_error;
use crate::run::{Input, Manifest, Summary};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// The file that makes a folder that of a study.
pub const STUDY: &str = "study.json";

/// What `study.json` says.
#[derive(Debug, Default, Deserialize)]
pub struct Plan {
    /// Version of the program.
    pub version: String,
    /// Version of SUMO.
    pub sumo_version: String,
    /// The varied keys.
    pub keys: Vec<String>,
    /// The seeds.
    pub seeds: Vec<u64>,
    /// What to think of their number, if they are not enough.
    pub advice: Option<String>,
    /// All input files.
    pub inputs: Vec<Input>,
    /// The settings.
    pub settings: Vec<Setting>,
    /// The cases.
    pub cases: Vec<Case>,
}

/// A setting of a plan.
#[derive(Debug, Deserialize)]
pub struct Setting {
    /// The values of the varied keys.
    pub values: Vec<String>,
    /// Those of the setting that it is compared with.
    pub reference: Option<Vec<String>>,
}

/// A case of a plan.
#[derive(Debug, Deserialize)]
pub struct Case {
    /// Its number.
    pub case: usize,
}

/// What a study has left.
#[derive(Debug)]
pub struct StudyData {
    /// Its folder.
    pub dir: PathBuf,
    /// `study.json`.
    pub plan: Plan,
    /// `cases.csv`.
    pub cases: Option<Table>,
    /// `comparison.csv`.
    pub comparison: Option<Table>,
    /// How long the cases ran, those of which it is known \[s\].
    pub wall_s: Vec<f64>,
    /// Notes of the cases, each once.
    pub notes: Vec<String>,
    /// What is not there, and why.
    pub missing: Vec<String>,
}

impl StudyData {
    /// Reads the folder of a study.
    ///
    /// # Errors
    /// [`ReportError`] if a file is there that is not as it should be.
    pub fn read(dir: &Path) -> Result<Self, ReportError> {
        let mut missing = Vec::new();
        let text = std::fs::read_to_string(dir.join(STUDY)).map_err(file_error("read", &dir.join(STUDY)))?;
        let plan: Plan = serde_json::from_str(&text).map_err(|e| file_error("read", &dir.join(STUDY))(e.into()))?;
        let schema: SchemaInfo = read_json(&dir.join("schema.json"), &mut missing)?.unwrap_or_default();
        let mut table = |name: &str| -> Result<Option<Table>, ReportError> {
            let path = dir.join(name);
            if !path.is_file() {
                missing.push(format!("{name} is not in the folder: what is made from it is left out."));
                return Ok(None);
            }
            Table::read(&path, &schema.files.get(name).cloned().unwrap_or_default()).map(Some)
        };
        let (cases, comparison) = (table("cases.csv")?, table("comparison.csv")?);
        let (mut wall_s, mut notes) = (Vec::new(), Vec::new());
        for case in &plan.cases {
            let folder = dir.join("cases").join(format!("{:04}", case.case));
            let summary: Option<Summary> = read_json(&folder.join("summary.json"), &mut Vec::new()).unwrap_or_default();
            wall_s.extend(summary.map(|summary| summary.wall_s));
            let of_case = Manifest::read(&folder.join("run.json")).map(|manifest| manifest.notes).unwrap_or_default();
            for note in of_case {
                if !notes.contains(&note) {
                    notes.push(note);
                }
            }
        }
        Ok(Self { dir: dir.to_owned(), plan, cases, comparison, wall_s, notes, missing })
    }

    /// The title of a metric, from what the schema says of its column in the table of cases.
    pub fn title(&self, metric: &str) -> String {
        let column = self.cases.as_ref().and_then(|cases| cases.column(metric));
        column.map_or_else(|| metric.to_owned(), |column| column.info.meaning.clone())
    }
}

/// One row of `comparison.csv`, by name.
pub struct Compared<'a> {
    table: &'a Table,
    row: usize,
}

impl<'a> Compared<'a> {
    /// All rows.
    pub fn all(table: &'a Table) -> impl Iterator<Item = Self> {
        (0..table.rows).map(move |row| Self { table, row })
    }

    /// A text.
    pub fn text(&self, column: &str) -> &'a str {
        self.table.texts(column).map_or("", |texts| &texts[self.row])
    }

    /// A number, if it has a value.
    pub fn number(&self, column: &str) -> Option<f64> {
        self.table.numbers(column).map(|numbers| numbers[self.row]).filter(|number| number.is_finite())
    }

    /// The values of the varied keys.
    pub fn values(&self, keys: &[String]) -> Vec<String> {
        keys.iter().map(|key| self.text(key).to_owned()).collect()
    }
}
