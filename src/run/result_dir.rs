//! The folder of one run.

use super::error::RunError;
use super::manifest::{Manifest, Status};
use crate::output::{FORMATS, OutputError, file_error, part_of, whole_of, write_json};
use serde::Serialize;
use std::fs::{File, TryLockError};
use std::os::unix::fs::MetadataExt;
use std::path::{Component, Path, PathBuf};

/// The tables that a run may write, without suffix.
const TABLES: [&str; 5] = ["vehicles", "quality", "trace", "edges", "sample"];
/// What was run.
pub const MANIFEST: &str = "run.json";
/// The summary.
pub(super) const SUMMARY: &str = "summary.json";
/// What the files contain.
pub(super) const SCHEMA: &str = "schema.json";

/// The folder that a run writes to, held for as long as this value lives.
#[derive(Debug)]
pub struct ResultDir {
    path: PathBuf,
    /// The folder itself, locked: the system lets go of it even if the process is killed.
    _lock: Option<File>,
}

impl ResultDir {
    /// Makes `path` (and the folders above it) the folder of a run. A folder that holds a result is refused unless
    /// `force`; with `force` the files of that result are removed, and only those: files that a run of this program
    /// writes, and those which its manifest lists.
    ///
    /// # Errors
    /// [`RunError::Finished`], [`RunError::Busy`], or [`OutputError::File`] naming what could not be made.
    pub fn create(path: &Path, force: bool) -> Result<Self, RunError> {
        std::fs::create_dir_all(path).map_err(file_error("create", path))?;
        Self::open(path)?.cleared(force)
    }

    /// The folder of a run that has ended, as it is.
    ///
    /// # Errors
    /// [`RunError::Busy`] if it has not.
    pub fn open(path: &Path) -> Result<Self, RunError> {
        Ok(Self { path: path.to_owned(), _lock: lock(path)? })
    }

