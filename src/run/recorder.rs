//! What is written while the run goes on (trace, sample, rows of vehicles that have left) and at its end (all vehicles,
//! edges).

use super::error::RunError;
use super::noted::Noted;
use super::outcome::Outcome;
use super::result_dir::{ResultDir, SCHEMA};
use super::rows::{EDGES, PlaceColumns, SampleRow, TRACE, TraceRow};
use super::sampler::{SAMPLED, Sampler};
use super::schema::Schema;
use crate::cosim::{Ego, Place, World};
use crate::fleet::Snapshot;
use crate::fleet::block::Block;
use crate::output::{OutputError, Table, write_table};
use crate::scenario::{Scenario, Trace, TraceRows};
use std::collections::HashMap;
use std::sync::Arc;

/// Open files.
pub struct Recorder {
    /// The rows of vehicles that have left.
    pub noted: Noted,
    schema: Schema,
    trace: Option<Table<'static, TraceRow>>,
    sampler: Sampler,
    sample_every: u64,
    step: u64,
}

impl Recorder {
    /// Opens the files.
    pub fn open(scenario: &Scenario, dir: &ResultDir, world: &World) -> Result<Self, RunError> {
        let steps = |period_s: f64| (period_s / world.step_s()).round().max(1.0) as u64;
        let output = &scenario.output;
        let trace = match output.trace {
            Trace::None => None,
            _ => Some(Table::create(&dir.file(&output.trace_file), &TRACE)?),
        };
        let trace_file = trace.is_some().then_some(output.trace_file.as_str());
        let schema = Schema::of_run(&output.vehicles, output.quality, trace_file);
        dir.write(SCHEMA, &schema)?;
        let noted = Noted::create(scenario, dir)?;
        let sampler = Sampler::create(&dir.file("sample.csv"), scenario.sumo.seed, SAMPLED)?;
        Ok(Self { noted, schema, trace, sampler, sample_every: steps(1.0), step: 0 })
    }

    /// Takes down the step that was just made.
    pub async fn step(&mut self, world: &mut World, scenario: &Scenario) -> Result<(), RunError> {
        self.step += 1;
        self.noted.note(world.take_finished(), scenario, world.time_s())?;
        for id in world.take_admitted() {
            self.sampler.depart(&id);
        }
        let samples = self.step.is_multiple_of(self.sample_every);
        let mut places = self.places(world, samples).await?;
        if let Some(table) = &mut self.trace {
            trace(table, world, self.step, &places)?;
        }
        if samples {
            for (ego, block) in world.driving() {
                if self.sampler.follows(ego.id()) {
                    let now = block.snapshot(ego.slot.lane());
                    let place = places.remove(ego.id());
                    let TraceRow { time, id, speed, target, distance, torque, place, .. } =
                        trace_row(ego, &now, world.time_s(), place);
                    self.sampler.write(&SampleRow { time, id, speed, target, distance, torque, place })?;
                }
            }
        }
        Ok(())
    }

    /// The places of the egos that get a row now.
    async fn places(&self, world: &mut World, samples: bool) -> Result<HashMap<Arc<str>, Place>, RunError> {
        let (who, rows) = world.trace().clone();
        let traces = self.trace.is_some() && rows.at_the_end_of(self.step);
        if !traces && !samples {
            return Ok(HashMap::new());
        }
        let wanted = |ego: &Ego| traces && who.names(ego.id()) || samples && self.sampler.follows(ego.id());
        Ok(world.places(wanted).await?)
    }

    /// Completes all tables that can be completed; the first error is the one to tell.
    pub fn finish(self, dir: &ResultDir, outcome: &Outcome) -> Result<(), RunError> {
        let Self { noted, schema, trace, sampler, .. } = self;
        let whole = || noted.finish(|| outcome.joined.rows());
        let (whole, sample) = match whole() {
            Ok(()) => (Ok(()), sampler.finish().map(drop)),
            // Where the disk is full, what the sampler holds of it is better used for these.
            Err(error) => {
                drop(sampler);
                match whole() {
                    Ok(()) => (Ok(()), Err(error)),
                    Err(_) => (Err(error), Ok(())),
                }
            }
        };
        let edges = write_table(&dir.file("edges.csv"), &EDGES, &outcome.edges);
        let trace = trace.map_or(Ok(()), |trace| trace.finish().map(drop));
        // Whoever has deleted the folder has deleted this, too.
        let schema = if dir.file(SCHEMA).is_file() { Ok(()) } else { dir.write(SCHEMA, &schema).map(drop) };
        whole.and(edges.map(drop)).and(trace).and(sample).and(schema)?;
        Ok(())
    }
}

/// The rows of a step, in the order of time.
fn trace(
    table: &mut Table<'_, TraceRow>,
    world: &World,
    step: u64,
    places: &HashMap<Arc<str>, Place>,
) -> Result<(), OutputError> {
    let (who, rows) = world.trace();
    let traced = world.driving().filter(|(ego, _)| who.names(ego.id()));
    match *rows {
        TraceRows::Steps(every) if step.is_multiple_of(every) => {
            for (ego, block) in traced {
                let place = places.get(ego.id()).cloned();
                table.write(&trace_row(ego, &block.snapshot(ego.slot.lane()), world.time_s(), place))?;
            }
        }
        TraceRows::Steps(_) => {}
        TraceRows::Periods(_) => {
            let begin_s = world.time_s() - world.step_s();
            let last = (world.step_s() / world.period_s()).round() as u32;
            let at = |period| ((begin_s + f64::from(period) * world.period_s()) * 1e6).round() / 1e6;
            let of_ego = |(ego, block): (&Ego, &Block)| {
                let place = |period| places.get(ego.id()).filter(|_| period == last).cloned();
                let row = |(period, shown)| (period, trace_row(ego, shown, at(period), place(period)));
                block.snapshots(ego.slot.lane()).map(row).collect::<Vec<_>>()
            };
            let mut rows: Vec<_> = traced.flat_map(of_ego).collect();
            rows.sort_by_key(|(period, _)| *period);
            rows.iter().try_for_each(|(_, row)| table.write(row))?;
        }
    }
    Ok(())
}

/// One line of the trace.
pub(super) fn trace_row(ego: &Ego, shown: &Snapshot, time_s: f64, place: Option<Place>) -> TraceRow {
    TraceRow {
        time: time_s,
        id: ego.id().clone(),
        target: shown.target_mps,
        reference: shown.reference_mps,
        speed: shown.speed_mps,
        measured_speed: shown.measured_mps,
        lateral_speed: shown.lateral_mps,
        yaw_rate: shown.yaw_rate_radps,
        slip_front: shown.slip[0],
        slip_rear: shown.slip[1],
        torque: shown.torque_nm,
        alpha_hat: shown.alpha_ratio,
        f_hat: shown.f_hat_mps2,
        distance: shown.distance_m,
        place: place.map(PlaceColumns::from).unwrap_or_default(),
    }
}
