//! Fleet and SUMO, stepping together. [`World::step`] is one SUMO step from its beginning to its end; everything that it
//! calls stands in a file of its own.

use super::admission::{Admission, Newcomer, Wanted};
use super::body_leads::BodyLeads;
use super::changes;
use super::chunk::{Chunk, blocks_of, share_out};
use super::display::Display;
use super::egos::{Ego, EgoTable, Presence};
use super::error::CosimError;
use super::events::Events;
use super::following::note_speeds;
use super::lanes::Lanes;
use super::leader::Leader;
use super::link::Link;
use super::newcomers::ego_of;
use super::observation::EgoQuestion;
use super::orders::{Hand, Orders};
use super::places::{Place, places};
use super::question::NoAnswer;
use super::readings::{ReadingQuestion, Readings};
use super::records::{Finished, Reason, Records};
use super::setup::WorldSetup;
use super::sumo::{Sumo, Tell};
use crate::fleet::block::Block;
use crate::fleet::follow::Follow;
use crate::fleet::{Fleet, Slot};
use crate::scenario::{Trace, TraceRows};
use crate::traci::Client;
use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;

/// Fleet and SUMO, stepping together.
pub struct World<S: Sumo = Link> {
    sumo: S,
    fleet: Fleet,
    egos: EgoTable,
    events: Events,
    admission: Admission,
    body_leads: BodyLeads,
    lanes: Lanes,
    readings: Readings,
    /// Who follows whom is kept.
    platoons: bool,
    records: Records,
    /// The chunks of the last step, whose memory the next one uses.
    chunks: Vec<Chunk<S>>,
    /// The same for the readings.
    readings_room: S::Asked<ReadingQuestion>,
    /// Egos that got a body since [`World::take_admitted`].
    admitted: Vec<Arc<str>>,
    /// Egos that SUMO has not been told of yet.
    newcomers: Vec<Slot>,
    /// Egos that SUMO did not know any more.
    lost: Vec<Slot>,
    trace: (Trace, TraceRows),
    /// What a caller has ordered for single vehicles.
    orders: Orders,
    grade: bool,
    sigma: Option<f64>,
    display: Display,
    step_s: f64,
    /// Control periods in a step.
    periods: u32,
    steps: u64,
}

impl World {
    /// Joins SUMO over TraCI, and finds the vehicles that are there.
    ///
    /// # Errors
    /// If SUMO does not answer, or its step is not a whole number of control periods.
    pub async fn join(client: Client, setup: WorldSetup) -> Result<Self, CosimError> {
        Self::over(Link::traci(client, setup.shared), setup).await
    }
}

impl<S: Sumo> World<S> {
    /// The same over any implementation of the seam.
    ///
    /// # Errors
    /// As [`World::join`].
    pub async fn over(mut sumo: S, setup: WorldSetup) -> Result<Self, CosimError> {
        let joined = sumo.join().await?;
        let (step_s, period_s) = (joined.step_s, setup.loop_config.period_s);
        let periods = (step_s / period_s).round();
        if periods < 1.0 || (periods * period_s - step_s).abs() > 1e-9 {
            return Err(CosimError::Step { step_s, period_s });
        }
        let trace_s = setup.trace.1.unwrap_or(step_s);
        let rows = TraceRows::every(trace_s, step_s, period_s)
            .map_err(|wanted| CosimError::TracePeriod { trace_s, wanted })?;
        let body_leads = BodyLeads::new(setup.targets);
        let wanted = Wanted {
            before: body_leads.anywhere(),
            lane: body_leads.anywhere() || setup.friction,
            imperfection: setup.sigma.is_some(),
            headway: setup.rules.headway.is_some(),
            mass: joined.tells_mass,
            colour: setup.display.colours,
        };
        let mut admission = Admission::new(setup.rules, wanted);
        let mut records = Records::default();
        records.counters.present = joined.present.len() as u64;
        admission.wait(joined.present);
        Ok(Self {
            sumo,
            fleet: Fleet::new(setup.loop_config, setup.blocks).rated(setup.quality),
            egos: EgoTable::default(),
            events: Events { time_s: joined.time_s, expected: joined.expected, ..Events::default() },
            admission,
            body_leads,
            lanes: Lanes::new(setup.friction),
            readings: Readings::every_second(step_s, setup.platoons),
            platoons: setup.platoons,
            records,
            chunks: Vec::new(),
            readings_room: Default::default(),
            admitted: Vec::new(),
            newcomers: Vec::new(),
            lost: Vec::new(),
            trace: (setup.trace.0, rows),
            orders: Orders::default(),
            grade: setup.grade,
            sigma: setup.sigma,
            display: setup.display,
            step_s,
            periods: periods as u32,
            steps: 0,
        })
    }

