//! What is changed on a vehicle in SUMO while it is an ego: told when it comes, restored when it is handed back.

use super::egos::Ego;
use super::error::CosimError;
use super::sumo::{Sumo, Tell};

/// Changes a newcomer: its driver imperfection to `sigma`, if that is given, and its headway.
pub fn make<S: Sumo>(sumo: &mut S, ego: &Ego, sigma: Option<f64>) -> Result<(), CosimError> {
    if let (Some(sigma), Some(_)) = (sigma, ego.imperfection_before) {
        sumo.tell(&ego.object, Tell::Imperfection(sigma))?;
    }
    if let Some(headway_s) = ego.headway_s {
        sumo.tell(&ego.object, Tell::Headway(headway_s))?;
    }
    Ok(())
}

/// Makes a vehicle as it was.
pub fn undo<S: Sumo>(sumo: &mut S, ego: &Ego) -> Result<(), CosimError> {
    if let Some(sigma) = ego.imperfection_before {
        sumo.tell(&ego.object, Tell::Imperfection(sigma))?;
    }
    if let (Some(headway_s), Some(_)) = (ego.headway_before_s, ego.headway_s) {
        sumo.tell(&ego.object, Tell::Headway(headway_s))?;
    }
    if let (Some(colour), Some(_)) = (ego.colour_before, ego.shade) {
        sumo.tell(&ego.object, Tell::Colour(colour))?;
    }
    if ego.has_ordered_speed {
        sumo.tell(&ego.object, Tell::ReleaseSpeed)?;
    }
    if let Some(leader) = &ego.leader {
        leader.hand_back(sumo, &ego.object)?;
    }
    sumo.unwatch(&ego.object)
}
