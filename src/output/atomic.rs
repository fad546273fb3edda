//! Files that exist under their name only when they are whole.

use super::error::{OutputError, file_error};
use serde::Serialize;
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file being written as `<path>.part`. [`PartFile::finish`] gives it its name; without that (error, panic, kill) the
/// `.part` stays as it is, for whoever wants to look.
#[derive(Debug)]
pub struct PartFile {
    path: PathBuf,
    part: PathBuf,
    writer: BufWriter<File>,
}

impl PartFile {
    /// Opens `<path>.part`; missing folders above it are made.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the folder or file that could not be made.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        Self::create_as(path, part_of(path))
    }

    /// The same with another name until then.
    pub(super) fn create_as(path: &Path, part: PathBuf) -> Result<Self, OutputError> {
        if let Some(folder) = path.parent().filter(|p| !p.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).map_err(file_error("create", folder))?;
        }
        let file = File::create(&part).map_err(file_error("create", &part))?;
        Ok(Self { path: path.to_owned(), part, writer: BufWriter::new(file) })
    }

    /// Where the file will be.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes what is buffered to the disk and gives the file its name, replacing a file that has it.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the file, e.g. when the disk is full.
    pub fn finish(mut self) -> Result<PathBuf, OutputError> {
        self.writer.flush().and_then(|()| self.writer.get_ref().sync_all()).map_err(file_error("write", &self.part))?;
        std::fs::rename(&self.part, &self.path).map_err(file_error("rename to", &self.path))?;
        Ok(self.path)
    }
}

impl Write for PartFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

/// The name under which `path` is written.
pub fn part_of(path: &Path) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(".part");
    name.into()
}

/// Writes a value as JSON.
///
/// # Errors
/// As [`write_whole`].
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<PathBuf, OutputError> {
    let text = serde_json::to_string_pretty(value).map_err(|e| file_error("write", path)(e.into()))?;
    write_whole(path, &(text + "\n"))
}

/// Writes a whole small file.
///
/// # Errors
/// [`OutputError::File`] naming the file.
pub fn write_whole(path: &Path, text: &str) -> Result<PathBuf, OutputError> {
    let mut file = PartFile::create(path)?;
    file.write_all(text.as_bytes()).map_err(file_error("write", path))?;
    file.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_appears_only_when_the_file_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deeper/vehicles.csv");
        let mut file = PartFile::create(&path).unwrap();
        file.write_all(b"id\n").unwrap();
        file.flush().unwrap();
        assert!(!path.exists());
        assert_eq!(std::fs::read(part_of(&path)).unwrap(), b"id\n");
        file.finish().unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"id\n");
        assert!(!part_of(&path).exists());
    }

    #[test]
    fn what_was_written_stays_when_the_end_never_comes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("trace.csv");
        drop(PartFile::create(&path).map(|mut f| f.write_all(b"time\n")));
        assert_eq!(std::fs::read(part_of(&path)).unwrap(), b"time\n");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error_that_names_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        std::os::unix::fs::symlink("/dev/full", part_of(&path)).unwrap();
        let error = write_whole(&path, "{}").unwrap_err().to_string();
        assert!(error.contains("summary.json.part") && error.contains("No space left"), "{error}");
        assert!(!path.exists());
    }

    #[test]
    fn a_file_where_a_folder_should_be_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let blocked = folder.path().join("out");
        std::fs::write(&blocked, "").unwrap();
        let error = PartFile::create(&blocked.join("run.json")).unwrap_err().to_string();
        assert!(error.starts_with(&format!("cannot create {}", blocked.display())), "{error}");
    }
}
