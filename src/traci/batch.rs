//! A message under construction: many commands, at most one step, and the step last.
//!
//! SUMO acts on commands behind a step *before* it, dies of two steps in one message, of error texts that do not fit
//! 255 bytes, and waits for ever on a wrong length. A [`Batch`] cannot express any of these.

use std::marker::PhantomData;
use std::ops::Range;

use super::error::BatchError;
use super::prefix::{Prefix, check_id, too_long};
use super::subscription::Variables;
use super::typed::{Domain, FromValue, Shape, Var, finite};
use super::variables::{TABLE, vehicle};
use super::wire::{NO_VALUE, close_command, put_f64, put_i32, put_text, tag};

/// Longest get with its parameter, whose text SUMO repeats too.
const MAX_GET_BYTES: usize = 200;

/// Bytes for the reasons of a refused subscription, which SUMO joins in one status; and what a reason has besides the id.
const ERROR_TEXT_BYTES: usize = 220;
const ERROR_PER_VARIABLE_BYTES: usize = 40;
const ERROR_UNSUPPORTED_BYTES: usize = 70;

/// What the answer to a command looks like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Answer {
    Status,
    Get(u8),
    Subscription,
    Version,
    Step,
}

/// One command as its answer must match it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Expected {
    pub command: u8,
    pub answer: Answer,
}

/// Where the answer to a typed get will be; redeem it with [`super::Reply::get`].
#[derive(Debug)]
pub struct Handle<T> {
    pub(super) index: usize,
    kind: PhantomData<fn() -> T>,
}

impl<T> Clone for Handle<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Handle<T> {}

impl<T> Handle<T> {
    /// Number of the command in its batch, as used by [`super::Reply::value`].
    #[must_use]
    pub fn index(self) -> usize {
        self.index
    }
}

/// A message of many commands, reusable: [`Batch::clear`] keeps the memory.
#[derive(Debug, Clone)]
pub struct Batch {
    bytes: Vec<u8>,
    expected: Vec<Expected>,
    stepped: bool,
}

impl Default for Batch {
    fn default() -> Self {
        Self { bytes: vec![0, 0, 0, 4], expected: Vec::new(), stepped: false }
    }
}

impl Batch {
    /// An empty batch.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Empties it and keeps the memory.
    pub fn clear(&mut self) {
        self.bytes.truncate(4);
        self.expected.clear();
        self.stepped = false;
        self.write_length();
    }

    /// Number of commands.
    #[must_use]
    pub fn len(&self) -> usize {
        self.expected.len()
    }

