//! A comparison as a file and on the terminal.

use super::{ControllerRow, METRICS, Measured, Metric};
use crate::output::{OutputError, write_json, write_table};
use crate::run::{FileSchema, Schema};
use crate::table::{Cell, Column, Kind, Layout, Read};
use comfy_table::{CellAlignment, Table, presets};
use std::path::Path;
use std::sync::LazyLock;

/// `comparison.csv`: one row per controller. Four columns per metric: the mean over the seeds, then the paired
/// difference to the first controller, its standard deviation and the half width of its 95 % t interval.
pub static COMPARISON: LazyLock<Layout<ControllerRow>> = LazyLock::new(|| {
    let text = |name: &str, kind: Kind, meaning: &str| Column { kind, ..Column::number(name, None, meaning) };
    let mut columns: Vec<(Column, Read<ControllerRow>)> = vec![
        (text("controller", Kind::Text, "The controller"), Box::new(|r| Cell::Text(Some(&r.controller)))),
        (text("seeds", Kind::Count, "Seeds that it ran with"), Box::new(|r| Cell::Count(r.seeds))),
    ];
    for (k, metric) in METRICS.iter().enumerate() {
        let parts: [(&str, &str, fn(&Measured) -> Option<f64>); 4] = [
            ("", "mean over the seeds", |m| m.mean),
            ("_diff", "mean paired difference to the first controller", |m| Some(m.difference?.mean)),
            ("_diff_sd", "standard deviation of the paired difference", |m| m.difference?.sd),
            ("_diff_ci95", "half width of the 95 % t interval of the difference", |m| m.difference?.half_width),
        ];
        for (suffix, what, read) in parts {
            let unit = Some(metric.unit).filter(|unit| !unit.is_empty());
            let column = Column::number(format!("{}{suffix}", metric.name), unit, format!("{}: {what}", metric.title));
            let finite = move |row: &ControllerRow| read(&row.metrics[k]).filter(|x| x.is_finite());
            columns.push((column, Box::new(move |row| Cell::Number(finite(row)))));
        }
    }
    Layout::new(["comparison", "controller"], "One row per controller", columns)
});

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
