//! The coupling of fleet and SUMO, in every SUMO step:
//!
//! 1. For every ego `setPreviousSpeed(V, a)`: SUMO takes the body's speed for the car's. Then the step; and while
//!    SUMO makes it, messages that ask every ego for its speed and heading. (Where other clients share SUMO,
//!    newcomers are subscribed to instead.)
//! 2. The speed that comes back is v*, what SUMO's car-following, lights, right of way and stops chose from there.
//! 3. Body and controller run the *same* interval after the reply, along the ramp to v* (see
//!    [`crate::fleet::block`]). The speed they reach is sent at once.
//!
//! The egos go through 2 and 3 in companies (`convoy`): SUMO looks up and takes the values of one while the bodies of
//! another drive. Nothing waits for SUMO but the step itself.
//!
//! The two loops that come to mind first do not work: commanding `setSpeed` with a speed derived from SUMO's "speed
//! without TraCI" freezes every car, because SUMO bounds that value by the command itself; and handing v* to the
//! controller as a step makes cars creep, because v* is never more than a·dt ahead.
//!
//! Targets `limit` and `profile` turn the order round: the body runs first and leads, SUMO is told `setSpeed`
//! ([`lead`]).

pub mod bodies;
pub mod book;
mod convoy;
pub mod lead;
pub mod newcomers;
mod roads;
mod seen;
pub mod self_check;
pub mod state;

use crate::fleet::follow::Follow;
use crate::fleet::{GroupSetup, LoopConfig};
use crate::output::Reason;
use crate::plant::tyre::TyreError;
use crate::reference::Target;
use crate::registry::UnknownName;
use crate::scenario::{Group, Selector};
use crate::sumo_files::Equipped;
use crate::traci::{self, Batch, Client, Domain};
use book::{Ego, EgoKey, Presence};
use convoy::{Convoy, Member};
use newcomers::{Facts, Questions, TypeBook};
use state::State;

/// TraCI variables that are read in every step.
mod variable {
    pub const SPEED: u8 = 0x40;
    pub const SPEED_WITHOUT_TRACI: u8 = 0xb1;
    pub const ANGLE: u8 = 0x43;
    pub const SLOPE: u8 = 0x36;
    pub const LANE_ID: u8 = 0x51;
    pub const TIME: u8 = 0x66;
    pub const DEPARTED: u8 = 0x74;
    pub const ARRIVED: u8 = 0x7a;
    pub const TELEPORT_START: u8 = 0x76;
    pub const COLLIDING: u8 = 0x81;
    pub const EXPECTED: u8 = 0x7d;
}

