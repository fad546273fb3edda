//! The seam inside this process: every call acts at once, so the order of the calls is kept without more ado.
//!
//! A question is asked of SUMO when it comes, and its values are kept until the answer is fetched: what is told in between
//! must not change it. The values stand in the order in which [`Question::answer`] takes them.

use super::error::CosimError;
use super::events::Events;
use super::question::{Gets, NoAnswer, Object, Question, With};
use super::sumo::{Joined, Sumo, Tell, tells_mass, value_text};
use crate::stopwatch::Stopwatch;
use crate::traci::wire::NO_VALUE;
use crate::traci::{Color, Domain, Leader, SumoVersion, Value, finite, usable_speed, vehicle};
use std::time::Duration;
use sumo_mfc_libsumo::{self as libsumo, Ids, Simulation};

/// The integer with which SUMO says "no value".
const NO_VALUE_INT: i32 = NO_VALUE as i32;

/// A SUMO in this process.
pub struct LibsumoLink {
    simulation: Simulation,
    /// Vehicles in collisions, in the memory of the last step.
    colliding: Vec<String>,
    stepping: Stopwatch<1>,
}

/// Questions with the values that answer them.
pub struct Asked<Q> {
    /// Each with whether SUMO knows its object.
    questions: Vec<(Q, bool)>,
    values: Vec<Kept>,
    texts: String,
}

/// A value until it is fetched.
#[derive(Clone, Copy)]
enum Kept {
    /// SUMO does not tell it.
    Declined,
    /// SUMO has no value now.
    Missing,
    Double(f64),
    Integer(i32),
    /// From here to there in the texts.
    Text(usize, usize),
    Position([f64; 2]),
    Colour(Color),
    /// Who is ahead, from here to there in the texts, and the gap to it.
    Leader(usize, usize, f64),
}

impl LibsumoLink {
    /// A SUMO that is loaded.
    pub fn new(simulation: Simulation) -> Self {
        Self { simulation, colliding: Vec::new(), stepping: Stopwatch::new(true) }
    }

    /// Its version.
    pub fn version(&self) -> SumoVersion {
        let (api, text) = self.simulation.version();
        SumoVersion::parse(api, &text)
    }

    fn ids(&mut self, which: Ids) -> Result<Vec<String>, CosimError> {
        let mut ids = Vec::new();
        self.simulation.ids(which, &mut ids)?;
        Ok(ids)
    }
}

impl<Q> Default for Asked<Q> {
    fn default() -> Self {
        Self { questions: Vec::new(), values: Vec::new(), texts: String::new() }
    }
}

impl Sumo for LibsumoLink {
    type Step = ();
    type Asked<Q: Question> = Asked<Q>;

    async fn join(&mut self) -> Result<Joined, CosimError> {
        let libsumo::Clock { time_s, step_s, expected } = self.simulation.clock()?;
        let present = self.ids(Ids::Present)?;
        Ok(Joined { step_s, time_s, expected, present, tells_mass: tells_mass(&self.version()) })
    }

    async fn end_s(&mut self) -> Result<f64, CosimError> {
        Ok(self.simulation.end_s()?)
    }

    async fn option(&mut self, name: &str) -> Result<Option<String>, CosimError> {
        Ok(self.simulation.option(name)?)
    }

    fn tell(&mut self, object: &Object, what: Tell) -> Result<(), CosimError> {
        let (sumo, id) = (&mut self.simulation, &*object.id);
        // What SUMO declines is about a vehicle that has left, and the next answer says so.
        match what {
            Tell::PreviousSpeed(speed_mps, acceleration_mps2) => {
                let acceleration_mps2 = finite("acceleration", acceleration_mps2)?;
                sumo.set_previous_speed(id, usable_speed(speed_mps)?, acceleration_mps2)
            }
            Tell::Speed(speed_mps) => sumo.set(vehicle::SPEED.id, id, usable_speed(speed_mps)?),
            Tell::ReleaseSpeed => sumo.set(vehicle::SPEED.id, id, -1.0),
            Tell::Headway(headway_s) => sumo.set(vehicle::TAU.id, id, headway_s),
            Tell::Imperfection(sigma) => sumo.set(vehicle::IMPERFECTION.id, id, sigma),
            Tell::Accel(accel_mps2) => sumo.set(vehicle::ACCEL.id, id, accel_mps2),
            Tell::Decel(decel_mps2) => sumo.set(vehicle::DECEL.id, id, decel_mps2),
            Tell::SpeedFactor(factor) => sumo.set(vehicle::SPEED_FACTOR.id, id, factor),
            Tell::SpeedMode(mode) => sumo.set(vehicle::SPEED_MODE.id, id, mode.into()),
            Tell::Parameter(key, value) => sumo.set_parameter(id, key, &value_text(value)),
            Tell::Colour(Color { red, green, blue, alpha }) => sumo.set_colour(id, [red, green, blue, alpha]),
        }?;
        Ok(())
    }

    fn watch<Q: Question>(&mut self, _: &Object, _: &Q) -> Result<(), CosimError> {
        Ok(())
    }

    fn unwatch(&mut self, _: &Object) -> Result<(), CosimError> {
        Ok(())
    }

    async fn hand_over(&mut self) -> Result<(), CosimError> {
        Ok(())
    }

    async fn step(&mut self) -> Result<(), CosimError> {
        self.stepping.start();
        let stepped = self.simulation.step();
        self.stepping.lap(0);
        // Nothing else here ever waits, and signals want to be heard.
        tokio::task::yield_now().await;
        Ok(stepped?)
    }