    /// Makes it the folder of a run, as [`ResultDir::create`].
    pub(super) fn cleared(self, force: bool) -> Result<Self, RunError> {
        let manifest = self.read_manifest();
        if !force && let Some(found) = self.result_found(manifest.as_ref()) {
            return Err(RunError::Finished { dir: self.path, found });
        }
        self.clear(manifest.as_ref())?;
        // Asks for the permission now rather than after hours of simulation.
        let probe = part_of(&self.file(MANIFEST));
        File::create(&probe).map_err(file_error("create", &probe))?;
        std::fs::remove_file(&probe).map_err(file_error("remove", &probe))?;
        Ok(self)
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The folder of SUMO's log and outputs, made if it is missing.
    ///
    /// # Errors
    /// [`OutputError::File`] if it cannot be made.
    pub fn sumo(&self) -> Result<PathBuf, OutputError> {
        let folder = self.file("sumo");
        std::fs::create_dir_all(&folder).map_err(file_error("create", &folder))?;
        Ok(folder)
    }

    /// Writes `run.json`.
    ///
    /// # Errors
    /// [`OutputError::File`] if it cannot be written.
    pub fn write_manifest(&self, manifest: &Manifest) -> Result<PathBuf, OutputError> {
        self.write(MANIFEST, manifest)
    }

    /// Writes one of the other files of JSON.
    ///
    /// # Errors
    /// [`OutputError::File`] if it cannot be written.
    pub fn write(&self, name: &str, value: &impl Serialize) -> Result<PathBuf, OutputError> {
        write_json(&self.file(name), value)
    }

    /// Ends the manifest: status `complete`, or `incomplete` with the reason, and the list of all files that are there,
    /// added to those that it already names (tables that go by another name).
    ///
    /// # Errors
    /// [`OutputError::File`] if the folder cannot be read or `run.json` not be written.
    pub fn finish(&self, manifest: &mut Manifest, incomplete: Option<String>) -> Result<(), OutputError> {
        manifest.status = if incomplete.is_some() { Status::Incomplete } else { Status::Complete };
        manifest.reason = incomplete;
        manifest.files.extend(self.files()?.into_iter().chain([MANIFEST.to_owned()]));
        manifest.files.sort();
        manifest.files.dedup();
        self.write_manifest(manifest).map(drop)
    }

    /// The whole files of the result, relative and in order: those of this program and those in `sumo/`.
    ///
    /// # Errors
    /// [`OutputError::File`] if the folder cannot be read.
    pub fn files(&self) -> Result<Vec<String>, OutputError> {
        let mut files: Vec<String> = own_names().filter(|name| self.file(name).is_file()).collect();
        let sumo = self.file("sumo");
        if sumo.is_dir() {
            for entry in std::fs::read_dir(&sumo).map_err(file_error("read", &sumo))? {
                let entry = entry.map_err(file_error("read", &sumo))?;
                if entry.path().is_file() {
                    files.push(format!("sumo/{}", entry.file_name().to_string_lossy()));
                }
            }
        }
        files.sort();
        Ok(files)
    }

    fn read_manifest(&self) -> Option<Manifest> {
        serde_json::from_str(&std::fs::read_to_string(self.file(MANIFEST)).ok()?).ok()
    }

    /// What makes this folder hold a result. The rest of a run that was killed (`running`) is none.
    fn result_found(&self, manifest: Option<&Manifest>) -> Option<String> {
        match manifest {
            Some(Manifest { status: Status::Complete, .. }) => Some("run.json: complete".into()),
            Some(Manifest { status: Status::Planned | Status::Running | Status::Incomplete, .. }) => None,
            None => own_names().find(|name| self.file(name).exists()),
        }
    }

    /// The page that a report made of the result, and its figures: they are no part of the result, but go with it.
    fn pages(&self) -> Result<Vec<String>, OutputError> {
        let mut pages = vec!["report.html".to_owned()];
        let folder = self.file("report");
        if folder.is_dir() {
            for entry in std::fs::read_dir(&folder).map_err(file_error("read", &folder))? {
                let name = entry.map_err(file_error("read", &folder))?.file_name().to_string_lossy().into_owned();
                pages.extend(name.ends_with(".svg").then(|| format!("report/{name}")));
            }
        }
        Ok(pages)
    }

    fn clear(&self, manifest: Option<&Manifest>) -> Result<(), OutputError> {
        let listed = manifest.into_iter().flat_map(|m| &m.files).filter(|name| stays_below(Path::new(name)));
        let pages = self.pages()?;
        for name in own_names().chain(listed.cloned()).chain(pages) {
            let path = self.file(&name);
            for stale in [part_of(&path), whole_of(&path), path] {
                if stale.is_file() || stale.is_symlink() {
                    std::fs::remove_file(&stale).map_err(file_error("remove", &stale))?;
                }
            }
        }
        Ok(())
    }
}

/// A folder that must stay where it is.
#[derive(Debug)]
pub struct Standing {
    path: PathBuf,
    device_and_inode: (u64, u64),
}

impl Standing {
    /// The folder at `path` as it is now.
    ///
    /// # Errors
    /// [`OutputError::File`] if there is none.
    pub fn of(path: &Path) -> Result<Self, OutputError> {
        let device_and_inode = identity(path).map_err(file_error("read", path))?;
        Ok(Self { path: path.to_owned(), device_and_inode })
    }

