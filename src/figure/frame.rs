//! Axes, grid, titles and legend.

use super::drawing::WIDTH;
use super::escape::escape;
use super::scale::Scale;
use super::style::class;
use std::fmt::Write;

/// Height of a chart.
pub const HEIGHT: f64 = 320.0;
/// Left of the axes.
pub const LEFT: f64 = 64.0;
/// Right of the axes.
pub const RIGHT: f64 = 24.0;
/// Above the axes, with a legend of one line.
pub const TOP: f64 = 56.0;
/// Below the axes.
pub const BOTTOM: f64 = 46.0;
/// Height of a further line of the legend.
const LINE: f64 = 18.0;

/// One entry of a legend.
pub struct Entry<'a> {
    /// What it says.
    pub name: &'a str,
    /// The controller or the class that gives its style.
    pub style: &'a str,
    /// A dot instead of a line.
    pub dots: bool,
}

/// Axes from `x.from` to `x.to` and `y.from` (below) to `y.to`, with grid, title and labels.
pub fn frame(title: &str, [x_label, y_label]: [&str; 2], x: &Scale, y: &Scale) -> String {
    let mut out = String::new();
    let (right, top, bottom) = (x.to, y.to, y.from);
    let (inner_width, inner_height) = (right - LEFT, bottom - top);
    let _ = write!(
        out,
        "<rect class=\"plot\" x=\"{LEFT}\" y=\"{top}\" width=\"{inner_width}\" height=\"{inner_height}\"/>"
    );
    let (ticks, digits) = x.ticks(9.0);
    for tick in ticks {
        let at = x.at(tick);
        let _ = write!(out, "<line class=\"grid\" x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{top}\" y2=\"{bottom}\"/>");
        let below = bottom + 16.0;
        let _ = write!(
            out,
            "<text class=\"soft\" x=\"{at:.1}\" y=\"{below}\" text-anchor=\"middle\">{tick:.digits$}</text>"
        );
    }
    let (ticks, digits) = y.ticks(6.0);
    for tick in ticks {
        let at = y.at(tick);
        let class = if tick == 0.0 { "axis" } else { "grid" };
        let _ = write!(out, "<line class=\"{class}\" x1=\"{LEFT}\" x2=\"{right}\" y1=\"{at:.1}\" y2=\"{at:.1}\"/>");
        let (before, base) = (LEFT - 7.0, at + 4.0);
        let _ = write!(
            out,
            "<text class=\"soft\" x=\"{before}\" y=\"{base:.1}\" text-anchor=\"end\">{}</text>",
            label(tick, digits, y.logarithmic)
        );
    }
    let _ = write!(out, "<line class=\"axis\" x1=\"{LEFT}\" x2=\"{right}\" y1=\"{bottom}\" y2=\"{bottom}\"/>");
    let _ = write!(out, "<text class=\"title\" x=\"{LEFT}\" y=\"20\">{}</text>", escape(title));
    let (middle, low) = (LEFT + 0.5 * inner_width, bottom + BOTTOM - 10.0);
    let _ = write!(out, "<text x=\"{middle}\" y=\"{low}\" text-anchor=\"middle\">{}</text>", escape(x_label));
    let middle = top + 0.5 * inner_height;
    let _ = write!(
        out,
        "<text transform=\"translate(16 {middle}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        escape(y_label)
    );
    out
}

/// A tick as text; on a logarithmic axis each has its own digits.
fn label(tick: f64, digits: usize, logarithmic: bool) -> String {
    if logarithmic { format!("{tick}") } else { format!("{tick:.digits$}") }
}

/// The entries of a legend, each with its place.
fn places<'a>(entries: &'a [Entry<'a>]) -> Vec<(&'a Entry<'a>, f64, f64)> {
    let (mut x, mut y) = (LEFT, 38.0);
    let place = |entry: &'a Entry<'a>| {
        let width = 28.0 + 7.0 * entry.name.chars().count() as f64;
        if x > LEFT && x + width > WIDTH - 8.0 {
            (x, y) = (LEFT, y + LINE);
        }
        let here = (entry, x, y);
        x += width + 18.0;
        here
    };
    entries.iter().map(place).collect()
}

/// What a legend needs beyond its first line.
pub fn legend_height(entries: &[Entry]) -> f64 {
    places(entries).last().map_or(0.0, |(.., y)| y - 38.0)
}

/// Draws a legend below the title.
pub fn legend(out: &mut String, entries: &[Entry]) {
    for (entry, x, y) in places(entries) {
        let (name, class, base) = (escape(entry.name), class(entry.style), y + 4.0);
        if entry.dots {
            let _ = write!(out, "<circle class=\"{class}\" cx=\"{}\" cy=\"{y}\" r=\"4\"/>", x + 11.0);
        } else {
            let _ = write!(out, "<path class=\"{class}\" d=\"M{x} {y}H{}\"/>", x + 22.0);
        }
        let _ = write!(out, "<text x=\"{}\" y=\"{base}\">{name}</text>", x + 28.0);
    }
}
