//! Figures as SVG, drawn here so that one file serves light and dark, a page and a printer: colours are classes, text is text.

use std::fmt::Write;

/// Size of a chart in its own units.
const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 320.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 56.0;
const BOTTOM: f64 = 46.0;
/// A curve has at most two corners per bunch of points, and this many bunches.
const COLUMNS: usize = 300;

/// The strokes of all figures, and the colours of what is not a controller. `currentColor` of a hue is its colour.
const BASE: &str = "\
.fig{font:12px system-ui,'Segoe UI',Roboto,sans-serif;color:#1c2430;background:#fff}\
.fig text{fill:currentColor}.fig .title{font-size:14px;font-weight:600}.fig .soft{fill:#5b6675}\
.fig .grid{stroke:#e3e7ec;stroke-width:1}.fig .axis{stroke:#8a94a3;stroke-width:1}.fig .plot{fill:#fafbfc}\
.fig path{fill:none;stroke:currentColor;stroke-width:1.8;stroke-linejoin:round}\
.fig circle,.fig .bar{fill:currentColor;stroke:none}.fig .law{stroke-width:1.6}\
.fig .reference{stroke:#5b6675;stroke-dasharray:5 4;stroke-width:1.4}\
.fig .mark{fill:none;stroke:#c2185b;stroke-width:3}.fig .cell{font-size:10px;fill:#14181f}\
@media(prefers-color-scheme:dark){.fig{color:#e4e9f0;background:#151a21}.fig .soft{fill:#9aa7b8}.fig .grid{stroke:#2a323d}\
.fig .axis{stroke:#66717f}.fig .plot{fill:#1a2029}.fig .reference{stroke:#9aa7b8}.fig .mark{stroke:#ff6fa3}}";

/// The hues in light and dark. Neighbours stay apart for every kind of colour vision.
const HUES: [[&str; 2]; 8] = [
    ["#1765ad", "#5fb0f5"],
    ["#d1610a", "#ff9d4d"],
    ["#2e8540", "#63c97c"],
    ["#a02c8c", "#f08ad8"],
    ["#7a4fb5", "#b99af0"],
    ["#00798c", "#4cc9d8"],
    ["#8a6d00", "#e0bd3a"],
    ["#7d4b3a", "#d39b86"],
];

/// The styles that every page and file with figures needs.
pub fn style() -> String {
    let rules = |shade: usize| {
        let rule = |(i, hue): (usize, &[&str; 2])| format!(".fig .hue{i}{{color:{}}}", hue[shade]);
        HUES.iter().enumerate().map(rule).collect::<String>()
    };
    format!("{BASE}{}@media(prefers-color-scheme:dark){{{}}}", rules(0), rules(1))
}

/// The class of a controller's hue, by its place among the controllers; any other name is a class itself.
fn class(name: &str) -> String {
    let place = crate::control::CONTROLLERS.iter().position(|entry| entry.name == name);
    place.map_or_else(|| escape(name), |i| format!("hue{}", i % HUES.len()))
}

/// A finished figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// The file's stem.
    pub name: String,
    /// What it shows, for readers who cannot see it.
    pub title: String,
    /// The drawing, without the surrounding `<svg>`.
    body: String,
    height: f64,
}

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

    /// In the style of another controller or class than its name.
    pub fn in_style(self, style: &str) -> Self {
        Self { style: style.to_owned(), ..self }
    }
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
    /// What is drawn, last on top.
    pub curves: Vec<Curve>,
    /// Same scale on both axes (a map of a track).
    pub isotropic: bool,
}

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

