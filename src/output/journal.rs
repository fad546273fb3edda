//! Rows that are on disk from the moment they are known: lines of CSV in `<table>.part`, until the whole table is written. At
//! the end of a step the rows of all vehicles that left in it are handed to the system, before the next step is asked for: a
//! killed program loses at most those of the step under way. Only a power cut may cost more.

use super::atomic::{PartFile, part_of};
use super::csv::{header, line};
use super::error::{OutputError, file_error};
use super::sorted::{Section, unnamed};
use super::text::append;
use super::write::Table;
use crate::table::{Layout, Shape};
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::ops::Range;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

/// Rows of a table that is not whole.
pub struct Journal<R: 'static> {
    layout: &'static Layout<R>,
    path: PathBuf,
    /// What errors call it.
    name: PathBuf,
    file: File,
    /// Where the header ends, and the last row.
    rows: Range<u64>,
}

impl<R> Journal<R> {
    /// The journal of the table that will be at `path`, whatever its format.
    ///
    /// # Errors
    /// [`OutputError::File`] if the file cannot be made.
    pub fn create(path: &Path, layout: &'static Layout<R>) -> Result<Self, OutputError> {
        let part = part_of(path);
        let file = File::options().read(true).write(true).create(true).truncate(true).open(&part);
        Self::begin(file, path, part, layout)
    }

    /// One that nobody will see, in the folder of `path`.
    ///
    /// # Errors
    /// [`OutputError::File`] if the file cannot be made.
    pub fn unnamed(path: &Path, layout: &'static Layout<R>) -> Result<Self, OutputError> {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Self::begin(unnamed(&folder), path, folder, layout)
    }

    fn begin(
        file: io::Result<File>,
        path: &Path,
        name: PathBuf,
        layout: &'static Layout<R>,
    ) -> Result<Self, OutputError> {
        let made = file.and_then(|file| {
            let header = header(&layout.shape.columns)?;
            file.write_all_at(&header, 0)?;
            Ok((file, header.len() as u64))
        });
        let (file, begin) = made.map_err(file_error("create", &name))?;
        Ok(Self { layout, path: path.to_owned(), name, file, rows: begin..begin })
    }

    /// Appends rows. The system has them when this returns, whatever becomes of this program. After an error none of them
    /// is there.
    ///
    /// # Errors
    /// [`OutputError::File`], e.g. when the disk is full.
    pub fn append<'r>(&mut self, rows: impl IntoIterator<Item = &'r R>) -> Result<(), OutputError> {
        let lines: io::Result<Vec<_>> = rows.into_iter().map(|row| line(&mut self.layout.cells(row))).collect();
        let written = lines.map(|lines| lines.concat()).and_then(|lines| {
            self.file.write_all_at(&lines, self.rows.end).map(|()| self.rows.end += lines.len() as u64)
        });
        written.map_err(|error| {
            self.cut(self.rows.end);
            file_error("write", &self.name)(error)
        })
    }

    /// How long it is, for [`Journal::cut`].
    pub fn len(&self) -> u64 {
        self.rows.end
    }

    /// Takes the rows back that came after it was so long.
    pub fn cut(&mut self, length: u64) {
        self.rows.end = length;
        // What stands behind the end is written over, and read by nobody but who recovers.
        let _ = self.file.set_len(length);
    }

    /// The texts of all rows, in the order in which they came.
    pub fn texts(&self) -> impl Iterator<Item = Result<Vec<String>, OutputError>> {
        let section = Section { file: &self.file, range: self.rows.clone() };
        let reader = csv::ReaderBuilder::new().has_headers(false).flexible(false).from_reader(section);
        reader
            .into_deserialize()
            .map(|row| row.map_err(|error| file_error("read", &self.name)(io::Error::other(error))))
    }

    /// The texts of a row that is in no journal.
    pub fn texts_of(&self, row: &R) -> Vec<String> {
        texts(self.layout, row)
    }

    /// Writes the whole table from the texts of its rows; it takes the place of the journal.
    ///
    /// # Errors
    /// [`OutputError`]; the journal stays then.
    pub fn finish(&self, rows: impl Iterator<Item = Result<Vec<String>, OutputError>>) -> Result<PathBuf, OutputError> {
        write_over(&self.path, &Layout::of_texts(&self.layout.shape), rows)
    }
}

/// The texts of the values of a row.
pub fn texts<R: 'static>(layout: &Layout<R>, row: &R) -> Vec<String> {
    let text = |cell| {
        let mut text = String::new();
        append(&mut text, cell);
        text
    };
    layout.cells(row).map(text).collect()
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
pub fn write_over<R: 'static>(
    path: &Path,
    layout: &Layout<R>,
    rows: impl IntoIterator<Item = Result<R, OutputError>>,
) -> Result<PathBuf, OutputError> {
    let mut table = Table::open(PartFile::create_as(path, whole_of(path))?, layout)?;
    for row in rows {
        table.write(&row?)?;
    }
    let path = table.finish()?;
    let journal = part_of(&path);
    match std::fs::remove_file(&journal) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(file_error("remove", &journal)(error)),
        _ => Ok(path),
    }
}