    /// True if there is no command.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.expected.is_empty()
    }

    /// The message as it goes to SUMO, length included.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    pub(super) fn expected(&self) -> &[Expected] {
        &self.expected
    }

    fn write_length(&mut self) {
        let length = i32::try_from(self.bytes.len()).unwrap_or(i32::MAX);
        self.bytes[..4].copy_from_slice(&length.to_be_bytes());
    }

    /// Appends one command; `put` writes what follows the identifier. On an error nothing is appended.
    fn push(
        &mut self,
        command: u8,
        answer: Answer,
        put: impl FnOnce(&mut Vec<u8>) -> Result<(), BatchError>,
    ) -> Result<usize, BatchError> {
        if self.stepped {
            return Err(BatchError::AfterStep);
        }
        let start = self.bytes.len();
        self.bytes.extend_from_slice(&[0, command]);
        let written = put(&mut self.bytes);
        close_command(&mut self.bytes, start);
        let written = if i32::try_from(self.bytes.len()).is_err() { Err(BatchError::TooLarge) } else { written };
        if let Err(error) = written {
            self.bytes.truncate(start);
            return Err(error);
        }
        self.write_length();
        self.expected.push(Expected { command, answer });
        Ok(self.expected.len() - 1)
    }

    /// Copies a prefix and lets `tail` bytes follow.
    fn push_prefixed(
        &mut self,
        prefix: &Prefix,
        command: u8,
        variable: u8,
        answer: Answer,
        tail: &[u8],
    ) -> Result<usize, BatchError> {
        if self.stepped {
            return Err(BatchError::AfterStep);
        }
        let start = self.bytes.len();
        let length = prefix.head().len() + tail.len();
        let (Ok(short), Ok(_)) = (u8::try_from(length), i32::try_from(start + length)) else {
            return self.push(command, answer, |out| {
                out.push(variable);
                out.extend_from_slice(prefix.id_bytes());
                out.extend_from_slice(tail);
                Ok(())
            });
        };
        self.bytes.extend_from_slice(prefix.head());
        self.bytes[start..start + 3].copy_from_slice(&[short, command, variable]);
        self.bytes.extend_from_slice(tail);
        self.write_length();
        self.expected.push(Expected { command, answer });
        Ok(self.expected.len() - 1)
    }

    /// `setSpeed`: the vehicle drives at `speed_mps` [m/s] from the next step on, as far as its speed mode lets it. SUMO
    /// may forget a command given only once, so send it in every step.
    ///
    /// # Errors
    /// If the speed is negative or not finite (SUMO would release the vehicle; see [`Batch::release_speed`]), or behind
    /// a step.
    pub fn set_speed(&mut self, vehicle: &Prefix, speed_mps: f64) -> Result<usize, BatchError> {
        let speed_mps = usable_speed(speed_mps)?;
        self.push_speed(vehicle, speed_mps)
    }

    /// Ends `setSpeed`: SUMO's own car-following drives again.
    ///
    /// # Errors
    /// Behind a step.
    pub fn release_speed(&mut self, vehicle: &Prefix) -> Result<usize, BatchError> {
        self.push_speed(vehicle, -1.0)
    }

    fn push_speed(&mut self, vehicle: &Prefix, speed_mps: f64) -> Result<usize, BatchError> {
        let mut tail = [tag::DOUBLE; 9];
        tail[1..].copy_from_slice(&speed_mps.to_be_bytes());
        self.push_prefixed(vehicle, Domain::Vehicle.set_command(), vehicle::SPEED.set_id, Answer::Status, &tail)
    }

    /// `setPreviousSpeed`: SUMO takes `speed_mps` [m/s] for the present speed and `acceleration_mps2` [m/s²] for the
    /// present acceleration and plans the next step from there. (Without the acceleration SUMO would report the jump of
    /// speed as one.)
    ///
    /// # Errors
    /// If the speed is negative or a number is not finite, or behind a step.
    pub fn set_previous_speed(
        &mut self,
        vehicle: &Prefix,
        speed_mps: f64,
        acceleration_mps2: f64,
    ) -> Result<usize, BatchError> {
        let speed_mps = usable_speed(speed_mps)?;
        let acceleration_mps2 = finite("acceleration", acceleration_mps2)?;
        let mut tail = [0; 23];
        tail[..6].copy_from_slice(&[tag::COMPOUND, 0, 0, 0, 2, tag::DOUBLE]);
        tail[6..14].copy_from_slice(&speed_mps.to_be_bytes());
        tail[14] = tag::DOUBLE;
        tail[15..].copy_from_slice(&acceleration_mps2.to_be_bytes());
        let variable = vehicle::PREVIOUS_SPEED.set_id;
        self.push_prefixed(vehicle, Domain::Vehicle.set_command(), variable, Answer::Status, &tail)
    }

    /// Asks for a variable of the object of `prefix`.
    ///
    /// # Errors
    /// Behind a step.
    pub fn get_by_prefix<T: FromValue, S>(
        &mut self,
        variable: Var<T, S>,
        object: &Prefix,
    ) -> Result<Handle<T>, BatchError> {
        let index =
            self.push_prefixed(object, variable.domain.get_command(), variable.id, Answer::Get(variable.id), &[])?;
        Ok(Handle { index, kind: PhantomData })
    }

    /// Asks for a variable that takes a parameter, of the object of `prefix`.
    ///
    /// # Errors
    /// If id and parameter are too long, a number of the parameter is not finite, or behind a step.
    pub fn get_with_by_prefix<T: FromValue, S, P: Shape>(
        &mut self,
        variable: Var<T, S, P>,
        object: &Prefix,
        parameter: P::Arg<'_>,
    ) -> Result<Handle<T>, BatchError> {
        let index = self.push(variable.domain.get_command(), Answer::Get(variable.id), |out| {
            let start = out.len();
            out.push(variable.id);
            out.extend_from_slice(object.id_bytes());
            P::put(parameter, out)?;
            let length = out.len() - start;
            let id = || String::from_utf8_lossy(&object.id_bytes()[4..]).into_owned();
            if object.is_known() || length <= MAX_GET_BYTES { Ok(()) } else { Err(too_long(&id(), length)) }
        })?;
        Ok(Handle { index, kind: PhantomData })
    }

    /// Asks for a variable of the object `id`.
    ///
    /// # Errors
    /// If the id is too long, or behind a step.
    pub fn get<T: FromValue, S>(&mut self, variable: Var<T, S>, id: &str) -> Result<Handle<T>, BatchError> {
        self.get_with(variable, id, ())
    }

    /// Asks for a variable that takes a parameter.
    ///
    /// # Errors
    /// If the id is too long or a number of the parameter not finite, or behind a step.
    pub fn get_with<T: FromValue, S, P: Shape>(
        &mut self,
        variable: Var<T, S, P>,
        id: &str,
        parameter: P::Arg<'_>,
    ) -> Result<Handle<T>, BatchError> {
        self.get_with_by_prefix(variable, &Prefix::new(id)?, parameter)
    }

    /// Sets a variable of the object `id`.
    ///
    /// # Errors
    /// If the id is too long or a number not finite, or behind a step.
    pub fn set<T, S: Shape, P>(
        &mut self,
        variable: Var<T, S, P>,
        id: &str,
        value: S::Arg<'_>,
    ) -> Result<usize, BatchError> {
        check_id(id)?;
        self.push(variable.domain.set_command(), Answer::Status, |out| {
            out.push(variable.set_id);
            put_text(out, id);
            S::put(value, out)
        })
    }

    /// Subscribes to variables of an object, such as `(vehicle::SPEED, vehicle::ANGLE)`: their values come with the reply
    /// to this batch and with every step from then on, and [`super::Block::read`] reads them by the same variables.
    /// `begin_s` is the present simulation time \[s\]; with SUMO's "from the beginning" each new subscription would cost
    /// time proportional to all others.
    ///
    /// Many variables of one vehicle may become several commands (SUMO ends itself when the texts about an unknown
    /// vehicle do not fit 255 bytes); their numbers are returned. SUMO joins them into one block.
    ///
    /// # Errors
    /// If the id is too long, the time not finite, or the variables are of several domains, or behind a step. Nothing is
    /// appended then.
    pub fn subscribe<V: Variables>(
        &mut self,
        variables: V,
        id: &str,
        begin_s: f64,
    ) -> Result<Range<usize>, BatchError> {
        let mut list = Vec::new();
        variables.list(&mut list);
        let domain = list.first().map_or(Domain::Simulation, |(domain, _)| *domain);
        if list.iter().any(|(other, _)| *other != domain) {
            return Err(BatchError::SeveralDomains);
        }
        let ids: Vec<u8> = list.into_iter().map(|(_, id)| id).collect();
        self.subscribe_ids(domain, id, &ids, begin_s)
    }

    /// As [`Batch::subscribe`], by bare identifiers: for variables that are known only when the program runs.
    ///
    /// # Errors
    /// As [`Batch::subscribe`], and if a variable needs a parameter.
    pub fn subscribe_ids(
        &mut self,
        domain: Domain,
        id: &str,
        variables: &[u8],
        begin_s: f64,
    ) -> Result<Range<usize>, BatchError> {
        if let Some(&id) = variables.iter().find(|variable| needs_parameter(domain, **variable)) {
            return Err(BatchError::NeedsParameter { id });
        }
        let first = self.len();
        for chunk in variables.chunks(variables_per_command(domain, id)) {
            let count = u8::try_from(chunk.len()).map_err(|_| BatchError::TooLarge)?;
            self.push_subscription(domain, id, begin_s, Answer::Subscription, count, |out| {
                out.extend_from_slice(chunk);
                Ok(())
            })?;
        }
        Ok(first..self.len())
    }

    /// Subscribes to one variable with its parameter.
    ///
    /// # Errors
    /// As [`Batch::subscribe`], or if a number of the parameter is not finite.
    pub fn subscribe_with<T: FromValue, S, P: Shape>(
        &mut self,
        variable: Var<T, S, P>,
        id: &str,
        parameter: P::Arg<'_>,
        begin_s: f64,
    ) -> Result<usize, BatchError> {
        self.push_subscription(variable.domain, id, begin_s, Answer::Subscription, 1, |out| {
            out.push(variable.id);
            P::put(parameter, out)
        })
    }

    /// Ends all subscriptions of an object.
    ///
    /// # Errors
    /// If the id is too long, or behind a step.
    pub fn unsubscribe(&mut self, domain: Domain, id: &str) -> Result<usize, BatchError> {
        self.push_subscription(domain, id, NO_VALUE, Answer::Status, 0, |_| Ok(()))
    }

    fn push_subscription(
        &mut self,
        domain: Domain,
        id: &str,
        begin_s: f64,
        answer: Answer,
        count: u8,
        variables: impl FnOnce(&mut Vec<u8>) -> Result<(), BatchError>,
    ) -> Result<usize, BatchError> {
        check_id(id)?;
        finite("time", begin_s)?;
        self.push(domain.subscribe_command(), answer, |out| {
            put_f64(out, begin_s);
            put_f64(out, NO_VALUE);
            put_text(out, id);
            out.push(count);
            variables(out)
        })
    }

    /// One simulation step; ends the batch.
    ///
    /// # Errors
    /// If the batch already ends with a step.
    pub fn step(&mut self) -> Result<usize, BatchError> {
        self.step_until(0.0)
    }

    /// Steps until the simulation time is at least `time_s` \[s\] (not at all if it already is; 0 makes one step); ends
    /// the batch.
    ///
    /// # Errors
    /// If the time is not finite, or the batch already ends with a step.
    pub fn step_until(&mut self, time_s: f64) -> Result<usize, BatchError> {
        finite("time", time_s)?;
        let index = self.push(0x02, Answer::Step, |out| {
            put_f64(out, time_s);
            Ok(())
        })?;
        self.stepped = true;
        Ok(index)
    }

    /// First half of a step (SUMO 1.18 or newer): plan and move; the next step does the rest. Ends the batch, as a step
    /// does, and brings no subscription results.
    ///
    /// # Errors
    /// If the batch already ends with a step.
    pub fn execute_move(&mut self) -> Result<usize, BatchError> {
        let index = self.push(0x7d, Answer::Status, |_| Ok(()))?;
        self.stepped = true;
        Ok(index)
    }

    pub(super) fn version(&mut self) -> Result<usize, BatchError> {
        self.push(0x00, Answer::Version, |_| Ok(()))
    }

    pub(super) fn order(&mut self, order: i32) -> Result<usize, BatchError> {
        self.push(0x03, Answer::Status, |out| {
            put_i32(out, order);
            Ok(())
        })
    }

    pub(super) fn close(&mut self) -> Result<usize, BatchError> {
        self.push(0x7f, Answer::Status, |_| Ok(()))
    }
}