    /// The folder, if it is there no more, or is another one by now.
    pub fn deleted(&self) -> Option<&Path> {
        (identity(&self.path).ok() != Some(self.device_and_inode)).then_some(&*self.path)
    }
}

fn identity(path: &Path) -> std::io::Result<(u64, u64)> {
    path.metadata().map(|folder| (folder.dev(), folder.ino()))
}

/// The files that this program writes into a result, `sumo/` apart.
fn own_names() -> impl Iterator<Item = String> {
    let tables = TABLES.into_iter().flat_map(|table| FORMATS.iter().map(move |f| format!("{table}.{}", f.name)));
    [MANIFEST, SUMMARY, SCHEMA].map(str::to_owned).into_iter().chain(tables)
}

/// A manifest is a file that anybody can edit: nothing outside the folder may be removed for it.
fn stays_below(path: &Path) -> bool {
    path.components().all(|part| matches!(part, Component::Normal(_)))
}

/// Locks the folder; on systems where a folder cannot be locked, does without.
fn lock(path: &Path) -> Result<Option<File>, RunError> {
    let Ok(folder) = File::open(path) else { return Ok(None) };
    match folder.try_lock() {
        Ok(()) => Ok(Some(folder)),
        Err(TryLockError::WouldBlock) => Err(RunError::Busy { dir: path.to_owned() }),
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest() -> Manifest {
        Manifest::new(42, "[sumo]\n".into(), Vec::new())
    }

    #[test]
    fn a_finished_result_is_refused_without_force() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out/city-adaptive-42");
        for incomplete in [Some("SUMO died".to_owned()), None] {
            // A run that was killed, or broke off, is no finished result.
            let dir = ResultDir::create(&path, false).unwrap();
            dir.write_manifest(&manifest()).unwrap();
            drop(dir);
            let dir = ResultDir::create(&path, false).unwrap();
            std::fs::write(dir.file("vehicles.csv"), "id\n").unwrap();
            std::fs::write(dir.sumo().unwrap().join("tripinfo.xml"), "").unwrap();
            dir.finish(&mut manifest(), incomplete.clone()).unwrap();
            let read: Manifest =
                serde_json::from_str(&std::fs::read_to_string(path.join("run.json")).unwrap()).unwrap();
            assert_eq!(read.files, ["run.json", "sumo/tripinfo.xml", "vehicles.csv"]);
            assert_eq!(read.reason, incomplete);
        }
        let error = ResultDir::create(&path, false).unwrap_err();
        assert!(matches!(error, RunError::Finished { .. }), "{error}");
        assert!(error.to_string().contains("--force"), "{error}");
        ResultDir::create(&path, true).unwrap();
    }

    #[test]
    fn force_removes_the_result_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result");
        let dir = ResultDir::create(&path, false).unwrap();
        std::fs::write(folder.path().join("precious"), "").unwrap();
        std::fs::create_dir(dir.sumo().unwrap().join("mine")).unwrap();
        for name in ["vehicles.parquet", "trace.csv.part", "notes.txt", "sumo/log.txt"] {
            std::fs::write(dir.file(name), "").unwrap();
        }
        let mut manifest = manifest();
        dir.finish(&mut manifest, None).unwrap();
        std::fs::write(dir.file("sumo/later.xml"), "").unwrap();
        manifest.files.push("../precious".into());
        dir.write_manifest(&manifest).unwrap();
        drop(dir);
        ResultDir::create(&path, true).unwrap();
        for gone in ["vehicles.parquet", "trace.csv.part", "run.json", "sumo/log.txt"] {
            assert!(!path.join(gone).exists(), "{gone}");
        }
        for kept in ["notes.txt", "sumo/mine", "sumo/later.xml", "../precious"] {
            assert!(path.join(kept).exists(), "{kept}");
        }
    }

    #[test]
    fn somebody_elses_table_is_not_overwritten_silently() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("vehicles.csv"), "mine").unwrap();
        assert!(matches!(ResultDir::create(folder.path(), false), Err(RunError::Finished { .. })));
    }

    #[test]
    fn two_runs_do_not_write_to_one_folder() {
        let folder = tempfile::tempdir().unwrap();
        let first = ResultDir::create(folder.path(), false).unwrap();
        assert!(matches!(ResultDir::create(folder.path(), true), Err(RunError::Busy { .. })));
        drop(first);
        ResultDir::create(folder.path(), false).unwrap();
    }

    #[test]
    fn a_folder_of_the_same_name_is_another_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result");
        std::fs::create_dir(&path).unwrap();
        let standing = Standing::of(&path).unwrap();
        assert_eq!(standing.deleted(), None);
        // It goes, but its number is not free.
        let moved = folder.path().join("moved");
        std::fs::rename(&path, &moved).unwrap();
        assert_eq!(standing.deleted(), Some(&*path));
        std::fs::create_dir(&path).unwrap();
        assert_eq!(standing.deleted(), Some(&*path));
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let blocked = folder.path().join("file");
        std::fs::write(&blocked, "").unwrap();
        let error = ResultDir::create(&blocked.join("result"), false).unwrap_err().to_string();
        assert!(error.starts_with(&format!("cannot create {}", blocked.join("result").display())), "{error}");
    }
}
