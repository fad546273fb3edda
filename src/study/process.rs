//! The process that runs one case, and the words in which its end is written down. All executors use the same.

use crate::run::{Backend, MANIFEST};
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// Runs the case whose planned `run.json` lies in `dir`, with this SUMO. It ends in order, within a step, when its standard
/// input ends.
pub fn command(program: &Path, (sumo, backend): (&Path, Backend), dir: &Path) -> Command {
    let mut command = Command::new(program);
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
