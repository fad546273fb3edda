//! What is written while the run goes on (trace, sample) and at its end (vehicles, edges).

use super::error::RunError;
use super::outcome::Outcome;
use super::result_dir::{ResultDir, SCHEMA};
use super::rows::{EDGES, SampleRow, TRACE, TraceRow, VEHICLES, sort_vehicles};
use super::sampler::{SAMPLED, Sampler};
use super::schema::Schema;
use crate::cosim::{Ego, World};
use crate::fleet::block::Block;
use crate::output::{Table, write_table};
use crate::scenario::{Scenario, Trace};

/// Open files.
pub struct Recorder {
    trace: Option<(Table<'static, TraceRow>, Trace, u64)>,
    sampler: Sampler,
    sample_every: u64,
    step: u64,
}

impl Recorder {
    /// Opens the files.
    pub fn open(scenario: &Scenario, dir: &ResultDir, world: &World) -> Result<Self, RunError> {
        let steps = |period_s: f64| (period_s / world.step_s()).round().max(1.0) as u64;
        let output = &scenario.output;
        let trace = if output.trace == Trace::None {
            None
        } else {
            let table = Table::create(&dir.file(&output.trace_file), &TRACE)?;
            Some((table, output.trace.clone(), output.trace_period_s.map_or(1, steps)))
        };
        let trace_file = trace.is_some().then_some(output.trace_file.as_str());
        dir.write(SCHEMA, &Schema::of_run(&output.vehicles, trace_file))?;
        let sampler = Sampler::create(&dir.file("sample.csv"), scenario.sumo.seed, SAMPLED)?;
        Ok(Self { trace, sampler, sample_every: steps(1.0), step: 0 })
    }

    /// Takes down the step that was just made.
    pub fn step(&mut self, world: &mut World) -> Result<(), RunError> {
        self.step += 1;
        for id in world.take_admitted() {
            self.sampler.depart(&id);
        }
        if let Some((table, wanted, every)) = &mut self.trace
            && self.step.is_multiple_of(*every)
        {
            for (ego, block) in world.driving().filter(|(ego, _)| is_traced(wanted, ego.id())) {
                table.write(&trace_row(ego, block, world.time_s()))?;
            }
        }
        if self.step.is_multiple_of(self.sample_every) {
            for (ego, block) in world.driving() {
                if self.sampler.follows(ego.id()) {
                    let TraceRow { time, id, speed, target, distance, torque, .. } =
                        trace_row(ego, block, world.time_s());
                    self.sampler.write(&SampleRow { time, id, speed, target, distance, torque })?;
                }
            }
        }
        Ok(())
    }

    /// Completes all tables that can be completed; the first error is the one to tell.
    pub fn finish(self, dir: &ResultDir, scenario: &Scenario, outcome: &mut Outcome) -> Result<(), RunError> {
        sort_vehicles(&mut outcome.rows);
        let vehicles = write_table(&dir.file(&scenario.output.vehicles), &VEHICLES, &outcome.rows);
        let edges = write_table(&dir.file("edges.csv"), &EDGES, &outcome.edges);
        let trace = self.trace.map_or(Ok(()), |(trace, ..)| trace.finish().map(drop));
        let sample = self.sampler.finish().map(drop);
        vehicles.map(drop).and(edges.map(drop)).and(trace).and(sample)?;
        Ok(())
    }
}

fn is_traced(wanted: &Trace, id: &str) -> bool {
    match wanted {
        Trace::None => false,
        Trace::All => true,
        Trace::Ids(ids) => ids.iter().any(|i| i == id),
    }
}

/// A profile knows no target but its reference.
fn target_mps(block: &Block, lane: usize) -> f64 {
    let target_mps = block.target_mps(lane);
    if target_mps.is_finite() { target_mps } else { block.reference_mps(lane) }
}

/// One line of the trace.
pub(super) fn trace_row(ego: &Ego, block: &Block, time_s: f64) -> TraceRow {
    let lane = ego.slot.lane();
    let state = block.plant().state(lane);
    let [slip_front, slip_rear] = block.slip(lane);
    TraceRow {
        time: time_s,
        id: ego.id().clone(),
        target: target_mps(block, lane),
        reference: block.reference_mps(lane),
        speed: state.vx_mps,
        measured_speed: block.measured_mps(lane),
        lateral_speed: state.vy_mps,
        yaw_rate: state.yaw_rate_radps,
        slip_front,
        slip_rear,
        torque: block.torque_nm(lane),
        alpha_hat: block.alpha_ratio(lane),
        f_hat: block.f_hat_mps2(lane),
        distance: block.distance_m(lane),
    }
}