    /// One SUMO step.
    ///
    /// # Errors
    /// If SUMO ends, answers nonsense, or a newcomer's parameters are wrong.
    pub async fn step(&mut self) -> Result<(), CosimError> {
        self.admit_newcomers().await?;
        self.lanes.learn(&mut self.sumo, &mut self.egos, &mut self.fleet).await?;
        self.body_leads.advance(&mut self.fleet, &mut self.egos, self.periods);
        self.tell_before_step()?;
        let step = self.sumo.step().await?;
        self.sumo.events(step, &mut self.events).await?;
        self.steps += 1;
        self.lost.clear();
        // Before records end: they tell in how many collisions their vehicle was.
        self.records.count_collisions(&self.events.collisions);
        self.settle_departures_and_arrivals();
        // Only now: each question about a vehicle that has left would be an error in SUMO's log.
        let mut chunks = self.ask_egos()?;
        let departed = self.admission.ask(&mut self.sumo, &mut self.records.counters)?;
        let (are_due, room) = (self.readings.are_due(self.steps), std::mem::take(&mut self.readings_room));
        let readings = self.readings.ask(are_due, room, &mut self.sumo, &self.egos)?;
        // In a collision or a teleport vehicles of other chunks matter: then all answers are heard before any body drives.
        if !self.events.is_quiet() {
            for chunk in &mut chunks {
                self.hear(chunk).await?;
            }
        }
        self.settle_teleports();
        for (place, chunk) in chunks.iter_mut().enumerate() {
            if place > 0 {
                // While this chunk drives, SUMO takes the speeds of the one before. Those of the last go with the next step.
                self.sumo.hand_over().await?;
            }
            self.hear(chunk).await?;
            self.end_lost();
            self.drive(place, &chunk.members)?;
            self.tell(&chunk.members)?;
        }
        if self.platoons {
            note_speeds(&mut self.egos, &self.fleet, self.step_s);
        }
        self.chunks = chunks;
        self.admission.hear(&mut self.sumo, departed, &mut self.records.counters).await?;
        self.hear_readings(readings).await
    }

    /// Gives a slot and a body to every vehicle that has departed and is to be an ego.
    async fn admit_newcomers(&mut self) -> Result<(), CosimError> {
        for Newcomer { mut departed, group, action_step_s, headway_s, setup } in
            self.admission.decide(&mut self.sumo, &mut self.records.counters).await?
        {
            let speed_mps = setup.speed_mps;
            let slot = self.fleet.admit(group, setup);
            if let (TraceRows::Periods(periods), true) = (self.trace.1, self.trace.0.names(&departed.object.id)) {
                self.fleet.block_mut(slot).watch(slot.lane(), periods);
            }
            let before = departed.before.take().filter(|_| self.body_leads.in_group(group));
            let leader = before.map(|before| Box::new(Leader::new(before, speed_mps, self.body_leads.target(group))));
            self.admitted.push(departed.object.id.clone());
            self.newcomers.push(slot);
            // It was inserted at the end of the step before the one that it will move in.
            let depart_s = self.events.time_s - if self.steps > 0 { self.step_s } else { 0.0 };
            let keeps_plan = action_step_s > 1.5 * self.step_s;
            let mut ego = Ego { keeps_plan, leader, headway_s, ..ego_of(departed, (group, slot), depart_s) };
            if !ego.lane.is_empty() {
                self.lanes.arrive(&mut ego, self.fleet.block_mut(slot));
            }
            self.egos.insert(ego);
        }
        Ok(())
    }