    async fn events(&mut self, (): (), events: &mut Events) -> Result<(), CosimError> {
        events.clear();
        let libsumo::Clock { time_s, expected, .. } = self.simulation.clock()?;
        (events.time_s, events.expected) = (time_s, expected);
        self.simulation.ids(Ids::Departed, &mut events.departed)?;
        self.simulation.ids(Ids::Arrived, &mut events.arrived)?;
        let (began, ended) = (self.ids(Ids::TeleportBegan)?, self.ids(Ids::TeleportEnded)?);
        events.note_teleports(began, ended);
        self.colliding.clear();
        self.simulation.ids(Ids::Colliding, &mut self.colliding)?;
        events.colliding = !self.colliding.is_empty();
        if events.colliding {
            let pairs = self.ids(Ids::Collisions)?;
            events.collisions = pairs.chunks_exact(2).map(|pair| [pair[0].clone(), pair[1].clone()]).collect();
        }
        Ok(())
    }

    fn ask_in<'o, Q: Question>(
        &mut self,
        mut room: Asked<Q>,
        questions: impl Iterator<Item = (&'o Object, Q)>,
    ) -> Result<Asked<Q>, CosimError> {
        let Asked { questions: asked, values, texts } = &mut room;
        for (object, question) in questions {
            let before = values.len();
            let mut caller = Caller { sumo: &mut self.simulation, id: &object.id, values, texts, failed: None };
            question.answer(&mut caller);
            if let Some(error) = caller.failed {
                return Err(error.into());
            }
            // As over TraCI: the first value decides.
            let known = values.get(before).is_none_or(|first| !matches!(first, Kept::Declined));
            asked.push((question, known));
        }
        Ok(room)
    }

    async fn answers<Q: Question>(
        &mut self,
        mut asked: Asked<Q>,
        mut each: impl for<'a> FnMut(Q, Result<Q::Answer<'a>, NoAnswer>),
    ) -> Result<Asked<Q>, CosimError> {
        let mut values = asked.values.iter();
        for (question, known) in asked.questions.drain(..) {
            // All its values are taken, also of an object that is gone.
            let answer = question.answer(&mut Reader { values: &mut values, texts: &asked.texts });
            each(question, if known { Ok(answer) } else { Err(NoAnswer::Gone) });
        }
        asked.values.clear();
        asked.texts.clear();
        Ok(asked)
    }

    async fn leave(&mut self) -> Result<(), CosimError> {
        Ok(())
    }

    async fn close(self) -> Result<(), CosimError> {
        Ok(self.simulation.close()?)
    }

    fn waited(&self) -> Duration {
        self.stepping.spent()[0]
    }
}

/// Asks SUMO for the values of a question, and keeps them.
struct Caller<'c> {
    sumo: &'c mut Simulation,
    id: &'c str,
    values: &'c mut Vec<Kept>,
    texts: &'c mut String,
    failed: Option<libsumo::Error>,
}

impl Caller<'_> {
    fn keep(&mut self, domain: Domain, variable: u8, with: libsumo::With<'_>) -> Result<Kept, libsumo::Error> {
        let Some(value) = self.sumo.get(domain.get_command(), variable, self.id, with)? else {
            return Ok(Kept::Declined);
        };
        Ok(match value {
            libsumo::Value::Double(NO_VALUE) | libsumo::Value::Integer(NO_VALUE_INT) => Kept::Missing,
            libsumo::Value::Double(number) => Kept::Double(number),
            libsumo::Value::Integer(number) => Kept::Integer(number),
            libsumo::Value::Text(text) => {
                let begin = self.texts.len();
                self.texts.push_str(text);
                Kept::Text(begin, self.texts.len())
            }
            libsumo::Value::Leader(id, gap_m) => {
                let begin = self.texts.len();
                self.texts.push_str(id);
                Kept::Leader(begin, self.texts.len(), gap_m)
            }
            libsumo::Value::Position([NO_VALUE, NO_VALUE]) => Kept::Missing,
            libsumo::Value::Position(at) => Kept::Position(at),
            libsumo::Value::Colour([red, green, blue, alpha]) => Kept::Colour(Color { red, green, blue, alpha }),
        })
    }
}

impl<'a> Gets<'a> for Caller<'_> {
    fn value(&mut self, domain: Domain, variable: u8, with: Option<With<'_>>) -> Option<Value<'a>> {
        let with = match with {
            None => libsumo::With::Nothing,
            Some(With::Key(key)) => libsumo::With::Key(key),
            Some(With::Distance(distance_m)) => libsumo::With::Distance(distance_m),
        };
        let kept = self.keep(domain, variable, with);
        let kept = kept.unwrap_or_else(|error| {
            self.failed.get_or_insert(error);
            Kept::Declined
        });
        self.values.push(kept);
        None
    }
}

/// Reads the values that were kept, in their order.
struct Reader<'a, 'v> {
    values: &'v mut std::slice::Iter<'a, Kept>,
    texts: &'a str,
}

impl<'a> Gets<'a> for Reader<'a, '_> {
    fn value(&mut self, _: Domain, _: u8, _: Option<With<'_>>) -> Option<Value<'a>> {
        match *self.values.next()? {
            Kept::Declined | Kept::Leader(..) => None,
            Kept::Missing => Some(Value::Missing),
            Kept::Double(number) => Some(Value::Double(number)),
            Kept::Integer(number) => Some(Value::Int(number)),
            Kept::Text(begin, end) => Some(Value::Text(&self.texts[begin..end])),
            Kept::Position(at) => Some(Value::Position2(at)),
            Kept::Colour(colour) => Some(Value::Color(colour)),
        }
    }

    /// It comes as one value, with an empty id if there is none.
    fn leader(&mut self, _: f64) -> Option<Leader> {
        match *self.values.next()? {
            Kept::Leader(begin, end, gap_m) if begin < end => {
                Some(Leader { id: self.texts[begin..end].to_owned(), gap_m })
            }
            _ => None,
        }
    }
}
