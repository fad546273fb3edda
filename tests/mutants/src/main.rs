//! Which small changes of the code does no test notice?
//!
//! cargo-mutants lists the changes: `<` for `<=`, an empty body, a match arm less. Built one after the other they take a
//! day. So all of them are put into one copy of the crate (mutant schemata), each behind a question to a switch; the copy
//! is built once, and a number in the environment says which change is in force. Every test is run once to see which
//! changes it comes across; then every change is tried with the tests that do, the quickest first, until one fails.
//!
//! `sumo-mfc-mutants [OPTIONS] PLACE... -- ARGUMENTS` tries what is in PLACEs such as `src/cosim`, one after the other, with
//! the tests that `cargo test ARGUMENTS` builds. Its options:
//! - `--root DIR`: the crate; without it the working directory.
//! - `--survivors FILE`: the survivors whose reasons are known. It ends with 1 when another one survives.
//! - `--list FILE`: what `cargo mutants --list --json` has printed before.
//! - `--test-s SECONDS`: tests that take longer are left out. `--mutant-s SECONDS`: no further test is begun for a change
//!   behind this time. `--jobs N`: tests at a time.

mod compile;
mod list;
mod outcome;
mod refused;
mod rewrite;
mod sites;
mod tree;
mod trial;

use std::collections::{HashMap, HashSet};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::time::Duration;

use list::{Mutant, is_in};
use outcome::{Known, Tried, survivors, table};
use refused::Refused;
use trial::{Fate, Limits};

struct Call {
    root: PathBuf,
    survivors: Option<PathBuf>,
    list: Option<PathBuf>,
    limits: Limits,
    places: Vec<String>,
    cargo: Vec<String>,
}

impl Call {
    fn read(mut words: impl Iterator<Item = String>) -> Result<Self, String> {
        let jobs = std::thread::available_parallelism().map_or(1, usize::from);
        let limits = Limits { test: Duration::from_secs(120), mutant: Duration::from_secs(60), jobs };
        let mut call =
            Self { root: ".".into(), survivors: None, list: None, limits, places: Vec::new(), cargo: Vec::new() };
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("{word} needs a value"));
            let seconds =
                |text: String| text.parse().map(Duration::from_secs).map_err(|error| format!("{text}: {error}"));
            match word.as_str() {
                "--root" => call.root = value()?.into(),
                "--survivors" => call.survivors = Some(value()?.into()),
                "--list" => call.list = Some(value()?.into()),
                "--test-s" => call.limits.test = seconds(value()?)?,
                "--jobs" => call.limits.jobs = value()?.parse().map_err(|error| format!("--jobs: {error}"))?,
                "--mutant-s" => call.limits.mutant = seconds(value()?)?,
                "--" => call.cargo = words.by_ref().collect(),
                _ if word.starts_with('-') => return Err(format!("{word} is not an option")),
                _ => call.places.push(word),
            }
        }
        call.root = call.root.canonicalize().map_err(|error| format!("{}: {error}", call.root.display()))?;
        Ok(call)
    }
}

fn main() -> ExitCode {
    match Call::read(std::env::args().skip(1)).and_then(|call| carry_out(&call)) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::from(1),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Tries all changes and prints what came out; gives how many survive without a reason.
fn carry_out(call: &Call) -> Result<usize, String> {
    let known = call.survivors.as_ref().map_or(Ok(String::new()), |file| said(file, fs::read_to_string(file)))?;
    let work = call.root.join("target/mutants");
    let mutants = match &call.list {
        None => list_all(call, &work.join("list"))?,
        Some(file) => list::read_all(&said(file, fs::read(file))?, &call.places)?,
    };
    let empty = |place: &&String| !mutants.iter().any(|mutant| is_in(&mutant.file, place));
    if let Some(place) = call.places.iter().find(empty) {
        return Err(format!("there is nothing to change in {place}"));
    }
    let mut tried: Vec<Tried> = Vec::new();
    let mut text = String::new();
    for of_place in mutants.chunk_by(|one, other| place_of(call, one) == place_of(call, other)) {
        let fates = try_place(call, &work, of_place)?;
        for (mutant, number) in of_place.iter().zip(1..) {
            let fate = fates.get(&number).cloned();
            text += &format!("{}\t{}\n", fate.as_ref().map_or("not tried".into(), Fate::to_string), mutant.name);
            tried.push((mutant, fate));
        }
        let log = work.join("tried.txt");
        said(&log, fs::write(&log, &text))?;
    }
    let (text, new) = survivors(&tried, &mut Known::read(&known));
    println!("{text}\n{}", table(&tried));
    Ok(new)
}

fn place_of(call: &Call, mutant: &Mutant) -> Option<usize> {
    call.places.iter().position(|place| is_in(&mutant.file, place))
}

/// Tries the changes of one place: all else is as it stands, and as fast. Numbers count from the first one of the place.
fn try_place(call: &Call, work: &Path, mutants: &[Mutant]) -> Result<HashMap<u32, Fate>, String> {
    let tree = work.join("tree");
    let mut written: HashSet<PathBuf> = mutants.iter().map(|mutant| PathBuf::from(&mutant.file)).collect();
    written.extend(["src/lib.rs".into(), "src/mutant_switch.rs".into()]);
    said(&tree, tree::copy(&call.root, &tree, &written))?;
    let file = work.join("refused.txt");
    let mut refused = said(&file, Refused::read(file.clone(), &call.root, mutants))?;
    let built = compile::compile(&call.root, &tree, mutants, &call.cargo, &mut refused)?;
    let tests = trial::record(&tree, &built.programs, call.limits);
    let mut numbers: Vec<u32> = built.placed.iter().copied().collect();
    numbers.sort_unstable();
    eprintln!("{} tests pass; {} changes are to be tried", tests.len(), numbers.len());
    let log = work.join("trying.txt");
    let file = Mutex::new(said(&log, fs::File::create(&log))?);
    let note = |number: u32, fate: &Fate| {
        // Only for those who want to look while it runs.
        let line = format!("{fate}\t{}\n", mutants[number as usize - 1].name);
        let _ = file.lock().map(|mut file| file.write_all(line.as_bytes()));
    };
    Ok(trial::try_all(&tree, &tests, &numbers, call.limits, note))
}

/// Lists the changes in a copy in which files that only a macro declares are declared.
fn list_all(call: &Call, copy: &Path) -> Result<Vec<Mutant>, String> {
    said(copy, tree::copy(&call.root, copy, &HashSet::new()))?;
    for place in &call.places {
        let room = place.trim_start_matches("src/").split('/').next().unwrap_or_default();
        let file = copy.join(format!("src/{room}.rs"));
        if file.is_file() {
            let lines = said(&file, tree::undeclared(&call.root, room))?;
            let text = said(&file, fs::read_to_string(call.root.join(format!("src/{room}.rs"))))?;
            said(&file, fs::write(&file, text + &lines))?;
        }
    }
    list::list(copy, &call.places)
}

fn said<T>(path: &Path, result: std::io::Result<T>) -> Result<T, String> {
    result.map_err(|error| format!("{}: {error}", path.display()))
}
