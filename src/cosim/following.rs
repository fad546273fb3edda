//! The speeds of those who follow and of those ahead, step by step.

use super::egos::EgoTable;
use crate::fleet::{Fleet, Slot};

/// Takes the speeds of all who follow, once all bodies are at the end of a step.
pub fn note_speeds(egos: &mut EgoTable, fleet: &Fleet, step_s: f64) {
    let speed_mps = |slot: Slot| fleet.block(slot).speed_mps(slot.lane());
    let ahead = |slot: Slot| {
        let (id, ahead) = egos.get(slot)?.follower.ahead()?;
        // Another vehicle may have its slot by now.
        egos.get(ahead).filter(|ego| ego.id() == id).map(|_| (slot, [speed_mps(slot), speed_mps(ahead)]))
    };
    let pairs: Vec<_> = egos.slots().filter_map(ahead).collect();
    for (slot, speeds_mps) in pairs {
        if let Some(ego) = egos.get_mut(slot) {
            ego.follower.note(speeds_mps, step_s);
        }
    }
}
