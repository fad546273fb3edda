//! A network of roads, coloured by a value.

use super::drawing::{Figure, WIDTH};
use super::escape::escape;
use super::ramp::Ramp;
use std::fmt::Write;

/// Up to so many roads tell their name and value; more of them would make the file large.
const NAMED: usize = 4000;
/// Corners nearer to each other than this are one, in units of the drawing.
const NEAR: f64 = 0.8;

/// One road.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Road {
    /// Its id.
    pub id: String,
    /// Its shape \[m\].
    pub shape: Vec<[f64; 2]>,
    /// Its value, if it has one.
    pub value: Option<f64>,
}

/// Something that happened at a place.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Event {
    /// Its class among the styles: `event` or `conflict`.
    pub class: &'static str,
    /// Where \[m\].
    pub place: [f64; 2],
    /// What.
    pub text: String,
}

/// A network.
#[derive(Debug, Clone, PartialEq)]
pub struct Roads<'a> {
    /// Title.
    pub title: String,
    /// What the colour says.
    pub unit: &'a str,
    /// The colours.
    pub ramp: Ramp,
    /// The roads.
    pub roads: Vec<Road>,
    /// What happened on them.
    pub events: Vec<Event>,
}

impl Figure {
    /// Draws a network, north up. What can be zoomed is the group of class `plane`.
    pub fn roads(name: &str, roads: &Roads) -> Self {
        const TOP: f64 = 74.0;
        const EDGE: f64 = 14.0;
        let points = || roads.roads.iter().flat_map(|road| &road.shape);
        let ends = |k: usize| {
            points().map(|p| p[k]).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
        };
        let [[west, east], [south, north]] = [ends(0), ends(1)];
        let (wide, tall) = ((east - west).max(1.0), (north - south).max(1.0));
        let scale = ((WIDTH - 2.0 * EDGE) / wide).min(560.0 / tall);
        let left = 0.5 * (WIDTH - scale * wide);
        let place = |p: &[f64; 2]| [left + scale * (p[0] - west), TOP + EDGE + scale * (north - p[1])];
        let height = TOP + 2.0 * EDGE + scale * tall;
        let mut body = format!("<text class=\"title\" x=\"16\" y=\"20\">{}</text>", escape(&roads.title));
        let ramp = &roads.ramp;
        ramp.draw(&mut body, 28.0, 32.0, roads.unit);
        let _ = write!(
            body,
            "<svg class=\"map\" x=\"0\" y=\"{TOP}\" width=\"{WIDTH}\" height=\"{:.1}\" viewBox=\"0 {TOP} {WIDTH} {:.1}\"><rect class=\"plot\" x=\"0\" y=\"{TOP}\" width=\"{WIDTH}\" height=\"{:.1}\"/><g class=\"plane\">",
            height - TOP,
            height - TOP,
            height - TOP
        );
        let path = |road: &Road| {
            let corners = thinned(road.shape.iter().map(place).collect());
            let corners: Vec<String> = corners.iter().map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
            format!("M{}", corners.join("L"))
        };
        let empty: String = roads.roads.iter().filter(|road| road.value.is_none()).map(path).collect();
        if !empty.is_empty() {
            let _ = write!(body, "<path class=\"empty\" d=\"{empty}\"/>");
        }
        draw_valued(&mut body, roads, &path);
        for event in &roads.events {
            let [x, y] = place(&event.place);
            let _ = write!(
                body,
                "<circle class=\"{}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\"><title>{}</title></circle>",
                event.class,
                escape(&event.text)
            );
        }
        body += "</g></svg>";
        Self::drawn(name, &roads.title, body, height)
    }
}

/// A line without corners that are too near the last one to be seen; its ends stay.
fn thinned(corners: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let end = corners.len().saturating_sub(1);
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for (index, corner) in corners.iter().enumerate() {
        let far = kept.last().is_none_or(|last| libm::hypot(corner[0] - last[0], corner[1] - last[1]) > NEAR);
        if far || index == end {
            kept.push(*corner);
        }
    }
    kept
}

/// The roads with a value, the largest on top.
fn draw_valued(body: &mut String, roads: &Roads, path: &dyn Fn(&Road) -> String) {
    let mut valued: Vec<(f64, &Road)> = roads.roads.iter().filter_map(|road| Some((road.value?, road))).collect();
    valued.sort_by(|a, b| a.0.total_cmp(&b.0));
    let ramp = &roads.ramp;
    let named = valued.len().saturating_sub(NAMED);
    for group in valued[..named].chunk_by(|a, b| ramp.step(a.0) == ramp.step(b.0)) {
        let paths: String = group.iter().map(|(_, road)| path(road)).collect();
        let _ = write!(body, "<g class=\"v{}\"><path class=\"road\" d=\"{paths}\"/></g>", ramp.step(group[0].0));
    }
    for group in valued[named..].chunk_by(|a, b| ramp.step(a.0) == ramp.step(b.0)) {
        let _ = write!(body, "<g class=\"v{}\">", ramp.step(group[0].0));
        for (value, road) in group {
            let (id, digits) = (escape(&road.id), ramp.digits());
            let _ =
                write!(body, "<path class=\"road\" d=\"{}\"><title>{id}: {value:.digits$}</title></path>", path(road));
        }
        *body += "</g>";
    }
}
