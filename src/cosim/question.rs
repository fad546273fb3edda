//! What is asked of SUMO about one object, and how the answer is read: one function for both, so that they cannot
//! disagree.
//!
//! [`Question::answer`] takes values from a [`Gets`], one after the other. A [`Gets`] that writes a message appends a
//! command per value and returns nothing yet; one that reads a reply returns the values in the same order; one that reads
//! a subscription looks them up by their numbers; a SUMO in this process is called by the first, and the second reads
//! what it said.

use crate::traci::{BatchError, Color, Domain, FromValue, Leader, Prefix, Value, Var, vehicle};
use std::sync::Arc;

/// A vehicle, vType, lane or the simulation, by its id in SUMO.
#[derive(Debug, Clone)]
pub struct Object {
    /// SUMO's id; empty for the simulation.
    pub id: Arc<str>,
    /// The same as the beginning of a command.
    pub prefix: Prefix,
}

impl Object {
    /// The object `id`.
    ///
    /// # Errors
    /// If the id is too long for SUMO's error texts ([`crate::traci::MAX_ID_BYTES`]).
    pub fn new(id: impl Into<Arc<str>>) -> Result<Self, BatchError> {
        let id = id.into();
        Ok(Self { prefix: Prefix::new(&id)?, id })
    }

    /// An object that SUMO has named and keeps; its id may have any length.
    pub fn known(id: impl Into<Arc<str>>) -> Self {
        let id = id.into();
        Self { prefix: Prefix::of_known(&id), id }
    }
}

/// What is said along with a variable.
#[derive(Debug, Clone, Copy)]
pub enum With<'k> {
    /// The key of a generic parameter.
    Key(&'k str),
    /// A distance \[m\].
    Distance(f64),
}

/// Values of one object. `None`: SUMO has no value now (a vehicle that teleports has no speed), or declined.
pub trait Gets<'a> {
    /// A variable by its number in its domain, with what has to be said along with it.
    fn value(&mut self, domain: Domain, variable: u8, with: Option<With<'_>>) -> Option<Value<'a>>;

    /// A number.
    fn number<S>(&mut self, variable: Var<f64, S>) -> Option<f64> {
        self.value(variable.domain, variable.id, None)?.as_f64()
    }

    /// A whole number.
    fn integer<S>(&mut self, variable: Var<i32, S>) -> Option<i32> {
        self.value(variable.domain, variable.id, None)?.as_i32()
    }

    /// A text.
    fn text<S>(&mut self, variable: Var<String, S>) -> Option<&'a str> {
        self.value(variable.domain, variable.id, None)?.as_str()
    }

    /// A point x, y \[m\].
    fn position<S>(&mut self, variable: Var<[f64; 2], S>) -> Option<[f64; 2]> {
        <[f64; 2]>::from_value(self.value(variable.domain, variable.id, None)?).ok()
    }

    /// A colour.
    fn colour<S>(&mut self, variable: Var<Color, S>) -> Option<Color> {
        Color::from_value(self.value(variable.domain, variable.id, None)?).ok()
    }

    /// A generic parameter by its key; empty if the object does not have it.
    fn parameter<S>(&mut self, variable: Var<String, S, String>, key: &str) -> Option<&'a str> {
        self.value(variable.domain, variable.id, Some(With::Key(key)))?.as_str()
    }

    /// The vehicle ahead within a distance \[m\], and the gap to it.
    fn leader(&mut self, ahead_m: f64) -> Option<Leader> {
        let value = self.value(vehicle::LEADER.domain, vehicle::LEADER.id, Some(With::Distance(ahead_m)))?;
        Option::<Leader>::from_value(value).ok()?
    }
}

/// Something to be asked about one object.
pub trait Question {
    /// The answer, which may borrow from the reply.
    type Answer<'a>;
    /// True for the question that is asked of the same vehicles in every step: where SUMO is shared it is answered from
    /// subscriptions ([`super::sumo::Sumo::watch`]).
    const EVERY_STEP: bool = false;
    /// Takes all values of the answer, always the same ones in the same order. The first one decides whether SUMO knows
    /// the object.
    fn answer<'a>(&self, gets: &mut impl Gets<'a>) -> Self::Answer<'a>;
}

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq)]
pub enum NoAnswer {
    /// SUMO does not know the object (any more).
    Gone,
    /// The question must not be sent.
    Unaskable(BatchError),
}
