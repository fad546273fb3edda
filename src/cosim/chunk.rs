//! Egos in chunks: while SUMO looks up the values of one chunk, the bodies of the chunk before it drive.

use super::egos::EgoTable;
use super::observation::EgoQuestion;
use super::sumo::Sumo;
use crate::fleet::Slot;

/// Blocks of the fleet in one chunk: enough work to be worth two messages of its own.
pub const BLOCKS_PER_CHUNK: usize = 16;

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
pub fn share_out<S: Sumo>(egos: &EgoTable, chunks: &mut Vec<Chunk<S>>) {
    chunks.iter_mut().for_each(|chunk| chunk.members.clear());
    for slot in egos.slots() {
        let place = slot.block() / BLOCKS_PER_CHUNK;
        if place >= chunks.len() {
            chunks.resize_with(place + 1, Chunk::default);
        }
        chunks[place].members.push(slot);
    }
}
