//! The numbers of whole runs, as tables.

use super::data::RunData;
use super::figures::differences;
use super::groups::NAMES;
use super::number::{or_dash, sensible, signed};
use super::table::{ColumnInfo, Table};
use crate::page::{Cell, FigureView, Head, TableView};
use crate::run::Spread;
use std::collections::HashMap;

/// Columns of which the vehicle by vehicle differences are drawn.
const DRAWN: [&str; 3] = ["error_rms", "speed_gap_rms", "timeloss"];

/// Counts of vehicles and SUMO's totals, a column per run.
pub fn counts(runs: &[RunData], names: &[String]) -> Option<TableView> {
    let mut rows: Vec<(String, Vec<String>)> = Vec::new();
    for (place, run) in runs.iter().enumerate() {
        let Some(summary) = &run.summary else { continue };
        let counts = summary.counts.iter().map(|(name, count)| (format!("counts.{name}"), count.to_string()));
        let sumo = &summary.sumo;
        let of_sumo = [
            ("sumo.inserted", sumo.inserted.to_string()),
            ("sumo.arrived", sumo.arrived.to_string()),
            ("sumo.mean time loss [s]", or_dash(sumo.time_loss_mean_s)),
            ("sumo.collisions", sumo.collisions.to_string()),
            ("sumo.teleports", sumo.teleports.to_string()),
        ];
        let all = counts.chain(of_sumo.map(|(name, value)| (name.to_owned(), value)));
        for (name, value) in all {
            let found = rows.iter().position(|(known, _)| *known == name);
            let found = found.unwrap_or_else(|| {
                rows.push((name, vec!["–".to_owned(); runs.len()]));
                rows.len() - 1
            });
            rows[found].1[place] = value;
        }
    }
    let zero = |values: &[String]| values.iter().all(|value| value == "0");
    rows.retain(|(name, values)| !name.starts_with("counts.") || !zero(values) || name == "counts.vehicles");
    let row = |(name, values): (String, Vec<String>)| {
        let name = name.replace("counts.", "egos: ").replace("sumo.", "SUMO: ").replace('_', " ");
        [Cell::text(name.replace("egos: vehicles", "egos"))]
            .into_iter()
            .chain(values.into_iter().map(Cell::number))
            .collect()
    };
    let head = [Head::text("count", "")].into_iter().chain(names.iter().map(|name| Head::number(name, ""))).collect();
    let rows: Vec<Vec<Cell>> = rows.into_iter().map(row).collect();
    let caption = "Vehicles of the run: the equipped ones (egos) by how their rows ended, then what SUMO itself counted, vehicles that are no egos included. Counts that are 0 are left out.";
    (!rows.is_empty()).then(|| TableView {
        id: "counts".into(),
        caption: caption.into(),
        head,
        rows,
        ..TableView::default()
    })
}

/// What `summary.json` says of every column of the vehicles.
pub fn fleet(run: &RunData) -> Option<TableView> {
    let summary = run.summary.as_ref()?;
    let infos = infos(run);
    let mut rows = Vec::new();
    for info in &infos {
        let Some(spread) = summary.fleet.get(&info.name) else { continue };
        let Spread { mean, p05, p50, p95, max } = *spread;
        let numbers = [mean, p05, p50, p95, max].map(|value| Cell::number(sensible(value)));
        let unit = info.unit.clone().unwrap_or_default();
        let start = [Cell::text(&info.name), Cell::text(unit)];
        rows.push(start.into_iter().chain(numbers).chain([Cell::text(&info.meaning)]).collect());
    }
    let head = vec![
        Head::text("column", "column of the table of vehicles"),
        Head::text("unit", ""),
        Head::number("mean", "over the egos"),
        Head::number("p05", "5 % of the egos have less"),
        Head::number("p50", "median"),
        Head::number("p95", "95 % of the egos have less"),
        Head::number("max", "largest value"),
        Head::text("what it is", ""),
    ];
    let caption = "Every column of the table of vehicles over all egos. e = true speed − reference; read error_* together with lead_limited and speed_gap_rms: where the reference was held near the true speed, large errors were cut.";
    (!rows.is_empty()).then(|| TableView {
        id: "fleet".into(),
        caption: caption.into(),
        head,
        rows,
        ..TableView::default()
    })
}

