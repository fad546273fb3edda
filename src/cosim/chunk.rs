//! Egos in chunks: while SUMO looks up the values of one chunk, the bodies of the chunk before it drive.

use super::egos::EgoTable;
use super::observation::EgoQuestion;
use super::sumo::Sumo;
use crate::fleet::{Fleet, Slot};
use std::ops::Range;

/// Blocks of the fleet in one chunk: enough work to be worth two messages of its own. A law that commands a whole group
/// needs the answers about all of it.
fn blocks_per_chunk(fleet: &Fleet) -> usize {
    if fleet.has_group_law() { usize::MAX } else { 16 }
}

/// The blocks of a chunk, of which the last need not exist.
pub fn blocks_of(place: usize, fleet: &Fleet) -> Range<usize> {
    let count = blocks_per_chunk(fleet);
    place.saturating_mul(count)..(place + 1).saturating_mul(count)
}

/// The egos of neighbouring blocks.
pub struct Chunk<S: Sumo> {
    /// Their slots, in the order of the egos.
    pub members: Vec<Slot>,
    /// What was asked about them.
    pub asked: S::Asked<EgoQuestion>,
    /// True once the answers have been heard.
    pub is_heard: bool,
}

impl<S: Sumo> Default for Chunk<S> {
    fn default() -> Self {
        Self { members: Vec::new(), asked: Default::default(), is_heard: true }
    }
}

/// Puts every ego into the chunk of its block.
pub fn share_out<S: Sumo>(egos: &EgoTable, fleet: &Fleet, chunks: &mut Vec<Chunk<S>>) {
    let count = blocks_per_chunk(fleet);
    chunks.iter_mut().for_each(|chunk| chunk.members.clear());
    for slot in egos.slots() {
        let place = slot.block() / count;
        if place >= chunks.len() {
            chunks.resize_with(place + 1, Chunk::default);
        }
        chunks[place].members.push(slot);
    }
}
