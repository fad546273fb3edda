//! The network, its roads coloured by what happened on them.

use super::data::RunData;
use super::table::Table;
use crate::figure::{Event, Figure, Ramp, Road, Roads};
use crate::page::FigureView;
use crate::sumo_files::{Incident, NetworkRoad};
use std::collections::BTreeMap;

/// Columns of `edges.csv` that colour the roads, the first that is there, and the words for it.
const COLUMNS: [(&str, &str); 3] =
    [("speed_gap_rms", "RMS speed gap"), ("error_rms", "RMS tracking error"), ("speed_mean", "mean speed")];
/// Roads up to which those within junctions are drawn, too.
const SMALL: usize = 4000;
/// Incidents that are drawn; more would hide the roads.
const DRAWN: usize = 500;

/// The maps of all runs, with one scale of colour, for each column that the tables have.
pub fn maps(runs: &[RunData], names: &[Option<&str>]) -> Vec<FigureView> {
    let of_column = |(column, words): &(&str, &str)| -> Vec<FigureView> {
        let values: Vec<_> =
            runs.iter().map(|run| run.edges.as_ref().and_then(|edges| by_edge(edges, column))).collect();
        let ramp = Ramp::of(values.iter().flatten().flat_map(|values| values.values().copied()));
        let maps = runs.iter().zip(names).zip(&values);
        maps.filter_map(|((run, name), values)| map(run, *name, [column, words], values.as_ref()?, &ramp)).collect()
    };
    COLUMNS.iter().flat_map(of_column).collect()
}

fn by_edge<'a>(edges: &'a Table, column: &str) -> Option<BTreeMap<&'a str, f64>> {
    let (ids, numbers) = (edges.texts("edge")?, edges.numbers(column)?);
    let known = ids.iter().map(String::as_str).zip(numbers.iter().copied()).filter(|(_, value)| value.is_finite());
    Some(known.collect())
}

fn map(
    run: &RunData,
    name: Option<&str>,
    [column, words]: [&str; 2],
    values: &BTreeMap<&str, f64>,
    ramp: &Ramp,
) -> Option<FigureView> {
    let network = run.roads.as_ref()?;
    let small = network.len() <= SMALL;
    let drawn = |road: &&NetworkRoad| !road.edge.starts_with(':') || small && values.contains_key(road.edge.as_str());
    let road = |road: &NetworkRoad| Road {
        id: road.edge.clone(),
        shape: road.shape.clone(),
        value: values.get(road.edge.as_str()).copied(),
    };
    let incidents = run.incidents.as_deref().unwrap_or_default();
    let (file, of) = name.map_or_else(Default::default, |name| (format!("_{name}"), format!(", {name}")));
    let roads = Roads {
        title: format!("{}{of}", capital(words)),
        unit: "[m/s]",
        ramp: ramp.clone(),
        roads: network.iter().filter(drawn).map(road).collect(),
        events: events(network, incidents),
    };
    let dots = match roads.events.len() {
        0 => String::new(),
        n => format!(" Dots: {n} safety events of SUMO's log, in the middle of their lanes' roads."),
    };
    let caption = format!(
        "Roads of the network by the {words} of the vehicles on them, in m/s ({column} of edges.csv); grey: no equipped vehicle was there.{dots}"
    );
    Some(FigureView::new(&Figure::roads(&format!("map_{column}{file}"), &roads), caption).zoomed())
}

/// Incidents at the middle of their road: the log names the lane, not the place on it.
fn events(network: &[NetworkRoad], incidents: &[Incident]) -> Vec<Event> {
    let shapes: BTreeMap<&str, &NetworkRoad> = network.iter().map(|road| (road.edge.as_str(), road)).collect();
    let place = |incident: &Incident| {
        let edge = incident.lane.rsplit_once('_').map_or(incident.lane.as_str(), |(edge, _)| edge);
        Some(Event { place: middle(&shapes.get(edge)?.shape), text: incident.text.clone() })
    };
    incidents.iter().filter_map(place).take(DRAWN).collect()
}

/// The point half-way along a shape.
fn middle(shape: &[[f64; 2]]) -> [f64; 2] {
    let length = |[a, b]: [[f64; 2]; 2]| libm::hypot(b[0] - a[0], b[1] - a[1]);
    let pieces = || shape.windows(2).map(|pair| [pair[0], pair[1]]);
    let mut left = 0.5 * pieces().map(length).sum::<f64>();
    for piece in pieces() {
        let long = length(piece);
        if long >= left && long > 0.0 {
            let share = left / long;
            return [0, 1].map(|k| piece[0][k] + share * (piece[1][k] - piece[0][k]));
        }
        left -= long;
    }
    shape[0]
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}
