//! The vehicles of a run, to be paired with those of another: same seed, same demand, same id.

use super::metrics::{METRIC_COUNT, METRICS, TIME_LOSS};
use crate::output::{OutputError, file_error};
use crate::sumo_files::Trips;
use std::collections::BTreeMap;
use std::path::Path;

/// A vehicle.
#[derive(Debug, Clone, Default, PartialEq)]
struct Vehicle {
    arrived: bool,
    /// As [`METRICS`].
    values: [Option<f64>; METRIC_COUNT],
}

/// Vehicles by id; an id that is used again is another vehicle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Vehicles(BTreeMap<(String, usize), Vehicle>);

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

impl Vehicles {
    /// Reads what SUMO tells of all vehicles, and our table of the egos.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the table.
    pub fn read(table: &Path, trips: &Trips) -> Result<Self, OutputError> {
        let mut all = Self::default();
        for (id, trips) in &trips.by_id {
            for (again, trip) in trips.iter().enumerate() {
                let vehicle = all.0.entry((id.clone(), again)).or_default();
                vehicle.arrived = trip.arrival_s.is_some();
                for (value, _) in vehicle.values.iter_mut().zip(&METRICS).filter(|(_, m)| m.column == Some(TIME_LOSS)) {
                    *value = Some(trip.time_loss_s);
                }
            }
        }
        all.add_egos(table).map_err(|error| file_error("read", table)(error.into()))?;
        Ok(all)
    }

    fn add_egos(&mut self, table: &Path) -> Result<(), csv::Error> {
        let mut reader = csv::Reader::from_path(table)?;
        let headers = reader.headers()?.clone();
        let place = |name: &str| headers.iter().position(|header| header == name);
        let (id, complete) = (place("id").unwrap_or(0), place("complete"));
        let columns = METRICS.each_ref().map(|m| m.column.and_then(place));
        let (mut seen, mut row) = (BTreeMap::<String, usize>::new(), csv::StringRecord::new());
        while reader.read_record(&mut row)? {
            let field = |place: Option<usize>| row.get(place?);
            let id = row.get(id).unwrap_or_default().to_owned();
            let again = seen.entry(id.clone()).and_modify(|n| *n += 1).or_insert(0);
            let vehicle = self.0.entry((id, *again)).or_default();
            vehicle.arrived |= field(complete) == Some("true");
            for (value, column) in vehicle.values.iter_mut().zip(columns) {
                *value = field(column).and_then(|text| text.parse().ok()).or(*value);
            }
        }
        Ok(())
    }

    /// Mean time loss of all that have one \[s\]: for egos that of our table, which is right also where bodies lead.
    pub fn time_loss_mean_s(&self) -> Option<f64> {
        let place = METRICS.iter().position(|metric| metric.column == Some(TIME_LOSS))?;
        let losses: Vec<f64> = self.0.values().filter_map(|vehicle| vehicle.values[place]).collect();
        (!losses.is_empty()).then(|| losses.iter().sum::<f64>() / losses.len() as f64)
    }

    /// Compares the vehicles that arrived in both runs, metric by metric.
    pub fn pairs(&self, reference: &Self) -> [Pairs; METRIC_COUNT] {
        let mut pairs = [Pairs::default(); METRIC_COUNT];
        let own = self.0.iter().filter(|(_, vehicle)| vehicle.arrived);
        let both = own.filter_map(|(id, v)| Some((v, reference.0.get(id).filter(|other| other.arrived)?)));
        for (own, other) in both {
            for ((pairs, own), other) in pairs.iter_mut().zip(own.values).zip(other.values) {
                let (Some(own), Some(other)) = (own, other) else { continue };
                pairs.count += 1;
                pairs.better += u64::from(own < other);
                pairs.difference += own - other;
            }
        }
        pairs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        Vehicles::read(&path("vehicles.csv"), &Trips::read(&path("trips.xml")).unwrap()).unwrap()
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
        let pairs = own.pairs(&reference);
        let error = pairs[place("error_rms_mean")];
        assert_eq!((error.count, error.better), (2, 1));
        assert!((error.difference - (0.25 - 0.3)).abs() < 1e-12);
        assert_eq!(pairs[place("timeloss_mean")], Pairs { count: 2, better: 1, difference: -3.0 });
        assert_eq!(pairs[place("arrived")], Pairs::default());
        assert_eq!(own.pairs(&own)[place("timeloss_mean")], Pairs { count: 3, better: 0, difference: 0.0 });
    }

    #[test]
    fn an_ego_has_the_time_loss_of_our_table() {
        let own = read("id,timeloss,complete\na,5,true\n", &[("a", 900.0, true), ("b", 1.0, true)]);
        assert_eq!(own.time_loss_mean_s(), Some(3.0));
        let reference = read("id,timeloss,complete\na,7,true\n", &[("a", 1.0, true), ("b", 1.0, true)]);
        assert_eq!(own.pairs(&reference)[place("timeloss_mean")], Pairs { count: 2, better: 1, difference: -2.0 });
        assert_eq!(read("id,complete\n", &[]).time_loss_mean_s(), None);
    }

    #[test]
    fn an_id_that_is_used_again_is_another_vehicle() {
        let table = "id,error_rms,complete\na,1,true\na,2,true\n";
        let own = read(table, &[("a", 3.0, true), ("a", 4.0, true)]);
        assert_eq!(own.0[&("a".to_owned(), 1)].values[place("error_rms_mean")], Some(2.0));
        assert_eq!(own.pairs(&own)[place("timeloss_mean")].count, 2);
    }
}
