//! Rows that are on disk from the moment they are known: lines of CSV in `<table>.part`, until the whole table is written.

use super::atomic::{PartFile, part_of};
use super::csv::{header, line};
use super::error::{OutputError, file_error};
use super::write::Table;
use crate::table::{Layout, Shape};
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Rows of a table that is not whole.
pub struct Journal<R: 'static> {
    layout: &'static Layout<R>,
    path: PathBuf,
    file: File,
}

impl<R> Journal<R> {
    /// The journal of the table that will be at `path`, whatever its format.
    ///
    /// # Errors
    /// [`OutputError::File`] if the file cannot be made.
    pub fn create(path: &Path, layout: &'static Layout<R>) -> Result<Self, OutputError> {
        let part = part_of(path);
        let made =
            File::create(&part).and_then(|mut file| file.write_all(&header(&layout.shape.columns)?).map(|()| file));
        let file = made.map_err(file_error("create", &part))?;
        Ok(Self { layout, path: path.to_owned(), file })
    }

    /// Appends rows. The system has them when this returns, whatever becomes of this program.
    ///
    /// # Errors
    /// [`OutputError::File`], e.g. when the disk is full.
    pub fn append<'r>(&mut self, rows: impl IntoIterator<Item = &'r R>) -> Result<(), OutputError> {
        let lines: io::Result<Vec<_>> = rows.into_iter().map(|row| line(&mut self.layout.cells(row))).collect();
        let written = lines.and_then(|lines| self.file.write_all(&lines.concat()));
        written.map_err(file_error("write", &part_of(&self.path)))
    }

    /// Writes the whole table, which takes the place of the journal.
    ///
    /// # Errors
    /// [`OutputError`]; the journal stays then.
    pub fn finish<'r>(&self, rows: impl IntoIterator<Item = &'r R>) -> Result<PathBuf, OutputError> {
        write_over(&self.path, self.layout, rows)
    }
}

/// Where the whole table is written while its journal is there.
pub fn whole_of(path: &Path) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(".whole.part");
    name.into()
}

/// Writes a whole table, and then removes its journal.
///
/// # Errors
/// [`OutputError`]; the journal stays then.
pub fn write_over<'r, R: 'static>(
    path: &Path,
    layout: &Layout<R>,
    rows: impl IntoIterator<Item = &'r R>,
) -> Result<PathBuf, OutputError> {
    let mut table = Table::open(PartFile::create_as(path, whole_of(path))?, layout)?;
    for row in rows {
        table.write(row)?;
    }
    let path = table.finish()?;
    let journal = part_of(&path);
    match std::fs::remove_file(&journal) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(file_error("remove", &journal)(error)),
        _ => Ok(path),
    }
}

/// The rows of a journal as texts; a line that the end of the program cut in two is left out.
///
/// # Errors
/// [`OutputError::File`] if it cannot be read, or has other columns.
pub fn read_journal(path: &Path, shape: &Shape) -> Result<Vec<Vec<String>>, OutputError> {
    let part = part_of(path);
    let read = || -> io::Result<Vec<Vec<String>>> {
        let mut bytes = std::fs::read(&part)?;
        bytes.truncate(bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1));
        let rest = bytes.strip_prefix(header(&shape.columns)?.as_slice()).ok_or_else(|| {
            io::Error::new(ErrorKind::InvalidData, "its first line is not that of a table of this version")
        })?;
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(false).from_reader(rest);
        reader.deserialize().map(|row| row.map_err(io::Error::other)).collect()
    };
    read().map_err(file_error("read", &part))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::record;
    use std::sync::LazyLock;

    record! {
        /// A row.
        #[derive(Debug, Clone, PartialEq)]
        pub struct Point {
            id: String = "A name";
            speed: Option<f64> = "A speed" ["m/s"];
            here: bool = "A flag";
        }
    }

    static POINTS: LazyLock<Layout<Point>> =
        LazyLock::new(|| Layout::of_record(["points", "point"], "One row per point"));

    fn points() -> [Point; 2] {
        let point = |id: &str, speed, here| Point { id: id.to_owned(), speed, here };
        [point("a,\"b\"\n c", Some(0.1), true), point("d", None, false)]
    }

    #[test]
    fn rows_are_there_as_soon_as_they_are_appended() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.parquet");
        let mut journal = Journal::create(&path, &POINTS).unwrap();
        journal.append(&points()[..1]).unwrap();
        journal.append(&points()[1..]).unwrap();
        let mut file = std::fs::OpenOptions::new().append(true).open(part_of(&path)).unwrap();
        file.write_all(b"e,0.").unwrap();
        let texts = read_journal(&path, &POINTS.shape).unwrap();
        assert_eq!(texts, [["a,\"b\"\n c", "0.1", "true"], ["d", "", "false"]]);
        // Read as what the columns say.
        let (as_texts, rows) = (Layout::of_texts(&POINTS.shape), points());
        for (text, row) in texts.iter().zip(&rows) {
            assert!(as_texts.cells(text).eq(POINTS.cells(row)));
        }
        let whole = journal.finish(&rows).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "{}", whole.display());
    }

    #[test]
    fn a_table_that_cannot_be_written_leaves_the_journal() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        let mut journal = Journal::create(&path, &POINTS).unwrap();
        journal.append(&points()).unwrap();
        std::os::unix::fs::symlink("/dev/full", whole_of(&path)).unwrap();
        assert!(journal.finish(&points()).is_err());
        assert_eq!(read_journal(&path, &POINTS.shape).unwrap().len(), 2);
    }

    #[test]
    fn a_journal_of_other_columns_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        std::fs::write(part_of(&path), "id,speed\na,1\n").unwrap();
        let error = read_journal(&path, &POINTS.shape).unwrap_err().to_string();
        assert!(error.contains("points.csv.part") && error.contains("first line"), "{error}");
    }
}
