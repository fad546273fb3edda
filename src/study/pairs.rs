//! Vehicles paired with those of another run: same seed, same demand, same id.

use super::metrics::{METRIC_COUNT, METRICS};
use super::vehicle::{VEHICLE, Vehicle};
use super::vehicles::{TIME_LOSS, Vehicles, time_loss_s};
use std::sync::LazyLock;

/// The place in [`VEHICLE`] of the column that each metric averages.
static PLACES: LazyLock<[Option<usize>; METRIC_COUNT]> =
    LazyLock::new(|| METRICS.each_ref().map(|metric| metric.column.and_then(|column| VEHICLE.place(column))));

/// How the vehicles that arrived in both of two runs compare in a metric.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Pairs {
    /// How many.
    pub count: u64,
    /// How many have less of it.
    pub better: u64,
    /// The sum of their differences.
    pub difference: f64,
}

/// Compares the vehicles that arrived in both of two runs, metric by metric.
pub fn pairs(own: &Vehicles, reference: &Vehicles) -> [Pairs; METRIC_COUNT] {
    let mut pairs = [Pairs::default(); METRIC_COUNT];
    let own = own.iter().filter(|(_, vehicle)| vehicle.arrived);
    let both = own.filter_map(|(id, v)| Some((v, reference.get(id).filter(|other| other.arrived)?)));
    for (own, other) in both {
        for (pairs, (own, other)) in pairs.iter_mut().zip(values(own).zip(values(other))) {
            let (Some(own), Some(other)) = (own, other) else { continue };
            pairs.count += 1;
            pairs.better += u64::from(own < other);
            pairs.difference += own - other;
        }
    }
    pairs
}

/// What the metrics average, as [`METRICS`].
fn values(vehicle: &Vehicle) -> impl Iterator<Item = Option<f64>> {
    PLACES.iter().zip(&METRICS).map(move |(place, metric)| match metric.column {
        Some(TIME_LOSS) => time_loss_s(vehicle),
        _ => place.and_then(|place| VEHICLE.cell(vehicle, place).number()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sumo_files::Trips;

    fn read(table: &str, trips: &[(&str, f64, bool)]) -> Vehicles {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("vehicles.csv"), table).unwrap();
        let trips = trips.iter().map(|(id, loss, arrived)| {
            let arrival = if *arrived { 9 } else { -1 };
            format!(
                r#"<tripinfo id="{id}" depart="0" arrival="{arrival}" duration="9" timeLoss="{loss}" routeLength="1"/>"#
            )
        });
        let text = format!("<tripinfos>{}</tripinfos>", trips.collect::<String>());
        std::fs::write(path("trips.xml"), text).unwrap();
        let mut all = Vehicles::of_trips(&Trips::read(&path("trips.xml")).unwrap());
        all.take_table(&path("vehicles.csv")).unwrap();
        all
    }

    fn place(name: &str) -> usize {
        METRICS.iter().position(|metric| metric.name == name).unwrap()
    }

    #[test]
    fn only_vehicles_that_arrived_in_both_runs_are_paired() {
        let ours = "id,error_rms,complete\na,0.5,true\nb,0.1,true\nc,0.2,false\n";
        let own = read(ours, &[("a", 3.0, true), ("b", 2.0, true), ("c", 0.0, false), ("d", 1.0, true)]);
        let theirs = "id,error_rms,complete\na,0.25,true\nb,0.4,true\nc,0.9,true\n";
        let reference = read(theirs, &[("a", 3.0, true), ("b", 5.0, true), ("c", 8.0, true), ("d", 0.0, false)]);
        let found = pairs(&own, &reference);
        let error = found[place("error_rms_mean")];
        assert_eq!((error.count, error.better), (2, 1));
        assert!((error.difference - (0.25 - 0.3)).abs() < 1e-12);
        assert_eq!(found[place("timeloss_mean")], Pairs { count: 2, better: 1, difference: -3.0 });
        assert_eq!(found[place("arrived")], Pairs::default());
        assert_eq!(pairs(&own, &own)[place("timeloss_mean")], Pairs { count: 3, better: 0, difference: 0.0 });
    }

    #[test]
    fn an_ego_has_the_time_loss_of_our_table() {
        let own = read("id,timeloss,complete\na,5,true\n", &[("a", 900.0, true), ("b", 1.0, true)]);
        assert_eq!(own.time_loss_mean_s(), Some(3.0));
        let reference = read("id,timeloss,complete\na,7,true\n", &[("a", 1.0, true), ("b", 1.0, true)]);
        assert_eq!(pairs(&own, &reference)[place("timeloss_mean")], Pairs { count: 2, better: 1, difference: -2.0 });
        assert_eq!(read("id,complete\n", &[]).time_loss_mean_s(), None);
    }

    #[test]
    fn an_id_that_is_used_again_is_another_vehicle() {
        let table = "id,error_rms,complete\na,1,true\na,2,true\n";
        let own = read(table, &[("a", 3.0, true), ("a", 4.0, true)]);
        let second = own.get(&("a".to_owned(), 1)).unwrap();
        assert_eq!(values(second).nth(place("error_rms_mean")), Some(Some(2.0)));
        assert_eq!(pairs(&own, &own)[place("timeloss_mean")].count, 2);
    }
}