/// What can go wrong between fleet and SUMO.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CosimError {
    /// The connection, or SUMO.
    #[error(transparent)]
    Traci(#[from] traci::Error),
    /// A batch that must not be sent.
    #[error(transparent)]
    Batch(#[from] traci::BatchError),
    /// Bytes that are not TraCI.
    #[error("SUMO's answer cannot be understood: {0}")]
    Decode(#[from] traci::wire::DecodeError),
    /// A name that no registry has.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// A measured tyre curve.
    #[error("vehicle.tyre_curve: {0}")]
    Tyre(#[from] TyreError),
    /// A `mfc.*` parameter of a vehicle or vType.
    #[error("vehicle \"{vehicle}\", parameter {key}: found \"{found}\", wanted {wanted}")]
    Parameter {
        /// The vehicle.
        vehicle: String,
        /// The parameter.
        key: String,
        /// Its value.
        found: String,
        /// What it should be.
        wanted: String,
    },
    /// SUMO's step is not a whole number of control periods.
    #[error("SUMO steps by {step_s} s, which is not a whole number of control periods of {period_s} s")]
    Step {
        /// SUMO's step \[s\].
        step_s: f64,
        /// Control period \[s\].
        period_s: f64,
    },
}

/// Ways to get the coupling wrong, so that the self-check can be shown to notice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Fault {
    /// None: the contract.
    #[default]
    None,
    /// v* is given to the controller as a step.
    StepReference,
    /// The target is "speed without TraCI" under `setSpeed`.
    SpeedWithoutTraci,
    /// The body's speed is not sent back.
    NotSentBack,
}

/// What a world is made of.
pub struct WorldSetup {
    /// The scenario's groups; the first whose selector matches takes a vehicle.
    pub groups: Vec<Group>,
    /// The target of each group.
    pub targets: Vec<Target>,
    /// The measured tyre curve of each group, if it has one.
    pub tyre_curves: Vec<Option<String>>,
    /// How each group's blocks are made.
    pub blocks: Vec<GroupSetup>,
    /// Which vehicles may become egos at all.
    pub egos: Selector,
    /// What the demand says of `has.mfc.device`.
    pub equipped: Equipped,
    /// Plant, control period, memory of the reference.
    pub loop_config: LoopConfig,
    /// Seed of everything that is drawn per vehicle.
    pub seed: u64,
    /// Bodies feel the slope of SUMO's road.
    pub grade: bool,
    /// Driver imperfection given to every ego, if any.
    pub sigma: Option<f64>,
    /// For the self-check.
    pub fault: Fault,
    /// True if other clients may be at this SUMO.
    pub shared: bool,
}

/// Fleet and SUMO, stepping together.
pub struct World {
    client: Client,
    batch: Batch,
    /// The step in a message of its own, if SUMO is shared with other clients: SUMO sends the answers to whatever stands
    /// before a step in the same message to the client that it serves next.
    step_apart: Option<Batch>,
    types: TypeBook,
    groups: Vec<Group>,
    tyre_curves: Vec<Option<String>>,
    egos: Selector,
    equipped: Equipped,
    seed: u64,
    sigma: Option<f64>,
    fault: Fault,
    /// The egos as they drive together, and the state of the book that this is for. Gets are cheaper for SUMO than
    /// subscriptions, but each one for a vehicle that arrived in the step is a line on SUMO's console: where SUMO is
    /// shared, and the console not ours, vehicles are subscribed to.
    convoys: Vec<Convoy>,
    convoys_for: u64,
    /// Asks for odometers and roads, and who it is about; empty if nothing is under way.
    readings: Batch,
    read: Vec<EgoKey>,
    /// Questions about vehicles that have departed, under way; and the answers that are there.
    asked: Vec<Questions>,
    facts: Vec<Facts>,
    /// Egos that SUMO has not been told of yet.
    newcomers: Vec<EgoKey>,
    /// What the replies said, and the fleet that follows them.
    pub state: State,
}

impl World {
    /// Joins SUMO: reads time and step length, subscribes to the simulation and finds the vehicles that are there.
    ///
    /// # Errors
    /// If SUMO does not answer, or its step is not a whole number of control periods.
    pub async fn join(mut client: Client, setup: WorldSetup) -> Result<Self, CosimError> {
        use variable::{ARRIVED, COLLIDING, DEPARTED, EXPECTED, TELEPORT_START, TIME};
        let step_s = client.get(traci::simulation::STEP_LENGTH, "").await?;
        let time_s = client.get(traci::simulation::TIME, "").await?;
        let mut state = State::new(setup.loop_config, setup.blocks, setup.targets, step_s, time_s)?;
        let mut batch = Batch::new();
        let events = [TIME, DEPARTED, ARRIVED, TELEPORT_START, COLLIDING, EXPECTED];
        batch.subscribe(Domain::Simulation, "", &events, time_s)?;
        let present = batch.get(traci::vehicle::IDS, "")?;
        let expected = batch.get(traci::simulation::EXPECTED, "")?;
        let reply = client.exchange(&batch).await?;
        state.grade = setup.grade;
        state.waiting = reply.get(present)?;
        state.expected = reply.get(expected)?;
        let mut step = Batch::new();
        step.step()?;
        Ok(Self {
            client,
            batch,
            step_apart: setup.shared.then_some(step),
            types: TypeBook::default(),
            groups: setup.groups,
            tyre_curves: setup.tyre_curves,
            egos: setup.egos,
            equipped: setup.equipped,
            seed: setup.seed,
            sigma: setup.sigma,
            fault: setup.fault,
            convoys: Vec::new(),
            convoys_for: 0,
            readings: Batch::new(),
            read: Vec::new(),
            asked: Vec::new(),
            facts: Vec::new(),
            newcomers: Vec::new(),
            state,
        })
    }

    /// The end that SUMO's configuration asks for \[s\]; negative without one.
    ///
    /// # Errors
    /// If SUMO does not answer.
    pub async fn end_s(&mut self) -> Result<f64, CosimError> {
        Ok(self.client.get(traci::simulation::END, "").await?)
    }

    /// One SUMO step.
    ///
    /// # Errors
    /// If SUMO ends, answers nonsense, or a newcomer's parameters are wrong.
    pub async fn step(&mut self) -> Result<(), CosimError> {
        self.admit_waiting().await?;
        self.learn_lane_limits().await?;
        self.state.advance_leaders();
        self.compose()?;
        self.ask().await?;
        let follow = if self.fault == Fault::StepReference { Follow::Target } else { Follow::Traffic };
        // A collision and a teleport are about vehicles that are in other convoys: then all is heard first.
        let at_once = !self.subscribes() && self.state.is_quiet();
        if at_once {
            self.state.settle_events();
        } else {
            for place in 0..self.convoys.len() {
                self.hear(place).await?;
            }
            if self.state.colliding {
                // Before the records of vehicles that a collision ended.
                self.count_collisions().await?;
            }
            self.state.settle_events();
            self.state.settle_carried();
        }
        if self.subscribes() {
            self.state.settle_silent();
        } else {
            self.ask_about_newcomers().await?;
        }
        self.ask_for_readings().await?;
        for place in 0..self.convoys.len() {
            if at_once {
                self.hear(place).await?;
            }
            self.state.settle_lost();
            self.state.advance_followers(convoy::blocks(place), &self.convoys[place].members, follow);
            self.tell(place).await?;
        }
        self.hear_of_newcomers().await?;
        self.hear_readings().await
    }

    /// Sends what was composed and reads what the step says.
    async fn ask(&mut self) -> Result<(), CosimError> {
        let step_apart = self.step_apart.as_ref();
        let first = Some(&self.batch).filter(|batch| !batch.is_empty());
        let told = self.client.under_way();
        self.client.send(first.into_iter().chain(step_apart)).await?;
        // SUMO is stepping from here on.
        let book = &self.state.book;
        if self.convoys_for != book.changes() {
            self.convoys_for = book.changes();
            convoy::form(&mut self.convoys, book);
        }
        if !self.subscribes() {
            self.convoys.iter_mut().try_for_each(|convoy| convoy.ask(&self.state))?;
            let gets = self.convoys.iter().map(|convoy| &convoy.gets).filter(|gets| !gets.is_empty());
            self.client.send(gets).await?;
        }
        for _ in 0..told {
            // A vehicle that declines is one that has left, and the next answer says so.
            self.client.receive().await?;
        }
        if first.is_some() {
            let answers = self.client.receive().await?;
            if step_apart.is_none() {
                return self.state.absorb(&answers);
            }
        }
        let stepped = self.client.receive().await?;
        self.state.absorb(&stepped)
    }

    /// Reads what SUMO shows of a convoy.
    async fn hear(&mut self, place: usize) -> Result<(), CosimError> {
        let convoy = &self.convoys[place];
        if !convoy.gets.is_empty() {
            let reply = self.client.receive().await?;
            self.state.see_answers(&convoy.members, &reply);
        }
        Ok(())
    }

    /// Sends the speeds of a convoy's bodies, so that SUMO takes them while the next convoy drives. The answers are read
    /// in the next step. A SUMO that is shared is told in the message of the step.
    async fn tell(&mut self, place: usize) -> Result<(), CosimError> {
        if self.subscribes() {
            return Ok(());
        }
        let convoy = &mut self.convoys[place];
        convoy.speeds.clear();
        for Member { key, .. } in &convoy.members {
            let Some(ego) = self.state.book.get(*key).filter(|ego| ego.lead.is_none()) else { continue };
            if !self.state.fleet.block(ego.slot).rests(ego.slot.lane()) {
                put_speed(&mut convoy.speeds, ego, &self.state, self.fault)?;
            }
            self.state.book[*key].told_after = Some(self.state.steps());
        }
        if !convoy.speeds.is_empty() {
            self.client.send([&convoy.speeds]).await?;
        }
        Ok(())
    }

    /// Asks for odometers and roads, once a second. SUMO looks them up while the bodies drive to the same instant.
    async fn ask_for_readings(&mut self) -> Result<(), CosimError> {
        if self.state.reads_now() {
            self.compose_readings()?;
            if !self.readings.is_empty() {
                self.client.send([&self.readings]).await?;
            }
        }
        Ok(())
    }

    fn compose_readings(&mut self) -> Result<(), CosimError> {
        self.readings.clear();
        self.read.clear();
        for key in self.state.book.keys() {
            let prefix = &self.state.book[*key].prefix;
            self.readings.get_by_prefix(traci::vehicle::DISTANCE, prefix)?;
            self.readings.get_by_prefix(traci::vehicle::ROAD, prefix)?;
            self.read.push(*key);
        }
        Ok(())
    }

    async fn hear_readings(&mut self) -> Result<(), CosimError> {
        if !self.read.is_empty() {
            let reply = self.client.receive().await?;
            self.state.take_readings(&self.read, &reply);
            self.read.clear();
        }
        Ok(())
    }

    /// Writes the message of a step.
    fn compose(&mut self) -> Result<(), CosimError> {
        self.batch.clear();
        let newcomers = std::mem::take(&mut self.newcomers);
        let state = &self.state;
        for key in &newcomers {
            lead::take_over(&mut self.batch, &state.book[*key], &state.fleet, self.sigma)?;
        }
        self.put_speeds()?;
        let state = &self.state;
        let to_subscribe = if self.subscribes() { &newcomers[..] } else { &[] };
        for key in to_subscribe {
            let ego = &state.book[*key];
            let speed =
                if self.fault == Fault::SpeedWithoutTraci { variable::SPEED_WITHOUT_TRACI } else { variable::SPEED };
            let mut wanted = vec![speed, variable::ANGLE];
            wanted.extend(ego.lead.is_some().then_some(variable::LANE_ID));
            wanted.extend(state.grade.then_some(variable::SLOPE));
            self.batch.subscribe(Domain::Vehicle, &ego.id, &wanted, state.time_s)?;
        }
        if self.step_apart.is_none() {
            self.batch.step()?;
        }
        Ok(())
    }

    /// True if vehicles are read by subscriptions: a shared SUMO, or the fault that reads something else.
    fn subscribes(&self) -> bool {
        self.step_apart.is_some() || self.fault == Fault::SpeedWithoutTraci
    }

    /// Tells SUMO the speeds of the bodies that it has not been told since the last step.
    fn put_speeds(&mut self) -> Result<(), CosimError> {
        let state = &self.state;
        for ego in state.book.iter().filter(|ego| ego.told_after != Some(state.steps())) {
            put_speed(&mut self.batch, ego, state, self.fault)?;
        }
        Ok(())
    }

    /// The limits of lanes that leading egos have come to.
    async fn learn_lane_limits(&mut self) -> Result<(), CosimError> {
        if self.state.unknown_lanes.is_empty() {
            return Ok(());
        }
        self.batch.clear();
        let lanes = std::mem::take(&mut self.state.unknown_lanes);
        let mut limits = Vec::with_capacity(lanes.len());
        for lane in &lanes {
            limits.push(self.batch.get(traci::lane::MAX_SPEED, lane)?);
        }
        let reply = self.client.exchange(&self.batch).await?;
        for (lane, limit) in lanes.into_iter().zip(limits) {
            self.state.lane_limits_mps.insert(lane, reply.get(limit)?);
        }
        self.state.renew_limits();
        Ok(())
    }

    async fn count_collisions(&mut self) -> Result<(), CosimError> {
        let collisions = self.client.get(traci::simulation::COLLISIONS, "").await?;
        self.state.count_collisions(collisions.iter().map(|c| (c.collider.as_str(), c.victim.as_str())));
        Ok(())
    }

    /// Reads odometers and roads once more, gives every vehicle back to SUMO as it was, and ends all records.
    ///
    /// # Errors
    /// If SUMO has ended.
    pub async fn hand_back(&mut self) -> Result<(), CosimError> {
        // Who departed in the last step has a record too, without samples.
        self.admit_waiting().await?;
        self.compose_readings()?;
        if !self.readings.is_empty() {
            let reply = self.client.exchange(&self.readings).await?;
            self.state.take_readings(&self.read, &reply);
        }
        self.batch.clear();
        for ego in self.state.book.iter() {
            lead::hand_back(&mut self.batch, ego)?;
            if self.subscribes() {
                self.batch.unsubscribe(Domain::Vehicle, &ego.id)?;
            }
        }
        self.batch.unsubscribe(Domain::Simulation, "")?;
        self.client.exchange(&self.batch).await?;
        self.state.end_all(Reason::Running);
        Ok(())
    }

    /// Leaves SUMO. What was computed comes back also if SUMO does not answer.
    pub async fn close(self) -> (State, Result<(), CosimError>) {
        let left = self.client.close().await.map_err(CosimError::from);
        (self.state, left)
    }

    /// Time spent waiting for SUMO so far.
    pub fn waited(&self) -> std::time::Duration {
        self.client.waited()
    }

    /// What is known when SUMO cannot be left in order any more.
    pub fn into_state(self) -> State {
        self.state
    }
}

/// Tells SUMO the speed of an ego's body, if it is on the road.
fn put_speed(batch: &mut Batch, ego: &Ego, state: &State, fault: Fault) -> Result<(), CosimError> {
    if ego.presence == Presence::Teleporting {
        return Ok(());
    }
    let (block, lane) = (state.fleet.block(ego.slot), ego.slot.lane());
    let speed_mps = block.speed_mps(lane);
    match (&ego.lead, fault) {
        (Some(lead), _) => batch.set_speed(&ego.prefix, lead.command_mps)?,
        (None, Fault::NotSentBack) => return Ok(()),
        (None, Fault::SpeedWithoutTraci) => batch.set_speed(&ego.prefix, speed_mps)?,
        (None, _) => batch.set_previous_speed(&ego.prefix, speed_mps, block.acceleration_mps2(lane))?,
    };
    Ok(())
}