/// A speed that SUMO takes as one: negative ones and NaN would release the vehicle. −0 becomes 0.
pub(crate) fn usable_speed(speed_mps: f64) -> Result<f64, BatchError> {
    finite("speed", speed_mps)?;
    if speed_mps < 0.0 {
        return Err(BatchError::BadNumber { what: "speed", value: speed_mps });
    }
    Ok(speed_mps.abs())
}

/// A generic parameter together with its key; every domain has it, the table leaves it out.
const PARAMETER_WITH_KEY: u8 = 0x3e;

/// True if a subscription to the variable must carry a parameter. The short form of stops needs one only in a
/// subscription, and only in newer SUMO.
fn needs_parameter(domain: Domain, variable: u8) -> bool {
    let by_table = TABLE.iter().any(|row| row.domain == domain && row.id == variable && row.parameter.is_some());
    by_table || variable == PARAMETER_WITH_KEY || (domain == Domain::Vehicle && variable == vehicle::NEXT_STOPS.id)
}

/// How many variables one subscribe command may carry so that the error texts fit. The simulation always exists.
fn variables_per_command(domain: Domain, id: &str) -> usize {
    if domain == Domain::Simulation {
        return 255;
    }
    let text = (id.len() + ERROR_PER_VARIABLE_BYTES).max(ERROR_UNSUPPORTED_BYTES);
    (ERROR_TEXT_BYTES / text).max(1)
}
