//! What a run comes to: SUMO's own outputs joined with the fleet's records.

use super::error::RunError;
use super::joined::{Joined, SortedTrips};
use super::noted::Noted;
use super::rows::{EdgeRow, edge_rows};
use super::summary::{COUNTS, SumoTotals};
use super::tally::{Tallied, Tally};
use crate::cosim::{Counters, LONG_S, Records, SLOW_MPS};
use crate::output::OutputError;
use crate::registry::nearest;
use crate::scenario::{Scenario, Selector, Trace};
use crate::sumo_files::{SumoCommand, SumoFileError, SumoStatistics, left_out};
use std::path::Path;

/// Rows and totals of a run.
pub struct Outcome {
    /// The rows, in order.
    pub joined: Joined,
    /// What they come to.
    pub tallied: Tallied,
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

/// A run that has ended, to be summed up.
pub struct Ended<'r> {
    /// What was run.
    pub scenario: &'r Scenario,
    /// When it ended \[s\].
    pub time_s: f64,
    /// The SUMO that was started for it, if it has ended.
    pub own_sumo: Option<&'r SumoCommand>,
    /// Whether the run broke off.
    pub broke_off: bool,
    /// Where what does not fit into memory may go.
    pub folder: &'r Path,
}

impl Outcome {
    /// Joins the rows with what the SUMO that we started has written. Of one that we joined, and of one that died,
    /// only what the replies told is known. Rows do not depend on SUMO's files: those that cannot be read leave the columns
    /// empty that come from them.
    ///
    /// # Errors
    /// [`OutputError::File`] if the disk is full, or a journal cannot be read.
    pub fn new(ended: &Ended<'_>, noted: &Noted, records: Records) -> Result<Self, OutputError> {
        let Ended { scenario, time_s, own_sumo, broke_off, folder } = *ended;
        let counters = &records.counters;
        let mut notes = notes(counters, noted.count);
        let mut told = |error: SumoFileError, instead: &str| {
            if !broke_off {
                notes.push(format!("{error}: {instead}"));
            }
        };
        let statistics = own_sumo.and_then(|own| {
            let totals = "inserted, collisions and teleports are those told over TraCI";
            SumoStatistics::read(&own.statistics).map_err(|error| told(error, totals)).ok()
        });
        let trips = match own_sumo {
            Some(own) => {
                SortedTrips::read(&own.tripinfo, folder)?.map_err(|error| told(error, "time losses are missing")).ok()
            }
            None => None,
        };
        let cut = trips.as_ref().is_some_and(|trips| !trips.whole) && !broke_off;
        let broken = own_sumo.filter(|_| cut).map(|own| format!("{}: the file breaks off", own.tripinfo.display()));
        // A log that the user sent elsewhere need not be a file.
        if let Some((count, first)) = own_sumo.and_then(|own| left_out(&own.log).ok().flatten()) {
            notes.push(format!("SUMO's log has {count} warnings about vehicles that it left out; the first: {first}"));
        }
        let asked = counters.departed > 0 && scenario.egos != Selector::Share(0.0);
        let nobody = (asked && noted.count == 0).then(|| RunError::NoEgos(no_egos(scenario, counters)));
        let (has_trips, trips) = (trips.is_some(), trips.unwrap_or_else(|| SortedTrips::none(folder)));
        // `device.tripinfo.probability` leaves vehicles out.
        let (found, entered) = (trips.count, counters.present + counters.departed);
        let joined = Joined::new(noted, trips, (scenario, time_s), folder)?;
        let (mut arrived, time_loss_mean_s) = joined.arrivals;
        if found < entered {
            arrived = counters.arrived;
            if has_trips && !broke_off {
                notes.push(format!(
                    "SUMO's tripinfo holds {found} of {entered} vehicles: time losses are those of these"
                ));
            }
        }
        let totals = totals(statistics, counters, arrived, time_loss_mean_s);
        let others: u64 = counters.others.values().sum();
        let counts = [counters.unequipped, others, counters.refused.count, counters.crept];
        notes.extend(idle(scenario, noted));
        notes.extend(untraced(noted, scenario, time_s)?);
        let mut tally = Tally::new(folder);
        joined.rows().try_for_each(|row| tally.add(&row?))?;
        let (tallied, edges) = (tally.finish()?, edge_rows(&records.roads));
        Ok(Self { joined, tallied, edges, totals, counts, notes, failed: broken.map(RunError::Outputs).or(nobody) })
    }
}

