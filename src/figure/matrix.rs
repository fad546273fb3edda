//! A table of values as colours, with the values in it.

use super::drawing::{Figure, WIDTH};
use super::escape::escape;
use super::ramp::Ramp;
use std::fmt::Write;

/// A table of values.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Matrix<'a> {
    /// Title.
    pub title: String,
    /// What the columns are.
    pub x: &'a str,
    /// What the rows are.
    pub y: &'a str,
    /// What the values are.
    pub unit: &'a str,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Names of the rows, from above.
    pub rows: Vec<String>,
    /// Values by row and column.
    pub values: Vec<Vec<Option<f64>>>,
}

impl Figure {
    /// Draws a table of values.
    pub fn matrix(name: &str, matrix: &Matrix) -> Self {
        const CELL: f64 = 30.0;
        const TOP: f64 = 66.0;
        let longest = matrix.rows.iter().map(|row| row.chars().count()).max().unwrap_or(0);
        let left = 34.0 + (7.0 * longest as f64).min(200.0);
        let width = (WIDTH - left - 16.0) / matrix.columns.len().max(1) as f64;
        let ramp = Ramp::of(matrix.values.iter().flatten().flatten().copied());
        let mut body = format!("<text class=\"title\" x=\"16\" y=\"20\">{}</text>", escape(&matrix.title));
        for (c, column) in matrix.columns.iter().enumerate() {
            let middle = left + (c as f64 + 0.5) * width;
            let _ = write!(
                body,
                "<text class=\"soft\" x=\"{middle:.1}\" y=\"58\" text-anchor=\"middle\">{}</text>",
                escape(column)
            );
        }
        let largest = matrix.values.iter().flatten().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        let digits = (2.0 - libm::floor(libm::log10(largest.max(1e-12)))).clamp(0.0, 6.0) as usize;
        for (r, row) in matrix.rows.iter().enumerate() {
            let top = TOP + r as f64 * CELL;
            let base = top + 0.5 * CELL + 4.0;
            let _ = write!(
                body,
                "<text class=\"soft\" x=\"{:.1}\" y=\"{base}\" text-anchor=\"end\">{}</text>",
                left - 6.0,
                escape(row)
            );
            for (c, value) in matrix.values[r].iter().enumerate() {
                let x = left + c as f64 * width;
                let middle = x + 0.5 * width;
                let Some(value) = value else {
                    let _ = write!(
                        body,
                        "<text class=\"soft\" x=\"{middle:.1}\" y=\"{base}\" text-anchor=\"middle\">–</text>"
                    );
                    continue;
                };
                let (step, width, height) = (ramp.step(*value), width - 1.0, CELL - 1.0);
                let _ = write!(
                    body,
                    "<g class=\"v{step}\"><rect class=\"full\" x=\"{x:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height}\"/>\
                     <text class=\"value\" x=\"{middle:.1}\" y=\"{base}\" text-anchor=\"middle\">{value:.digits$}</text></g>"
                );
            }
        }
        let bottom = TOP + matrix.rows.len() as f64 * CELL;
        let _ = write!(
            body,
            "<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            0.5 * (left + WIDTH),
            bottom + 18.0,
            escape(matrix.x)
        );
        let _ = write!(
            body,
            "<text transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            0.5 * (TOP + bottom),
            escape(matrix.y)
        );
        ramp.draw(&mut body, 64.0, bottom + 32.0, matrix.unit);
        Self::drawn(name, &matrix.title, body, bottom + 70.0)
    }
}
