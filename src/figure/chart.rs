//! Charts of lines and points.

use super::drawing::{Figure, WIDTH};
use super::frame::{BOTTOM, Entry, HEIGHT, LEFT, RIGHT, TOP, frame, legend, legend_height};
use super::scale::Scale;
use super::style::class;
use std::fmt::Write;

/// A curve has at most two corners per bunch of points, and this many bunches.
const COLUMNS: usize = 300;

/// A line or a set of points.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    /// Name in the legend.
    pub name: String,
    /// The controller or the class that gives its style.
    pub style: String,
    /// Points.
    pub points: Vec<(f64, f64)>,
    /// Dots instead of a line.
    pub dots: bool,
}

impl Curve {
    /// A line.
    pub fn of(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.to_owned(), style: name.to_owned(), points, dots: false }
    }

    /// Dots.
    pub fn dots(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self { dots: true, ..Self::of(name, points) }
    }

    fn entry(&self) -> Entry<'_> {
        Entry { name: &self.name, style: &self.style, dots: self.dots }
    }

    /// In the style of another controller or class than its name.
    pub fn in_style(self, style: &str) -> Self {
        Self { style: style.to_owned(), ..self }
    }
}

/// The range around a line.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Band {
    /// The controller or the class that gives its style.
    pub style: String,
    /// Place, lower and upper end.
    pub points: Vec<(f64, f64, f64)>,
}

/// A chart to be drawn.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chart<'a> {
    /// Title.
    pub title: String,
    /// Label of the horizontal axis.
    pub x: &'a str,
    /// Label of the vertical axis.
    pub y: &'a str,
    /// Ranges, below all curves.
    pub bands: Vec<Band>,
    /// What is drawn, last on top. A curve without a name is not in the legend.
    pub curves: Vec<Curve>,
    /// Same scale on both axes (a map of a track).
    pub isotropic: bool,
    /// A logarithmic vertical axis, for values above 0.
    pub logarithmic: bool,
}

/// Widens the axis that is too narrow.
fn make_isotropic(x: &mut Scale, y: &mut Scale) {
    let unit = ((x.high - x.low) / (x.to - x.from).abs()).max((y.high - y.low) / (y.to - y.from).abs());
    for scale in [x, y] {
        let (middle, half) = (0.5 * (scale.low + scale.high), 0.5 * unit * (scale.to - scale.from).abs());
        (scale.low, scale.high) = (middle - half, middle + half);
    }
}

impl Figure {
    /// Draws a chart.
    pub fn chart(name: &str, chart: &Chart) -> Self {
        let of_bands = |k: usize| chart.bands.iter().flat_map(|band| &band.points).map(move |p| [p.0, p.1, p.2][k]);
        let of_curves = || chart.curves.iter().flat_map(|c| &c.points);
        let entry = |curve: &'_ Curve| !curve.name.is_empty();
        let entries: Vec<Entry> = chart.curves.iter().filter(|c| entry(c)).map(Curve::entry).collect();
        let top = TOP + legend_height(&entries);
        let bottom = top + HEIGHT - TOP - BOTTOM;
        let margin = if chart.isotropic { 0.03 } else { 0.0 };
        let mut x = Scale::new(of_curves().map(|p| p.0).chain(of_bands(0)), LEFT, WIDTH - RIGHT, margin);
        let heights = of_curves().map(|p| p.1).chain(of_bands(1)).chain(of_bands(2));
        let axis = if chart.logarithmic { Scale::logarithmic } else { Scale::new };
        let mut y = axis(heights, bottom, top, 0.06);
        if chart.isotropic {
            make_isotropic(&mut x, &mut y);
        }
        let mut body = frame(&chart.title, [chart.x, chart.y], &x, &y);
        for band in &chart.bands {
            draw_band(&mut body, band, &x, &y);
        }
        for curve in &chart.curves {
            draw(&mut body, curve, &x, &y);
        }
        legend(&mut body, &entries);
        Self::drawn(name, &chart.title, body, bottom + BOTTOM)
    }
}

fn draw_band(out: &mut String, band: &Band, x: &Scale, y: &Scale) {
    let upper = band.points.iter().map(|(at, _, high)| (at, high));
    let lower = band.points.iter().rev().map(|(at, low, _)| (at, low));
    let corners = upper.chain(lower).map(|(a, b)| format!("{:.1} {:.1}", x.at(*a), y.at(*b)));
    let path = corners.collect::<Vec<_>>().join("L");
    let _ = write!(out, "<g class=\"{}\"><path class=\"band\" d=\"M{path}Z\"/></g>", class(&band.style));
}

fn draw(out: &mut String, curve: &Curve, x: &Scale, y: &Scale) {
    let class = class(&curve.style);
    let points: Vec<(f64, f64)> = curve
        .points
        .iter()
        .filter(|(a, b)| a.is_finite() && b.is_finite())
        .map(|(a, b)| (x.at(*a), y.at(*b)))
        .collect();
    if curve.dots {
        let radius = if class == "mark" { 8.0 } else { 3.0 };
        for (a, b) in points {
            let _ = write!(out, "<circle class=\"{class}\" cx=\"{a:.1}\" cy=\"{b:.1}\" r=\"{radius}\"/>");
        }
        return;
    }
    let mut path = String::new();
    for (i, (a, b)) in thinned(&points).into_iter().enumerate() {
        let _ = write!(path, "{}{a:.1} {b:.1}", if i == 0 { 'M' } else { 'L' });
    }
    let _ = write!(out, "<path class=\"{class}\" d=\"{path}\"/>");
}

/// The points of a curve that can be told apart: of each bunch of neighbours the lowest and the highest, in their order.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let bunch = points.len().div_ceil(COLUMNS);
    if bunch <= 1 {
        return points.to_vec();
    }
    let extremes = points.chunks(bunch).flat_map(|chunk| {
        let by_height = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let (low, high) = (chunk.iter().min_by(by_height), chunk.iter().max_by(by_height));
        let (low, high) = (low.expect("chunks are not empty"), high.expect("chunks are not empty"));
        if low.0 <= high.0 { [*low, *high] } else { [*high, *low] }
    });
    extremes.chain(points.last().copied()).collect()
}
