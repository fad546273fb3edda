//! What is read of an ego in every step, and what becomes of it. A further variable is a line in
//! [`EgoQuestion::answer`], a field of [`Observation`] and its use in [`Observation::apply`].

use super::egos::{Ego, Presence};
use super::lanes::Lanes;
use super::platoon::AHEAD_M;
use super::question::{Gets, Question};
use crate::fleet::Slot;
use crate::fleet::block::Block;
use crate::fleet::follow::Bound;
use crate::traci::{Leader, vehicle};

/// The bit of a vehicle that stops as planned, in SUMO's stop state.
const STOPPED: i32 = 1;

/// The question about an ego after a step. What both sides know is not asked.
#[derive(Debug, Clone, Copy)]
pub struct EgoQuestion {
    /// The ego.
    pub slot: Slot,
    /// Its heading; a body that stands needs none.
    pub heading: bool,
    /// Its lane, if its body leads or feels the friction.
    pub lane: bool,
    /// Whether it stops as planned, if its body leads.
    pub stop: bool,
    /// The slope of its road; only if bodies feel it.
    pub slope: bool,
    /// Who is ahead, if its target keeps a gap.
    pub ahead: bool,
}

/// What SUMO shows of an ego at the end of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation<'a> {
    /// Speed v* [m/s]; `None` while SUMO carries the vehicle.
    speed_mps: Option<f64>,
    /// Heading, clockwise from north \[degrees\].
    heading_deg: Option<f64>,
    /// Lane.
    lane: Option<&'a str>,
    /// SUMO's bits about stops.
    stop: Option<i32>,
    /// Slope of the road, uphill positive \[degrees\].
    slope_deg: Option<f64>,
    /// Who is ahead, and the gap to it.
    ahead: Option<Leader>,
}

impl Question for EgoQuestion {
    type Answer<'a> = Observation<'a>;
    const EVERY_STEP: bool = true;

    fn answer<'a>(&self, gets: &mut impl Gets<'a>) -> Observation<'a> {
        Observation {
            speed_mps: gets.number(vehicle::SPEED),
            heading_deg: if self.heading { gets.number(vehicle::ANGLE) } else { None },
            lane: if self.lane { gets.text(vehicle::LANE) } else { None },
            stop: if self.stop { gets.integer(vehicle::STOP_STATE) } else { None },
            slope_deg: if self.slope { gets.number(vehicle::SLOPE) } else { None },
            ahead: if self.ahead { gets.leader(AHEAD_M) } else { None },
        }
    }
}

impl EgoQuestion {
    /// All that may ever be asked of an ego.
    pub fn whole(ego: &Ego, lanes: &Lanes, slope: bool) -> Self {
        let leads = ego.leader.is_some();
        let ahead = ego.leader.as_ref().is_some_and(|leader| leader.keeps_gap);
        Self { slot: ego.slot, heading: true, lane: leads || lanes.have_friction(), stop: leads, slope, ahead }
    }

    /// What is asked of it now.
    pub fn now(ego: &Ego, block: &Block, lanes: &Lanes, slope: bool) -> Self {
        Self { heading: !block.stands(ego.slot.lane()), ..Self::whole(ego, lanes, slope) }
    }
}

impl Observation<'_> {
    /// Writes what SUMO shows into the ego and its columns, before the body follows it.
    pub fn apply(self, ego: &mut Ego, block: &mut Block, lanes: &mut Lanes, step_s: f64) {
        let lane = ego.slot.lane();
        if let Some(id) = self.lane {
            lanes.see(ego, block, id);
        }
        if let Some(slope_deg) = self.slope_deg {
            block.set_grade(lane, slope_deg.to_radians());
        }
        let Some(speed_mps) = self.speed_mps else {
            if ego.presence == Presence::Driving {
                ego.presence = Presence::Teleporting;
                block.vanish(lane);
            }
            return;
        };
        if ego.presence == Presence::Teleporting {
            ego.presence = Presence::Driving;
            ego.carried = true;
            block.appear(lane, speed_mps);
        }
        block.see_speed(lane, speed_mps);
        // SUMO: clockwise from north. ISO: left positive; the offset does not matter for a change.
        block.see_heading(lane, self.heading_deg.map(|heading| -heading.to_radians()), step_s);
        match &mut ego.leader {
            None => block.set_target(lane, speed_mps, Bound::Traffic),
            Some(leader) => {
                leader.see_ahead(self.ahead.map(|ahead| (ahead.id, ahead.gap_m)), step_s);
                leader.lose_time(speed_mps, self.stop.is_some_and(|bits| bits & STOPPED != 0), step_s);
                if leader.see_speed(speed_mps) {
                    block.set_bound(lane, Bound::Clamp);
                }
            }
        }
    }
}
