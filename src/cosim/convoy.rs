//! The egos in companies of a few blocks, so that SUMO and the fleet work at the same time: while SUMO looks up the
//! values of one convoy, the bodies of the convoy before it drive, and their speeds are already on the way back.
//!
//! What both sides know is not said: a body that stands turns nowhere, and where SUMO's car stands too it need not be
//! told so.

use super::book::{Book, EgoKey};
use super::state::State;
use crate::traci::{Batch, BatchError, vehicle};
use std::ops::Range;

/// Blocks of the fleet in one convoy: enough work to be worth two messages of its own.
const BLOCKS: usize = 16;

/// The egos of neighbouring blocks.
#[derive(Default)]
pub(super) struct Convoy {
    /// Those on the road when it was formed.
    pub members: Vec<Member>,
    /// Asks for what SUMO shows of every member. Empty if vehicles are subscribed to.
    pub gets: Batch,
    /// Tells SUMO the speeds of the bodies.
    pub speeds: Batch,
}

/// An ego in a convoy.
#[derive(Debug, Clone, Copy)]
pub(super) struct Member {
    /// The ego, which may have left since the convoy was formed.
    pub key: EgoKey,
    /// Number of the first answer that is about it.
    pub first: usize,
    /// True if its heading is among the answers.
    pub heading: bool,
}

/// The blocks of the convoy at `place`, of which the last may not exist yet.
pub(super) fn blocks(place: usize) -> Range<usize> {
    place * BLOCKS..(place + 1) * BLOCKS
}

/// Forms the convoys anew.
pub(super) fn form(convoys: &mut Vec<Convoy>, book: &Book) {
    for convoy in convoys.iter_mut() {
        convoy.members.clear();
        convoy.gets.clear();
    }
    for key in book.keys() {
        let place = book[*key].slot.block() / BLOCKS;
        if place >= convoys.len() {
            convoys.resize_with(place + 1, Convoy::default);
        }
        convoys[place].members.push(Member { key: *key, first: 0, heading: false });
    }
}

impl Convoy {
    /// Writes the gets for the coming step.
    pub fn ask(&mut self, state: &State) -> Result<(), BatchError> {
        self.gets.clear();
        for member in &mut self.members {
            let ego = &state.book[member.key];
            member.first = self.gets.len();
            member.heading = !state.fleet.block(ego.slot).stands(ego.slot.lane());
            self.gets.get_by_prefix(vehicle::SPEED, &ego.prefix)?;
            if member.heading {
                self.gets.get_by_prefix(vehicle::ANGLE, &ego.prefix)?;
            }
            if ego.lead.is_some() {
                self.gets.get_by_prefix(vehicle::LANE, &ego.prefix)?;
            }
            if state.grade {
                self.gets.get_by_prefix(vehicle::SLOPE, &ego.prefix)?;
            }
        }
        Ok(())
    }
}