fn infos(run: &RunData) -> Vec<ColumnInfo> {
    if let Some(table) = &run.vehicles {
        return table.columns.iter().map(|column| column.info.clone()).collect();
    }
    // Without the table itself the summary still has its columns, without units.
    let names = run.summary.iter().flat_map(|summary| summary.fleet.keys());
    let info =
        |name: &String| ColumnInfo { name: name.clone(), kind: "number".into(), unit: None, meaning: String::new() };
    names.map(info).collect()
}

/// Two runs side by side, and the figures of their differences.
pub fn side_by_side(a: &RunData, b: &RunData) -> (Option<TableView>, Vec<FigureView>) {
    let (Some(left), Some(right)) = (&a.summary, &b.summary) else { return (None, Vec::new()) };
    let pairs = a.vehicles.as_ref().zip(b.vehicles.as_ref()).map(|(a, b)| pairs(a, b)).unwrap_or_default();
    let (mut rows, mut figures) = (Vec::new(), Vec::new());
    for info in infos(a) {
        let (Some(one), Some(two)) = (left.fleet.get(&info.name), right.fleet.get(&info.name)) else { continue };
        let column = |table: &Option<Table>| table.as_ref().and_then(|t| t.numbers(&info.name)).map(<[f64]>::to_vec);
        let paired = column(&a.vehicles).zip(column(&b.vehicles));
        let paired: Vec<f64> = paired.map_or_else(Vec::new, |(a, b)| {
            pairs.iter().map(|(i, k)| b[*k] - a[*i]).filter(|difference| difference.is_finite()).collect()
        });
        let mean = (!paired.is_empty()).then(|| paired.iter().sum::<f64>() / paired.len() as f64);
        let numbers = [one.mean, two.mean].map(sensible).into_iter().chain([signed(two.mean - one.mean)]);
        let numbers = numbers.chain([one.p95, two.p95].map(sensible)).chain([signed(two.p95 - one.p95)]);
        let numbers = numbers.chain([mean.map_or("–".to_owned(), signed), paired.len().to_string()]);
        let start = [Cell::text(&info.name), Cell::text(info.unit.clone().unwrap_or_default())];
        rows.push(start.into_iter().chain(numbers.map(Cell::number)).collect());
        if DRAWN.contains(&info.name.as_str()) {
            figures.extend(differences(&info.name, info.unit.as_deref().unwrap_or("1"), paired));
        }
    }
    let number = |text: &str, meaning: &str| Head::number(text, meaning);
    let [a, b] = NAMES;
    let head = vec![
        Head::text("column", "column of the table of vehicles"),
        Head::text("unit", ""),
        number(&format!("mean {a}"), "over the egos of the first run"),
        number(&format!("mean {b}"), "over the egos of the second run"),
        number(&format!("{b} − {a}"), "difference of the means"),
        number(&format!("p95 {a}"), "95 % of the egos have less"),
        number(&format!("p95 {b}"), "95 % of the egos have less"),
        number(&format!("{b} − {a}"), "difference of the 95 % quantiles"),
        number("same vehicles", "mean of the differences of the vehicles that are in both runs, B − A"),
        number("vehicles", "vehicles that are in both runs and have a value"),
    ];
    let caption = "Every column of the table of vehicles in both runs, and the differences. One run each says nothing about chance: sumo-mfc compare runs several seeds.";
    let view = TableView { id: "differences".into(), caption: caption.into(), head, rows, ..TableView::default() };
    ((!view.rows.is_empty()).then_some(view), figures)
}

/// The rows of vehicles that are in both tables. The nth use of an id belongs to the nth.
fn pairs(a: &Table, b: &Table) -> Vec<(usize, usize)> {
    let (Some(left), Some(right)) = (a.texts("id"), b.texts("id")) else { return Vec::new() };
    let mut places: HashMap<&str, Vec<usize>> = HashMap::new();
    for (row, id) in right.iter().enumerate().rev() {
        places.entry(id).or_default().push(row);
    }
    left.iter().enumerate().filter_map(|(row, id)| Some((row, places.get_mut(id.as_str())?.pop()?))).collect()
}
