//! The vehicles of one or two runs, by controller.

use super::data::RunData;
use super::table::Table;
use crate::figure::hue;
use std::collections::BTreeMap;

/// The names of two runs side by side.
pub const NAMES: [&str; 2] = ["A", "B"];

/// Vehicles of one run that the same controller drove.
pub struct Group<'a> {
    /// The controller, after the name of the run if there are two.
    pub name: String,
    /// Class of its hue.
    pub style: String,
    table: &'a Table,
    rows: Vec<usize>,
}

impl Group<'_> {
    /// The values of a column, in ascending order.
    pub fn sorted(&self, column: &str) -> Vec<f64> {
        let numbers = self.table.numbers(column).unwrap_or_default();
        let mut values: Vec<f64> = self.rows.iter().filter_map(|row| numbers.get(*row)).copied().collect();
        values.retain(|value| value.is_finite());
        values.sort_by(f64::total_cmp);
        values
    }
}

/// The groups of all runs.
pub fn groups(runs: &[RunData]) -> Vec<Group<'_>> {
    let mut groups: Vec<Group> = Vec::new();
    for (run, label) in runs.iter().zip(NAMES) {
        let Some(table) = &run.vehicles else { continue };
        let mut rows: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for row in 0..table.rows {
            let controller = table.texts("controller").map_or("", |texts| texts[row].as_str());
            rows.entry(controller).or_default().push(row);
        }
        for (controller, rows) in rows {
            let place = groups.len();
            let (name, style) = if runs.len() == 1 {
                (controller.to_owned(), hue(controller, place))
            } else {
                (format!("{label}: {controller}"), format!("hue{}", place % 8))
            };
            groups.push(Group { name, style, table, rows });
        }
    }
    groups
}

/// A quantile of ascending values, between neighbours (Hyndman and Fan 1996, type 7).
pub fn quantile(sorted: &[f64], p: f64) -> f64 {
    let place = p * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let (low, high) = (sorted[below], sorted[(below + 1).min(sorted.len() - 1)]);
    low + (place - below as f64) * (high - low)
}