/// The rows of a journal as texts, one by one; a line that the end of the program cut in two is left out.
///
/// # Errors
/// [`OutputError::File`] if it cannot be read, or has other columns.
pub fn read_journal(
    path: &Path,
    shape: &Shape,
) -> Result<impl Iterator<Item = Result<Vec<String>, OutputError>> + use<>, OutputError> {
    let part = part_of(path);
    let open = || -> io::Result<_> {
        let file = File::open(&part)?;
        let header = header(&shape.columns)?;
        let mut first = vec![0; header.len()];
        match file.read_exact_at(&mut first, 0) {
            Ok(()) if first == header => {}
            Err(error) if error.kind() != ErrorKind::UnexpectedEof => return Err(error),
            _ => {
                let what = "its first line is not that of a table of this version";
                return Err(io::Error::new(ErrorKind::InvalidData, what));
            }
        }
        let begin = header.len() as u64;
        let end = whole_lines(&file)?.max(begin);
        (&file).seek(SeekFrom::Start(begin))?;
        Ok(BufReader::new(file.take(end - begin)))
    };
    let lines = open().map_err(file_error("read", &part))?;
    let reader = csv::ReaderBuilder::new().has_headers(false).flexible(false).from_reader(lines);
    let failed = move |error| file_error("read", &part)(io::Error::other(error));
    Ok(reader.into_deserialize().map(move |row: Result<_, _>| row.map_err(&failed)))
}

/// Where the last whole line of a file ends.
///
/// # Errors
/// If it cannot be read.
pub fn whole_lines(file: &File) -> io::Result<u64> {
    let mut end = file.metadata()?.len();
    let mut bytes = [0; 1 << 12];
    while end > 0 {
        let begin = end.saturating_sub(bytes.len() as u64);
        let read = &mut bytes[..(end - begin) as usize];
        file.read_exact_at(read, begin)?;
        if let Some(place) = read.iter().rposition(|byte| *byte == b'\n') {
            return Ok(begin + place as u64 + 1);
        }
        end = begin;
    }
    Ok(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::record;
    use std::io::Write;
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

    fn read(path: &Path) -> Result<Vec<Vec<String>>, OutputError> {
        read_journal(path, &POINTS.shape)?.collect()
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
        let texts = read(&path).unwrap();
        assert_eq!(texts, [["a,\"b\"\n c", "0.1", "true"], ["d", "", "false"]]);
        // Read as what the columns say.
        let (as_texts, rows) = (Layout::of_texts(&POINTS.shape), points());
        for (text, row) in texts.iter().zip(&rows) {
            assert!(as_texts.cells(text).eq(POINTS.cells(row)));
        }
        assert_eq!(journal.texts().map(Result::unwrap).collect::<Vec<_>>(), texts);
        assert_eq!(journal.texts_of(&rows[0]), texts[0]);
        let whole = journal.finish(journal.texts()).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "{}", whole.display());
    }

    #[test]
    fn a_table_that_cannot_be_written_leaves_the_journal() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        let mut journal = Journal::create(&path, &POINTS).unwrap();
        journal.append(&points()).unwrap();
        std::os::unix::fs::symlink("/dev/full", whole_of(&path)).unwrap();
        assert!(journal.finish(journal.texts()).is_err());
        assert_eq!(read(&path).unwrap().len(), 2);
    }

    #[test]
    fn rows_that_cannot_be_appended_leave_no_part_of_a_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        let mut journal = Journal::create(&path, &POINTS).unwrap();
        journal.append(&points()[..1]).unwrap();
        let whole = std::mem::replace(&mut journal.file, File::open(part_of(&path)).unwrap());
        whole.write_all_at(b"half a li", journal.rows.end).unwrap();
        assert!(journal.append(&points()[1..]).is_err(), "a file that is only read");
        journal.file = whole;
        assert_eq!(journal.texts().count(), 1);
        journal.append(&points()[1..]).unwrap();
        assert_eq!(read(&path).unwrap().len(), 2);
    }

    #[test]
    fn a_journal_of_other_columns_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        for text in ["id,speed\na,1\n", "id,something,else\na,1,2\n", "id", ""] {
            std::fs::write(part_of(&path), text).unwrap();
            let error = read(&path).unwrap_err().to_string();
            assert!(error.contains("points.csv.part") && error.contains("first line"), "{text}: {error}");
        }
    }

    #[test]
    fn a_torn_line_may_be_long() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.csv");
        let mut journal = Journal::create(&path, &POINTS).unwrap();
        journal.append(&points()).unwrap();
        let whole = std::fs::metadata(part_of(&path)).unwrap().len();
        for torn in [0, 1, 4095, 4096, 4097, 100_000] {
            let mut file = File::options().append(true).open(part_of(&path)).unwrap();
            file.set_len(whole).unwrap();
            file.write_all(&vec![b'x'; torn]).unwrap();
            assert_eq!(whole_lines(&File::open(part_of(&path)).unwrap()).unwrap(), whole, "{torn}");
            assert_eq!(read(&path).unwrap().len(), 2, "{torn}");
        }
    }
}
