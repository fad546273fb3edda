//! Horizontal bars in groups.

use super::drawing::{Figure, WIDTH};
use super::escape::escape;
use super::frame::{BOTTOM, Entry, RIGHT, TOP, legend};
use super::scale::Scale;
use super::style::class;
use std::fmt::Write;

/// Horizontal bars in groups.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bars<'a> {
    /// Title.
    pub title: String,
    /// Label of the axis of values.
    pub unit: &'a str,
    /// A label and its bars: controller and value.
    pub groups: Vec<(String, Vec<Bar>)>,
}

/// The controller of a bar and its value.
pub type Bar = (&'static str, Option<f64>);

impl Figure {
    /// Draws bars, from 0; a missing value is written as such.
    pub fn bars(name: &str, bars: &Bars) -> Self {
        const BAR: f64 = 8.0;
        const LABELS: f64 = 170.0;
        let group_height = |bars: &[Bar]| bars.len() as f64 * BAR + 10.0;
        let height = TOP + BOTTOM + bars.groups.iter().map(|(_, b)| group_height(b)).sum::<f64>();
        let values = bars.groups.iter().flat_map(|(_, b)| b.iter().filter_map(|(_, value)| *value));
        let x = Scale::new(values.chain([0.0]), LABELS, WIDTH - RIGHT - 40.0, 0.0);
        let bottom = height - BOTTOM;
        let mut body = format!("<text class=\"title\" x=\"16\" y=\"20\">{}</text>", escape(&bars.title));
        let (ticks, digits) = x.ticks(8.0);
        for tick in ticks {
            let at = x.at(tick);
            let _ = write!(body, "<line class=\"grid\" x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{TOP}\" y2=\"{bottom}\"/>");
            let below = bottom + 16.0;
            let _ = write!(
                body,
                "<text class=\"soft\" x=\"{at:.1}\" y=\"{below}\" text-anchor=\"middle\">{tick:.digits$}</text>"
            );
        }
        let mut y = TOP;
        for (label, group) in &bars.groups {
            let middle = y + 0.5 * group_height(group) + 4.0;
            let end = LABELS - 8.0;
            let _ = write!(body, "<text x=\"{end}\" y=\"{middle:.1}\" text-anchor=\"end\">{}</text>", escape(label));
            for (i, (name, value)) in group.iter().enumerate() {
                let class = class(name);
                let top = y + 5.0 + BAR * i as f64;
                match value {
                    Some(value) => {
                        let width = x.at(*value) - LABELS;
                        let height = BAR - 1.0;
                        let _ = write!(
                            body,
                            "<rect class=\"bar {class}\" x=\"{LABELS}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height}\"/>"
                        );
                    }
                    None => {
                        let base = top + BAR;
                        let _ = write!(
                            body,
                            "<text class=\"cell\" x=\"{LABELS}\" y=\"{base:.1}\">{name}: did not arrive</text>"
                        );
                    }
                }
            }
            y += group_height(group);
        }
        let (middle, low) = (0.5 * (LABELS + WIDTH), height - 10.0);
        let _ = write!(body, "<text x=\"{middle}\" y=\"{low}\" text-anchor=\"middle\">{}</text>", escape(bars.unit));
        let mut entries: Vec<Entry> = Vec::new();
        for (name, _) in bars.groups.iter().flat_map(|(_, b)| b) {
            if !entries.iter().any(|e| e.name == *name) {
                entries.push(Entry { name, style: name, dots: false });
            }
        }
        legend(&mut body, &entries);
        Self::drawn(name, &bars.title, body, height)
    }
}
