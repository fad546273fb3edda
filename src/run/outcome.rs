//! What a run comes to: SUMO's own outputs joined with the fleet's records.

use super::error::RunError;
use super::rows::{EdgeRow, VehicleRow, edge_rows};
use super::summary::{NO_EGOS, SumoTotals};
use crate::cosim::{Counters, Finished, Records};
use crate::scenario::Scenario;
use crate::sumo_files::{SumoCommand, SumoStatistics, Trips};

/// Rows and totals of a run.
pub struct Outcome {
    /// One row per ego that departed.
    pub rows: Vec<VehicleRow>,
    /// Errors by road.
    pub edges: Vec<EdgeRow>,
    /// Totals of the whole traffic.
    pub totals: SumoTotals,
    /// Counts of vehicles that are no egos, as [`NO_EGOS`].
    pub counts: [u64; NO_EGOS.len()],
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
        // SUMO's own `vehicleTripStatistics` also average over unfinished trips, hence the trips.
        let (arrived, time_loss_mean_s) = trips.arrivals();
        let totals = match statistics {
            Some(SumoStatistics { inserted, collisions, teleports, .. }) => {
                SumoTotals { inserted, arrived, time_loss_mean_s, collisions, teleports }
            }
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
        let rows = records.finished.into_iter().map(|record| row(record, &trips, scenario, time_s)).collect();
        Ok(Self { rows, edges, totals, counts })
    }
}

fn row(record: Finished, trips: &Trips, scenario: &Scenario, end_s: f64) -> VehicleRow {
    let trip = trips.by_id.get(&*record.id);
    let group = &scenario.groups[record.group];
    let depart = trip.map_or(record.depart_s, |t| t.depart_s);
    let arrival = trip.and_then(|t| t.arrival_s).or(record.arrival_s);
    VehicleRow {
        id: record.id.to_string(),
        vehicle_type: record.type_id.into(),
        controller: group.controller.name(),
        target: group.target.name(),
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
