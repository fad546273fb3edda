//! The seam over TraCI: messages of many commands, several of them under way at a time.
//!
//! Vehicles are asked about by gets in messages behind the step. This is cheaper for SUMO than subscriptions. Where other
//! clients share SUMO, and may take a vehicle out at any time, vehicles are subscribed to (a get for one that has left is
//! an error in SUMO's log), and everything is told in the message of the step.

use super::error::CosimError;
use super::events::Events;
use super::question::{Gets, NoAnswer, Object, Question, With};
use super::subscriptions::{Lookup, Subscriptions, Variables};
use super::sumo::{Joined, Sumo, Tell, tells_mass, value_text};
use crate::traci::{
    Batch, BatchError, Block, Client, Domain, Error, Never, Reply, Subscribed, Ticket, Value, Var, simulation, vehicle,
};
use std::sync::Arc;
use std::time::Duration;

/// A SUMO that is reached over TraCI.
pub struct TraciLink {
    client: Client,
    /// What SUMO is told next.
    told: Batch,
    /// Any other message, while it is written.
    message: Batch,
    /// Subscriptions, if SUMO is shared with other clients.
    subscriptions: Option<Subscriptions>,
    time_s: f64,
}

/// Questions under way.
pub struct Asked<Q> {
    questions: Vec<(Q, Source)>,
    ticket: Option<Ticket>,
}

/// Where an answer comes from.
enum Source {
    /// The reply, from this command on.
    Reply(usize),
    /// The subscription of this vehicle; what has a parameter from the reply, from this command on.
    Subscription(Arc<str>, usize),
    /// Nowhere: the question could not be sent.
    Nowhere(Box<BatchError>),
}

impl TraciLink {
    /// A SUMO that is connected; `shared` if other clients may be at it.
    pub fn new(client: Client, shared: bool) -> Self {
        Self {
            client,
            told: Batch::new(),
            message: Batch::new(),
            subscriptions: shared.then(Subscriptions::default),
            time_s: 0.0,
        }
    }

    /// Sends what was told. A command that SUMO declines is about a vehicle that has left, and the next answer says so.
    fn send_told(&mut self) -> Result<(), CosimError> {
        if !self.told.is_empty() {
            self.client.queue_unheard(&self.told)?;
            self.told.clear();
        }
        Ok(())
    }
}

impl<Q> Default for Asked<Q> {
    fn default() -> Self {
        Self { questions: Vec::new(), ticket: None }
    }
}

impl Sumo for TraciLink {
    type Step = Ticket;
    type Asked<Q: Question> = Asked<Q>;

    async fn join(&mut self) -> Result<Joined, CosimError> {
        let step_s = self.client.get(simulation::STEP_LENGTH, "").await?;
        let time_s = self.client.get(simulation::TIME, "").await?;
        self.time_s = time_s;
        let mut batch = Batch::new();
        batch.subscribe(EVENTS, "", time_s)?;
        let present = batch.get(vehicle::IDS, "")?;
        let expected = batch.get(simulation::EXPECTED, "")?;
        let reply = self.client.exchange(&batch).await?;
        let (expected, present) = (reply.get(expected)?, reply.get(present)?);
        let tells_mass = tells_mass(self.client.version());
        Ok(Joined { step_s, time_s, expected, present, tells_mass })
    }

    async fn end_s(&mut self) -> Result<f64, CosimError> {
        Ok(self.client.get(simulation::END, "").await?)
    }

