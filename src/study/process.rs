//! The process that runs one case, and the words in which its end is written down. All executors use the same.

use crate::run::{Backend, MANIFEST};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// How the program is started again: its file, and what stands before its arguments (`-m sumo_mfc` behind Python's).
#[derive(Debug, Clone)]
pub struct Program {
    file: PathBuf,
    first: Vec<OsString>,
}

impl Program {
    /// A program.
    pub fn new(file: PathBuf, first: Vec<OsString>) -> Self {
        Self { file, first }
    }

    /// The file of this process.
    ///
    /// # Errors
    /// If the system does not tell it.
    pub fn current() -> std::io::Result<Self> {
        std::env::current_exe().map(|file| Self::new(file, Vec::new()))
    }

    /// The words that start it.
    pub fn words(&self) -> impl Iterator<Item = String> {
        let file = [self.file.display().to_string()];
        file.into_iter().chain(self.first.iter().map(|word| word.to_string_lossy().into_owned()))
    }

    fn command(&self) -> Command {
        let mut command = Command::new(&self.file);
        command.args(&self.first);
        command
    }
}

/// Runs the case whose planned `run.json` lies in `dir`, with this SUMO. It ends in order, within a step, when its standard
/// input ends.
pub fn command(program: &Program, (sumo, backend): (&Path, Backend), dir: &Path) -> Command {
    let mut command = program.command();
    command
        .args(["run", "--quiet", "--no-report", "--force", "--tied", "--threads", "1", "--from"])
        .arg(dir.join(MANIFEST));
    command.args(["--backend", backend.name()]);
    command.arg("-o").arg(dir).env("SUMO_BINARY", sumo);
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// Why a process has ended that did not say so itself.
pub fn last_words(output: &Output) -> String {
    let said = String::from_utf8_lossy(&output.stderr);
    let said: Vec<&str> = said.split_whitespace().collect();
    format!("{}: {}", output.status, said.join(" ")).trim_end_matches([':', ' ']).to_owned()
}
