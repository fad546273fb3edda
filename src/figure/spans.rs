//! Ranges side by side: intervals, or the quantiles of a distribution.

use super::drawing::{Figure, WIDTH};
use super::escape::escape;
use super::frame::{BOTTOM, RIGHT};
use super::scale::Scale;
use super::style::class;
use std::fmt::Write;

/// One range.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Span {
    /// What it is of.
    pub label: String,
    /// The controller or the class that gives its style.
    pub style: String,
    /// Its ends.
    pub ends: [f64; 2],
    /// Its middle half, if that is drawn as a box.
    pub half: Option<[f64; 2]>,
    /// Its middle.
    pub middle: f64,
}

/// Ranges on one axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Spans<'a> {
    /// Title.
    pub title: String,
    /// Label of the axis.
    pub unit: &'a str,
    /// The ranges, from above.
    pub spans: Vec<Span>,
    /// Draw the axis from 0 on.
    pub from_zero: bool,
}

impl Figure {
    /// Draws ranges.
    pub fn spans(name: &str, spans: &Spans) -> Self {
        const ROW: f64 = 26.0;
        const TOP: f64 = 34.0;
        let longest = spans.spans.iter().map(|span| span.label.chars().count()).max().unwrap_or(0);
        let left = 24.0 + (6.6 * longest as f64).min(240.0);
        let zero = spans.from_zero.then_some(0.0);
        let x = Scale::new(spans.spans.iter().flat_map(|span| span.ends).chain(zero), left + 8.0, WIDTH - RIGHT, 0.02);
        let bottom = TOP + ROW * spans.spans.len() as f64;
        let mut body = format!("<text class=\"title\" x=\"16\" y=\"20\">{}</text>", escape(&spans.title));
        let (ticks, digits) = x.ticks(7.0);
        for tick in ticks {
            let (at, base) = (x.at(tick), bottom + 16.0);
            let class = if tick == 0.0 { "axis" } else { "grid" };
            let _ = write!(
                body,
                "<line class=\"{class}\" x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{TOP}\" y2=\"{bottom}\"/>\
                 <text class=\"soft\" x=\"{at:.1}\" y=\"{base}\" text-anchor=\"middle\">{tick:.digits$}</text>"
            );
        }
        for (i, span) in spans.spans.iter().enumerate() {
            let y = TOP + (i as f64 + 0.5) * ROW;
            let [low, high] = span.ends.map(|end| x.at(end));
            let _ = write!(
                body,
                "<text x=\"{left:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text><g class=\"{}\"><path class=\"whisker\" d=\"M{low:.1} {y}H{high:.1}\"/>",
                y + 4.0,
                escape(&span.label),
                class(&span.style)
            );
            if let Some(half) = span.half {
                let [low, high] = half.map(|end| x.at(end));
                let (top, width) = (y - 7.0, (high - low).max(1.0));
                let _ =
                    write!(body, "<rect class=\"box\" x=\"{low:.1}\" y=\"{top}\" width=\"{width:.1}\" height=\"14\"/>");
            }
            let _ = write!(body, "<circle cx=\"{:.1}\" cy=\"{y}\" r=\"3.6\"/></g>", x.at(span.middle));
        }
        let (middle, low) = (0.5 * (left + WIDTH), bottom + BOTTOM - 10.0);
        let _ = write!(body, "<text x=\"{middle}\" y=\"{low}\" text-anchor=\"middle\">{}</text>", escape(spans.unit));
        Self::drawn(name, &spans.title, body, bottom + BOTTOM)
    }
}
