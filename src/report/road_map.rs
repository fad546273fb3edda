//! The network, its roads coloured by what happened on them.

use super::data::RunData;
use super::number::counted;
use super::table::Table;
use crate::figure::{Event, Figure, Ramp, Road, Roads};
use crate::page::FigureView;
use crate::sumo_files::{Conflict, Incident, NetworkRoad};
use std::collections::BTreeMap;

/// Columns of `edges.csv` that colour the roads, the first that is there, and the words for it.
const COLUMNS: [(&str, &str); 3] =
    [("speed_gap_rms", "RMS speed gap"), ("error_rms", "RMS tracking error"), ("speed_mean", "mean speed")];
/// Roads up to which those within junctions are drawn, too.
const SMALL: usize = 4000;
/// Conflicts that are drawn; more would hide the roads.
const DRAWN: usize = 500;
/// A vehicle may stand beside the middle of its road by so much \[m\].
const MARGIN_M: f64 = 50.0;
/// A map on which degrees would all fall into a corner \[m\].
const WIDE_M: f64 = 1000.0;

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
    let (happened, incidents) = incident_events(network, run.incidents.as_deref().unwrap_or_default());
    let conflicts = conflict_events(network, run.conflicts.as_deref().unwrap_or_default());
    let dots = match incidents.len() {
        0 => String::new(),
        n => format!(
            " Dots: {} of SUMO's log on {}, in the middle of each.",
            counted(happened, "safety event", "safety events"),
            counted(n, "road", "roads")
        ),
    };
    let rings = match (conflicts.len(), run.conflicts.as_ref().map_or(0, Vec::len)) {
        (0, 0) => String::new(),
        (drawn, all) if drawn < all => format!(
            " Rings: {drawn} of {all} conflicts that SUMO measured, the severest that have a place on this map."
        ),
        (drawn, _) => format!(" Rings: {drawn} conflicts that SUMO measured, where they were at their worst."),
    };
    let (file, of) = name.map_or_else(Default::default, |name| (format!("_{name}"), format!(", {name}")));
    let roads = Roads {
        title: format!("{}{of}", capital(words)),
        unit: "[m/s]",
        ramp: ramp.clone(),
        roads: network.iter().filter(drawn).map(road).collect(),
        events: conflicts.into_iter().chain(incidents).collect(),
    };
    let caption = format!(
        "Roads of the network by the {words} of the vehicles on them, in m/s ({column} of edges.csv); grey: no equipped vehicle was there.{dots}{rings}"
    );
    Some(FigureView::new(&Figure::roads(&format!("map_{column}{file}"), &roads), caption).zoomed())
}

/// How many incidents are on roads of the network, and one event per such road, at its middle: the log names the lane, not
/// the place on it. The most on top.
fn incident_events(network: &[NetworkRoad], incidents: &[Incident]) -> (usize, Vec<Event>) {
    let mut roads: BTreeMap<&str, Vec<&Incident>> = BTreeMap::new();
    for incident in incidents {
        let edge = incident.lane.rsplit_once('_').map_or(incident.lane.as_str(), |(edge, _)| edge);
        roads.entry(edge).or_default().push(incident);
    }
    let shapes: BTreeMap<&str, &NetworkRoad> = network.iter().map(|road| (road.edge.as_str(), road)).collect();
    let mut events: Vec<(usize, Event)> = Vec::new();
    for (edge, incidents) in roads {
        let Some(road) = shapes.get(edge) else { continue };
        let text = match incidents.as_slice() {
            [one] => one.text.clone(),
            many => format!("{edge}: {}", kinds(many)),
        };
        events.push((incidents.len(), Event { class: "event", place: middle(&road.shape), text }));
    }
    events.sort_by_key(|(count, _)| *count);
    (events.iter().map(|(count, _)| count).sum(), events.into_iter().map(|(_, event)| event).collect())
}

/// "2 x collision, 30 x emergency braking"
fn kinds(incidents: &[&Incident]) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    incidents.iter().for_each(|incident| *counts.entry(incident.kind).or_default() += 1);
    counts.iter().map(|(kind, count)| format!("{count} x {kind}")).collect::<Vec<_>>().join(", ")
}

