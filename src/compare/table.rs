//! A comparison as a file and on the terminal.

use super::metrics::{METRICS, Metric};
use super::paired::{ControllerRow, Measured};
use crate::output::{OutputError, write_json, write_table};
use crate::run::{FileSchema, Schema};
use crate::table::Layout;
use comfy_table::{CellAlignment, Table, presets};
use std::path::Path;
use std::sync::LazyLock;

/// `comparison.csv`.
pub static COMPARISON: LazyLock<Layout<ControllerRow>> =
    LazyLock::new(|| Layout::of_record(["comparison", "controller"], "One row per controller"));

/// Writes `comparison.csv`, and `schema.json` beside it.
///
/// # Errors
/// [`OutputError`] naming the file.
pub fn write_comparison(folder: &Path, rows: &[ControllerRow]) -> Result<(), OutputError> {
    write_table(&folder.join("comparison.csv"), &COMPARISON, rows)?;
    let schema = Schema::new([("comparison.csv", FileSchema::of_table(&COMPARISON.shape))]);
    write_json(&folder.join("schema.json"), &schema).map(drop)
}

/// A number with the metric's decimals; whole numbers of metrics without a unit (counts) have none.
fn number(metric: &Metric, value: f64, sign: bool) -> String {
    let count = metric.unit.is_empty() && value == value.floor() && metric.decimals == 1;
    let decimals = if count { 0 } else { metric.decimals };
    let text = if sign { format!("{value:+.decimals$}") } else { format!("{value:.decimals$}") };
    // What rounds to nothing has no sign.
    if text.chars().any(|c| ('1'..='9').contains(&c)) { text } else { text.replace(['-', '+'], "") }
}

fn cell(metric: &Metric, measured: &Measured) -> String {
    let Some(mean) = measured.mean else { return "-".to_owned() };
    let mut text = number(metric, mean, false);
    if let Some(difference) = measured.difference {
        text += &format!("\n{}", number(metric, difference.mean, true));
        if let Some(half_width) = difference.half_width {
            text += &format!(" ± {}", number(metric, half_width, false));
        }
    }
    text
}

/// The table for the terminal: a column per controller, a row per metric, and what the second line of a cell means.
pub fn terminal_table(rows: &[ControllerRow]) -> String {
    let mut table = Table::new();
    table.load_style(presets::UTF8_FULL_CONDENSED);
    table.set_header([""].into_iter().chain(rows.iter().map(|r| r.controller.as_str())));
    for (k, metric) in METRICS.iter().enumerate() {
        let unit = if metric.unit.is_empty() { String::new() } else { format!(" [{}]", metric.unit) };
        let title = format!("{}{unit}", metric.title);
        table.add_row([title].into_iter().chain(rows.iter().map(|r| cell(metric, &r.metrics[k]))));
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let mut text = format!("{table}\n");
    if let [first, _, ..] = rows {
        let seeds = first.seeds;
        let plural = if seeds == 1 { "seed" } else { "seeds" };
        let spread = if seeds > 1 { ", mean over the seeds ± half width of its 95 % t interval" } else { "" };
        text += &format!("{seeds} {plural}. Second lines: paired difference to {}{spread}.\n", first.controller);
    }
    text
}