    async fn option(&mut self, name: &str) -> Result<Option<String>, CosimError> {
        match self.client.get(simulation::OPTION, name).await {
            Ok(value) => Ok(Some(value)),
            Err(Error::Refused { .. }) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    fn tell(&mut self, object: &Object, what: Tell) -> Result<(), CosimError> {
        let (batch, Object { id, prefix }) = (&mut self.told, object);
        match what {
            Tell::PreviousSpeed(speed_mps, acceleration_mps2) => {
                batch.set_previous_speed(prefix, speed_mps, acceleration_mps2)
            }
            Tell::Speed(speed_mps) => batch.set_speed(prefix, speed_mps),
            Tell::ReleaseSpeed => batch.release_speed(prefix),
            Tell::Headway(headway_s) => batch.set(vehicle::TAU, id, headway_s),
            Tell::Imperfection(sigma) => batch.set(vehicle::IMPERFECTION, id, sigma),
            Tell::Accel(accel_mps2) => batch.set(vehicle::ACCEL, id, accel_mps2),
            Tell::Decel(decel_mps2) => batch.set(vehicle::DECEL, id, decel_mps2),
            Tell::SpeedFactor(factor) => batch.set(vehicle::SPEED_FACTOR, id, factor),
            Tell::SpeedMode(mode) => batch.set(vehicle::SPEED_MODE, id, mode),
            Tell::Parameter(key, value) => batch.set(vehicle::PARAMETER, id, (key, value_text(value).as_str())),
            Tell::Colour(colour) => batch.set(vehicle::COLOR, id, colour),
        }?;
        Ok(())
    }

    fn watch<Q: Question>(&mut self, vehicle: &Object, question: &Q) -> Result<(), CosimError> {
        if let Some(subscriptions) = &mut self.subscriptions {
            let mut variables = Variables::default();
            question.answer(&mut variables);
            self.told.subscribe_ids(Domain::Vehicle, &vehicle.id, &variables.0, self.time_s)?;
            subscriptions.add(vehicle, variables.0.first().copied().unwrap_or_default());
        }
        Ok(())
    }

    fn unwatch(&mut self, vehicle: &Object) -> Result<(), CosimError> {
        if let Some(subscriptions) = &mut self.subscriptions {
            self.told.unsubscribe(Domain::Vehicle, &vehicle.id)?;
            subscriptions.remove(&vehicle.id);
        }
        Ok(())
    }

    async fn hand_over(&mut self) -> Result<(), CosimError> {
        if self.subscriptions.is_none() {
            self.send_told()?;
        }
        Ok(self.client.flush().await?)
    }

    async fn step(&mut self) -> Result<Ticket, CosimError> {
        if self.subscriptions.is_some() {
            // In a message of its own: SUMO sends the answers to whatever stands before a step in the same message to
            // the client that it serves next.
            self.send_told()?;
        }
        self.told.step()?;
        let ticket = self.client.queue(&self.told)?;
        self.told.clear();
        self.client.flush().await?;
        Ok(ticket)
    }

    async fn events(&mut self, step: Ticket, events: &mut Events) -> Result<(), CosimError> {
        events.clear();
        let reply = self.client.receive(step).await?;
        if let Some(subscriptions) = &mut self.subscriptions {
            subscriptions.forget_values();
        }
        for block in reply.blocks() {
            let block = block?;
            match (block.domain, &mut self.subscriptions) {
                (Some(Domain::Simulation), _) => note_events(&block, events)?,
                (Some(Domain::Vehicle), Some(subscriptions)) => subscriptions.note(&block)?,
                _ => {}
            }
        }
        self.time_s = events.time_s;
        if events.colliding {
            let collisions = self.client.get(simulation::COLLISIONS, "").await?;
            events.collisions = collisions.into_iter().map(|c| [c.collider, c.victim]).collect();
        }
        Ok(())
    }

    fn ask_in<'o, Q: Question>(
        &mut self,
        mut room: Asked<Q>,
        questions: impl Iterator<Item = (&'o Object, Q)>,
    ) -> Result<Asked<Q>, CosimError> {
        let subscribed = Q::EVERY_STEP && self.subscriptions.is_some();
        self.message.clear();
        let with_source = |(object, question): (&'o Object, Q)| {
            let first = self.message.len();
            let mut writer = Writer { batch: &mut self.message, object, subscribed, failed: None };
            question.answer(&mut writer);
            // What was asked before a failure is answered and left unread.
            let source = match writer.failed {
                Some(error) => Source::Nowhere(Box::new(error)),
                None if subscribed => Source::Subscription(object.id.clone(), first),
                None => Source::Reply(first),
            };
            (question, source)
        };
        room.questions.extend(questions.map(with_source));
        room.ticket = if self.message.is_empty() { None } else { Some(self.client.queue(&self.message)?) };
        Ok(room)
    }

    async fn answers<Q: Question>(
        &mut self,
        mut asked: Asked<Q>,
        mut each: impl for<'a> FnMut(Q, Result<Q::Answer<'a>, NoAnswer>),
    ) -> Result<Asked<Q>, CosimError> {
        let reply = match asked.ticket.take() {
            Some(ticket) => Some(self.client.receive(ticket).await?),
            None => None,
        };
        for (question, source) in asked.questions.drain(..) {
            let answer = match source {
                Source::Reply(first) => reply
                    .filter(|reply| reply.refusal(first).is_none())
                    .map(|reply| question.answer(&mut Reader { reply, next: first })),
                Source::Subscription(id, first) => {
                    self.subscriptions.as_ref().and_then(|subscriptions| subscriptions.values(&id)).map(|values| {
                        question.answer(&mut Both { values, gets: reply.map(|reply| Reader { reply, next: first }) })
                    })
                }
                Source::Nowhere(error) => {
                    each(question, Err(NoAnswer::Unaskable(*error)));
                    continue;
                }
            };
            each(question, answer.ok_or(NoAnswer::Gone));
        }
        Ok(asked)
    }

    async fn leave(&mut self) -> Result<(), CosimError> {
        self.told.unsubscribe(Domain::Simulation, "")?;
        self.client.exchange(&self.told).await?;
        self.told.clear();
        Ok(())
    }

    async fn close(self) -> Result<(), CosimError> {
        Ok(self.client.close().await?)
    }

    fn waited(&self) -> Duration {
        self.client.waited()
    }
}

/// A variable that is a list of ids.
type Ids = Var<Vec<String>>;

/// What reports the events of a step: time, vehicles that are still expected, departures, arrivals, teleports, vehicles
/// in collisions.
const EVENTS: (Var<f64>, Var<i32>, Ids, Ids, Ids, Ids, Ids) = (
    simulation::TIME,
    simulation::EXPECTED,
    simulation::DEPARTED,
    simulation::ARRIVED,
    simulation::TELEPORT_START,
    simulation::TELEPORT_END,
    simulation::COLLIDING,
);

/// Reads a block about the simulation, unless it is another client's.
fn note_events(block: &Block<'_>, events: &mut Events) -> Result<(), CosimError> {
    if let Subscribed::Own((time_s, expected, departed, arrived, began, ended, colliding)) = block.read(EVENTS)? {
        events.time_s = time_s.unwrap_or(events.time_s);
        events.expected = expected.unwrap_or(events.expected);
        events.departed = departed.unwrap_or_default();
        events.arrived = arrived.unwrap_or_default();
        events.note_teleports(began.unwrap_or_default(), ended.unwrap_or_default());
        events.colliding = !colliding.unwrap_or_default().is_empty();
    }
    Ok(())
}

/// Writes the gets of a question; there are no values yet.
struct Writer<'b> {
    batch: &'b mut Batch,
    object: &'b Object,
    /// What has no parameter comes by subscription.
    subscribed: bool,
    failed: Option<BatchError>,
}

