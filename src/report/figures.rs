//! Figures of a run's vehicles.

use super::data::RunData;
use super::groups::{Group, NAMES, quantile};
use super::number::counted;
use super::table::ColumnInfo;
use crate::figure::{Chart, Curve, Figure, Span, Spans, Tracks};
use crate::page::FigureView;
use std::collections::BTreeMap;

/// Corners of a distribution's curve.
const CORNERS: usize = 400;
/// Points of all sampled vehicles together.
const POINTS: usize = 16_000;

/// What is known of a column of the vehicles.
fn info<'a>(runs: &'a [RunData], column: &str) -> Option<&'a ColumnInfo> {
    runs.iter().find_map(|run| run.vehicles.as_ref()?.column(column)).map(|column| &column.info)
}

/// The distribution of a column over the vehicles, one curve per group.
pub fn distribution(runs: &[RunData], groups: &[Group], column: &str) -> Option<FigureView> {
    let info = info(runs, column)?;
    let sorted: Vec<Vec<f64>> = groups.iter().map(|group| group.sorted(column)).collect();
    let ends = sorted.iter().filter(|values| !values.is_empty());
    let (inner, outer) = ends.fold((f64::MIN, f64::MIN), |(inner, outer), values| {
        (inner.max(quantile(values, 0.99)), outer.max(values[values.len() - 1]))
    });
    if outer == f64::MIN {
        return None;
    }
    // A few large values would press all others together.
    let cut = outer > 2.0 * inner && inner > 0.0;
    let end = if cut { inner } else { outer };
    let curves = groups
        .iter()
        .zip(&sorted)
        .filter(|(_, values)| !values.is_empty())
        .map(|(group, values)| Curve::of(&group.name, steps(values, end)).in_style(&group.style));
    let x = info.titled();
    let title = format!("Distribution of {column} over the vehicles");
    let chart = Chart { title, x: &x, y: "share of the vehicles", curves: curves.collect(), ..Chart::default() };
    let beyond = if cut { " The largest 1 % are beyond the right end." } else { "" };
    let caption =
        format!("Share of the vehicles that have at most this {}: {}.{beyond}", info.titled(), lower(&info.meaning));
    Some(FigureView::new(&Figure::chart(&format!("distribution_{column}"), &chart), caption))
}

/// The corners of an empirical distribution function up to `end`.
fn steps(sorted: &[f64], end: f64) -> Vec<(f64, f64)> {
    let stride = sorted.len().div_ceil(CORNERS);
    let last = sorted.len() - 1;
    let (mut points, mut before) = (vec![(sorted[0], 0.0)], 0.0);
    for index in (0..=last).filter(|index| index % stride == stride - 1 || *index == last) {
        let (value, share) = (sorted[index], (index + 1) as f64 / sorted.len() as f64);
        if value > end {
            points.push((end, before));
            break;
        }
        points.extend([(value, before), (value, share)]);
        before = share;
    }
    points
}

/// The quantiles of all columns of this unit that are among `columns`, one box per group and column.
pub fn boxes(runs: &[RunData], groups: &[Group], columns: &[&str], unit: &str) -> Option<FigureView> {
    let known: Vec<&ColumnInfo> = columns.iter().filter_map(|column| info(runs, column)).collect();
    let mut spans = Vec::new();
    for column in known.iter().filter(|info| info.unit.as_deref() == Some(unit)) {
        for group in groups {
            let sorted = group.sorted(&column.name);
            if sorted.is_empty() {
                continue;
            }
            let at = |p| quantile(&sorted, p);
            spans.push(Span {
                label: format!("{}, {}", column.name, group.name),
                style: group.style.clone(),
                ends: [at(0.05), at(0.95)],
                half: Some([at(0.25), at(0.75)]),
                middle: at(0.5),
            });
        }
    }
    if spans.is_empty() {
        return None;
    }
    let axis = format!("[{unit}]");
    let figure = Figure::spans(
        "quantiles",
        &Spans { title: "Errors over the vehicles".to_owned(), unit: &axis, spans, from_zero: true },
    );
    let caption =
        format!("Dot: median; box: the middle half of the vehicles; line: from 5 % to 95 % of them, in {unit}.");
    Some(FigureView::new(&figure, caption))
}

/// The sampled vehicles over time and distance, coloured by speed.
pub fn time_space(run: &RunData, label: Option<&str>) -> Option<FigureView> {
    let sample = run.sample.as_ref()?;
    let (ids, times) = (sample.texts("id")?, sample.numbers("time")?);
    let (distances, speeds) = (sample.numbers("distance")?, sample.numbers("speed")?);
    let mut lines: BTreeMap<&str, Vec<(f64, f64, f64)>> = BTreeMap::new();
    for row in 0..sample.rows {
        lines.entry(&ids[row]).or_default().push((times[row], distances[row], speeds[row]));
    }
    if lines.is_empty() {
        return None;
    }
    let stride = sample.rows.div_ceil(POINTS);
    let thinned = |line: &Vec<(f64, f64, f64)>| -> Vec<_> {
        let last = line.len() - 1;
        line.iter().enumerate().filter(|(i, _)| i % stride == 0 || *i == last).map(|(_, point)| *point).collect()
    };
    let all = run.vehicles.as_ref().map_or(0, |table| table.rows);
    let (name, of) = label.map_or_else(Default::default, |label| (format!("_{label}"), format!(", {label}")));
    let tracks = Tracks {
        title: format!("Sampled vehicles in time and space{of}"),
        x: "simulation time [s]",
        y: "distance driven [m]",
        unit: "speed [m/s]",
        lines: lines.values().map(thinned).collect(),
    };
    let points = if stride > 1 { format!(", every {stride} s") } else { String::new() };
    let caption = format!(
        "Distance that each sampled vehicle has driven since its departure, coloured by its speed in m/s: {} of {all}{points}. A flat line stands still.",
        counted(lines.len(), "vehicle", "vehicles"),
    );
    Some(FigureView::new(&Figure::tracks(&format!("time_space{name}"), &tracks), caption).wide())
}

/// Differences B − A of the vehicles that are in both runs.
pub fn differences(column: &str, unit: &str, mut values: Vec<f64>) -> Option<FigureView> {
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    let (low, high) = (values.first().copied()?, quantile(&values, 0.99));
    let curve = Curve::of(&format!("{} − {}", NAMES[1], NAMES[0]), steps(&values, high)).in_style("hue0");
    let zero = Curve::of("", vec![(0.0, 0.0), (0.0, 1.0)]).in_style("reference");
    let x = format!("difference of {column} [{unit}]");
    let curves = if low <= 0.0 && high >= 0.0 { vec![zero, curve] } else { vec![curve] };
    let chart = Chart {
        title: format!("Difference of {column}, vehicle by vehicle"),
        x: &x,
        y: "share of the vehicles",
        curves,
        ..Chart::default()
    };
    let caption = format!(
        "Share of the vehicles that are in both runs with at most this difference of {column} (B − A), in {unit}. Left of 0, B has less.",
    );
    Some(FigureView::new(&Figure::chart(&format!("difference_{column}"), &chart), caption))
}

/// The meaning of a column within a sentence.
pub fn lower(meaning: &str) -> String {
    let mut letters = meaning.chars();
    let Some(first) = letters.next() else { return String::new() };
    let rest = letters.as_str();
    // A symbol or an abbreviation keeps its capital.
    if rest.starts_with(|c: char| c.is_lowercase()) && !meaning.starts_with("SUMO") {
        first.to_lowercase().chain(rest.chars()).collect()
    } else {
        meaning.to_owned()
    }
}
