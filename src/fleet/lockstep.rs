//! A group whose law commands all its vehicles in one call: its blocks go through a step side by side, period by period.

use super::block::{Block, CONTROL, Due};
use super::course::Course;
use super::follow::Follow;
use super::setup::LoopConfig;
use crate::control::{GroupController, GroupPeriod};
use crate::lanes::InstructionSet;

/// The law of a group, and what it sees.
pub(super) struct GroupLaw {
    law: Box<dyn GroupController>,
    period: GroupPeriod,
}

/// One block on its way through a step.
struct Walker<'b, 'f> {
    /// Its place among the blocks of its group.
    place: usize,
    block: &'b mut Block,
    course: Course<'f>,
    due: Option<Due>,
}

impl GroupLaw {
    /// A law that has seen nothing yet, with control periods of `period_s`.
    pub fn new(law: Box<dyn GroupController>, period_s: f64) -> Self {
        Self { law, period: GroupPeriod { period_s, ..GroupPeriod::default() } }
    }

    /// Lets the group's blocks, all of them in their order, drive `periods` control periods. Those that nothing drives in
    /// keep their place in the columns.
    ///
    /// # Errors
    /// What the law says went wrong.
    pub fn advance(
        &mut self,
        blocks: Vec<&mut Block>,
        config: &LoopConfig,
        periods: u32,
        follow: Follow<'_>,
    ) -> Result<(), String> {
        let set = InstructionSet::in_use();
        self.period.resize(blocks.len());
        let occupied = blocks.into_iter().enumerate().filter(|(_, block)| !block.is_empty());
        let walkers = occupied.map(|(place, block)| {
            let course = block.begin(config, periods, follow);
            Walker { place, block, course, due: None }
        });
        let mut walkers: Vec<Walker<'_, '_>> = walkers.collect();
        if walkers.is_empty() {
            return Ok(());
        }
        for k in 0..periods {
            self.period.clear();
            set.during(|| walkers.iter_mut().for_each(|walker| walker.observe(config, k, &mut self.period)));
            // The first block's stopwatch books the call for all.
            walkers[0].block.stopwatch.start();
            self.law.command(&mut self.period)?;
            walkers[0].block.stopwatch.lap(CONTROL);
            set.during(|| walkers.iter_mut().for_each(|walker| walker.act(config, k, &self.period)));
        }
        walkers.iter_mut().for_each(|walker| walker.block.finish(config, &walker.course));
        Ok(())
    }
}

impl Walker<'_, '_> {
    fn observe(&mut self, config: &LoopConfig, k: u32, period: &mut GroupPeriod) {
        // What the other blocks do meanwhile is not this one's time.
        self.block.stopwatch.start();
        let due = self.block.observe(config, &self.course, k);
        self.block.stopwatch.lap(CONTROL);
        if let (Some(port), Some(observation)) = (self.block.port(), &due.observation) {
            period.see(self.place, &due.moving, observation, port);
        }
        self.due = Some(due);
    }

    fn act(&mut self, config: &LoopConfig, k: u32, period: &GroupPeriod) {
        self.block.stopwatch.start();
        if let Some(port) = self.block.port() {
            period.tell(self.place, port);
        }
        if let Some(due) = self.due.take() {
            self.block.act(config, &due);
        }
        self.block.note_snapshots(k + 1);
    }
}
