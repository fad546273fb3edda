//! The ego that a departed vehicle becomes.

use super::admission::Departed;
use super::creep::Creep;
use super::egos::{Ego, Presence};
use super::platoon::Follower;
use super::plausible::Watch;
use crate::fleet::Slot;

/// The ego of a vehicle that departed at `depart_s`, in its group and slot. SUMO leads it at first, and it decides in every step.
pub fn ego_of(departed: Departed, (group, slot): (usize, Slot), depart_s: f64) -> Ego {
    Ego {
        object: departed.object,
        type_id: departed.type_id,
        group,
        slot,
        depart_s,
        presence: Presence::Driving,
        teleported: false,
        carried: false,
        lane: departed.lane.unwrap_or_default(),
        odometer_offset_m: departed.odometer_m,
        odometer_gap_m: None,
        road: None,
        leader: None,
        keeps_plan: false,
        follower: Follower::default(),
        creep: Creep::default(),
        watch: Watch::default(),
        headway_before_s: departed.headway_s,
        headway_s: None,
        imperfection_before: departed.imperfection,
        parameters: departed.parameters,
        ordered_parameters: Vec::new(),
        has_ordered_speed: false,
        colour_before: departed.colour,
        shade: None,
    }
}
