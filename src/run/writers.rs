//! What is written while the run goes on (trace, sample) and at its end (vehicles, edges).

use super::RunError;
use super::outcome::Outcome;
use crate::cosim::book::{Ego, Presence};
use crate::cosim::state::State;
use crate::fleet::block::Block;
use crate::output::{
    EDGES, ResultDir, SAMPLE, SampleRow, TRACE, Table, TraceRow, VEHICLES, sort_vehicles, write_table,
};
use crate::random::Stream;
use crate::scenario::{Scenario, Trace};
use std::collections::HashMap;
use std::sync::Arc;

/// Most vehicles in `sample.csv`.
const SAMPLED_MAX: usize = 200;

/// Open files, and who goes into them.
pub struct Writers {
    trace: Option<(Table<TraceRow>, Trace, u64)>,
    sample: Table<SampleRow>,
    sample_every: u64,
    /// Egos by id: `Some` if sampled. Names are shared by all rows.
    sampled: HashMap<String, Option<Arc<str>>>,
    sampled_count: usize,
    seed: u64,
    step: u64,
}

impl Writers {
    /// Opens the files.
    pub fn open(scenario: &Scenario, dir: &ResultDir, state: &State) -> Result<Self, RunError> {
        let steps = |period_s: f64| (period_s / state.step_s).round().max(1.0) as u64;
        let output = &scenario.output;
        let trace = if output.trace == Trace::None {
            None
        } else {
            let table = Table::create(&dir.file(&output.trace_file), &TRACE)?;
            Some((table, output.trace.clone(), output.trace_period_s.map_or(1, steps)))
        };
        Ok(Self {
            trace,
            sample: Table::create(&dir.file("sample.csv"), &SAMPLE)?,
            sample_every: steps(1.0),
            sampled: HashMap::new(),
            sampled_count: 0,
            seed: scenario.sumo.seed,
            step: 0,
        })
    }

    /// Takes down the step that was just made.
    pub fn step(&mut self, state: &mut State) -> Result<(), RunError> {
        self.step += 1;
        if let Some((table, wanted, every)) = &mut self.trace
            && self.step.is_multiple_of(*every)
        {
            for ego in state.book.iter().filter(|e| e.presence == Presence::Driving && is_traced(wanted, &e.id)) {
                table.write(&trace_row(ego, state.fleet.block(ego.slot), state.time_s))?;
            }
        }
        if self.step.is_multiple_of(self.sample_every) {
            self.sample(state)?;
        }
        Ok(())
    }

    fn sample(&mut self, state: &State) -> Result<(), RunError> {
        // Of as many vehicles as are known of now, each has the same chance.
        let known = state.departed + u64::try_from(state.expected).unwrap_or(0);
        let share = SAMPLED_MAX as f64 / known.max(1) as f64;
        for ego in state.book.iter().filter(|e| e.presence == Presence::Driving) {
            if !self.sampled.contains_key(&ego.id) {
                let drawn = Stream::new(self.seed, "sample", &ego.id).uniform() < share;
                let taken = drawn && self.sampled_count < SAMPLED_MAX;
                self.sampled_count += usize::from(taken);
                self.sampled.insert(ego.id.clone(), taken.then(|| Arc::from(ego.id.as_str())));
            }
            let Some(Some(id)) = self.sampled.get(&ego.id) else { continue };
            let (block, lane) = (state.fleet.block(ego.slot), ego.slot.lane());
            self.sample.write(&SampleRow {
                time: state.time_s,
                id: id.clone(),
                speed: block.speed_mps(lane),
                target: target_mps(block, lane),
                distance: block.distance_m(lane),
                torque: block.torque_nm(lane),
            })?;
        }
        Ok(())
    }

    /// Completes all tables.
    pub fn finish(self, dir: &ResultDir, scenario: &Scenario, outcome: &mut Outcome) -> Result<(), RunError> {
        if let Some((trace, ..)) = self.trace {
            trace.finish()?;
        }
        self.sample.finish()?;
        sort_vehicles(&mut outcome.rows);
        write_table(&dir.file(&scenario.output.vehicles), &VEHICLES, &outcome.rows)?;
        write_table(&dir.file("edges.csv"), &EDGES, &outcome.edges.rows())?;
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

fn trace_row(ego: &Ego, block: &Block, time_s: f64) -> TraceRow {
    let lane = ego.slot.lane();
    let state = block.plant().state(lane);
    let [slip_front, slip_rear] = block.slip(lane);
    TraceRow {
        time: time_s,
        id: Arc::from(ego.id.as_str()),
        target: target_mps(block, lane),
        reference: block.reference_mps(lane),
        speed: state.vx_mps,
        measured_speed: block.measured_mps(lane),
        lateral_speed: state.vy_mps,
        yaw_rate: state.yaw_rate_radps,
        slip_front,
        slip_rear,
        torque: block.torque_nm(lane),
        alpha_hat: block.controller().alpha_ratio(lane),
        f_hat: block.controller().f_hat_mps2(lane),
        distance: block.distance_m(lane),
    }
}
