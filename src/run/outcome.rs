//! What a run comes to: SUMO's own outputs joined with the fleet's records.

use super::error::RunError;
use super::rows::{EdgeRow, QualityRow, VehicleRow, edge_rows};
use super::summary::{COUNTS, SumoTotals};
use crate::cosim::{Counters, Finished, LONG_S, Reason, Records, SLOW_MPS};
use crate::registry::nearest;
use crate::scenario::{Scenario, Selector, Trace};
use crate::sumo_files::{SumoCommand, SumoFileError, SumoStatistics, Trips, left_out};
use std::collections::{BTreeSet, HashMap};

/// Rows and totals of a run.
pub struct Outcome {
    /// One row per ego that departed.
    pub rows: Vec<VehicleRow>,
    /// Its drive quality, row by row.
    pub quality: Vec<QualityRow>,
    /// Errors by road.
    pub edges: Vec<EdgeRow>,
    /// Totals of the whole traffic.
    pub totals: SumoTotals,
    /// Further counts, as [`COUNTS`].
    pub counts: [u64; COUNTS.len()],
    /// What the user should be told.
    pub notes: Vec<String>,
    /// Why the result is not whole though the run came to its end: SUMO's outputs break off, or there are no egos.
    pub failed: Option<RunError>,
}

impl Outcome {
    /// Joins the records with what the SUMO that we started has written. Of one that we joined, and of one that died,
    /// only what the replies told is known. Rows do not depend on SUMO's files: those that cannot be read leave the columns
    /// empty that come from them.
    pub fn new(scenario: &Scenario, records: Records, time_s: f64, own_sumo: Option<&SumoCommand>, died: bool) -> Self {
        let mut notes = notes(&records.counters, records.finished.len());
        let mut told = |error: SumoFileError, instead: &str| {
            if !died {
                notes.push(format!("{error}: {instead}"));
            }
        };
        let statistics = own_sumo.and_then(|own| {
            let totals = "inserted, collisions and teleports are those told over TraCI";
            SumoStatistics::read(&own.statistics).map_err(|error| told(error, totals)).ok()
        });
        let trips = own_sumo
            .and_then(|own| Trips::read(&own.tripinfo).map_err(|error| told(error, "time losses are missing")).ok());
        let cut = trips.as_ref().is_some_and(|trips| !trips.whole) && !died;
        let broken = own_sumo.filter(|_| cut).map(|own| format!("{}: the file breaks off", own.tripinfo.display()));
        // A log that the user sent elsewhere need not be a file.
        if let Some((count, first)) = own_sumo.and_then(|own| left_out(&own.log).ok().flatten()) {
            notes.push(format!("SUMO's log has {count} warnings about vehicles that it left out; the first: {first}"));
        }
        let asked = records.counters.departed > 0 && scenario.egos != Selector::Share(0.0);
        let nobody =
            (asked && records.finished.is_empty()).then(|| RunError::NoEgos(no_egos(scenario, &records.counters)));
        let (has_trips, mut trips) = (trips.is_some(), trips.unwrap_or_default());
        take_own_time_losses(&records.finished, &mut trips);
        let counters = &records.counters;
        let (mut arrived, time_loss_mean_s) = trips.arrivals();
        // `device.tripinfo.probability` leaves vehicles out.
        let (found, entered) = (trips.all().count() as u64, counters.present + counters.departed);
        if found < entered {
            arrived = counters.arrived;
            if has_trips && !died {
                notes.push(format!(
                    "SUMO's tripinfo holds {found} of {entered} vehicles: time losses are those of these"
                ));
            }
        }
        let totals = match statistics {
            Some(SumoStatistics { inserted, collisions, teleports, .. }) => {
                // A state that was loaded brings the counts of its own past along.
                let inserted = if counters.present > 0 { entered } else { inserted };
                SumoTotals { inserted, arrived, time_loss_mean_s, collisions, teleports }
            }
            None => SumoTotals {
                inserted: counters.departed,
                arrived,
                time_loss_mean_s,
                collisions: counters.collision_pairs as u64,
                teleports: counters.teleports,
            },
        };
        let edges = edge_rows(&records.roads);
        let refused = counters.refused.len() as u64;
        let counts = [counters.unequipped, counters.others.values().sum(), refused, counters.crept];
        let driven: BTreeSet<usize> = records.finished.iter().map(|record| record.group).collect();
        let rows: Vec<_> = records.finished.iter().map(|record| row(record, &mut trips, scenario, time_s)).collect();
        let quality = records.finished.iter().zip(&rows).map(|(record, row)| quality_row(record, row)).collect();
        notes.extend(unmatched(scenario, &driven, &rows));
        Self { rows, quality, edges, totals, counts, notes, failed: broken.map(RunError::Outputs).or(nobody) }
    }
}

/// Of a vehicle whose body led, SUMO has the time loss against the speed factor that it was given meanwhile.
fn take_own_time_losses(finished: &[Finished], trips: &mut Trips) {
    let mut earlier: HashMap<&str, usize> = HashMap::new();
    for record in finished {
        let nth = earlier.entry(&record.id).or_default();
        let trip = trips.by_id.get_mut(&*record.id).and_then(|trips| trips.get_mut(*nth));
        if let (Some(time_loss_s), Some(trip)) = (record.time_loss_s, trip) {
            trip.time_loss_s = time_loss_s;
        }
        *nth += 1;
    }
}

