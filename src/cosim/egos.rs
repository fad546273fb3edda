//! Who is in the fleet: one record per ego, at its slot.

use super::creep::Creep;
use super::leader::Leader;
use super::platoon::Follower;
use super::plausible::Watch;
use super::question::Object;
use crate::fleet::Slot;
use crate::keys::Key;
use crate::traci::Color;
use std::collections::HashMap;
use std::sync::Arc;

/// Where a vehicle is, as far as its body may drive it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Presence {
    /// On the road (moving, waiting, stopped or parking).
    Driving,
    /// SUMO carries it; it has no speed.
    Teleporting,
}

/// One ego.
pub struct Ego {
    /// The vehicle in SUMO.
    pub object: Object,
    /// vType.
    pub type_id: String,
    /// Index of the scenario's group.
    pub group: usize,
    /// Place in the fleet.
    pub slot: Slot,
    /// Time of departure \[s\].
    pub depart_s: f64,
    /// On the road or not.
    pub presence: Presence,
    /// True once SUMO has teleported it.
    pub teleported: bool,
    /// True from the end of a teleport or jump until the odometer is read again.
    pub carried: bool,
    /// Its lane, if that is asked.
    pub lane: String,
    /// SUMO's odometer when the body started at 0 \[m\].
    pub odometer_offset_m: f64,
    /// SUMO's odometer minus the body's, as last read \[m\].
    pub odometer_gap_m: Option<f64>,
    /// Index of the road that it was last seen on.
    pub road: Option<u32>,
    /// Set if its body leads.
    pub leader: Option<Box<Leader>>,
    /// True if its driver decides less often than SUMO steps, and keeps an acceleration in between.
    pub keeps_plan: bool,
    /// Whom it follows.
    pub follower: Follower,
    /// Whether it creeps.
    pub creep: Creep,
    /// Whether it does what no vehicle can.
    pub watch: Watch,
    /// Desired time headway before the scenario changed it \[s\].
    pub headway_before_s: Option<f64>,
    /// The one that it is given in place of that \[s\].
    pub headway_s: Option<f64>,
    /// Driver imperfection before the scenario changed it.
    pub imperfection_before: Option<f64>,
    /// Its `mfc.*` parameters in SUMO.
    pub parameters: Vec<(&'static Key, String)>,
    /// Those that a caller has set since, which count in their place.
    pub ordered_parameters: Vec<(&'static Key, String)>,
    /// SUMO drives it at a speed that a caller has set.
    pub has_ordered_speed: bool,
    /// Its colour before it showed its error.
    pub colour_before: Option<Color>,
    /// The step of colour that it shows.
    pub shade: Option<usize>,
}

impl Ego {
    /// SUMO's id.
    pub fn id(&self) -> &Arc<str> {
        &self.object.id
    }
}

/// An ego with its place in the order.
struct Entry {
    ego: Ego,
    place: usize,
}

/// All egos on the road, by slot, by id, and in the order of their admission. Entry and exit take the same time however
/// many there are: an exit leaves a gap in the order, and the gaps are closed once they are as many as the egos.
#[derive(Default)]
pub struct EgoTable {
    by_slot: Vec<Option<Entry>>,
    by_id: HashMap<Arc<str>, Slot>,
    order: Vec<Option<Slot>>,
}

impl EgoTable {
    /// Adds an ego at the end of the order.
    pub fn insert(&mut self, ego: Ego) {
        let slot = ego.slot;
        if self.by_slot.len() <= slot.index() {
            self.by_slot.resize_with(slot.index() + 1, || None);
        }
        self.by_id.insert(ego.id().clone(), slot);
        self.by_slot[slot.index()] = Some(Entry { ego, place: self.order.len() });
        self.order.push(Some(slot));
    }

    /// Takes an ego out.
    pub fn remove(&mut self, slot: Slot) -> Option<Ego> {
        let Entry { ego, place } = self.by_slot.get_mut(slot.index())?.take()?;
        self.by_id.remove(ego.id());
        self.order[place] = None;
        if self.order.len() > 2 * self.len() {
            self.close_gaps();
        }
        Some(ego)
    }

    fn close_gaps(&mut self) {
        self.order.retain(Option::is_some);
        for (place, slot) in self.order.iter().flatten().enumerate() {
            if let Some(entry) = &mut self.by_slot[slot.index()] {
                entry.place = place;
            }
        }
    }

    /// The ego at a slot.
    pub fn get(&self, slot: Slot) -> Option<&Ego> {
        self.by_slot.get(slot.index())?.as_ref().map(|entry| &entry.ego)
    }

    /// The ego at a slot, to change it.
    pub fn get_mut(&mut self, slot: Slot) -> Option<&mut Ego> {
        self.by_slot.get_mut(slot.index())?.as_mut().map(|entry| &mut entry.ego)
    }

    /// The ego with this id, to change it.
    pub fn find_mut(&mut self, id: &str) -> Option<&mut Ego> {
        let slot = *self.by_id.get(id)?;
        self.get_mut(slot)
    }

    /// The ego with this id.
    pub fn find(&self, id: &str) -> Option<&Ego> {
        self.get(*self.by_id.get(id)?)
    }

    /// The slots of all egos in order.
    pub fn slots(&self) -> impl Iterator<Item = Slot> {
        self.order.iter().flatten().copied()
    }

    /// All egos in order.
    pub fn iter(&self) -> impl Iterator<Item = &Ego> {
        self.slots().filter_map(|slot| self.get(slot))
    }

    /// Calls `change` with every ego in order.
    pub fn for_each_mut(&mut self, mut change: impl FnMut(&mut Ego)) {
        for slot in self.order.iter().flatten() {
            if let Some(entry) = &mut self.by_slot[slot.index()] {
                change(&mut entry.ego);
            }
        }
    }

    /// Number of egos.
    pub fn len(&self) -> usize {
        self.by_id.len()
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.by_id.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ego(id: &str) -> Ego {
        Ego {
            object: Object::new(id).unwrap(),
            type_id: String::new(),
            group: 0,
            slot: Slot::default(),
            depart_s: 0.0,
            presence: Presence::Driving,
            teleported: false,
            carried: false,
            lane: String::new(),
            odometer_offset_m: 0.0,
            odometer_gap_m: None,
            road: None,
            leader: None,
            keeps_plan: false,
            follower: Follower::default(),
            creep: Creep::default(),
            watch: Watch::default(),
            headway_before_s: None,
            headway_s: None,
            imperfection_before: None,
            parameters: Vec::new(),
            ordered_parameters: Vec::new(),
            has_ordered_speed: false,
            colour_before: None,
            shade: None,
        }
    }

    #[test]
    fn who_has_come_and_gone_leaves_no_gap_for_ever() {
        let mut egos = EgoTable::default();
        assert!(egos.is_empty());
        for id in (0..100).map(|i| format!("v{i}")) {
            egos.insert(ego(&id));
            assert_eq!((egos.is_empty(), egos.len(), egos.iter().count()), (false, 1, 1));
            let left = egos.remove(Slot::default()).unwrap();
            assert!(**left.id() == *id && egos.is_empty() && egos.order.len() <= 1, "{} places", egos.order.len());
        }
    }
}
