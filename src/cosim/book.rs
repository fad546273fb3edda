//! Who is in the fleet: one record per ego, found by slot order in the steady state and by id when something changes.

use crate::fleet::Slot;
use crate::traci::Prefix;
use std::collections::HashMap;
use std::sync::Arc;

/// Where a vehicle is, as far as we may drive it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Presence {
    /// On the road (moving, waiting, stopped or parking).
    Driving,
    /// SUMO carries it; it has no speed.
    Teleporting,
}

/// What was changed on a vehicle whose plant leads, to be restored at hand-back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Before {
    /// Speed factor.
    pub speed_factor: f64,
    /// Largest acceleration [m/s²].
    pub accel_mps2: f64,
    /// Largest comfortable deceleration [m/s²].
    pub decel_mps2: f64,
    /// Speed mode.
    pub speed_mode: i32,
}

/// The state of a vehicle whose plant leads (targets `limit` and `profile`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lead {
    /// What to restore.
    pub before: Before,
    /// Limit of the lane that it is on [m/s].
    pub limit_mps: f64,
    /// The speed sent last [m/s].
    pub command_mps: f64,
    /// The speed that SUMO allowed instead, while it does [m/s].
    pub clamp_mps: Option<f64>,
}

/// One ego.
pub struct Ego {
    /// SUMO's id.
    pub id: Arc<str>,
    /// vType.
    pub type_id: String,
    /// Index of the scenario's group.
    pub group: usize,
    /// Place in the fleet.
    pub slot: Slot,
    /// Time of departure \[s\].
    pub depart_s: f64,
    /// The command that is sent in every step, all but its numbers.
    pub prefix: Prefix,
    /// On the road or not.
    pub presence: Presence,
    /// True once SUMO has teleported it.
    pub teleported: bool,
    /// SUMO's odometer minus the plant's when the ego was admitted \[m\].
    pub odometer_offset_m: f64,
    /// SUMO's odometer minus the plant's, as last read \[m\].
    pub odometer_gap_m: Option<f64>,
    /// Index of the road it was last seen on, in the world's table of roads.
    pub edge: Option<u32>,
    /// Set if its plant leads.
    pub lead: Option<Lead>,
    /// The lane it was last seen on; only known of leading egos.
    pub lane: Option<String>,
    /// Driver imperfection before the scenario changed it.
    pub sigma_before: Option<f64>,
    /// Step in which the last reply spoke of it.
    pub seen_in_step: u64,
    /// Number of the step after which SUMO was last told its body's speed, ahead of the next step's message.
    pub told_after: Option<u64>,
}

/// Handle of an ego in the [`Book`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EgoKey(usize);

/// All egos on the road, in the order of their subscriptions.
#[derive(Default)]
pub struct Book {
    egos: Vec<Option<Ego>>,
    free: Vec<usize>,
    by_id: HashMap<Arc<str>, EgoKey>,
    order: Vec<EgoKey>,
    cursor: usize,
    changes: u64,
}

impl Book {
    /// Adds an ego at the end of the order.
    pub fn insert(&mut self, ego: Ego) -> EgoKey {
        let id = ego.id.clone();
        let index = self.free.pop().unwrap_or_else(|| {
            self.egos.push(None);
            self.egos.len() - 1
        });
        self.egos[index] = Some(ego);
        let key = EgoKey(index);
        self.by_id.insert(id, key);
        self.order.push(key);
        self.changes += 1;
        key
    }

    /// Takes an ego out.
    pub fn remove(&mut self, key: EgoKey) -> Option<Ego> {
        let ego = self.egos.get_mut(key.0)?.take()?;
        self.by_id.remove(&ego.id);
        self.order.retain(|k| *k != key);
        self.changes += 1;
        self.free.push(key.0);
        Some(ego)
    }

    /// The ego, while it is in the book.
    pub fn get(&self, key: EgoKey) -> Option<&Ego> {
        self.egos.get(key.0)?.as_ref()
    }

    /// True while the ego is in the book.
    pub fn contains(&self, key: EgoKey) -> bool {
        self.get(key).is_some()
    }

    /// The ego with this id.
    pub fn find(&self, id: &str) -> Option<EgoKey> {
        self.by_id.get(id).copied()
    }

    /// Starts a pass over a reply, whose blocks come in the order of subscription.
    pub fn rewind(&mut self) {
        self.cursor = 0;
    }

    /// The ego that a block of the reply speaks of: the next in order nearly always, else looked up.
    pub fn next_in_reply(&mut self, id: &str) -> Option<EgoKey> {
        let expected = self.order.get(self.cursor).copied();
        let key = expected.filter(|k| *self[*k].id == *id).or_else(|| {
            let found = self.find(id)?;
            self.cursor = self.order.iter().position(|k| *k == found)?;
            Some(found)
        })?;
        self.cursor += 1;
        Some(key)
    }

    /// Number of entries and exits so far: while it stays the same, so does the order.
    pub fn changes(&self) -> u64 {
        self.changes
    }

    /// All egos in order.
    pub fn keys(&self) -> &[EgoKey] {
        &self.order
    }

    /// The ego at a place of the order, to change it.
    pub fn at(&mut self, place: usize) -> &mut Ego {
        let key = self.order[place];
        &mut self[key]
    }

    /// All egos in order.
    pub fn iter(&self) -> impl Iterator<Item = &Ego> {
        self.order.iter().map(|k| &self[*k])
    }

    /// Number of egos.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }
}

impl std::ops::Index<EgoKey> for Book {
    type Output = Ego;
    fn index(&self, key: EgoKey) -> &Ego {
        self.egos[key.0].as_ref().expect("a key is valid until its ego is removed")
    }
}

impl std::ops::IndexMut<EgoKey> for Book {
    fn index_mut(&mut self, key: EgoKey) -> &mut Ego {
        self.egos[key.0].as_mut().expect("a key is valid until its ego is removed")
    }
}
