//! Figures of a study: differences with their intervals, curves over one varied key, maps over two.

use super::figures::lower;
use super::study_data::{Compared, StudyData};
use crate::figure::{Band, Chart, Curve, Figure, Matrix, Span, Spans, hue};
use crate::page::FigureView;

/// Settings beside each other in one figure; more could not be read.
const SETTINGS: usize = 40;
/// Curves in one figure.
const CURVES: usize = 8;

/// A name and its points: place, mean, half width of the interval.
type Line = (String, Vec<(f64, f64, f64)>);
/// A name and its values by row and column.
type NamedTable = (String, Vec<Vec<Option<f64>>>);

/// One metric of all settings.
pub struct MetricRows<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its title with its unit.
    pub titled: String,
    /// Its name with its unit, for axes and captions.
    pub axis: String,
    /// What it is called in a sentence.
    pub words: String,
    /// Its rows, setting by setting.
    pub rows: Vec<Compared<'a>>,
}

impl<'a> MetricRows<'a> {
    /// The metrics of a study, in the order of its table.
    pub fn all(study: &'a StudyData) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for row in study.comparison.iter().flat_map(Compared::all) {
            let name = row.text("metric");
            match all.iter_mut().find(|known| known.name == name) {
                Some(known) => known.rows.push(row),
                None => {
                    let (title, unit) = (study.title(name), row.text("unit"));
                    let titled = if unit.is_empty() { title.clone() } else { format!("{title} [{unit}]") };
                    // "Tracking: error_rms": the group of a metric is told once, in the title of its section.
                    let words = lower(title.split_once(": ").map_or(title.as_str(), |(_, words)| words));
                    let axis = if unit.is_empty() { words.clone() } else { format!("{words} [{unit}]") };
                    all.push(Self { name, titled, axis, words, rows: vec![row] });
                }
            }
        }
        all
    }

    /// Whether any setting has a value.
    pub fn is_known(&self) -> bool {
        self.rows.iter().any(|row| row.number("mean").is_some())
    }

    /// Whether any two settings differ in it.
    pub fn varies(&self) -> bool {
        let means: Vec<f64> = self.rows.iter().filter_map(|row| row.number("mean")).collect();
        means.windows(2).any(|pair| pair[0] != pair[1])
    }
}

/// The paired differences to the reference with their intervals, or, without a reference, the means with theirs.
pub fn intervals(study: &StudyData, metric: &MetricRows) -> Option<FigureView> {
    let paired = metric.rows.iter().any(|row| row.number("diff").is_some());
    let [middle, half] = if paired { ["diff", "diff_ci95"] } else { ["mean", "ci95"] };
    let mut spans = Vec::new();
    for row in &metric.rows {
        let Some(at) = row.number(middle) else { continue };
        let width = row.number(half).unwrap_or(0.0);
        let sure = paired && row.number("p_holm").is_some_and(|p| p < 0.05);
        let label = setting(&study.plan.keys, &row.values(&study.plan.keys), &[]);
        spans.push(Span {
            label: if sure { format!("{label} *") } else { label },
            style: hue("", usize::from(sure)),
            ends: [at - width, at + width],
            half: None,
            middle: at,
        });
    }
    if spans.is_empty() || spans.len() > SETTINGS {
        return None;
    }
    let title = if paired { format!("{}: difference to the reference", metric.words) } else { metric.words.clone() };
    let figure = Figure::spans(
        &format!("intervals_{}", metric.name),
        &Spans { title, unit: &metric.axis, spans, from_zero: paired },
    );
    let caption = if paired {
        format!(
            "Paired difference of {} to the reference, mean over the seeds with the 95 % interval; * p < 0.05 after Holm.",
            metric.axis
        )
    } else {
        format!("{}: mean over the seeds with its 95 % interval.", metric.axis)
    };
    Some(FigureView::new(&figure, caption))
}

