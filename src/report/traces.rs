//! What is known of single vehicles over time: their trace, else what the sample holds.

use super::compact::packed;
use super::data::RunData;
use super::figures::lower;
use super::groups::NAMES;
use super::number::counted;
use super::page::FigureView;
use super::table::Table;
use crate::figure::{Chart, Curve, Figure};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Rows of all traces, and of all sampled vehicles, that a page takes.
const TRACED: usize = 20_000;
const SAMPLED: usize = 30_000;
/// Rows of one vehicle. With less than the second number a curve says little, so that rather vehicles are left out.
const ROWS: [usize; 2] = [4000, 300];

/// What is shown over time, where a table has it; the figures on paper, and those of the script.
const SHOWN: [&str; 7] = ["target", "reference", "speed", "measured_speed", "torque", "alpha_hat", "f_hat"];

/// The rows of every vehicle of a table.
fn by_vehicle(table: &Table) -> BTreeMap<&str, Vec<usize>> {
    let mut rows: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (row, id) in table.texts("id").unwrap_or_default().iter().enumerate() {
        rows.entry(id).or_default().push(row);
    }
    rows
}

/// Every nth of the rows, so that at most `most` are left.
fn thinned(rows: &[usize], most: usize) -> Vec<usize> {
    let stride = rows.len().div_ceil(most.max(1)).max(1);
    rows.iter().step_by(stride).copied().collect()
}

/// One table of a run, its name and how many of its rows a page takes.
type Source<'a> = (&'static str, &'a Table, usize);

fn sources(run: &RunData) -> Vec<Source<'_>> {
    let trace = run.trace.as_ref().map(|table| ("trace", table, TRACED));
    let sample = run.sample.as_ref().map(|table| ("sample", table, SAMPLED));
    trace.into_iter().chain(sample).collect()
}

/// The series of all runs for the script, and what was left out, in words.
pub fn series(runs: &[RunData], wanted: Option<&str>) -> (Vec<Value>, Vec<String>) {
    let (mut all, mut notes) = (Vec::new(), Vec::new());
    for (run, name) in runs.iter().zip(NAMES) {
        let name = if runs.len() > 1 { name } else { "" };
        for (source, table, budget) in sources(run) {
            let vehicles = by_vehicle(table);
            let most = (budget / runs.len() / vehicles.len().max(1)).clamp(ROWS[1], ROWS[0]);
            let (mut left, mut kept, mut thin) = (budget / runs.len(), 0, false);
            let mut ordered: Vec<_> = vehicles.iter().collect();
            ordered.sort_by_key(|(id, _)| Some(**id) != wanted);
            for (id, rows) in &ordered {
                let most = if Some(**id) == wanted { ROWS[0] } else { most };
                let taken = thinned(rows, most);
                if taken.len() > left && kept > 0 {
                    continue;
                }
                left = left.saturating_sub(taken.len());
                kept += 1;
                thin |= taken.len() < rows.len();
                let shown = |name: &&str| table.column(name);
                let columns: Vec<Value> =
                    ["time"].iter().chain(&SHOWN).filter_map(shown).map(|column| packed(column, &taken)).collect();
                all.push(json!({ "id": id, "run": name, "source": source, "columns": columns }));
            }
            if kept < vehicles.len() {
                notes.push(format!(
                    "Of {} in {source}, the curves of {kept} are in this page.",
                    counted(vehicles.len(), "vehicle", "vehicles")
                ));
            }
            if thin {
                notes.push(format!("Curves from {source} have a part of their points, evenly taken."));
            }
        }
    }
    (all, notes)
}

/// Whether any of the runs knows this vehicle.
pub fn ids(run: &RunData) -> impl Iterator<Item = &str> {
    let tables = [&run.vehicles, &run.trace, &run.sample];
    tables.into_iter().flatten().filter_map(|table| table.texts("id")).flatten().map(String::as_str)
}

/// The figures of one vehicle of a run.
pub fn figures(run: &RunData, label: Option<&str>, id: &str) -> Vec<FigureView> {
    let found =
        sources(run).into_iter().find_map(|(source, table, _)| Some((source, table, by_vehicle(table).remove(id)?)));
    let Some((source, table, rows)) = found else { return Vec::new() };
    let Some(times) = table.numbers("time") else { return Vec::new() };
    let mut by_unit: Vec<(String, Vec<&str>)> = Vec::new();
    for column in SHOWN.iter().filter_map(|name| table.column(name)) {
        let unit = column.info.unit.clone().unwrap_or_else(|| "1".to_owned());
        match by_unit.iter_mut().find(|(known, _)| *known == unit) {
            Some((_, names)) => names.push(&column.info.name),
            None => by_unit.push((unit, vec![&column.info.name])),
        }
    }
    let chart = |(unit, names): (String, Vec<&str>)| {
        let curve = |(place, name): (usize, &&str)| {
            let values = table.numbers(name)?;
            let points = rows.iter().map(|row| (times[*row], values[*row])).collect();
            Some(Curve::of(name, points).in_style(&format!("hue{place}")))
        };
        let curves: Vec<Curve> = names.iter().enumerate().filter_map(curve).collect();
        let (y, of) = (format!("[{unit}]"), label.map(|label| format!(", {label}")).unwrap_or_default());
        let title = format!("{}{of}", names.join(", "));
        let chart = Chart { title, x: "simulation time [s]", y: &y, curves, ..Chart::default() };
        let meanings = names.iter().filter_map(|name| table.column(name));
        let meanings: Vec<String> =
            meanings.map(|column| format!("{}: {}", column.info.name, lower(&column.info.meaning))).collect();
        let caption = format!("From the {source}, in {unit} over time in s. {}.", meanings.join("; "));
        let stem = format!("vehicle_{}{}", names[0], label.map(|label| format!("_{label}")).unwrap_or_default());
        FigureView::new(&Figure::chart(&stem, &chart), caption)
    };
    by_unit.into_iter().map(chart).collect()
}
