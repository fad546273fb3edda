//! Body-leads mode, for the targets `limit` and `profile`: the bodies run the coming step first, and SUMO is told
//! `setSpeed` with the speeds that they will have at its end, in every step.

use super::egos::EgoTable;
use super::error::CosimError;
use super::leader::Leader;
use super::question::{Gets, NoAnswer, Object, Question};
use super::sumo::Sumo;
use crate::fleet::Fleet;
use crate::fleet::follow::Follow;
use crate::reference::Target;
use crate::traci::lane;
use std::collections::HashMap;

/// The groups' targets, and the limits of the lanes that leading bodies have come to.
pub struct BodyLeads {
    targets: Vec<Target>,
    /// Limits by lane.
    pub limits: LaneLimits,
}

impl BodyLeads {
    /// The target of each group.
    pub fn new(targets: Vec<Target>) -> Self {
        Self { targets, limits: LaneLimits::default() }
    }

    /// True if the bodies of a group lead.
    pub fn in_group(&self, group: usize) -> bool {
        !matches!(self.targets[group], Target::Traffic)
    }

    /// True if the bodies of any group lead.
    pub fn anywhere(&self) -> bool {
        (0..self.targets.len()).any(|group| self.in_group(group))
    }

    /// Leading bodies drive the coming step.
    pub fn advance(&self, fleet: &mut Fleet, egos: &mut EgoTable, periods: u32) {
        if !self.anywhere() {
            return;
        }
        egos.for_each_mut(|ego| {
            if let Some(leader) = &ego.leader {
                leader.set_target(&self.targets[ego.group], fleet.block_mut(ego.slot), ego.slot.lane());
            }
        });
        for (group, target) in self.targets.iter().enumerate() {
            let follow = match target {
                Target::Traffic => continue,
                Target::Limit => Follow::Target,
                Target::Profile(profile) => Follow::Profile(profile),
            };
            fleet.advance(periods, |block| block.group() == group, follow);
        }
        egos.for_each_mut(|ego| {
            if let Some(leader) = &mut ego.leader {
                leader.set_command(fleet.block(ego.slot).speed_mps(ego.slot.lane()));
            }
        });
    }

    /// Learns the limits of lanes that leading bodies have come to.
    pub async fn learn_limits(&mut self, sumo: &mut impl Sumo, egos: &mut EgoTable) -> Result<(), CosimError> {
        if self.limits.unknown.is_empty() {
            return Ok(());
        }
        let lanes: Vec<Object> = self.limits.unknown.drain(..).filter_map(|id| Object::new(id).ok()).collect();
        let asked = sumo.ask(lanes.iter().map(|lane| (lane, LimitQuestion(lane))))?;
        let known = &mut self.limits.known_mps;
        let learn = |LimitQuestion(lane): LimitQuestion<'_>, limit: Result<Option<f64>, NoAnswer>| {
            if let Ok(Some(limit_mps)) = limit {
                known.insert(lane.id.to_string(), limit_mps);
            }
        };
        sumo.answers(asked, learn).await?;
        egos.for_each_mut(|ego| {
            if let Some(leader) = &mut ego.leader
                && let Some(limit_mps) = self.limits.known_mps.get(&leader.lane)
            {
                leader.limit_mps = *limit_mps;
            }
        });
        Ok(())
    }
}

/// The question about the limit of a lane [m/s].
struct LimitQuestion<'o>(&'o Object);

impl Question for LimitQuestion<'_> {
    type Answer<'a> = Option<f64>;

    fn answer<'a>(&self, gets: &mut impl Gets<'a>) -> Option<f64> {
        gets.number(lane::MAX_SPEED)
    }
}

/// Limits of lanes [m/s], by id.
#[derive(Default)]
pub struct LaneLimits {
    known_mps: HashMap<String, f64>,
    unknown: Vec<String>,
}

impl LaneLimits {
    /// The vehicle is on this lane; its id is empty where the vehicle is on none.
    pub fn see_lane(&mut self, leader: &mut Leader, lane: &str) {
        if lane.is_empty() || leader.lane == lane {
            return;
        }
        match self.known_mps.get(lane) {
            Some(limit_mps) => leader.limit_mps = *limit_mps,
            None => self.note_unknown(lane),
        }
        lane.clone_into(&mut leader.lane);
    }

    /// The limit of this lane has to be asked for.
    pub fn note_unknown(&mut self, lane: &str) {
        if !self.unknown.iter().any(|unknown| unknown == lane) {
            self.unknown.push(lane.to_owned());
        }
    }
}
