//! A comparison as a file and on the terminal.

use super::{ControllerRow, Difference, METRICS, Measured, Metric};
use crate::output::{Column, Layout};
use comfy_table::{CellAlignment, Table, presets};

fn difference(row: &ControllerRow, metric: usize) -> Option<Difference> {
    row.metrics[metric].difference
}

/// Four columns per metric: the mean over the seeds, then the paired difference to the first controller, its standard
/// deviation and the half width of its 95 % t interval.
macro_rules! columns {
    ($($index:literal $name:literal),* $(,)?) => {
        &[
            Column::text("controller", |r| Some(&r.controller)),
            Column::count("seeds", |r| r.seeds),
            $(
                Column::number($name, |r| r.metrics[$index].mean),
                Column::number(concat!($name, "_diff"), |r| difference(r, $index).map(|d| d.mean)),
                Column::number(concat!($name, "_diff_sd"), |r| difference(r, $index)?.sd),
                Column::number(concat!($name, "_diff_ci95"), |r| difference(r, $index)?.half_width),
            )*
        ]
    };
}

/// `comparison.csv`: one row per controller.
pub static COMPARISON: Layout<ControllerRow> = Layout {
    table: "comparison",
    row: "controller",
    by_time: false,
    columns: columns![
        0 "vehicles",
        1 "arrived",
        2 "error_rms_mean",
        3 "error_rms_p95",
        4 "speed_gap_rms_mean",
        5 "lead_limited_mean",
        6 "overshoot_mean",
        7 "jerk_rms_mean",
        8 "timeloss_mean",
        9 "collisions",
    ],
};

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
