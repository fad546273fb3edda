//! Where egos are, for trajectories: asked between the steps, and only of those that are followed.

use super::egos::{Ego, EgoTable, Presence};
use super::error::CosimError;
use super::question::{Gets, NoAnswer, Question};
use super::sumo::Sumo;
use crate::fleet::Slot;
use crate::traci::vehicle;
use std::collections::HashMap;
use std::sync::Arc;

/// Where SUMO shows a vehicle at the end of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Middle of the front bumper, x and y in the network's coordinates \[m\].
    pub position_m: [f64; 2],
    /// Heading, clockwise from north \[degrees\].
    pub heading_deg: f64,
    /// Its lane.
    pub lane: String,
}

/// The question about it.
struct PlaceQuestion(Slot);

impl Question for PlaceQuestion {
    /// `None` while SUMO carries the vehicle.
    type Answer<'a> = Option<Place>;

    fn answer<'a>(&self, gets: &mut impl Gets<'a>) -> Option<Place> {
        let position_m = gets.position(vehicle::POSITION);
        let heading_deg = gets.number(vehicle::ANGLE);
        let lane = gets.text(vehicle::LANE).map(str::to_owned);
        Some(Place { position_m: position_m?, heading_deg: heading_deg?, lane: lane? })
    }
}

/// Asks where those egos are that `wanted` names. An ego that SUMO carries has no place.
pub(super) async fn places<S: Sumo>(
    sumo: &mut S,
    egos: &EgoTable,
    wanted: impl Fn(&Ego) -> bool,
) -> Result<HashMap<Arc<str>, Place>, CosimError> {
    let followed = egos.iter().filter(|ego| ego.presence == Presence::Driving && wanted(ego));
    let asked = sumo.ask(followed.map(|ego| (&ego.object, PlaceQuestion(ego.slot))))?;
    let mut places = HashMap::new();
    let note = |PlaceQuestion(slot), answer: Result<Option<Place>, NoAnswer>| {
        let known = egos.get(slot).zip(answer.ok().flatten());
        places.extend(known.map(|(ego, place)| (ego.id().clone(), place)));
    };
    sumo.answers(asked, note).await?;
    Ok(places)
}
