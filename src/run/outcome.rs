//! What a run comes to: SUMO's own outputs joined with the fleet's records.

use super::error::RunError;
use super::rows::{EdgeRow, VehicleRow, edge_rows};
use super::summary::{NO_EGOS, Summary, SumoTotals};
use crate::cosim::{Counters, Finished, Records};
use crate::scenario::Scenario;
use crate::sumo_files::{SumoCommand, SumoStatistics, TripInfo, Trips};
use std::sync::Arc;

/// Rows and totals of a run.
pub struct Outcome {
    /// One row per ego that departed.
    pub rows: Vec<VehicleRow>,
    /// Errors by road.
    pub edges: Vec<EdgeRow>,
    totals: SumoTotals,
    /// As [`NO_EGOS`].
    counts: [u64; NO_EGOS.len()],
}

impl Outcome {
    /// Joins the records with what the SUMO that we started has written. Of one that we joined, and of one that died,
    /// only what the replies told is known.
    pub fn new(
        scenario: &Scenario,
        records: Records,
        time_s: f64,
        own_sumo: Option<&SumoCommand>,
        broken: bool,
    ) -> Result<Self, RunError> {
        let read = own_sumo.map(|command| {
            Ok::<_, RunError>((SumoStatistics::read(&command.statistics)?, Trips::read(&command.tripinfo)?))
        });
        let (statistics, trips) = match read {
            Some(Ok((statistics, trips))) => (Some(statistics), trips),
            Some(Err(error)) if !broken => return Err(error),
            _ => (None, Trips::default()),
        };
        let counters = &records.counters;
        let totals = match statistics {
            Some(statistics) => totals(&statistics, &trips),
            None => SumoTotals {
                inserted: counters.departed,
                arrived: counters.arrived,
                time_loss_mean_s: None,
                collisions: counters.collision_pairs as u64,
                teleports: counters.teleports,
            },
        };
        let edges = edge_rows(&records.roads);
        let counts = [counters.unequipped, counters.others.values().sum(), counters.refused.len() as u64];
        let names = Names::new(scenario);
        let rows = records
            .finished
            .into_iter()
            .map(|record| {
                let trip = trips.by_id.get(&*record.id);
                row(record, trip, &names, time_s)
            })
            .collect();
        Ok(Self { rows, edges, totals, counts })
    }

    /// The summary of a run of `simulated_s` seconds that took `wall_s` seconds.
    pub fn summary(&self, simulated_s: f64, wall_s: f64) -> Summary {
        let mut summary = Summary::new(&self.rows, self.totals, simulated_s, wall_s);
        summary.counts.extend(NO_EGOS.iter().zip(self.counts).map(|((name, _), count)| ((*name).to_owned(), count)));
        summary
    }
}

/// From SUMO's outputs. Their `vehicleTripStatistics` also average over unfinished trips, hence the trips.
fn totals(statistics: &SumoStatistics, trips: &Trips) -> SumoTotals {
    let (arrived, time_loss_mean_s) = trips.arrivals();
    SumoTotals {
        inserted: statistics.inserted,
        arrived,
        time_loss_mean_s,
        collisions: statistics.collisions,
        teleports: statistics.teleports,
    }
}

/// Names of controller and target by group, shared by all rows.
struct Names(Vec<[Arc<str>; 2]>);

impl Names {
    fn new(scenario: &Scenario) -> Self {
        Self(scenario.groups.iter().map(|g| [Arc::from(g.controller.name()), Arc::from(g.target.name())]).collect())
    }
}

fn row(record: Finished, trip: Option<&TripInfo>, names: &Names, end_s: f64) -> VehicleRow {
    let depart = trip.map_or(record.depart_s, |t| t.depart_s);
    let arrival = trip.and_then(|t| t.arrival_s).or(record.arrival_s);
    let [controller, target] = names.0[record.group].clone();
    VehicleRow {
        id: record.id.to_string(),
        vehicle_type: record.type_id.into(),
        controller,
        target,
        depart,
        arrival,
        duration: Some(arrival.unwrap_or(end_s) - depart),
        timeloss: trip.map(|t| t.time_loss_s),
        distance: Some(record.distance_m),
        stats: record.stats,
        odometer_gap: record.odometer_gap_m,
        collisions: u64::from(record.collisions),
        reason: record.reason,
    }
}

/// What the user should be told about the traffic.
pub fn notes(counters: &Counters) -> Vec<String> {
    let mut notes = Vec::new();
    if !counters.others.is_empty() {
        let list: Vec<String> = counters.others.iter().map(|(class, count)| format!("{count} {class}")).collect();
        notes.push(format!("left to SUMO, for want of four wheels: {}", list.join(", ")));
    }
    if let Some((id, reason)) = counters.refused.first() {
        notes.push(format!("{} vehicles cannot be egos; the first, \"{id}\": {reason}", counters.refused.len()));
    }
    notes
}
