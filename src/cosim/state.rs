//! What the replies say, slot by slot, and the fleet that follows them: departures, arrivals, teleports, clamps,
//! odometers, roads and collisions.

use super::book::{Book, Ego, EgoKey, Presence};
use super::convoy::Member;
use super::roads::Roads;
use super::seen::{Seen, Values, seen};
use super::{CosimError, variable};
use crate::fleet::follow::{Bound, Follow};
use crate::fleet::{self, Fleet, GroupSetup, LoopConfig};
use crate::output::Reason;
use crate::reference::Target;
use crate::stats::VehicleStats;
use crate::traci::{Block, Domain, Reply};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// A reply's speed this far below the command means that SUMO clamped it [m/s].
const CLAMP_MPS: f64 = 1e-6;

/// One ego's record when its time is over.
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
    /// Why the record ends.
    pub reason: Reason,
    /// Its statistics.
    pub stats: VehicleStats,
    /// ∫V_x dt \[m\].
    pub distance_m: f64,
    /// SUMO's odometer minus that \[m\].
    pub odometer_gap_m: Option<f64>,
    /// Number of pairs of colliding vehicles that it was in.
    pub collisions: u32,
}

/// The fleet's side of the coupling.
pub struct State {
    /// Bodies and controllers.
    pub fleet: Fleet,
    /// Who is on the road.
    pub book: Book,
    /// Bodies feel the slope of SUMO's road.
    pub grade: bool,
    /// Simulation time at the end of the last step \[s\].
    pub time_s: f64,
    /// SUMO's step \[s\].
    pub step_s: f64,
    /// Vehicles that SUMO still expects.
    pub expected: i32,
    /// Egos that got a body since they were last taken.
    pub admitted: Vec<Arc<str>>,
    /// Records that have ended since they were last taken.
    pub finished: Vec<Finished>,
    /// Tables by road.
    pub roads: Roads,
    /// Departed vehicles without a body of ours, by vClass.
    pub others: BTreeMap<String, u64>,
    /// Departed vehicles that the selectors left to SUMO.
    pub unequipped: u64,
    /// Departed vehicles that were to be egos but cannot be, with the reason.
    pub refused: Vec<(String, String)>,
    /// Vehicles that departed, all of them.
    pub departed: u64,
    /// Vehicles that arrived, all of them.
    pub arrived: u64,
    /// Teleports that started.
    pub teleports: u64,
    pub(super) targets: Vec<Target>,
    /// Departed vehicles that are not decided on yet.
    pub(super) waiting: Vec<String>,
    pub(super) unknown_lanes: Vec<String>,
    pub(super) lane_limits_mps: HashMap<String, f64>,
    pub(super) colliding: bool,
    pairs: HashSet<(String, String)>,
    collisions: HashMap<String, u32>,
    came: Vec<String>,
    left: Vec<String>,
    carried: Vec<String>,
    lost: Vec<EgoKey>,
    periods: u32,
    step: u64,
    read_every: u64,
}

impl State {
    /// An empty fleet beside a SUMO at `time_s` with steps of `step_s` \[s\].
    ///
    /// # Errors
    /// If the step is not a whole number of control periods.
    pub fn new(
        loop_config: LoopConfig,
        blocks: Vec<GroupSetup>,
        targets: Vec<Target>,
        step_s: f64,
        time_s: f64,
    ) -> Result<Self, CosimError> {
        let period_s = loop_config.period_s;
        let periods = (step_s / period_s).round();
        if periods < 1.0 || (periods * period_s - step_s).abs() > 1e-9 {
            return Err(CosimError::Step { step_s, period_s });
        }
        Ok(Self {
            fleet: Fleet::new(loop_config, blocks),
            book: Book::default(),
            grade: false,
            time_s,
            step_s,
            expected: 0,
            admitted: Vec::new(),
            finished: Vec::new(),
            roads: Roads::default(),
            others: BTreeMap::new(),
            unequipped: 0,
            refused: Vec::new(),
            departed: 0,
            arrived: 0,
            teleports: 0,
            targets,
            waiting: Vec::new(),
            unknown_lanes: Vec::new(),
            lane_limits_mps: HashMap::new(),
            colliding: false,
            pairs: HashSet::new(),
            collisions: HashMap::new(),
            came: Vec::new(),
            left: Vec::new(),
            carried: Vec::new(),
            lost: Vec::new(),
            periods: periods as u32,
            step: 0,
            read_every: (1.0 / step_s).round().max(1.0) as u64,
        })
    }

