//! What is known of the lanes that egos have come to: asked once per lane.

use super::egos::{Ego, EgoTable};
use super::error::CosimError;
use super::question::{Gets, NoAnswer, Object, Question};
use super::sumo::Sumo;
use crate::fleet::Fleet;
use crate::fleet::block::Block;
use crate::traci::lane;
use std::collections::HashMap;

/// A lane, as far as bodies care.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Lane {
    limit_mps: Option<f64>,
    /// `None` if it is not asked for.
    friction: Option<f64>,
}

/// Lanes by id.
#[derive(Default)]
pub struct Lanes {
    known: HashMap<String, Lane>,
    unknown: Vec<String>,
    friction: bool,
}

/// The question about a lane.
struct LaneQuestion<'o> {
    lane: &'o Object,
    friction: bool,
}

impl Question for LaneQuestion<'_> {
    type Answer<'a> = Lane;

    fn answer<'a>(&self, gets: &mut impl Gets<'a>) -> Lane {
        let limit_mps = gets.number(lane::MAX_SPEED);
        let friction = if self.friction { gets.number(lane::FRICTION) } else { None };
        Lane { limit_mps, friction }
    }
}

impl Lanes {
    /// No lanes yet; with `friction` the lanes' friction reaches the tyres.
    pub fn new(friction: bool) -> Self {
        Self { friction, ..Self::default() }
    }

    /// Whether bodies feel the friction of their lane.
    pub fn have_friction(&self) -> bool {
        self.friction
    }

    /// The ego is on this lane; the id is empty where it is on none.
    pub fn see(&mut self, ego: &mut Ego, block: &mut Block, id: &str) {
        if id.is_empty() || ego.lane == id {
            return;
        }
        id.clone_into(&mut ego.lane);
        self.arrive(ego, block);
    }

    /// The ego has come to its lane.
    pub fn arrive(&mut self, ego: &mut Ego, block: &mut Block) {
        match self.known.get(&ego.lane) {
            Some(lane) => lane.meet(ego, block),
            None if self.unknown.contains(&ego.lane) => {}
            None => self.unknown.push(ego.lane.clone()),
        }
    }

    /// Asks about the lanes that egos have come to since the last time.
    pub async fn learn(
        &mut self,
        sumo: &mut impl Sumo,
        egos: &mut EgoTable,
        fleet: &mut Fleet,
    ) -> Result<(), CosimError> {
        if self.unknown.is_empty() {
            return Ok(());
        }
        let lanes: Vec<Object> = self.unknown.drain(..).map(Object::known).collect();
        let friction = self.friction;
        let asked = sumo.ask(lanes.iter().map(|lane| (lane, LaneQuestion { lane, friction })))?;
        let known = &mut self.known;
        let learn = |LaneQuestion { lane, .. }: LaneQuestion<'_>, answer: Result<Lane, NoAnswer>| {
            known.extend(answer.ok().map(|found| (lane.id.to_string(), found)));
        };
        sumo.answers(asked, learn).await?;
        egos.for_each_mut(|ego| {
            if let Some(lane) = known.get(&ego.lane) {
                lane.meet(ego, fleet.block_mut(ego.slot));
            }
        });
        Ok(())
    }
}

impl Lane {
    fn meet(&self, ego: &mut Ego, block: &mut Block) {
        if let (Some(leader), Some(limit_mps)) = (&mut ego.leader, self.limit_mps) {
            leader.limit_mps = limit_mps;
        }
        if let Some(friction) = self.friction {
            block.set_road_friction(ego.slot.lane(), friction);
        }
    }
}