/// A value of a key as a number: `0.3`, `share:0.25`; `all` is the share 1.
pub fn numeric(value: &str) -> Option<f64> {
    let text = value.strip_prefix("share:").unwrap_or(if value == "all" { "1" } else { value });
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

/// The distinct values of a key, in ascending order if they are numbers, else as they come.
fn values_of(study: &StudyData, key: usize) -> Vec<String> {
    let mut values: Vec<String> = Vec::new();
    for setting in &study.plan.settings {
        if !values.contains(&setting.values[key]) {
            values.push(setting.values[key].clone());
        }
    }
    if values.iter().all(|value| numeric(value).is_some()) {
        values.sort_by(|a, b| numeric(a).unwrap_or(0.0).total_cmp(&numeric(b).unwrap_or(0.0)));
    }
    values
}

/// The metric over one key of numbers, one curve for each setting of the others.
pub fn curves(study: &StudyData, metric: &MetricRows, key: usize) -> Option<FigureView> {
    let keys = &study.plan.keys;
    let values = values_of(study, key);
    if values.len() < 3 || values.iter().any(|value| numeric(value).is_none()) {
        return None;
    }
    let mut lines: Vec<Line> = Vec::new();
    for row in &metric.rows {
        let Some(mean) = row.number("mean") else { continue };
        let of_row = row.values(keys);
        let name = setting(keys, &of_row, &[key]);
        let name = if name.is_empty() { "mean".to_owned() } else { name };
        let point = (numeric(&of_row[key])?, mean, row.number("ci95").unwrap_or(0.0));
        match lines.iter_mut().find(|(known, _)| *known == name) {
            Some((_, points)) => points.push(point),
            None => lines.push((name, vec![point])),
        }
    }
    let left_out = lines.len().saturating_sub(CURVES);
    lines.truncate(CURVES);
    let (mut bands, mut drawn) = (Vec::new(), Vec::new());
    for (place, (name, mut points)) in lines.into_iter().enumerate() {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let style = hue(&name, place);
        let band = points.iter().map(|(x, mean, half)| (*x, mean - half, mean + half)).collect();
        bands.push(Band { style: style.clone(), points: band });
        let line: Vec<(f64, f64)> = points.iter().map(|(x, mean, _)| (*x, *mean)).collect();
        drawn.push(Curve::dots("", line.clone()).in_style(&style));
        drawn.push(Curve::of(&name, line).in_style(&style));
    }
    let title = format!("{} over {}", metric.words, keys[key]);
    let chart = Chart { title, x: &keys[key], y: &metric.axis, bands, curves: drawn, ..Chart::default() };
    let figure = Figure::chart(&format!("curve_{}_{}", metric.name, stem(&keys[key])), &chart);
    let rest =
        if left_out > 0 { format!(" {left_out} more settings of the other keys are left out.") } else { String::new() };
    let caption = format!("{}: mean over the seeds; the bands are its 95 % intervals.{rest}", metric.axis);
    Some(FigureView::new(&figure, caption))
}

/// The metric over two keys, a table of colours for each setting of the others.
pub fn matrices(study: &StudyData, metric: &MetricRows, pair: [usize; 2]) -> Vec<FigureView> {
    let keys = &study.plan.keys;
    let [rows, columns] = pair.map(|key| values_of(study, key));
    let mut tables: Vec<NamedTable> = Vec::new();
    for row in &metric.rows {
        let of_row = row.values(keys);
        let name = setting(keys, &of_row, &pair);
        if !tables.iter().any(|(known, _)| *known == name) {
            tables.push((name.clone(), vec![vec![None; columns.len()]; rows.len()]));
        }
        let at = |values: &[String], key: usize| values.iter().position(|value| *value == of_row[key]);
        if let (Some((_, table)), Some(r), Some(c)) =
            (tables.iter_mut().find(|(known, _)| *known == name), at(&rows, pair[0]), at(&columns, pair[1]))
        {
            table[r][c] = row.number("mean");
        }
    }
    tables.truncate(4);
    let figure = |(place, (name, values)): (usize, NamedTable)| {
        let of = if name.is_empty() { String::new() } else { format!(" ({name})") };
        let matrix = Matrix {
            title: format!("{}{of}", metric.words),
            x: &keys[pair[1]],
            y: &keys[pair[0]],
            unit: &metric.axis,
            columns: columns.clone(),
            rows: rows.clone(),
            values,
        };
        let number = if place == 0 { String::new() } else { format!("_{}", place + 1) };
        let stem = format!("heat_{}_{}_{}{number}", metric.name, stem(&keys[pair[0]]), stem(&keys[pair[1]]));
        let caption = format!("{} over {} and {}, mean over the seeds.", metric.axis, keys[pair[0]], keys[pair[1]]);
        FigureView::new(&Figure::matrix(&stem, &matrix), caption)
    };
    tables.into_iter().enumerate().map(figure).collect()
}

/// A setting in words, without some of its keys. A word stands for itself, `pid`; a number needs its key, `delay_s=0.2`.
fn setting(keys: &[String], values: &[String], without: &[usize]) -> String {
    let others = keys.iter().zip(values).enumerate().filter(|(index, _)| !without.contains(index));
    let words = others.map(|(_, (key, value))| match value.parse::<f64>() {
        Ok(_) => format!("{}={value}", key.rsplit('.').next().unwrap_or(key)),
        Err(_) => value.clone(),
    });
    words.collect::<Vec<_>>().join(", ")
}

/// A key as a part of a file's name.
fn stem(key: &str) -> String {
    key.chars().map(|c| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' }).collect()
}

/// Whether a key has enough values for a table of colours.
pub fn divides(study: &StudyData, key: usize) -> bool {
    values_of(study, key).len() > 1
}
