//! The closed loop on columns: the only place where plant, controller, measurement and statistics meet.
//!
//! One control period of one block, in order: measure -> law -> actuators -> steer -> body -> standstill -> statistics
//! (`Block::period`). A [`Fleet`] is many blocks; every block belongs to one group of vehicles that share a
//! controller and a target. Blocks know nothing of each other, so they may advance on any number of threads and the
//! results stay the same to the last bit.

pub mod block;
mod course;
mod driver;
pub mod follow;
mod lockstep;
mod setup;
mod snapshot;
pub mod steering;

use crate::control::{Delegate, Law};
use crate::lanes::{InstructionSet, LANES};
use crate::stats::VehicleStats;
use crate::stopwatch::Stopwatch;
use block::Block;
use follow::Follow;
use lockstep::GroupLaw;
use rayon::prelude::*;
pub use setup::{ActuatorSetup, GroupSetup, LoopConfig, VehicleSetup};
pub use snapshot::Snapshot;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;
use std::time::Duration;

/// Less work than this is done on the calling thread, in control periods of blocks of about a microsecond each: waking a
/// second thread would cost more.
const PARALLEL_FROM_BLOCK_PERIODS: usize = 80;

/// Where a vehicle lives: block and slot in one number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Slot(u32);

impl Slot {
    fn new(block: usize, lane: usize) -> Self {
        Self(u32::try_from(block * LANES + lane).expect("fewer than 2^32 slots"))
    }

    /// Index among all slots of the fleet.
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// Index of the block.
    pub fn block(self) -> usize {
        self.0 as usize / LANES
    }

    /// Index within the block.
    pub fn lane(self) -> usize {
        self.0 as usize % LANES
    }
}

struct Group {
    setup: GroupSetup,
    /// The law of the whole group, if it has one.
    law: Option<GroupLaw>,
    /// The lowest comes first, so that vehicles gather in few blocks: a block costs as much with one as when it is full.
    free: BinaryHeap<Reverse<Slot>>,
}

/// All vehicles with a body.
pub struct Fleet {
    config: LoopConfig,
    rated: bool,
    groups: Vec<Group>,
    blocks: Vec<Block>,
    failure: Option<LawFailure>,
    stopwatch: Stopwatch<1>,
}

/// The law of a group gave up.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the controller: {0}")]
pub struct LawFailure(String);

/// Where the time of a fleet went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FleetTime {
    /// Measuring, laws, actuators.
    pub control: Duration,
    /// Steering, bodies, standstill.
    pub plant: Duration,
    /// Statistics by control period.
    pub statistics: Duration,
}

impl Fleet {
    /// An empty fleet.
    pub fn new(config: LoopConfig, groups: Vec<GroupSetup>) -> Self {
        let groups = groups.into_iter().map(|setup| Group { setup, law: None, free: BinaryHeap::new() }).collect();
        Self { config, rated: false, groups, blocks: Vec::new(), failure: None, stopwatch: Stopwatch::new(false) }
    }

    /// The same fleet; the drive quality of vehicles that are admitted from now on is kept.
    #[must_use]
    pub fn rated(self, rated: bool) -> Self {
        Self { rated, ..self }
    }

    /// From now on notes where its time goes, [`Fleet::time_spent`].
    pub fn time_yourself(&mut self) {
        self.stopwatch = Stopwatch::new(true);
        for block in &mut self.blocks {
            block.stopwatch = Stopwatch::new(true);
        }
    }

    /// The time that [`Fleet::advance`] took so far, divided as the blocks spent it: with several threads the sum over
    /// blocks is larger than the time that passed.
    pub fn time_spent(&self) -> FleetTime {
        let [passed] = self.stopwatch.spent();
        let sum = |part: usize| self.blocks.iter().map(|b| b.stopwatch.spent()[part]).sum::<Duration>();
        let parts = [block::CONTROL, block::PLANT, block::STATISTICS].map(sum);
        let all_s = parts.iter().sum::<Duration>().as_secs_f64();
        let share = |part: Duration| passed.mul_f64(if all_s > 0.0 { part.as_secs_f64() / all_s } else { 0.0 });
        let [control, plant, statistics] = parts.map(share);
        FleetTime { control, plant, statistics }
    }

    /// Control period \[s\].
    pub fn period_s(&self) -> f64 {
        self.config.period_s
    }

    /// Puts a vehicle into a free slot of `group`.
    pub fn admit(&mut self, group: usize, vehicle: VehicleSetup) -> Slot {
        if self.groups[group].free.is_empty() {
            self.grow(group);
        }
        let Reverse(slot) = self.groups[group].free.pop().expect("grow() left free slots");
        self.blocks[slot.block()].admit(slot.lane(), vehicle);
        slot
    }