/// Conflicts at their places, the severest on top. Those beside the map are left out; so are all if none of them is anywhere on a
/// wide map but within 180 m and 90 m of its origin: these are degrees (`device.ssm.geo`).
fn conflict_events(network: &[NetworkRoad], conflicts: &[Conflict]) -> Vec<Event> {
    let corners = || network.iter().flat_map(|road| &road.shape);
    let ends = [0, 1].map(|k| {
        let [low, high] = [f64::min, f64::max].map(|choose| corners().map(|corner| corner[k]).reduce(choose));
        low.unwrap_or(0.0) - MARGIN_M..=high.unwrap_or(0.0) + MARGIN_M
    });
    let places = || conflicts.iter().filter_map(|conflict| conflict.place);
    let is_wide = ends.iter().any(|ends| ends.end() - ends.start() > WIDE_M);
    if is_wide && places().all(|[x, y]| x.abs() <= 180.0 && y.abs() <= 90.0) {
        return Vec::new();
    }
    let event = |conflict: &Conflict| {
        let place = conflict.place.filter(|place| ends.iter().zip(place).all(|(ends, x)| ends.contains(x)))?;
        let measure = |name, value: Option<f64>, unit| value.map(|value| format!(", {name} {value:.2} {unit}"));
        let measures = [
            measure("TTC", conflict.ttc_min_s, "s"),
            measure("DRAC", conflict.drac_max_mps2, "m/s²"),
            measure("PET", conflict.pet_s, "s"),
        ];
        let time = conflict.time_s.map(|time| format!(", time {time:.2} s")).unwrap_or_default();
        let measures: String = measures.into_iter().flatten().collect();
        let text = format!("conflict of {} and {}{time}{measures}", conflict.ego, conflict.foe);
        Some(Event { class: "conflict", place, text })
    };
    let mut events: Vec<Event> = conflicts.iter().filter_map(event).take(DRAWN).collect();
    events.reverse();
    events
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_road_has_one_dot_for_its_incidents_and_the_most_are_on_top() {
        let network = ["a", "b"].map(|edge| NetworkRoad { edge: edge.into(), shape: vec![[0.0, 0.0], [10.0, 0.0]] });
        let incident = |lane: &str, kind| Incident { lane: lane.into(), kind, text: format!("{kind} on {lane}") };
        let incidents = [
            incident("a_0", "collision"),
            incident("a_1", "emergency braking"),
            incident("a_0", "collision"),
            incident("b_0", "teleport"),
            incident("elsewhere_0", "teleport"),
        ];
        let (count, events) = incident_events(&network, &incidents);
        let texts: Vec<&str> = events.iter().map(|event| event.text.as_str()).collect();
        assert_eq!(count, 4, "those on the map");
        assert_eq!(texts, ["teleport on b_0", "a: 2 x collision, 1 x emergency braking"]);
        assert_eq!(events[1].place, [5.0, 0.0]);
    }

    #[test]
    fn a_conflict_is_told_with_its_measures() {
        let network = [NetworkRoad { edge: "a".into(), shape: vec![[0.0, 0.0], [10.0, 0.0]] }];
        let conflict = Conflict {
            ego: "x".into(),
            foe: "y".into(),
            place: Some([5.0, 0.0]),
            time_s: Some(12.5),
            ttc_min_s: Some(0.8),
            drac_max_mps2: Some(3.25),
            pet_s: Some(1.5),
        };
        let text = "conflict of x and y, time 12.50 s, TTC 0.80 s, DRAC 3.25 m/s², PET 1.50 s";
        assert_eq!(conflict_events(&network, &[conflict])[0].text, text);
    }

    #[test]
    fn conflicts_that_are_not_on_the_map_are_left_out_and_the_severest_is_on_top() {
        let network = [NetworkRoad { edge: "a".into(), shape: vec![[0.0, 0.0], [1000.0, 500.0]] }];
        let conflict = |ego: &str, place| Conflict { ego: ego.into(), foe: "z".into(), place, ..Conflict::default() };
        let texts = |conflicts: &[Conflict]| -> Vec<String> {
            conflict_events(&network, conflicts).into_iter().map(|event| event.text).collect()
        };
        let metres = [
            conflict("severest", Some([10.0, 500.0])),
            conflict("outside", Some([2000.0, 0.0])),
            conflict("beside", Some([-30.0, 20.0])),
            conflict("nowhere", None),
        ];
        assert_eq!(texts(&metres), ["conflict of beside and z", "conflict of severest and z"]);
        let degrees = [conflict("a", Some([11.42, 48.77])), conflict("b", Some([11.43, 48.76]))];
        assert_eq!(texts(&degrees), [""; 0], "longitudes and latitudes are no metres");
    }
}
