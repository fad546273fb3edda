//! What a fault has cost.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use super::plan::Phase;
use super::scene::Undisturbed;
use super::support::{Ended, NEW, Row, Running, number, program};

/// Columns that come from SUMO's own files at the end of a run.
const FROM_THE_END: [&str; 3] = ["arrival", "duration", "timeloss"];

/// What became of a run.
#[derive(Default)]
pub struct Verdict {
    /// Where it was when it was struck.
    pub phase: Phase,
    /// Rows that must not be lost.
    pub rows_known: usize,
    pub rows_lost: usize,
    pub hung: bool,
    /// Processes and ports that stay.
    pub left: usize,
    /// The exit code and `run.json` do not agree, or it panicked.
    pub wrong: bool,
    /// All that is wrong.
    pub said: Vec<String>,
}

/// What is known of a run when it is struck.
#[derive(Default)]
pub struct Known {
    /// Vehicles that have a row on disk.
    pub ids: BTreeSet<String>,
    /// Vehicles that had arrived by then must have one \[s\].
    pub until_s: f64,
    /// What happens afterwards need not be what happens undisturbed \[s\].
    pub true_until_s: f64,
}

/// The vehicles that have a row on disk at this moment.
pub fn ids_on_disk(dir: &Path) -> BTreeSet<String> {
    let read = |name: &str| fs::read_to_string(dir.join(name)).ok();
    let text = read("vehicles.csv.part").or_else(|| read("vehicles.csv")).unwrap_or_default();
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    // A row of the whole table may be that of a vehicle on the road.
    let left = whole.lines().skip(1).filter(|line| line.ends_with(",arrived,true"));
    left.filter_map(|line| line.split(',').next().map(str::to_owned)).collect()
}

/// The status in `run.json`, if there is one.
pub fn status(dir: &Path) -> Option<String> {
    let text = fs::read_to_string(dir.join("run.json")).ok()?;
    let value: serde_json::Value = serde_json::from_str(&text).ok()?;
    Some(value["status"].as_str()?.to_owned())
}

impl Verdict {
    pub fn wrong(&mut self, why: String) {
        self.wrong = true;
        self.said.push(why);
    }

    /// Makes tables of what is left, and compares the rows with those of an undisturbed run.
    pub fn take_rows(&mut self, dir: &Path, undisturbed: &Undisturbed, known: &Known) {
        if dir.join("run.json").exists() && status(dir).as_deref() != Some("complete") {
            let mut command = program(NEW);
            command.arg("recover").arg(dir);
            let Ended { code, stderr, .. } = Running::start(command).wait();
            // Where the disk is full the rows stay where they are.
            if code != Some(0) && !stderr.contains("nothing to recover") && !stderr.contains("No space left") {
                self.wrong(format!("recover ends with {code:?}: {stderr}"));
            }
        }
        let rows = rows(dir);
        let mut lost = lost(&rows, &undisturbed.rows, known);
        if dir.join("vehicles.csv").is_file() && !rows.is_sorted_by_key(|row| number(row, "depart")) {
            lost.push("the rows are out of order".to_owned());
        }
        self.rows_known = known.ids.len();
        self.rows_lost = lost.len();
        self.said.extend(lost);
    }
}

/// The rows of the table, or of its journal but for a line that is cut in two.
fn rows(dir: &Path) -> Vec<Row> {
    let read = |name: &str| fs::read_to_string(dir.join(name)).ok();
    let text = read("vehicles.csv").or_else(|| read("vehicles.csv.part")).unwrap_or_default();
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    csv::Reader::from_reader(whole.as_bytes()).deserialize().map(|row| row.expect("a row of the table")).collect()
}

/// What is missing or not as it would have been undisturbed.
fn lost(rows: &[Row], undisturbed: &BTreeMap<String, Row>, known: &Known) -> Vec<String> {
    let mut lost = Vec::new();
    let arrived: Vec<&Row> = rows.iter().filter(|row| row["reason"] == "arrived").collect();
    let there: BTreeSet<&str> = arrived.iter().map(|row| row["id"].as_str()).collect();
    lost.extend(known.ids.iter().filter(|id| !there.contains(id.as_str())).map(|id| format!("{id} had a row")));
    let theirs = |id: &str| undisturbed.get(id).filter(|row| row["reason"] == "arrived");
    let arrival_s = |id: &str| theirs(id).map(|row| number(row, "arrival"));
    let comparable = |id: &str| arrival_s(id).is_some_and(|arrival_s| arrival_s < known.true_until_s);
    for row in &arrived {
        let id = row["id"].as_str();
        match theirs(id) {
            Some(theirs) if comparable(id) => {
                let differ = row.iter().filter(|(column, _)| !FROM_THE_END.contains(&column.as_str()));
                let differ = differ.filter(|(column, value)| theirs[*column] != **value);
                lost.extend(
                    differ.map(|(column, value)| format!("{column} of {id} is {value}, not {}", theirs[column])),
                );
            }
            None if known.true_until_s == f64::INFINITY => lost.push(format!("{id} has not arrived undisturbed")),
            _ => {}
        }
    }
    // Whoever arrived before the last one, or before the fault, has a row.
    let last_s = there.iter().filter(|id| comparable(id)).filter_map(|id| arrival_s(id)).fold(known.until_s, f64::max);
    let missing = undisturbed.keys().filter(|id| arrival_s(id).is_some_and(|s| s < last_s.min(known.true_until_s)));
    let missing = missing.filter(|id| !there.contains(id.as_str()) && !known.ids.contains(*id));
    lost.extend(
        missing.map(|id| format!("{id} arrived at {:.1} s, before {last_s:.1} s", arrival_s(id).unwrap_or(0.0))),
    );
    lost
}

/// A judge that sees nothing would find nothing.
#[test]
fn what_is_missing_or_changed_is_noticed() {
    let row = |k: u32, reason: &str| -> Row {
        let columns = [("id", format!("v{k}")), ("depart", k.to_string()), ("arrival", (10 + k).to_string())];
        let more = [("reason", reason.to_owned()), ("distance", "300".to_owned())];
        columns.into_iter().chain(more).map(|(name, value)| (name.to_owned(), value)).collect()
    };
    let undisturbed: BTreeMap<String, Row> = (0..9).map(|k| (format!("v{k}"), row(k, "arrived"))).collect();
    let all: Vec<Row> = (0..5).map(|k| row(k, "arrived")).collect();
    let known = Known { ids: ["v3".to_owned()].into(), until_s: 13.5, true_until_s: f64::INFINITY };
    assert_eq!(lost(&all, &undisturbed, &known), [""; 0]);
    let without = |gone: usize| all.iter().enumerate().filter(move |(k, _)| *k != gone).map(|(_, row)| row.clone());
    assert_eq!(lost(&without(3).collect::<Vec<_>>(), &undisturbed, &known), ["v3 had a row"]);
    assert_eq!(lost(&without(1).collect::<Vec<_>>(), &undisturbed, &known).len(), 1, "a hole");
    assert_eq!(lost(&all[..4], &undisturbed, &known), [""; 0], "v4 left after the fault");
    assert_eq!(lost(&all[..3], &undisturbed, &known).len(), 1);
    let mut changed = all.clone();
    changed[2].insert("distance".to_owned(), "301".to_owned());
    assert_eq!(lost(&changed, &undisturbed, &known), ["distance of v2 is 301, not 300"]);
    // Behind a wrong byte on the wire nothing is compared.
    let garbled = Known { ids: BTreeSet::new(), until_s: 11.5, true_until_s: 11.5 };
    assert_eq!(lost(&changed, &undisturbed, &garbled), [""; 0]);
}
