//! The table of vehicles: a part of it in HTML, more of it as data of the script.

use super::compact::packed;
use super::data::RunData;
use super::groups::NAMES;
use super::number::{counted, sensible};
use super::table::{Column, ColumnInfo, Table, Values};
use crate::page::{Cell, Head, TableView};
use serde_json::{Value, json};
use std::collections::HashSet;

/// Rows that can be read without the script.
const STATIC: usize = 50;
/// What a page may take with all that is in it \[bytes\].
const BUDGET: usize = 4_900_000;
/// What the table may take even if the rest of the page is large \[bytes\].
const LEAST: usize = 1_000_000;
/// Rows by which the size of all is guessed.
const PROBE: usize = 500;

/// The vehicles of all runs in one table; where there are two, the first column says whose they are.
pub fn joined(runs: &[RunData]) -> Option<Table> {
    let tables: Vec<(&str, &Table)> =
        NAMES.into_iter().zip(runs).filter_map(|(name, run)| Some((name, run.vehicles.as_ref()?))).collect();
    let (_, first) = tables.first()?;
    if runs.len() == 1 {
        return Some((*first).clone());
    }
    let mut columns = Vec::new();
    let names = tables.iter().flat_map(|(name, table)| vec![(*name).to_owned(); table.rows]).collect();
    let info = ColumnInfo {
        name: "run".into(),
        kind: "string".into(),
        unit: None,
        meaning: "Which of the two results".into(),
    };
    columns.push(Column { info, values: Values::Texts(names) });
    for Column { info, .. } in &first.columns {
        let numbers: Option<Vec<&[f64]>> = tables.iter().map(|(_, table)| table.numbers(&info.name)).collect();
        let texts: Option<Vec<&[String]>> = tables.iter().map(|(_, table)| table.texts(&info.name)).collect();
        let values = match (numbers, texts) {
            (Some(numbers), _) => Values::Numbers(numbers.concat()),
            (_, Some(texts)) => Values::Texts(texts.concat()),
            _ => continue,
        };
        columns.push(Column { info: info.clone(), values });
    }
    Some(Table { columns, rows: tables.iter().map(|(_, table)| table.rows).sum() })
}

/// The table in HTML: the vehicles with the largest errors.
pub fn table(vehicles: &Table) -> TableView {
    let errors = vehicles.numbers("error_rms");
    let mut order: Vec<usize> = (0..vehicles.rows).collect();
    if let Some(errors) = errors {
        let size = |row: &usize| if errors[*row].is_finite() { errors[*row] } else { -1.0 };
        order.sort_by(|a, b| size(b).total_cmp(&size(a)));
    }
    order.truncate(STATIC);
    let cell = |column: &Column, row: usize| match &column.values {
        Values::Numbers(numbers) => Cell::number(sensible(numbers[row])),
        Values::Texts(texts) => Cell::text(&texts[row]),
    };
    let rows = order.iter().map(|row| vehicles.columns.iter().map(|column| cell(column, *row)).collect());
    let head = |column: &Column| {
        let class = if column.info.is_number() { "" } else { "text" };
        Head { text: column.info.titled(), meaning: column.info.meaning.clone(), class }
    };
    let which = if errors.is_some() && order.len() < vehicles.rows {
        format!("The {} with the largest error_rms of {}.", order.len(), vehicles.rows)
    } else {
        format!("{}.", counted(order.len(), "vehicle", "vehicles"))
    };
    TableView {
        id: "vehicles-table".into(),
        caption: format!("{which} Hold the pointer over a header to read what the column means."),
        head: vehicles.columns.iter().map(head).collect(),
        rows: rows.collect(),
        ..TableView::default()
    }
}

/// The data of the script: all rows, or evenly taken ones if all would make the page too large. `needed` are ids that
/// must be among them, `used` what the rest of the page takes \[bytes\].
pub fn data(vehicles: &Table, series: &[Value], needed: Option<&str>, used: usize) -> Value {
    let budget = BUDGET.saturating_sub(used).max(LEAST);
    let with_series: HashSet<&str> = series.iter().filter_map(|series| series["id"].as_str()).chain(needed).collect();
    let ids = vehicles.texts("id");
    let is_needed = |row: usize| ids.is_some_and(|ids| with_series.contains(ids[row].as_str()));
    let taken = |stride: usize| -> Vec<usize> {
        (0..vehicles.rows).filter(|row| row % stride == 0 || stride > 1 && is_needed(*row)).collect()
    };
    let pack = |rows: &[usize]| json!(vehicles.columns.iter().map(|column| packed(column, rows)).collect::<Vec<_>>());
    let probe: Vec<usize> = (0..vehicles.rows).step_by(vehicles.rows.div_ceil(PROBE).max(1)).collect();
    let each = pack(&probe).to_string().len() as f64 / probe.len().max(1) as f64;
    // The guess is somewhat high: the first stride that may do is tried, then larger ones.
    let mut stride = ((0.8 * each * vehicles.rows as f64 / budget as f64) as usize).max(1);
    let (rows, columns) = loop {
        let rows = taken(stride);
        let columns = pack(&rows);
        if columns.to_string().len() <= budget || stride >= vehicles.rows.max(1) {
            break (rows, columns);
        }
        stride += 1;
    };
    json!({
        "all": vehicles.rows,
        "shown": rows.len(),
        "stride": stride,
        "columns": columns,
        "series": series,
        "selected": needed,
    })
}
