//! A table of a result as it lies on the disk, with what `schema.json` says of its columns.

use super::error::ReportError;
use crate::output::file_error;
use crate::sumo_files::each_row;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;

/// What `schema.json` says of a column.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ColumnInfo {
    /// Its header.
    pub name: String,
    /// `string`, `number`, `integer` or `boolean`.
    #[serde(rename = "type", default)]
    pub kind: String,
    /// Its unit.
    pub unit: Option<String>,
    /// What it says.
    #[serde(default)]
    pub meaning: String,
}

impl ColumnInfo {
    /// Whether its values are numbers.
    pub fn is_number(&self) -> bool {
        matches!(self.kind.as_str(), "number" | "integer")
    }

    /// Name and unit.
    pub fn titled(&self) -> String {
        self.unit.as_ref().map_or_else(|| self.name.clone(), |unit| format!("{} [{unit}]", self.name))
    }
}

/// What `schema.json` says of a file.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
pub struct FileInfo {
    /// What a row is called.
    pub row: Option<String>,
    /// Its columns.
    #[serde(default)]
    pub columns: Vec<ColumnInfo>,
}

/// The contents of `schema.json`.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
pub struct SchemaInfo {
    /// The files by name.
    pub files: BTreeMap<String, FileInfo>,
}

/// The values of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Texts, flags among them.
    Texts(Vec<String>),
    /// Numbers; NaN is no value.
    Numbers(Vec<f64>),
}

/// A column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// What is known of it.
    pub info: ColumnInfo,
    /// Its values.
    pub values: Values,
}

/// A table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table {
    /// Its columns.
    pub columns: Vec<Column>,
    /// The number of rows.
    pub rows: usize,
}

impl Table {
    /// Reads a table in any of the project's formats. Columns that the schema does not know are texts.
    ///
    /// # Errors
    /// [`ReportError`] naming file and line.
    pub fn read(path: &Path, info: &FileInfo) -> Result<Self, ReportError> {
        if path.extension().is_some_and(|suffix| suffix == "csv") {
            return Self::read_csv(path, info);
        }
        let mut table = Self::of(info.columns.iter().cloned());
        let mut line = 1;
        let row = info.row.as_deref().unwrap_or_default();
        let whole = each_row(path, row, |attribute| {
            line += 1;
            let mut cells = info.columns.iter().map(|column| attribute(&column.name).unwrap_or_default());
            table.push(&mut cells.by_ref().map(std::borrow::Cow::Owned))
        })?;
        if whole { Ok(table) } else { Err(wrong(path, line, "the file breaks off".to_owned())) }
    }

    fn read_csv(path: &Path, info: &FileInfo) -> Result<Self, ReportError> {
        let file = File::open(path).map_err(file_error("read", path))?;
        let mut reader = csv::Reader::from_reader(file);
        let at = |error: csv::Error| wrong(path, error.position().map_or(1, |p| p.line() as usize), error.to_string());
        let header = reader.headers().map_err(at)?.clone();
        let column = |name: &str| {
            let known = info.columns.iter().find(|column| column.name == name).cloned();
            known.unwrap_or_else(|| ColumnInfo {
                name: name.to_owned(),
                kind: "string".to_owned(),
                unit: None,
                meaning: String::new(),
            })
        };
        let mut table = Self::of(header.iter().map(column));
        let mut record = csv::StringRecord::new();
        while reader.read_record(&mut record).map_err(at)? {
            let line = record.position().map_or(1, |place| place.line() as usize);
            table.push(&mut record.iter().map(std::borrow::Cow::Borrowed)).map_err(|what| wrong(path, line, what))?;
        }
        Ok(table)
    }

    fn of(columns: impl Iterator<Item = ColumnInfo>) -> Self {
        let empty = |info: ColumnInfo| {
            let values = if info.is_number() { Values::Numbers(Vec::new()) } else { Values::Texts(Vec::new()) };
            Column { info, values }
        };
        Self { columns: columns.map(empty).collect(), rows: 0 }
    }

    fn push<'a>(&mut self, cells: &mut dyn Iterator<Item = std::borrow::Cow<'a, str>>) -> Result<(), String> {
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            match &mut column.values {
                Values::Texts(texts) => texts.push(cell.into_owned()),
                Values::Numbers(numbers) if cell.is_empty() => numbers.push(f64::NAN),
                Values::Numbers(numbers) => {
                    let number = cell.parse().ok().filter(|number: &f64| number.is_finite());
                    let name = &column.info.name;
                    numbers.push(number.ok_or_else(|| format!("{name}: found {cell}, wanted a number"))?);
                }
            }
        }
        self.rows += 1;
        Ok(())
    }

    /// Appends the columns that this table does not have, if the other is of the same vehicles in the same order.
    /// False if it is not.
    #[must_use]
    pub fn append(&mut self, other: Self) -> bool {
        let same = self.rows == other.rows && self.texts("id") == other.texts("id");
        if same {
            let new = other.columns.into_iter().filter(|column| self.column(&column.info.name).is_none());
            let new: Vec<Column> = new.collect();
            self.columns.extend(new);
        }
        same
    }

    /// A column by name.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.info.name == name)
    }

    /// The numbers of a column.
    pub fn numbers(&self, name: &str) -> Option<&[f64]> {
        match &self.column(name)?.values {
            Values::Numbers(numbers) => Some(numbers),
            Values::Texts(_) => None,
        }
    }

    /// The texts of a column.
    pub fn texts(&self, name: &str) -> Option<&[String]> {
        match &self.column(name)?.values {
            Values::Texts(texts) => Some(texts),
            Values::Numbers(_) => None,
        }
    }
}

fn wrong(path: &Path, line: usize, what: String) -> ReportError {
    ReportError::Table { path: path.to_owned(), line, what }
}