    /// Tells SUMO what it must know before the step: what changes on newcomers, their speeds, and the commands of the
    /// bodies that lead. All other speeds were told after the last step.
    fn tell_before_step(&mut self) -> Result<(), CosimError> {
        let newcomers = std::mem::take(&mut self.newcomers);
        for ego in newcomers.iter().filter_map(|slot| self.egos.get(*slot)) {
            changes::make(&mut self.sumo, ego, self.sigma)?;
            if let Some(leader) = &ego.leader {
                let limits_mps2 = self.fleet.block(ego.slot).acceleration_limits_mps2(ego.slot.lane());
                leader.take_over(&mut self.sumo, &ego.object, limits_mps2)?;
            } else {
                self.sumo.tell(&ego.object, self.speed_of(ego))?;
            }
            self.sumo.watch(&ego.object, &EgoQuestion::whole(ego, &self.lanes, self.grade))?;
        }
        let driving = |ego: &&Ego| self.body_leads.anywhere() && ego.presence == Presence::Driving;
        for ego in self.egos.iter().filter(driving) {
            if let Some(leader) = &ego.leader {
                self.sumo.tell(&ego.object, leader.command())?;
            }
        }
        Ok(())
    }

    /// The body's speed and mean acceleration over the last step. Between the decisions of a driver SUMO goes on with the
    /// acceleration that it is told: then that is the driver's own.
    fn speed_of(&self, ego: &Ego) -> Tell {
        let (block, lane) = (self.fleet.block(ego.slot), ego.slot.lane());
        let acceleration_mps2 = if ego.keeps_plan { block.asked_mps2(lane) } else { block.acceleration_mps2(lane) };
        Tell::PreviousSpeed(block.speed_mps(lane), acceleration_mps2)
    }

    /// Asks about every ego, chunk by chunk.
    fn ask_egos(&mut self) -> Result<Vec<Chunk<S>>, CosimError> {
        let mut chunks = std::mem::take(&mut self.chunks);
        share_out(&self.egos, &self.fleet, &mut chunks);
        for chunk in &mut chunks {
            let egos = chunk.members.iter().filter_map(|slot| self.egos.get(*slot));
            let (fleet, lanes) = (&self.fleet, &self.lanes);
            let question = |ego: &Ego| EgoQuestion::now(ego, fleet.block(ego.slot), lanes, self.grade);
            let questions = egos.map(|ego| (&ego.object, question(ego)));
            chunk.asked = self.sumo.ask_in(std::mem::take(&mut chunk.asked), questions)?;
            chunk.is_heard = false;
        }
        Ok(chunks)
    }

    /// Takes what SUMO shows of a chunk, unless that was done before.
    async fn hear(&mut self, chunk: &mut Chunk<S>) -> Result<(), CosimError> {
        if std::mem::replace(&mut chunk.is_heard, true) {
            return Ok(());
        }
        let Self { egos, fleet, lost, lanes, step_s, .. } = self;
        let answers = self.sumo.answers(std::mem::take(&mut chunk.asked), |EgoQuestion { slot, .. }, answer| {
            match (answer, egos.get_mut(slot)) {
                (Ok(seen), Some(ego)) => seen.apply(ego, fleet.block_mut(slot), lanes, *step_s),
                (Err(NoAnswer::Gone), Some(_)) => lost.push(slot),
                // Its record has ended.
                (_, None) | (Err(NoAnswer::Unaskable(_)), _) => {}
            }
        });
        chunk.asked = answers.await?;
        Ok(())
    }