/// The totals of the whole traffic.
fn totals(
    statistics: Option<SumoStatistics>,
    counters: &Counters,
    arrived: u64,
    time_loss_mean_s: Option<f64>,
) -> SumoTotals {
    match statistics {
        Some(SumoStatistics { inserted, collisions, teleports, .. }) => {
            // A state that was loaded brings the counts of its own past along.
            let inserted = if counters.present > 0 { counters.present + counters.departed } else { inserted };
            SumoTotals { inserted, arrived, time_loss_mean_s, collisions, teleports }
        }
        None => SumoTotals {
            inserted: counters.departed,
            arrived,
            time_loss_mean_s,
            collisions: counters.collision_pairs as u64,
            teleports: counters.teleports,
        },
    }
}

/// Why there are no egos.
fn no_egos(scenario: &Scenario, counters: &Counters) -> String {
    let others: u64 = counters.others.values().sum();
    format!(
        "{} vehicles departed; egos.select = \"{}\" and the groups leave {} of them to SUMO, {others} have no four wheels, {} cannot be egos",
        counters.departed, scenario.egos, counters.unequipped, counters.refused.count
    )
}

/// Groups that came to nothing, unless it was told at the start.
fn idle(scenario: &Scenario, noted: &Noted) -> Vec<String> {
    // The last group takes what the others leave.
    let own = scenario.groups.iter().enumerate().take(scenario.groups.len() - 1);
    let idle = own.filter(|(index, _)| !noted.groups.contains(index));
    let idle = idle.map(|(index, group)| (format!("group.{index}.select"), group.select.to_string()));
    let idle = idle.filter(|(key, _)| !scenario.notes.iter().any(|note| note.starts_with(key.as_str())));
    idle.map(|(key, select)| format!("{key} = \"{select}\" matched no vehicle")).collect()
}

/// Ids of the trace that came to nothing.
fn untraced(noted: &Noted, scenario: &Scenario, time_s: f64) -> Result<Vec<String>, OutputError> {
    let Trace::Ids(ids) = &scenario.output.trace else { return Ok(Vec::new()) };
    let mut near: Vec<(&String, Option<String>)> =
        ids.iter().filter(|id| noted.untraced.contains(*id)).map(|id| (id, None)).collect();
    if near.is_empty() {
        return Ok(Vec::new());
    }
    noted.each(scenario, time_s, |[vehicle, _]| {
        for (id, near) in &mut near {
            let known = near.take();
            *near = nearest(id, known.as_deref().into_iter().chain([vehicle[0].as_str()])).map(str::to_owned);
        }
        Ok(())
    })?;
    let note = |(id, near): (&String, Option<String>)| {
        let near = near.map(|near| format!("; did you mean {near}?")).unwrap_or_default();
        format!("output.trace: {id} matched no vehicle{near}")
    };
    Ok(near.into_iter().map(note).collect())
}

/// What the user should be told about the traffic.
fn notes(counters: &Counters, egos: u64) -> Vec<String> {
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
    if let Some(first) = &counters.refused.first {
        notes.push(format!("{} vehicles cannot be egos; the first, {first}", counters.refused.count));
    }
    notes.extend(counters.implausible.notes());
    if let Some(first) = &counters.odd_masses.first {
        notes.push(format!(
            "{} egos have less than half or more than twice the mass of their kind; the first, {first} (vehicle.mass_factor is relative)",
            counters.odd_masses.count
        ));
    }
    notes
}
