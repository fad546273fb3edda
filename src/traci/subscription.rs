//! Subscriptions that keep the types of their variables: what [`super::Batch::subscribe`] takes is what
//! [`Block::read`] takes, and it returns a value of each variable's own type.
//!
//! A variable, a tuple of up to eight, or a slice of variables of one type can be subscribed to. Variables that need a
//! parameter do not compile here; [`super::Batch::subscribe_with`] takes them.

use super::error::Error;
use super::typed::{Domain, FromValue, Var};
use super::value::Value;
use super::variables::layout;
use super::wire::{DecodeError, Reader};

/// High four bits of the answer to a subscription; the low ones are the domain.
pub(super) const SUBSCRIBED: u8 = 0xe0;

/// What a block says about the variables asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Subscribed<T> {
    /// Their values. `None` inside is "no value now" (not departed, teleporting).
    Own(T),
    /// The object is gone.
    Removed,
    /// The block is about other variables: it answers another subscription.
    Foreign,
}

/// Variables that are subscribed to together, all of one domain.
pub trait Variables: Copy {
    /// Their values, in the same form.
    type Values;

    /// Appends domain and identifier of each.
    fn list(self, into: &mut Vec<(Domain, u8)>);

    /// Reads the values of each.
    ///
    /// # Errors
    /// As [`Block::read`].
    fn read(self, entries: &mut Entries<'_>) -> Result<Subscribed<Self::Values>, Error>;
}

impl<T: FromValue, S> Variables for Var<T, S> {
    type Values = Option<T>;

    fn list(self, into: &mut Vec<(Domain, u8)>) {
        into.push((self.domain, self.id));
    }

    fn read(self, entries: &mut Entries<'_>) -> Result<Subscribed<Option<T>>, Error> {
        if entries.domain != Some(self.domain) {
            return Ok(Subscribed::Foreign);
        }
        Ok(match entries.find(self.id)? {
            Some(Ok(Value::Missing)) => Subscribed::Own(None),
            Some(Ok(value)) => Subscribed::Own(Some(T::from_value(value)?)),
            Some(Err(_)) => Subscribed::Removed,
            None => Subscribed::Foreign,
        })
    }
}

impl<V: Variables> Variables for &[V] {
    type Values = Vec<V::Values>;

    fn list(self, into: &mut Vec<(Domain, u8)>) {
        self.iter().for_each(|variable| variable.list(into));
    }

    fn read(self, entries: &mut Entries<'_>) -> Result<Subscribed<Self::Values>, Error> {
        let mut values = Vec::with_capacity(self.len());
        for variable in self {
            match variable.read(entries)? {
                Subscribed::Own(value) => values.push(value),
                Subscribed::Removed => return Ok(Subscribed::Removed),
                Subscribed::Foreign => return Ok(Subscribed::Foreign),
            }
        }
        Ok(Subscribed::Own(values))
    }
}

macro_rules! tuples {
    ($($($name:ident)+;)+) => {$(
        impl<$($name: Variables),+> Variables for ($($name,)+) {
            type Values = ($($name::Values,)+);

            fn list(self, into: &mut Vec<(Domain, u8)>) {
                #[allow(non_snake_case)]
                let ($($name,)+) = self;
                $($name.list(into);)+
            }

            fn read(self, entries: &mut Entries<'_>) -> Result<Subscribed<Self::Values>, Error> {
                #[allow(non_snake_case)]
                let ($($name,)+) = self;
                Ok(Subscribed::Own(($(match $name.read(entries)? {
                    Subscribed::Own(values) => values,
                    Subscribed::Removed => return Ok(Subscribed::Removed),
                    Subscribed::Foreign => return Ok(Subscribed::Foreign),
                },)+)))
            }
        }
    )+};
}

tuples! {
    A B;
    A B C;
    A B C D;
    A B C D E;
    A B C D E F;
    A B C D E F G;
    A B C D E F G H;
}

/// The entries of a block, searched by variable. In the order of subscribing no entry is looked at twice.
#[derive(Debug)]
pub struct Entries<'a> {
    domain: Option<Domain>,
    all: Values<'a>,
    next: Values<'a>,
}

impl<'a> Entries<'a> {
    fn find(&mut self, variable: u8) -> Result<Option<Result<Value<'a>, &'a str>>, DecodeError> {
        let in_turn = self.next.next().into_iter();
        for entry in in_turn.chain(self.all.clone()) {
            let (id, value) = entry?;
            if id == variable {
                return Ok(Some(value));
            }
        }
        Ok(None)
    }
}

/// Subscribed values of one object.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    /// Its domain; `None` for a context subscription (of another client) and domains outside the table.
    pub domain: Option<Domain>,
    /// The object.
    pub id: &'a str,
    response: u8,
    count: u8,
    values: Reader<'a>,
}

impl<'a> Block<'a> {
    pub(super) fn decode(reader: &mut Reader<'a>) -> Result<Self, DecodeError> {
        let (response, mut values) = reader.command()?;
        let id = values.text()?;
        let domain = Domain::from_subscription(response);
        let count = if response & 0xf0 == SUBSCRIBED { values.u8()? } else { 0 };
        Ok(Self { domain, id, response, count, values })
    }

    /// The values, in the order of subscribing: variable, and its value or SUMO's reason for having none (mostly that the
    /// object is gone).
    #[must_use]
    pub fn values(&self) -> Values<'a> {
        Values { response: self.response, left: self.count, reader: self.values }
    }

    /// The values of variables that were subscribed to, each by its own type: `read((vehicle::SPEED, vehicle::LANE))`.
    ///
    /// # Errors
    /// [`Error::Type`] if a value has another type than the table says, [`Error::Decode`] for bad bytes.
    pub fn read<V: Variables>(&self, variables: V) -> Result<Subscribed<V::Values>, Error> {
        variables.read(&mut Entries { domain: self.domain, all: self.values(), next: self.values() })
    }

    /// One variable, also one that takes a parameter; `Ok(None)` if the block does not hold it.
    ///
    /// # Errors
    /// [`Error::Refused`] if SUMO gives a reason instead of a value (mostly that the object is gone), [`Error::NoValue`]
    /// if there is none now, and as [`Block::read`].
    pub fn get<T: FromValue, S, P>(&self, variable: Var<T, S, P>) -> Result<Option<T>, Error> {
        for entry in self.values() {
            let (id, value) = entry?;
            if id == variable.id {
                let value = value.map_err(|text| Error::Refused { text: text.to_owned(), not_implemented: false })?;
                return T::from_value(value).map(Some);
            }
        }
        Ok(None)
    }
}

/// Iterator over the values of a block.
#[derive(Debug, Clone)]
pub struct Values<'a> {
    response: u8,
    left: u8,
    reader: Reader<'a>,
}

impl<'a> Values<'a> {
    fn entry(&mut self) -> Result<(u8, Result<Value<'a>, &'a str>), DecodeError> {
        let variable = self.reader.u8()?;
        let start = self.reader;
        let value = match self.reader.u8()? {
            0x00 => Ok(Value::read(&mut self.reader, layout(self.response, variable))?),
            0xff => Err(self.reader.typed_text()?),
            _ => return Err(start.error("unknown status")),
        };
        if self.left == 0 {
            self.reader.finish()?;
        }
        Ok((variable, value))
    }
}

impl<'a> Iterator for Values<'a> {
    type Item = Result<(u8, Result<Value<'a>, &'a str>), DecodeError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.left = self.left.checked_sub(1)?;
        let entry = self.entry();
        if entry.is_err() {
            self.left = 0;
        }
        Some(entry)
    }
}