    /// Counts departures, arrivals and teleports, and ends the records of egos that arrived.
    fn settle_departures_and_arrivals(&mut self) {
        let counters = &mut self.records.counters;
        counters.departed += self.events.departed.len() as u64;
        counters.arrived += self.events.arrived.len() as u64;
        counters.teleports += self.events.teleported.len() as u64;
        for id in &self.events.teleported {
            if let Some(ego) = self.egos.find_mut(id) {
                ego.teleported = true;
            }
        }
        let found = std::mem::take(&mut self.events.found);
        counters.present += found.len() as u64;
        self.admission.wait(self.events.departed.drain(..).chain(found));
        for id in std::mem::take(&mut self.events.arrived) {
            self.admission.forget(&id);
            if let Some(ego) = self.egos.find(&id) {
                let reason = match ego.presence {
                    Presence::Driving => Reason::Arrived,
                    Presence::Teleporting if ego.teleported => Reason::TeleportedOut,
                    // Off the road, and not by a teleport: somebody (a calibrator, say) took it out.
                    Presence::Teleporting => Reason::Removed,
                };
                self.end(ego.slot, reason);
            }
        }
    }

    /// Vehicles that were carried and put down within the step: another place, another speed.
    fn settle_teleports(&mut self) {
        for id in &self.events.teleported {
            let Some(ego) = self.egos.find_mut(id) else { continue };
            if ego.presence == Presence::Driving {
                let (block, lane) = (self.fleet.block_mut(ego.slot), ego.slot.lane());
                let speed_mps = block.sumo_mps(lane);
                block.appear(lane, speed_mps);
                ego.carried = true;
            }
        }
    }

    fn end_lost(&mut self) {
        while let Some(slot) = self.lost.pop() {
            self.end(slot, Reason::Removed);
        }
    }

    /// The bodies of a chunk drive the step that SUMO has just done, towards the speeds that it chose.
    fn drive(&mut self, place: usize, members: &[Slot]) -> Result<(), CosimError> {
        let blocks = blocks_of(place, &self.fleet);
        let body_leads = &self.body_leads;
        let follows = |block: &Block| !body_leads.in_group(block.group());
        self.fleet.advance_among(blocks.clone(), self.periods, follows, Follow::Traffic);
        self.fleet.close_step_among(blocks);
        for slot in members {
            let Some(ego) = self.egos.get_mut(*slot) else { continue };
            let (block, lane) = (self.fleet.block(*slot), slot.lane());
            if ego.presence == Presence::Driving {
                ego.creep.note(block.speed_mps(lane), self.step_s);
                ego.watch.note(block, lane, self.step_s, self.events.time_s);
            }
            if !block.is_sound(lane) {
                self.end(*slot, Reason::Diverged);
            }
        }
        Ok(self.fleet.soundness()?)
    }

    /// Tells SUMO the speeds of a chunk's bodies. A body that stood all through the step, as SUMO's car did, has nothing to
    /// tell.
    fn tell(&mut self, members: &[Slot]) -> Result<(), CosimError> {
        let egos = members.iter().filter_map(|slot| self.egos.get(*slot));
        for ego in egos.filter(|ego| ego.leader.is_none() && ego.presence == Presence::Driving) {
            if !self.fleet.block(ego.slot).rests(ego.slot.lane()) {
                self.sumo.tell(&ego.object, self.speed_of(ego))?;
            }
        }
        for slot in members.iter().filter(|_| self.display.is_on()) {
            if let Some(ego) = self.egos.get_mut(*slot) {
                self.display.show(&mut self.sumo, ego, self.fleet.block(*slot))?;
            }
        }
        Ok(())
    }

    async fn hear_readings(&mut self, asked: S::Asked<ReadingQuestion>) -> Result<(), CosimError> {
        let Self { sumo, egos, fleet, records, .. } = self;
        self.readings_room = Readings::hear(asked, sumo, egos, fleet, &mut records.roads).await?;
        Ok(())
    }

    fn end(&mut self, slot: Slot, reason: Reason) {
        if let Some(ego) = self.egos.remove(slot) {
            self.records.end(ego, &mut self.fleet, self.events.time_s, reason);
        }
    }

