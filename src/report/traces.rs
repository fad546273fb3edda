//! What is known of single vehicles over time: their trace, else what the sample holds.

use super::compact::packed;
use super::data::RunData;
use super::figures::lower;
use super::groups::NAMES;
use super::number::counted;
use super::table::{Column, ColumnInfo, Table, Values};
use crate::figure::{Chart, Curve, Figure};
use crate::page::FigureView;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Rows of all traces, and of all sampled vehicles, that a page takes.
const TRACED: usize = 20_000;
const SAMPLED: usize = 30_000;
/// Rows of one vehicle. With less than the second number a curve says little, so that rather vehicles are left out.
const ROWS: [usize; 2] = [4000, 300];

/// What is shown over time, where a table has it. What comes later is drawn on top.
const SHOWN: [&str; 7] = ["measured_speed", "speed", "reference", "target", "torque", "alpha_hat", "f_hat"];

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

/// The columns that are shown of a table: first what tells most, how far the speed is from what it should be.
fn columns(table: &Table) -> Vec<Column> {
    let error = ["reference", "target"].into_iter().find_map(|wanted| {
        let (speeds, wished) = (table.numbers("speed")?, table.numbers(wanted)?);
        let known = &table.column("speed")?.info;
        let info = ColumnInfo {
            name: format!("speed − {wanted}"),
            meaning: format!("Difference of speed and {wanted}"),
            ..known.clone()
        };
        let values = speeds.iter().zip(wished).map(|(speed, wish)| speed - wish).collect();
        Some(Column { info, values: Values::Numbers(values) })
    });
    error.into_iter().chain(SHOWN.iter().filter_map(|name| table.column(name)).cloned()).collect()
}

/// How large the errors of every vehicle are, the largest of those that share an id.
fn errors(run: &RunData) -> BTreeMap<&str, f64> {
    let mut errors = BTreeMap::new();
    let table = run.vehicles.as_ref().and_then(|table| Some((table.texts("id")?, table.numbers("error_rms")?)));
    for (id, error) in table.into_iter().flat_map(|(ids, errors)| ids.iter().zip(errors)) {
        let known: &mut f64 = errors.entry(id.as_str()).or_insert(0.0);
        *known = known.max(*error);
    }
    errors
}

/// The series of all runs for the script, and what was left out, in words.
pub fn series(runs: &[RunData], wanted: Option<&str>) -> (Vec<Value>, Vec<String>) {
    let (mut all, mut notes) = (Vec::new(), Vec::new());
    for (run, name) in runs.iter().zip(NAMES) {
        let name = if runs.len() > 1 { name } else { "" };
        let errors = errors(run);
        let error = |id: &str| errors.get(id).copied().unwrap_or(0.0);
        for (source, table, budget) in sources(run) {
            let vehicles = by_vehicle(table);
            let most = (budget / runs.len() / vehicles.len().max(1)).clamp(ROWS[1], ROWS[0]);
            let (mut left, mut kept, mut thin) = (budget / runs.len(), 0, false);
            let shown = columns(table);
            let time = table.column("time");
            // Those with the largest errors are looked at first.
            let mut ordered: Vec<_> = vehicles.iter().collect();
            ordered.sort_by(|(a, _), (b, _)| {
                let last = |id: &str| Some(id) != wanted;
                last(a).cmp(&last(b)).then(error(b).total_cmp(&error(a)))
            });
            for (id, rows) in &ordered {
                let most = if Some(**id) == wanted { ROWS[0] } else { most };
                let taken = thinned(rows, most);
                if taken.len() > left && kept > 0 {
                    continue;
                }
                left = left.saturating_sub(taken.len());
                kept += 1;
                thin |= taken.len() < rows.len();
                let columns: Vec<Value> = time.into_iter().chain(&shown).map(|column| packed(column, &taken)).collect();
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
    let mut by_unit: Vec<(String, Vec<Column>)> = Vec::new();
    for column in columns(table) {
        let unit = column.info.unit.clone().unwrap_or_else(|| "1".to_owned());
        let alone = column.info.name.contains(" − ");
        match by_unit.iter_mut().find(|(known, columns)| *known == unit && !columns[0].info.name.contains(" − ")) {
            Some((_, columns)) if !alone => columns.push(column),
            _ => by_unit.push((unit, vec![column])),
        }
    }
    let of = label.map(|label| format!(", {label}")).unwrap_or_default();
    let chart = |(unit, columns): (String, Vec<Column>)| {
        let curve = |(place, column): (usize, &Column)| {
            let Values::Numbers(values) = &column.values else { return None };
            let points = rows.iter().map(|row| (times[*row], values[*row])).collect();
            Some(Curve::of(&column.info.name, points).in_style(&format!("hue{place}")))
        };
        let names: Vec<&str> = columns.iter().map(|column| column.info.name.as_str()).collect();
        let (y, title) = (format!("[{unit}]"), format!("{}{of}", names.join(", ")));
        let curves = columns.iter().enumerate().filter_map(curve).collect();
        let chart = Chart { title, x: "simulation time [s]", y: &y, curves, ..Chart::default() };
        let meaning = |column: &Column| format!("{}: {}", column.info.name, lower(&column.info.meaning));
        let meanings: Vec<String> = columns.iter().map(meaning).collect();
        let caption = format!("From the {source}, in {unit} over time in s. {}.", meanings.join("; "));
        let stem: String = names[0].chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        let stem = format!("vehicle_{stem}{}", label.map(|label| format!("_{label}")).unwrap_or_default());
        FigureView::new(&Figure::chart(&stem, &chart), caption)
    };
    by_unit.into_iter().map(chart).collect()
}