impl<'a> Gets<'a> for Writer<'_> {
    fn value(&mut self, domain: Domain, variable: u8, with: Option<With<'_>>) -> Option<Value<'a>> {
        let prefix = &self.object.prefix;
        // What the answers are is known to the question.
        let written = match with {
            None if self.subscribed => return None,
            None => self.batch.get_by_prefix(Var::<f64>::new(domain, variable), prefix).map(drop),
            Some(With::Distance(distance_m)) => {
                let variable = Var::<f64, Never, f64>::new(domain, variable);
                self.batch.get_with_by_prefix(variable, prefix, distance_m).map(drop)
            }
            Some(With::Key(key)) => {
                self.batch.get_with_by_prefix(Var::<f64, Never, String>::new(domain, variable), prefix, key).map(drop)
            }
        };
        self.failed = self.failed.take().or(written.err());
        None
    }
}

/// Reads what was subscribed to, and the answers to gets of what has a parameter.
struct Both<'a> {
    values: Lookup<'a>,
    gets: Option<Reader<'a>>,
}

impl<'a> Gets<'a> for Both<'a> {
    fn value(&mut self, domain: Domain, variable: u8, with: Option<With<'_>>) -> Option<Value<'a>> {
        match with {
            None => self.values.value(domain, variable, with),
            Some(_) => self.gets.as_mut()?.value(domain, variable, with),
        }
    }
}

/// Reads the answers to gets in their order.
struct Reader<'a> {
    reply: Reply<'a>,
    next: usize,
}

impl Reader<'_> {
    fn place(&mut self) -> usize {
        self.next += 1;
        self.next - 1
    }
}

impl<'a> Gets<'a> for Reader<'a> {
    fn value(&mut self, _: Domain, _: u8, _: Option<With<'_>>) -> Option<Value<'a>> {
        let place = self.place();
        self.reply.value(place).ok()?
    }

    /// The same, quicker: nearly all that is read in a step are numbers.
    fn number<S>(&mut self, _: Var<f64, S>) -> Option<f64> {
        let place = self.place();
        self.reply.f64(place)
    }
}
