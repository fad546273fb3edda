//! `schema.json`: every file of a result, and what its columns mean.

use super::rows::{EDGES, QUALITY, SAMPLE, TRACE, VEHICLES};
use super::summary::summary_fields;
use crate::table::{Column, Shape};
use serde::Serialize;
use std::collections::BTreeMap;

/// One file.
#[derive(Debug, Clone, Serialize)]
pub struct FileSchema {
    meaning: &'static str,
    /// What a row is of.
    #[serde(skip_serializing_if = "Option::is_none")]
    row: Option<&'static str>,
    /// Columns of a table, in order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    columns: Vec<Column>,
    /// Fields of a JSON file, with the names of the objects that they are in.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    fields: Vec<Column>,
    /// When it is written; for the reference, the schema stands beside files that are there.
    #[serde(skip)]
    when: &'static str,
}

/// The most usual case.
const ALWAYS: &str = "always";

impl FileSchema {
    /// A table.
    pub fn of_table(shape: &Shape) -> Self {
        let (meaning, columns) = (shape.meaning, shape.columns.clone());
        Self { meaning, row: Some(shape.row), columns, fields: Vec::new(), when: ALWAYS }
    }

    /// A file that is no table.
    pub fn of_file(meaning: &'static str, fields: Vec<Column>) -> Self {
        Self { meaning, row: None, columns: Vec::new(), fields, when: ALWAYS }
    }

    /// Written only in some cases.
    #[must_use]
    pub fn when(self, when: &'static str) -> Self {
        Self { when, ..self }
    }
}

/// The contents of `schema.json`.
#[derive(Debug, Clone, Serialize)]
pub struct Schema {
    schema: u32,
    files: BTreeMap<String, FileSchema>,
}

impl Schema {
    /// The schema of these files, and of itself.
    pub fn new<'a>(files: impl IntoIterator<Item = (&'a str, FileSchema)>) -> Self {
        let own = ("schema.json", FileSchema::of_file("What the files beside it contain", Vec::new()));
        let files = files.into_iter().chain([own]).map(|(name, file)| (name.to_owned(), file)).collect();
        Self { schema: 1, files }
    }

    /// The files of a run whose table of vehicles has this name, and whose trace, if it has one, has that; with or without
    /// drive quality.
    pub fn of_run(vehicles: &str, quality: bool, trace: Option<&str>) -> Self {
        let file = FileSchema::of_file;
        let summary =
            "The whole fleet: counts, SUMO's totals, mean and quantiles of the columns of vehicles and quality";
        let manifest = "What was run and how it ended: versions, seed, hashes of all inputs, the resolved scenario";
        let files = [
            (vehicles, FileSchema::of_table(&VEHICLES.shape)),
            ("edges.csv", FileSchema::of_table(&EDGES.shape)),
            ("sample.csv", FileSchema::of_table(&SAMPLE.shape)),
            ("summary.json", file(summary, summary_fields())),
            ("run.json", file(manifest, Vec::new())),
            ("sumo/", file("SUMO's log, and the outputs that its configuration names", Vec::new())),
        ];
        let unless = "unless `output.quality = false`";
        let quality = quality.then(|| ("quality.csv", FileSchema::of_table(&QUALITY.shape).when(unless)));
        let trace = trace.map(|name| (name, FileSchema::of_table(&TRACE.shape).when("with `--trace`")));
        Self::new(files.into_iter().chain(quality).chain(trace))
    }

    /// Name, meaning and condition of every file, by name.
    pub fn files(&self) -> impl Iterator<Item = [&str; 3]> {
        self.files.iter().map(|(name, file)| [name.as_str(), file.meaning, file.when])
    }
}