    fn grow(&mut self, group: usize) {
        let index = self.blocks.len();
        let period_s = self.config.period_s;
        let Group { setup, law, .. } = &mut self.groups[group];
        let controller = match law {
            Some(_) => Some(Box::<Delegate>::default() as _),
            None => match (setup.law)() {
                Law::Nothing => None,
                Law::Block(controller) => Some(controller),
                Law::Group(of_group) => {
                    *law = Some(GroupLaw::new(of_group, period_s));
                    Some(Box::<Delegate>::default() as _)
                }
            },
        };
        self.blocks.push(Block::new(group, controller, period_s, setup.dead_time_max_s, self.rated));
        self.blocks[index].stopwatch = Stopwatch::new(self.stopwatch.is_on());
        self.blocks[index].in_lockstep = self.groups[group].law.is_some();
        self.groups[group].free.extend((0..LANES).map(|lane| Reverse(Slot::new(index, lane))));
    }

    /// Takes a vehicle out and returns its statistics. The other slots are untouched.
    pub fn release(&mut self, slot: Slot) -> VehicleStats {
        let block = &mut self.blocks[slot.block()];
        let stats = block.release(slot.lane());
        let group = block.group();
        self.groups[group].free.push(Reverse(slot));
        stats
    }

    /// The block of a slot.
    pub fn block(&self, slot: Slot) -> &Block {
        &self.blocks[slot.block()]
    }

    /// The block of a slot, to write demands into.
    pub fn block_mut(&mut self, slot: Slot) -> &mut Block {
        &mut self.blocks[slot.block()]
    }

    /// Number of vehicles.
    pub fn len(&self) -> usize {
        self.blocks.iter().map(Block::len).sum()
    }

    /// True if there is no vehicle.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Lets every block for which `select` is true follow `follow` over `periods` control periods. With several
    /// threads the blocks are shared out; each works alone, so the result does not depend on how.
    pub fn advance(&mut self, periods: u32, select: impl Fn(&Block) -> bool + Sync, follow: Follow) {
        self.advance_among(0..self.blocks.len(), periods, select, follow);
    }

    /// True if the law of a group commands all its vehicles at once: then no range may be advanced that parts a group.
    pub fn has_group_law(&self) -> bool {
        self.groups.iter().any(|group| group.law.is_some())
    }

    /// Whether the law of a group has given up; from then on the fleet is not what it should be.
    ///
    /// # Errors
    /// [`LawFailure`]
    pub fn soundness(&self) -> Result<(), LawFailure> {
        self.failure.clone().map_or(Ok(()), Err)
    }

    /// The same for the blocks in a range, of which the last need not exist.
    pub fn advance_among(
        &mut self,
        blocks: Range<usize>,
        periods: u32,
        select: impl Fn(&Block) -> bool + Sync,
        follow: Follow,
    ) {
        self.stopwatch.start();
        let config = &self.config;
        // What the caller computes with, other threads do as well.
        let set = InstructionSet::in_use();
        let work = |block: &mut Block| {
            if !block.is_empty() && !block.in_lockstep && select(block) {
                set.during(|| block.step(config, periods, follow));
            }
        };
        let blocks = among(&mut self.blocks, blocks);
        let work_units = blocks.len() * periods as usize;
        if work_units < PARALLEL_FROM_BLOCK_PERIODS || rayon::current_num_threads() == 1 {
            blocks.iter_mut().for_each(work);
        } else {
            blocks.par_iter_mut().for_each(work);
        }
        for (index, group) in self.groups.iter_mut().enumerate() {
            let Some(law) = &mut group.law else { continue };
            let blocks = blocks.iter_mut().filter(|block| block.group() == index && select(block)).collect();
            if let (None, Err(what)) = (&self.failure, law.advance(blocks, config, periods, follow)) {
                self.failure = Some(LawFailure(what));
            }
        }
        self.stopwatch.lap(0);
    }

    /// Counts the step just done, once SUMO's speeds at its end are known ([`Block::see_speed`]).
    pub fn close_step(&mut self) {
        self.close_step_among(0..self.blocks.len());
    }

    /// The same for the blocks in a range, of which the last need not exist.
    pub fn close_step_among(&mut self, blocks: Range<usize>) {
        among(&mut self.blocks, blocks).iter_mut().filter(|b| !b.is_empty()).for_each(Block::close_step);
    }
}

/// The blocks of a range, as far as they exist.
fn among(blocks: &mut [Block], range: Range<usize>) -> &mut [Block] {
    let end = range.end.min(blocks.len());
    &mut blocks[range.start.min(end)..end]
}