    /// Pairs of vehicles that collided.
    pub fn collision_pairs(&self) -> usize {
        self.pairs.len()
    }

    /// True once SUMO has made a step with us.
    pub(super) fn has_stepped(&self) -> bool {
        self.step > 0
    }

    /// True if odometers and roads are to be read at the end of the step just made: once a second.
    pub(super) fn reads_now(&self) -> bool {
        self.step.is_multiple_of(self.read_every)
    }

    /// Steps so far.
    pub(super) fn steps(&self) -> u64 {
        self.step
    }

    /// True if nobody collided or was carried away in the step just read.
    pub(super) fn is_quiet(&self) -> bool {
        !self.colliding && self.carried.is_empty()
    }

    /// Reads the reply to a step.
    pub(super) fn absorb(&mut self, stepped: &Reply<'_>) -> Result<(), CosimError> {
        self.step += 1;
        self.book.rewind();
        self.lost.clear();
        self.colliding = false;
        for block in stepped.blocks() {
            let block = block?;
            match block.domain {
                Some(Domain::Simulation) => self.see_simulation(&block)?,
                Some(Domain::Vehicle) => self.see_vehicle(&block)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// Every client is sent every client's subscriptions: of what is here twice the last stays, what is not here is
    /// in another block.
    fn see_simulation(&mut self, block: &Block<'_>) -> Result<(), CosimError> {
        for entry in block.values() {
            let (id, Ok(value)) = entry? else { continue };
            let list = match id {
                variable::TIME => {
                    self.time_s = value.as_f64().unwrap_or(self.time_s);
                    continue;
                }
                variable::EXPECTED => {
                    self.expected = value.as_i32().unwrap_or(self.expected);
                    continue;
                }
                variable::COLLIDING => {
                    self.colliding = value.as_texts().into_iter().flatten().count() > 0;
                    continue;
                }
                variable::DEPARTED => &mut self.came,
                variable::ARRIVED => &mut self.left,
                variable::TELEPORT_START => &mut self.carried,
                _ => continue,
            };
            list.clear();
            list.extend(value.as_texts().into_iter().flatten().map(str::to_owned));
        }
        Ok(())
    }

    fn see_vehicle(&mut self, block: &Block<'_>) -> Result<(), CosimError> {
        match seen(block)? {
            Seen::Ours(values) => {
                if let Some(key) = self.book.next_in_reply(block.id) {
                    self.see(key, &values);
                }
            }
            Seen::Gone => self.lost.extend(self.book.next_in_reply(block.id)),
            Seen::Others => {}
        }
        Ok(())
    }

    /// Reads the answers to the gets of a convoy.
    pub(super) fn see_answers(&mut self, members: &[Member], reply: &Reply<'_>) {
        for member in members {
            let Some(ego) = self.book.get(member.key) else { continue };
            if reply.refusal(member.first).is_some() {
                self.lost.push(member.key);
                continue;
            }
            let leads = ego.lead.is_some();
            let angle_at = member.first + 1;
            let lane_at = angle_at + usize::from(member.heading);
            let values = Values {
                speed: reply.f64(member.first),
                angle: if member.heading { reply.f64(angle_at) } else { None },
                lane: if leads { reply.text(lane_at) } else { None },
                slope: if self.grade { reply.f64(lane_at + usize::from(leads)) } else { None },
            };
            self.see(member.key, &values);
        }
    }

    fn see(&mut self, key: EgoKey, values: &Values<'_>) {
        let ego = &mut self.book[key];
        ego.seen_in_step = self.step;
        see_lane(ego, values.lane, &self.lane_limits_mps, &mut self.unknown_lanes);
        if let Some(slope_deg) = values.slope {
            let slot = ego.slot;
            self.fleet.block_mut(slot).set_grade(slot.lane(), slope_deg.to_radians());
        }
        match values.speed {
            Some(speed_mps) => self.drive(key, speed_mps, values.angle),
            None => self.carry(key),
        }
    }

    /// The vehicle is on the road and SUMO tells its speed.
    fn drive(&mut self, key: EgoKey, speed_mps: f64, angle_deg: Option<f64>) {
        let ego = &mut self.book[key];
        let lane = ego.slot.lane();
        let block = self.fleet.block_mut(ego.slot);
        if ego.presence == Presence::Teleporting {
            ego.presence = Presence::Driving;
            block.appear(lane, speed_mps);
        }
        block.see_speed(lane, speed_mps);
        // SUMO: clockwise from north. ISO: left positive; the offset does not matter for a change.
        block.see_heading(lane, angle_deg.map(|angle| -angle.to_radians()), self.step_s);
        match &mut ego.lead {
            None => block.set_target(lane, speed_mps, Bound::Traffic),
            Some(lead) => {
                let clamped = speed_mps < lead.command_mps - CLAMP_MPS;
                lead.clamp_mps = clamped.then_some(speed_mps);
                if clamped {
                    block.set_bound(lane, Bound::Clamp);
                }
            }
        }
    }

    /// SUMO carries the vehicle: it has no speed and nothing of it moves.
    fn carry(&mut self, key: EgoKey) {
        let ego = &mut self.book[key];
        if ego.presence == Presence::Driving {
            ego.presence = Presence::Teleporting;
            self.fleet.block_mut(ego.slot).vanish(ego.slot.lane());
        }
    }

    /// Comings and goings of the step just read.
    pub(super) fn settle_events(&mut self) {
        self.departed += self.came.len() as u64;
        self.arrived += self.left.len() as u64;
        self.teleports += self.carried.len() as u64;
        for key in self.carried.iter().filter_map(|id| self.book.find(id)).collect::<Vec<_>>() {
            self.book[key].teleported = true;
        }
        for id in std::mem::take(&mut self.left) {
            // A vehicle can depart and arrive within one step; it never had a body.
            self.waiting.retain(|w| *w != id);
            self.came.retain(|c| *c != id);
            if let Some(key) = self.book.find(&id) {
                let ego = &self.book[key];
                let reason = match ego.presence {
                    Presence::Driving => Reason::Arrived,
                    Presence::Teleporting if ego.teleported => Reason::TeleportedOut,
                    // Off the road, and not by a teleport: somebody (a calibrator, say) took it out.
                    Presence::Teleporting => Reason::Removed,
                };
                self.end(key, reason);
            }
        }
        self.waiting.append(&mut self.came);
    }

    /// Vehicles that were carried in the step just read, once what SUMO shows of them is known.
    pub(super) fn settle_carried(&mut self) {
        for id in std::mem::take(&mut self.carried) {
            // Carried and put down within the step: another place, another speed.
            if let Some(key) = self.book.find(&id)
                && self.book[key].presence == Presence::Driving
            {
                let slot = self.book[key].slot;
                let block = self.fleet.block_mut(slot);
                let speed_mps = block.sumo_mps(slot.lane());
                block.appear(slot.lane(), speed_mps);
            }
        }
    }

    /// Vehicles that SUMO did not know any more.
    pub(super) fn settle_lost(&mut self) {
        while let Some(key) = self.lost.pop() {
            if self.book.contains(key) {
                self.end(key, Reason::Removed);
            }
        }
    }

    /// Vehicles that are subscribed to and of which the step said nothing.
    pub(super) fn settle_silent(&mut self) {
        let (book, step) = (&self.book, self.step);
        let silent: Vec<EgoKey> = book.keys().iter().copied().filter(|k| book[*k].seen_in_step < step).collect();
        for key in silent {
            self.end(key, Reason::Removed);
        }
    }

    /// Leaders drive the coming step: the body first, SUMO after it.
    pub(super) fn advance_leaders(&mut self) {
        if self.targets.iter().all(|t| matches!(t, Target::Traffic)) {
            return;
        }
        for index in 0..self.book.len() {
            let ego = self.book.at(index);
            let Some(lead) = &ego.lead else { continue };
            let block = self.fleet.block_mut(ego.slot);
            let (limit_mps, bound) = match &self.targets[ego.group] {
                Target::Profile(_) => (f64::INFINITY, Bound::Profile),
                _ => (lead.limit_mps * lead.before.speed_factor, Bound::Limit),
            };
            match lead.clamp_mps {
                Some(clamp_mps) if clamp_mps < limit_mps => block.set_target(ego.slot.lane(), clamp_mps, Bound::Clamp),
                _ => block.set_target(ego.slot.lane(), limit_mps, bound),
            }
        }
        for (group, target) in self.targets.iter().enumerate() {
            let follow = match target {
                Target::Traffic => continue,
                Target::Limit => Follow::Target,
                Target::Profile(profile) => Follow::Profile(profile),
            };
            self.fleet.advance(self.periods, |b| b.group() == group, follow);
        }
        for index in 0..self.book.len() {
            let ego = self.book.at(index);
            let Some(lead) = &mut ego.lead else { continue };
            let speed_mps = self.fleet.block(ego.slot).speed_mps(ego.slot.lane());
            // A car that SUMO holds has to ask whether it may go, or it would stand for ever.
            let probe = if lead.clamp_mps == Some(0.0) { super::lead::PROBE_MPS } else { 0.0 };
            lead.command_mps = speed_mps.max(probe);
        }
    }

    /// The followers in `blocks`, which are among `members`, drive the step that SUMO has just done towards the speed
    /// that it chose.
    pub(super) fn advance_followers(&mut self, blocks: Range<usize>, members: &[Member], follow: Follow) {
        let targets = &self.targets;
        let follows = |block: &fleet::block::Block| matches!(targets[block.group()], Target::Traffic);
        self.fleet.advance_among(blocks.clone(), self.periods, follows, follow);
        self.fleet.close_step_among(blocks);
        for Member { key, .. } in members {
            let sound = |ego: &Ego| self.fleet.block(ego.slot).is_sound(ego.slot.lane());
            if self.book.get(*key).is_some_and(|ego| !sound(ego)) {
                self.end(*key, Reason::Diverged);
            }
        }
    }

    /// Odometers and roads of egos, two answers each in order; bodies and SUMO's cars are at the same instant.
    pub(super) fn take_readings(&mut self, egos: &[EgoKey], reply: &Reply<'_>) {
        for (index, key) in egos.iter().enumerate() {
            if !self.book.contains(*key) {
                continue;
            }
            let ego = &mut self.book[*key];
            let lane = ego.slot.lane();
            let block = self.fleet.block_mut(ego.slot);
            if let Some(odometer_m) = reply.f64(2 * index) {
                ego.odometer_gap_m = Some(odometer_m - ego.odometer_offset_m - block.distance_m(lane));
            }
            if let Some(road) = reply.text(2 * index + 1).filter(|r| !r.is_empty()) {
                let sums = block.take_sums(lane);
                let edge = self.roads.index(road);
                ego.edge = Some(edge);
                self.roads.add(edge, &sums);
            }
        }
    }

    /// Limits that have become known.
    pub(super) fn renew_limits(&mut self) {
        for index in 0..self.book.len() {
            let ego = self.book.at(index);
            if let (Some(lead), Some(limit)) =
                (&mut ego.lead, ego.lane.as_ref().and_then(|l| self.lane_limits_mps.get(l)))
            {
                lead.limit_mps = *limit;
            }
        }
    }

    /// Adds this step's colliding pairs to those known.
    pub(super) fn count_collisions<'a>(&mut self, pairs: impl Iterator<Item = (&'a str, &'a str)>) {
        for (a, b) in pairs {
            let pair = if a <= b { (a.to_owned(), b.to_owned()) } else { (b.to_owned(), a.to_owned()) };
            if self.pairs.insert(pair) {
                for id in [a, b] {
                    *self.collisions.entry(id.to_owned()).or_default() += 1;
                }
            }
        }
    }

    fn end(&mut self, key: EgoKey, reason: Reason) {
        let Some(ego) = self.book.remove(key) else { return };
        let block = self.fleet.block_mut(ego.slot);
        let distance_m = block.distance_m(ego.slot.lane());
        if let Some(edge) = ego.edge {
            let sums = block.take_sums(ego.slot.lane());
            self.roads.add(edge, &sums);
        }
        let stats = self.fleet.release(ego.slot);
        self.finished.push(Finished {
            collisions: self.collisions.get(&*ego.id).copied().unwrap_or(0),
            id: ego.id,
            type_id: ego.type_id,
            group: ego.group,
            depart_s: ego.depart_s,
            arrival_s: matches!(reason, Reason::Arrived | Reason::TeleportedOut).then_some(self.time_s),
            reason,
            stats,
            distance_m,
            odometer_gap_m: ego.odometer_gap_m,
        });
    }

    /// Ends every record: the run is over.
    pub fn end_all(&mut self, reason: Reason) {
        for key in self.book.keys().to_vec() {
            self.end(key, reason);
        }
    }
}

fn see_lane(ego: &mut Ego, lane: Option<&str>, limits_mps: &HashMap<String, f64>, unknown: &mut Vec<String>) {
    let (Some(lead), Some(lane)) = (&mut ego.lead, lane.filter(|l| !l.is_empty())) else { return };
    if ego.lane.as_deref() == Some(lane) {
        return;
    }
    match limits_mps.get(lane) {
        Some(limit) => lead.limit_mps = *limit,
        None if !unknown.iter().any(|u| u == lane) => unknown.push(lane.to_owned()),
        None => {}
    }
    ego.lane = Some(lane.to_owned());
}