/// The drive quality of an ego, beside its row.
pub(super) fn quality_row(record: &Finished, row: &VehicleRow) -> QualityRow {
    let (id, depart) = (row.id.clone(), row.depart);
    QualityRow { id, depart, quality: record.quality, string_gain: record.string_gain }
}

/// The row of an ego as far as it is known while SUMO runs.
pub(super) fn first_row(record: &Finished, scenario: &Scenario, time_s: f64) -> VehicleRow {
    row(record, &mut Trips::default(), scenario, time_s)
}

/// The row of an ego. An id that was used twice takes its trips one after the other.
fn row(record: &Finished, trips: &mut Trips, scenario: &Scenario, end_s: f64) -> VehicleRow {
    let trip = trips.by_id.get_mut(&*record.id).and_then(|trips| trips.pop_front());
    let group = &scenario.groups[record.group];
    let depart = milliseconds(trip.as_ref().map_or(record.depart_s, |t| t.depart_s));
    let reason = match (record.reason, trip.as_ref().and_then(|t| t.taken_out.as_deref())) {
        // TraCI calls all of them arrived, or (SUMO 1.15) nothing at all.
        (Reason::Arrived | Reason::Removed, Some("collision")) => Reason::Collided,
        (Reason::Arrived | Reason::Removed, Some("teleport")) => Reason::TeleportedOut,
        (Reason::Arrived, Some(_)) => Reason::Removed,
        (reason, _) => reason,
    };
    let ended = trip.as_ref().and_then(|t| t.arrival_s).or(record.arrival_s);
    let arrival = ended.filter(|_| reason != Reason::Removed && reason != Reason::Collided).map(milliseconds);
    VehicleRow {
        id: record.id.to_string(),
        vehicle_type: record.type_id.as_str().into(),
        controller: group.controller.name(),
        target: group.target.name(),
        depart,
        arrival,
        duration: Some(milliseconds(ended.unwrap_or(end_s) - depart)),
        timeloss: trip.map(|t| t.time_loss_s).or(record.time_loss_s),
        distance: Some(record.distance_m),
        stats: record.stats,
        odometer_gap: record.odometer_gap_m,
        collisions: u64::from(record.collisions),
        reason,
    }
}

/// SUMO's times are whole milliseconds; sums of steps are that but for rounding.
fn milliseconds(time_s: f64) -> f64 {
    (time_s * 1000.0).round() / 1000.0
}

/// Why there are no egos.
fn no_egos(scenario: &Scenario, counters: &Counters) -> String {
    let others: u64 = counters.others.values().sum();
    format!(
        "{} vehicles departed; egos.select = \"{}\" and the groups leave {} of them to SUMO, {others} have no four wheels, {} cannot be egos",
        counters.departed,
        scenario.egos,
        counters.unequipped,
        counters.refused.len()
    )
}

/// Groups and ids of the trace that came to nothing, unless it was told at the start.
fn unmatched(scenario: &Scenario, driven: &BTreeSet<usize>, rows: &[VehicleRow]) -> Vec<String> {
    // The last group takes what the others leave.
    let own = scenario.groups.iter().enumerate().take(scenario.groups.len() - 1);
    let idle = own.filter(|(index, _)| !driven.contains(index));
    let idle = idle.map(|(index, group)| (format!("group.{index}.select"), group.select.to_string()));
    let idle = idle.filter(|(key, _)| !scenario.notes.iter().any(|note| note.starts_with(key.as_str())));
    let mut notes: Vec<_> = idle.map(|(key, select)| format!("{key} = \"{select}\" matched no vehicle")).collect();
    if let Trace::Ids(ids) = &scenario.output.trace {
        for id in ids.iter().filter(|id| rows.iter().all(|row| row.id != **id)) {
            let near = nearest(id, rows.iter().map(|row| row.id.as_str()));
            let near = near.map(|near| format!("; did you mean {near}?")).unwrap_or_default();
            notes.push(format!("output.trace: {id} matched no vehicle{near}"));
        }
    }
    notes
}

/// What the user should be told about the traffic.
fn notes(counters: &Counters, egos: usize) -> Vec<String> {
    let mut notes = Vec::new();
    if !counters.others.is_empty() {
        let list: Vec<String> = counters.others.iter().map(|(class, count)| format!("{count} {class}")).collect();
        notes.push(format!("left to SUMO, for want of four wheels: {}", list.join(", ")));
    }
    if counters.crept > 0 {
        notes.push(format!(
            "{} of {egos} equipped vehicles crept: they moved for more than {LONG_S} s without exceeding {SLOW_MPS} m/s",
            counters.crept
        ));
    }
    if let Some((id, [asked, given])) = counters.beyond_body.first_key_value() {
        notes.push(format!(
            "{} vTypes allow more than their bodies can do; the first, \"{id}\": accel {:.1} and emergencyDecel {:.1} m/s², \
             the body {:.1} and {:.1} m/s²",
            counters.beyond_body.len(),
            asked[0],
            asked[1],
            given[0],
            given[1]
        ));
    }
    if let Some((id, reason)) = counters.refused.first() {
        notes.push(format!("{} vehicles cannot be egos; the first, \"{id}\": {reason}", counters.refused.len()));
    }
    notes.extend(counters.implausible.notes());
    if let Some(first) = counters.odd_masses.first() {
        notes.push(format!(
            "{} egos have less than half or more than twice the mass of their kind; the first, {first} (vehicle.mass_factor is relative)",
            counters.odd_masses.len()
        ));
    }
    notes
}
