//! What a SUMO step says about the traffic as a whole.

use std::collections::HashSet;

/// Events of one SUMO step. Ids are SUMO's.
#[derive(Debug, Clone, Default)]
pub struct Events {
    /// Simulation time at the end of the step \[s\].
    pub time_s: f64,
    /// Number of vehicles that are on the road or still to come.
    pub expected: i32,
    /// Vehicles that departed; they have not moved yet.
    pub departed: Vec<String>,
    /// Vehicles that arrived.
    pub arrived: Vec<String>,
    /// Vehicles of which a teleport began.
    pub teleported: Vec<String>,
    /// Vehicles that a teleport has put down which had begun before anybody looked on.
    pub found: Vec<String>,
    /// Vehicles that are being carried, since [`Events::note_teleports`] has been told so.
    pub carried: HashSet<String>,
    /// True if vehicles touch, or are nearer than their smallest gap.
    pub colliding: bool,
    /// The pairs of these vehicles: collider, victim.
    pub collisions: Vec<[String; 2]>,
}

impl Events {
    /// Forgets the events of the last step; time and number of vehicles stay.
    pub fn clear(&mut self) {
        for list in [&mut self.departed, &mut self.arrived, &mut self.teleported, &mut self.found] {
            list.clear();
        }
        self.colliding = false;
        self.collisions.clear();
    }

    /// Takes the vehicles of which a teleport began, and those that were put down.
    pub fn note_teleports(&mut self, began: Vec<String>, ended: Vec<String>) {
        self.carried.extend(began.iter().cloned());
        self.found = ended.into_iter().filter(|id| !self.carried.remove(id)).collect();
        self.carried.retain(|id| !self.arrived.contains(id));
        self.teleported = began;
    }

    /// True if nobody collided or teleported. Then what SUMO shows of one vehicle says nothing about another.
    pub fn is_quiet(&self) -> bool {
        !self.colliding && self.teleported.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_put_down_without_having_been_taken_up_is_found() {
        let ids = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let mut events = Events::default();
        events.note_teleports(ids(&["a", "b"]), ids(&["b", "early"]));
        assert_eq!((&events.teleported, &events.found), (&ids(&["a", "b"]), &ids(&["early"])));
        events.clear();
        events.note_teleports(Vec::new(), ids(&["a"]));
        assert_eq!((&events.teleported, &events.found), (&ids(&[]), &ids(&[])));
        // Who arrives on the way is forgotten: the id may come again, in a state that is loaded.
        events.arrived = ids(&["c"]);
        events.note_teleports(ids(&["c"]), Vec::new());
        assert!(events.carried.is_empty());
    }

    #[test]
    fn a_step_is_quiet_again_after_a_collision_or_a_teleport() {
        let quiet = Events { time_s: 3.0, expected: 7, departed: vec!["a".into()], ..Events::default() };
        assert!(quiet.is_quiet(), "comings and goings concern nobody else");
        let collision = Events { colliding: true, collisions: vec![["a".into(), "b".into()]], ..quiet.clone() };
        let teleport = Events { teleported: vec!["a".into()], found: vec!["b".into()], ..quiet.clone() };
        for mut events in [collision, teleport] {
            assert!(!events.is_quiet());
            events.clear();
            assert!(
                events.is_quiet()
                    && events.collisions.is_empty()
                    && events.departed.is_empty()
                    && events.found.is_empty()
            );
            assert_eq!((events.time_s, events.expected), (3.0, 7), "these stay");
        }
    }
}
