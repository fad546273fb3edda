//! The changes to try, as cargo-mutants lists them.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// A small change of the code. Its number is its place in the list, from 1 on; 0 is the code as it stands.
#[derive(Clone, Debug)]
pub struct Mutant {
    /// The file below the crate's root, such as `src/cosim/egos.rs`.
    pub file: String,
    /// What is changed, with line and column: `src/cosim/egos.rs:12:3: replace < with <= in find`.
    pub name: String,
    /// The kind of change, in cargo-mutants' words: `FnValue`, `BinaryOperator`, ...
    pub genre: String,
    /// What stands there instead.
    pub replacement: String,
    /// Where the change begins: line and column, both counted from 1, the column in characters.
    pub line: usize,
    pub column: usize,
}

impl Mutant {
    /// The name without line and column, which other changes of the file do not touch.
    pub fn short_name(&self) -> String {
        format!("{}: {}", self.file, self.name.splitn(4, ':').nth(3).unwrap_or(&self.name).trim_start())
    }

    /// The room of the file: `cosim` for `src/cosim/egos.rs` and for `src/cosim.rs`.
    pub fn room(&self) -> &str {
        self.file.trim_start_matches("src/").trim_end_matches(".rs").split('/').next().unwrap_or_default()
    }
}

/// Lists the changes of all files of `crate_root` in `places` (`src/cosim`, ...), place by place.
///
/// # Errors
/// When cargo-mutants is missing, or its list is not understood.
pub fn list(crate_root: &Path, places: &[String]) -> Result<Vec<Mutant>, String> {
    let mut command = Command::new(cargo());
    command.args(["mutants", "--list", "--json", "--dir"]).arg(crate_root).current_dir(crate_root);
    let ended = command.output().map_err(|error| format!("cargo cannot be started: {error}"))?;
    let said = String::from_utf8_lossy(&ended.stderr);
    if said.contains("no such command") {
        return Err("cargo-mutants is missing, which lists the changes to try: cargo install cargo-mutants".into());
    }
    if !ended.status.success() {
        return Err(format!("cargo mutants --list has failed:\n{said}"));
    }
    read_all(&ended.stdout, places)
}

/// Reads what `cargo mutants --list --json` has printed.
///
/// # Errors
/// When it is not understood.
pub fn read_all(listed: &[u8], places: &[String]) -> Result<Vec<Mutant>, String> {
    let all: Vec<Value> =
        serde_json::from_slice(listed).map_err(|error| format!("the list of cargo-mutants: {error}"))?;
    let mutants = all.iter().map(|entry| read(entry).ok_or_else(|| format!("cargo-mutants lists {entry}")));
    let mut mutants = mutants.collect::<Result<Vec<Mutant>, String>>()?;
    mutants.retain(|mutant| places.iter().any(|place| is_in(&mutant.file, place)));
    let place = |mutant: &Mutant| places.iter().position(|place| is_in(&mutant.file, place));
    mutants.sort_by_key(|mutant| (place(mutant), mutant.file.clone(), mutant.line));
    Ok(mutants)
}

/// The program of cargo: the one that runs this, if one does.
pub fn cargo() -> std::ffi::OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// `src/cosim` holds `src/cosim.rs`, `src/cosim/egos.rs`, and, as `src/cosim/egos`, the latter alone.
pub fn is_in(file: &str, place: &str) -> bool {
    file.strip_prefix(place).is_some_and(|rest| rest.is_empty() || rest.starts_with('/') || rest == ".rs")
}

fn read(entry: &Value) -> Option<Mutant> {
    let text = |key: &str| entry[key].as_str().map(String::from);
    let start = &entry["span"]["start"];
    Some(Mutant {
        file: text("file")?,
        name: text("name")?,
        genre: text("genre")?,
        replacement: text("replacement")?,
        line: start["line"].as_u64()? as usize,
        column: start["column"].as_u64()? as usize,
    })
}