    /// Ends every record: the run is over.
    pub fn end_all(&mut self, reason: Reason) {
        for slot in self.egos.slots().collect::<Vec<_>>() {
            self.end(slot, reason);
        }
    }

    /// Reads odometers and roads once more, gives every vehicle back to SUMO as it was, and ends all records.
    ///
    /// # Errors
    /// If SUMO has ended.
    pub async fn hand_back(&mut self) -> Result<(), CosimError> {
        // Who departed in the last step has a record too, without samples.
        self.admit_newcomers().await?;
        let readings = self.readings.ask(true, Default::default(), &mut self.sumo, &self.egos)?;
        self.hear_readings(readings).await?;
        for ego in self.egos.iter() {
            changes::undo(&mut self.sumo, ego)?;
        }
        self.sumo.leave().await?;
        self.end_all(Reason::Running);
        Ok(())
    }

    /// Asks where those egos are that `wanted` names, at the end of the last step. An ego that SUMO carries has no place.
    ///
    /// # Errors
    /// If SUMO has ended.
    pub async fn places(&mut self, wanted: impl Fn(&Ego) -> bool) -> Result<HashMap<Arc<str>, Place>, CosimError> {
        places(&mut self.sumo, &self.egos, wanted).await
    }

    /// Leaves SUMO. What was computed comes back also if SUMO does not answer.
    pub async fn close(self) -> (Records, Result<(), CosimError>) {
        (self.records, self.sumo.close().await)
    }

    /// What is known when SUMO cannot be left in order any more.
    pub fn abandon(&mut self) -> Records {
        self.end_all(Reason::Incomplete);
        std::mem::take(&mut self.records)
    }

    /// Simulation time at the end of the last step \[s\].
    pub fn time_s(&self) -> f64 {
        self.events.time_s
    }

    /// Whose trajectories are wanted, and when.
    pub fn trace(&self) -> &(Trace, TraceRows) {
        &self.trace
    }

    /// SUMO's step \[s\].
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Control period \[s\].
    pub fn period_s(&self) -> f64 {
        self.fleet.period_s()
    }

    /// Number of vehicles that are on the road or still to come.
    pub fn expected(&self) -> i32 {
        self.events.expected
    }

    /// Records that have ended, sums by road, and counters.
    pub fn records(&self) -> &Records {
        &self.records
    }

    /// Takes the records that have ended since they were last taken.
    pub fn take_finished(&mut self) -> Vec<Finished> {
        std::mem::take(&mut self.records.finished)
    }

    /// Takes the ids of the egos that got a body since they were last taken.
    pub fn take_admitted(&mut self) -> Vec<Arc<str>> {
        std::mem::take(&mut self.admitted)
    }

    /// Takes one order for a single vehicle.
    pub fn hand(&mut self) -> Hand<'_, S> {
        let Self { sumo, fleet, egos, admission, orders, .. } = self;
        Hand { sumo, fleet, egos, admission, orders }
    }

    /// For whom anything was ordered so far.
    pub fn orders(&self) -> &Orders {
        &self.orders
    }

    /// SUMO itself, to be asked for more between the steps.
    pub fn sumo_mut(&mut self) -> &mut S {
        &mut self.sumo
    }

    /// The egos, in the order of their admission.
    pub fn egos(&self) -> &EgoTable {
        &self.egos
    }

    /// The egos that are on the road, in the order of their admission, with the blocks of their slots.
    pub fn driving(&self) -> impl Iterator<Item = (&Ego, &Block)> {
        let egos = self.egos.iter().filter(|ego| ego.presence == Presence::Driving);
        egos.map(|ego| (ego, self.fleet.block(ego.slot)))
    }

    /// From now on the fleet notes where its time goes, [`Fleet::time_spent`].
    pub fn time_fleet(&mut self) {
        self.fleet.time_yourself();
    }

    /// The vehicles of all groups.
    pub fn fleet(&self) -> &Fleet {
        &self.fleet
    }

    /// Time spent waiting for SUMO so far.
    pub fn waited(&self) -> Duration {
        self.sumo.waited()
    }
}
