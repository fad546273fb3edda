//! What a run leaves: a record per ego, sums by road, and counters of the whole traffic.

use super::egos::Ego;
use super::platoon::StringGain;
use super::plausible::{Ending, Implausible};
use super::roads::Roads;
use crate::fleet::Fleet;
use crate::stats::{DriveQuality, VehicleStats};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

/// How the record of an ego ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reason {
    /// It reached the end of its route.
    Arrived,
    /// It was on the road when the run ended.
    Running,
    /// Somebody else took it out.
    Removed,
    /// SUMO took it out after a collision.
    Collided,
    /// SUMO teleported it and it never came back.
    TeleportedOut,
    /// Its plant left the range of sensible states ([`crate::plant::FASTEST_MPS`]).
    Diverged,
    /// The run broke off.
    Incomplete,
}

impl Reason {
    /// All reasons.
    pub const ALL: [Self; 7] = [
        Self::Arrived,
        Self::Running,
        Self::Removed,
        Self::Collided,
        Self::TeleportedOut,
        Self::Diverged,
        Self::Incomplete,
    ];

    /// As in the column `reason`.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Arrived => "arrived",
            Self::Running => "running",
            Self::Removed => "removed",
            Self::Collided => "collided",
            Self::TeleportedOut => "teleported_out",
            Self::Diverged => "diverged",
            Self::Incomplete => "incomplete",
        }
    }
}

/// The record of one ego, once it has ended.
pub struct Finished {
    /// SUMO's id.
    pub id: Arc<str>,
    /// vType.
    pub type_id: String,
    /// Index of its group.
    pub group: usize,
    /// Time of departure \[s\].
    pub depart_s: f64,
    /// End of the step in which it arrived \[s\].
    pub arrival_s: Option<f64>,
    /// Why the record ended.
    pub reason: Reason,
    /// Its statistics.
    pub stats: VehicleStats,
    /// Its drive quality.
    pub quality: DriveQuality,
    /// How it passes on what the egos ahead do.
    pub string_gain: StringGain,
    /// ∫V_x dt \[m\].
    pub distance_m: f64,
    /// SUMO's odometer minus that \[m\].
    pub odometer_gap_m: Option<f64>,
    /// Number of pairs of colliding vehicles that it was in.
    pub collisions: u32,
    /// Time lost against its own speed factor, if its body led \[s\].
    pub time_loss_s: Option<f64>,
}

/// Counters of all vehicles, egos or not.
#[derive(Debug, Clone, Default)]
pub struct Counters {
    /// Vehicles that were on the road at the beginning, in a state that SUMO had loaded.
    pub present: u64,
    /// Vehicles that departed.
    pub departed: u64,
    /// Vehicles that arrived.
    pub arrived: u64,
    /// Teleports that began.
    pub teleports: u64,
    /// Pairs of vehicles that collided.
    pub collision_pairs: usize,
    /// Departed vehicles without four wheels, by vClass.
    pub others: BTreeMap<String, u64>,
    /// Departed vehicles that the selectors left to SUMO.
    pub unequipped: u64,
    /// Egos that crept: they moved for more than [`super::LONG_S`] without exceeding [`super::SLOW_MPS`].
    pub crept: u64,
    /// vTypes whose accel or emergencyDecel [m/s²] is more than their bodies can give, with both and what the bodies give.
    pub beyond_body: BTreeMap<String, [[f64; 2]; 2]>,
    /// Departed vehicles that were to be egos but cannot be, with the reason.
    pub refused: Told,
    /// Egos of less than half or more than twice the mass that preset and vType give.
    pub odd_masses: Told,
    /// What egos did that no vehicle does.
    pub implausible: Implausible,
}

/// Vehicles of which something is to be told.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Told {
    /// How many there are.
    pub count: u64,
    /// The first, in words.
    pub first: Option<String>,
}

impl Told {
    /// One more.
    pub(super) fn add(&mut self, words: impl FnOnce() -> String) {
        self.count += 1;
        self.first.get_or_insert_with(words);
    }
}

/// Records, roads and counters.
#[derive(Default)]
pub struct Records {
    /// Records that have ended.
    pub finished: Vec<Finished>,
    /// Errors and speeds by road.
    pub roads: Roads,
    /// Counters.
    pub counters: Counters,
    pairs: HashSet<[String; 2]>,
    collisions: HashMap<String, u32>,
}

impl Records {
    /// Ends the record of an ego that was taken out of the table, and frees its slot.
    pub fn end(&mut self, ego: Ego, fleet: &mut Fleet, time_s: f64, reason: Reason) {
        let (slot, lane) = (ego.slot, ego.slot.lane());
        let block = fleet.block_mut(slot);
        let (distance_m, quality) = (block.distance_m(lane), block.quality(lane));
        let ending = Ending {
            id: ego.id(),
            watch: &ego.watch,
            time_s,
            diverged: reason == Reason::Diverged,
            speed_mps: block.speed_mps(lane),
            distance_m,
            odometer_gap_m: ego.odometer_gap_m,
        };
        self.counters.implausible.note(&ending);
        if let Some(road) = ego.road {
            let sums = block.take_sums(lane);
            self.roads.add(road, &sums);
        }
        self.counters.crept += u64::from(ego.creep.crept);
        self.finished.push(Finished {
            collisions: self.collisions.remove(&**ego.id()).unwrap_or(0),
            id: ego.object.id,
            type_id: ego.type_id,
            group: ego.group,
            depart_s: ego.depart_s,
            arrival_s: matches!(reason, Reason::Arrived | Reason::TeleportedOut).then_some(time_s),
            reason,
            stats: fleet.release(slot),
            quality,
            string_gain: ego.follower.gain(),
            distance_m,
            odometer_gap_m: ego.odometer_gap_m,
            time_loss_s: ego.leader.map(|leader| leader.time_loss_s),
        });
    }

    /// Counts the pairs of a step that have not collided before.
    pub fn count_collisions(&mut self, pairs: &[[String; 2]]) {
        for [a, b] in pairs {
            let pair = if a <= b { [a.clone(), b.clone()] } else { [b.clone(), a.clone()] };
            if self.pairs.insert(pair) {
                self.counters.collision_pairs += 1;
                for id in [a, b] {
                    *self.collisions.entry(id.clone()).or_default() += 1;
                }
            }
        }
    }
}
