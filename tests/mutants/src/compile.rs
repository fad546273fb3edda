//! The copy, compiled with all changes in it. What does not compile is taken out, by the compiler's messages.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::list::Mutant;
use crate::refused::Refused;
use crate::rewrite::{marks, rewrite};
use crate::tree::write_new;

/// What there is to try.
pub struct Built {
    /// The programs of tests: a name such as `coupling`, and the file.
    pub programs: Vec<(String, PathBuf)>,
    /// Numbers of the changes that are in the programs.
    pub placed: HashSet<u32>,
}

/// Rewrites the files of `mutants` from `root` to `tree` and builds the tests there with `cargo test --no-run ARGUMENTS`, again
/// and again until all that is left compiles; what does not is added to `refused`.
///
/// # Errors
/// When the build fails for another reason than a change.
pub fn compile(
    root: &Path,
    tree: &Path,
    mutants: &[Mutant],
    arguments: &[String],
    refused: &mut Refused,
) -> Result<Built, String> {
    loop {
        let placed = place(root, tree, mutants, &refused.numbers)?;
        let messages = build(tree, arguments)?;
        let errors: Vec<&Value> =
            messages.iter().map(|line| &line["message"]).filter(|message| message["level"] == "error").collect();
        if errors.is_empty() {
            let programs: Vec<_> = messages.iter().filter_map(program).collect();
            if programs.is_empty() {
                return Err("cargo has built no test: see above".into());
            }
            return Ok(Built { programs, placed });
        }
        let found: BTreeSet<u32> = errors.iter().flat_map(|message| blamed(tree, message)).collect();
        if found.is_empty() {
            let said: Vec<&str> = errors.iter().filter_map(|message| message["rendered"].as_str()).collect();
            return Err(format!("no change is to blame for this:\n{}", said.join("\n")));
        }
        eprintln!("{} of {} changes do not compile: once more without them", found.len(), placed.len());
        refused.extend(found).map_err(|error| format!("the list of what is refused: {error}"))?;
    }
}

/// Writes the rewritten files and the switch. Gives the numbers of the changes that have found a place.
fn place(root: &Path, tree: &Path, mutants: &[Mutant], refused: &BTreeSet<u32>) -> Result<HashSet<u32>, String> {
    let mut files: BTreeMap<&str, Vec<(u32, &Mutant)>> = BTreeMap::new();
    for (number, mutant) in (1..).zip(mutants) {
        let of_file = files.entry(&mutant.file).or_default();
        if !refused.contains(&number) {
            of_file.push((number, mutant));
        }
    }
    let mut placed = HashSet::new();
    for (file, wanted) in files {
        let read = fs::read_to_string(root.join(file)).map_err(|error| format!("{file}: {error}"))?;
        let (text, found) = rewrite(&read, &wanted).map_err(|error| format!("{file}: {error}"))?;
        placed.extend(found);
        write_new(&tree.join(file), text.as_bytes()).map_err(|error| format!("{file}: {error}"))?;
    }
    let library = fs::read_to_string(root.join("src/lib.rs")).map_err(|error| format!("src/lib.rs: {error}"))?;
    let with_switch = format!("{library}\n#[doc(hidden)]\npub mod mutant_switch;\n");
    for (file, text) in [("src/lib.rs", with_switch.as_str()), ("src/mutant_switch.rs", include_str!("switch.rs"))] {
        write_new(&tree.join(file), text.as_bytes()).map_err(|error| format!("{file}: {error}"))?;
    }
    Ok(placed)
}

/// Builds the tests; gives cargo's messages.
fn build(tree: &Path, arguments: &[String]) -> Result<Vec<Value>, String> {
    let mut command = Command::new(crate::list::cargo());
    command.args(["test", "--no-run", "--message-format", "json"]).args(arguments).current_dir(tree);
    // The changes make warnings, of which nobody wants to read.
    command.env("RUSTFLAGS", "--cap-lints allow").env("CARGO_TARGET_DIR", tree.join("target"));
    command.env_remove("CARGO_MANIFEST_DIR").stderr(Stdio::inherit());
    let ended = command.output().map_err(|error| format!("cargo cannot be started: {error}"))?;
    let text = String::from_utf8_lossy(&ended.stdout).into_owned();
    Ok(text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect())
}

/// The program of tests that a message tells of.
fn program(message: &Value) -> Option<(String, PathBuf)> {
    let is_test = message["profile"]["test"] == true;
    let (name, file) = (message["target"]["name"].as_str()?, message["executable"].as_str()?);
    is_test.then(|| (name.to_string(), file.into()))
}

/// The changes in the innermost stretch that a message of the compiler points into, else in those that it points at.
fn blamed(tree: &Path, message: &Value) -> Vec<u32> {
    let spans = message["spans"].as_array().map(Vec::as_slice).unwrap_or_default();
    let primary_first = |wanted: bool| spans.iter().filter(move |span| (span["is_primary"] == true) == wanted);
    for span in primary_first(true).chain(primary_first(false)) {
        let (Some(file), Some(start), Some(end)) =
            (span["file_name"].as_str(), span["byte_start"].as_u64(), span["byte_end"].as_u64())
        else {
            continue;
        };
        let Ok(text) = fs::read_to_string(tree.join(file)) else { continue };
        let marks = marks(&text);
        let around = marks.iter().rev().find(|(bytes, _)| bytes.contains(&(start as usize)));
        let within = || marks.iter().find(|(bytes, _)| bytes.start >= start as usize && bytes.end <= end as usize);
        if let Some((_, numbers)) = around.or_else(within) {
            return numbers.clone();
        }
    }
    Vec::new()
}
