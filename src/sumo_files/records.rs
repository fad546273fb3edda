//! What SUMO's outputs hold, in whatever format a configuration asks for: XML (gzipped too), CSV or Parquet
//! (<https://sumo.dlr.de/docs/Simulation/Output/index.html>). In the column formats the attributes of an element `x` are
//! columns `x_name`, or `name`.

use std::{fs::File, io::Read, ops::ControlFlow, path::Path};

use parquet::{
    errors::ParquetError,
    file::reader::{FileReader, SerializedFileReader},
    record::Field,
};

use super::{
    error::{SumoFileError, unreadable},
    options::seconds,
    xml::{self, Xml, is_xml},
};

/// One element of an output.
pub(super) struct Record<'a> {
    attribute: &'a dyn Fn(&str) -> Option<String>,
}

impl Record<'_> {
    /// An attribute, unless it is empty.
    pub fn text(&self, name: &str) -> Option<String> {
        (self.attribute)(name).filter(|value| !value.is_empty())
    }

    /// An attribute that must be a finite number, or a time \[s\], human-readable ones too.
    pub fn number(&self, name: &str) -> Result<f64, String> {
        let value = self.text(name).ok_or_else(|| format!("no {name}"))?;
        seconds(&value).filter(|x| x.is_finite()).ok_or_else(|| format!("{name}=\"{value}\" is no number"))
    }
}

/// Calls `visit` with the attributes of each of these elements in a file, by name. True if the file is whole.
pub(crate) fn each_row(
    path: &Path,
    element: &str,
    mut visit: impl FnMut(&dyn Fn(&str) -> Option<String>) -> Result<(), String>,
) -> Result<bool, SumoFileError> {
    each(path, &[element], |_, record| visit(&|name| record.text(name)))
}

/// Calls `visit` with the name of each of these elements in a file and its attributes. True if the file is whole.
pub(super) fn each(
    path: &Path,
    elements: &[&str],
    mut visit: impl FnMut(&str, &Record<'_>) -> Result<(), String>,
) -> Result<bool, SumoFileError> {
    let mut magic = [0; 4];
    let begins = File::open(path).map_err(unreadable(path))?.read_exact(&mut magic);
    if path.metadata().is_ok_and(|file| file.len() == 0) {
        return Ok(false);
    }
    if begins.is_ok() && &magic == b"PAR1" {
        return columns(path, elements, parquet_rows(path)?, &mut visit);
    }
    if !is_xml(path)? {
        return columns(path, elements, csv_rows(path)?, &mut visit);
    }
    let mut xml = Xml::open(path)?;
    xml.each(|element| {
        if elements.contains(&element.name()) {
            let attribute = |name: &str| element.attribute(name);
            let told = visit(element.name(), &Record { attribute: &attribute });
            told.map_err(|what| format!("{what} in {}", element.name()))?;
        }
        Ok(ControlFlow::Continue(()))
    })?;
    Ok(xml.is_whole())
}

/// The rows of a table: column and value.
type Rows = Vec<Vec<(String, String)>>;

fn columns(
    path: &Path,
    elements: &[&str],
    rows: Rows,
    visit: &mut impl FnMut(&str, &Record<'_>) -> Result<(), String>,
) -> Result<bool, SumoFileError> {
    for (index, row) in rows.iter().enumerate() {
        for element in elements {
            let prefix = format!("{element}_");
            let value = |name: &str| row.iter().find(|(column, _)| column == name).map(|(_, value)| value.clone());
            let attribute = |name: &str| value(&format!("{prefix}{name}")).or_else(|| value(name));
            let told = visit(element, &Record { attribute: &attribute });
            told.map_err(|what| content(path, index + 2, format!("{what} in {element}")))?;
        }
    }
    Ok(true)
}

fn csv_rows(path: &Path) -> Result<Rows, SumoFileError> {
    let text = xml::text(path)?;
    let header = text.lines().next().unwrap_or_default();
    let separator = [b';', b',', b'\t'].into_iter().max_by_key(|s| header.bytes().filter(|b| b == s).count());
    let mut reader = csv::ReaderBuilder::new().delimiter(separator.unwrap_or(b';')).from_reader(text.as_bytes());
    let wrong = |error: csv::Error| {
        let line = error.position().map_or(1, |place| place.line() as usize);
        content(path, line, format!("neither XML nor CSV as SUMO writes it: {error}"))
    };
    let header = reader.headers().map_err(wrong)?.clone();
    let rows = reader.records().map(|row| {
        let row = row.map_err(wrong)?;
        Ok(header.iter().zip(row.iter()).map(|(column, value)| (column.to_owned(), value.to_owned())).collect())
    });
    rows.collect()
}

fn parquet_rows(path: &Path) -> Result<Rows, SumoFileError> {
    let damaged = |what: String| content(path, 1, format!("no Parquet file as SUMO writes it: {what}"));
    // The crate believes lengths that stand in the file, and panics at some of those that cannot be.
    let read = std::panic::catch_unwind(|| rows_of_parquet(path));
    // Behind the first sentence the crate tells programmers what it had in hand.
    let first = |error: &ParquetError| error.to_string().split(['.', '{', '[']).next().unwrap_or_default().to_owned();
    read.map_err(|_| damaged("it is damaged".to_owned()))?.map_err(|error| damaged(first(&error)))
}

fn rows_of_parquet(path: &Path) -> Result<Rows, ParquetError> {
    let reader = SerializedFileReader::try_from(path)?;
    let rows = reader.get_row_iter(None)?.map(|row| {
        let row = row?;
        let text = |field: &Field| match field {
            Field::Null => String::new(),
            Field::Str(text) => text.clone(),
            other => other.to_string(),
        };
        Ok(row.get_column_iter().map(|(column, field)| (column.clone(), text(field))).collect())
    });
    rows.collect()
}

fn content(path: &Path, line: usize, what: String) -> SumoFileError {
    SumoFileError::Content { path: path.to_owned(), line, what }
}