/// One axis: from values to places in the drawing.
struct Scale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Scale {
    fn new(values: impl Iterator<Item = f64>, from: f64, to: f64, margin: f64) -> Self {
        let (low, high) = values
            .filter(|x| x.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let (low, high) = if low > high { (0.0, 1.0) } else { (low, high) };
        let room = if high > low { (high - low) * margin } else { 0.5 };
        Self { low: low - room, high: high + room, from, to }
    }

    fn at(&self, value: f64) -> f64 {
        self.from + (value - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Round values within the axis, about `count` of them.
    fn ticks(&self, count: f64) -> (Vec<f64>, usize) {
        let rough = (self.high - self.low) / count;
        let decade = libm::floor(libm::log10(rough));
        let power = libm::pow(10.0, decade);
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= rough).unwrap_or(10.0 * power);
        let first = (self.low / step).ceil() as i64;
        let last = (self.high / step).floor() as i64;
        let digits = (-libm::floor(libm::log10(step) + 1e-9)).max(0.0) as usize;
        ((first..=last).map(|k| k as f64 * step).collect(), digits)
    }
}

impl Figure {
    /// Draws a chart.
    pub fn chart(name: &str, chart: &Chart) -> Self {
        let all = || chart.curves.iter().flat_map(|c| &c.points);
        let mut x = Scale::new(all().map(|p| p.0), LEFT, WIDTH - RIGHT, if chart.isotropic { 0.03 } else { 0.0 });
        let mut y = Scale::new(all().map(|p| p.1), HEIGHT - BOTTOM, TOP, 0.06);
        if chart.isotropic {
            make_isotropic(&mut x, &mut y);
        }
        let mut body = frame(chart, &x, &y);
        for curve in &chart.curves {
            draw(&mut body, curve, &x, &y);
        }
        legend(&mut body, &chart.curves);
        Self { name: name.to_owned(), title: chart.title.clone(), body, height: HEIGHT }
    }

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
        let mut names: Vec<Curve> = Vec::new();
        for (name, _) in bars.groups.iter().flat_map(|(_, b)| b) {
            if !names.iter().any(|c| c.name == *name) {
                names.push(Curve::of(name, Vec::new()));
            }
        }
        legend(&mut body, &names);
        Self { name: name.to_owned(), title: bars.title.clone(), body, height }
    }

    /// A drawing made elsewhere, `height` units high and as wide as a chart.
    pub fn drawn(name: &str, title: &str, body: String, height: f64) -> Self {
        Self { name: name.to_owned(), title: title.to_owned(), body, height }
    }

    /// For a page that has [`style`].
    pub fn inline(&self) -> String {
        self.wrapped("", "")
    }

    /// As a file of its own.
    pub fn file(&self) -> String {
        self.wrapped(" xmlns=\"http://www.w3.org/2000/svg\"", &format!("<style>{}</style>", style()))
    }

    fn wrapped(&self, attributes: &str, style: &str) -> String {
        let (title, height, body) = (escape(&self.title), self.height, &self.body);
        format!(
            "<svg{attributes} class=\"fig\" viewBox=\"0 0 {WIDTH} {height}\" role=\"img\"><title>{title}</title>{style}{body}</svg>\n"
        )
    }
}

/// Text without what XML keeps for itself.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Widens the axis that is too narrow.
fn make_isotropic(x: &mut Scale, y: &mut Scale) {
    let unit = ((x.high - x.low) / (x.to - x.from).abs()).max((y.high - y.low) / (y.to - y.from).abs());
    for scale in [x, y] {
        let (middle, half) = (0.5 * (scale.low + scale.high), 0.5 * unit * (scale.to - scale.from).abs());
        (scale.low, scale.high) = (middle - half, middle + half);
    }
}

fn frame(chart: &Chart, x: &Scale, y: &Scale) -> String {
    let mut out = String::new();
    let (right, bottom) = (WIDTH - RIGHT, HEIGHT - BOTTOM);
    let (inner_width, inner_height) = (right - LEFT, bottom - TOP);
    let _ = write!(
        out,
        "<rect class=\"plot\" x=\"{LEFT}\" y=\"{TOP}\" width=\"{inner_width}\" height=\"{inner_height}\"/>"
    );
    let (ticks, digits) = x.ticks(10.0);
    for tick in ticks {
        let at = x.at(tick);
        let _ = write!(out, "<line class=\"grid\" x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{TOP}\" y2=\"{bottom}\"/>");
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
            "<text class=\"soft\" x=\"{before}\" y=\"{base:.1}\" text-anchor=\"end\">{tick:.digits$}</text>"
        );
    }
    let _ = write!(out, "<line class=\"axis\" x1=\"{LEFT}\" x2=\"{right}\" y1=\"{bottom}\" y2=\"{bottom}\"/>");
    let _ = write!(out, "<text class=\"title\" x=\"{LEFT}\" y=\"20\">{}</text>", escape(&chart.title));
    let (middle, low) = (LEFT + 0.5 * inner_width, HEIGHT - 10.0);
    let _ = write!(out, "<text x=\"{middle}\" y=\"{low}\" text-anchor=\"middle\">{}</text>", escape(chart.x));
    let middle = TOP + 0.5 * inner_height;
    let _ = write!(
        out,
        "<text transform=\"translate(16 {middle}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        escape(chart.y)
    );
    out
}

fn legend(out: &mut String, curves: &[Curve]) {
    let mut x = LEFT;
    for curve in curves {
        let (name, class) = (escape(&curve.name), class(&curve.style));
        let (end, text) = (x + 22.0, x + 28.0);
        if curve.dots {
            let _ = write!(out, "<circle class=\"{class}\" cx=\"{}\" cy=\"38\" r=\"4\"/>", x + 11.0);
        } else {
            let _ = write!(out, "<path class=\"{class}\" d=\"M{x} 38H{end}\"/>");
        }
        let _ = write!(out, "<text x=\"{text}\" y=\"42\">{name}</text>");
        x = text + 7.0 * curve.name.len() as f64 + 18.0;
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_controller_has_a_colour_in_light_and_dark() {
        let style = style();
        let names = crate::control::CONTROLLERS.iter().map(|entry| class(entry.name));
        let classes: std::collections::BTreeSet<String> = names.collect();
        assert_eq!(
            classes.len(),
            crate::control::CONTROLLERS.len().min(HUES.len()),
            "no two share one while there are enough"
        );
        for class in classes {
            assert_eq!(style.matches(&format!(".{class}{{color:#")).count(), 2, "{class}");
        }
    }
}
