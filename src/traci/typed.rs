//! Variables as constants with types: what a get brings, what a set takes, what parameter it needs.

use std::marker::PhantomData;

use super::error::{BatchError, Error};
use super::value::{Color, Layout, Value};
use super::wire::{put_compound, put_count, put_f64, put_i32, put_text, tag};

/// The kinds of objects in the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Domain {
    /// Traffic lights.
    TrafficLight = 0x2,
    /// Lanes.
    Lane = 0x3,
    /// Vehicles.
    Vehicle = 0x4,
    /// Vehicle types.
    VehicleType = 0x5,
    /// Routes.
    Route = 0x6,
    /// Junctions.
    Junction = 0x9,
    /// Edges.
    Edge = 0xa,
    /// The simulation itself; its object id is "".
    Simulation = 0xb,
}

impl Domain {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Simulation,
        Self::Vehicle,
        Self::VehicleType,
        Self::Route,
        Self::Edge,
        Self::Lane,
        Self::Junction,
        Self::TrafficLight,
    ];

    pub(crate) fn get_command(self) -> u8 {
        0xa0 | self as u8
    }

    pub(super) fn set_command(self) -> u8 {
        0xc0 | self as u8
    }

    pub(super) fn subscribe_command(self) -> u8 {
        0xd0 | self as u8
    }

    pub(super) fn from_subscription(response: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|domain| response == 0xe0 | *domain as u8)
    }
}

/// In place of a type: the variable cannot be read, or cannot be set.
#[derive(Debug, Clone, Copy)]
pub enum Never {}

/// A variable: `T` is what a get brings, `S` what a set takes, `P` the parameter of the get. [`Never`] in one of these
/// places makes the wrong use a compile error.
#[derive(Debug)]
pub struct Var<T, S = Never, P = ()> {
    /// What it is a variable of.
    pub domain: Domain,
    /// Its identifier in gets and subscriptions (and mostly in sets).
    pub id: u8,
    pub(super) set_id: u8,
    types: PhantomData<fn(S, P) -> T>,
}

impl<T, S, P> Clone for Var<T, S, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T, S, P> Copy for Var<T, S, P> {}

impl<T, S, P> Var<T, S, P> {
    /// A variable that is not in the table. The types are the caller's promise; a wrong one shows as [`Error::Type`] or
    /// as a refusal.
    #[must_use]
    pub const fn new(domain: Domain, id: u8) -> Self {
        Self::row(domain, id, id)
    }

    pub(super) const fn row(domain: Domain, id: u8, set_id: u8) -> Self {
        Self { domain, id, set_id, types: PhantomData }
    }
}

/// What can be read.
pub trait FromValue: Sized {
    /// How the compound that brings it lies in the reply; of no meaning for other types.
    const LAYOUT: Layout = Layout::Counted;

    /// Takes the value apart.
    ///
    /// # Errors
    /// [`Error::NoValue`] if SUMO has none now, [`Error::Type`] if it has another type.
    fn from_value(value: Value<'_>) -> Result<Self, Error>;
}

pub(super) fn mismatch<T>(expected: &'static str, value: &Value<'_>) -> Result<T, Error> {
    match value {
        Value::Missing => Err(Error::NoValue),
        other => Err(Error::Type { expected, got: other.kind() }),
    }
}

macro_rules! from_value {
    ($($type:ty, $name:literal: $($pattern:pat => $make:expr),+;)+) => {$(
        impl FromValue for $type {
            fn from_value(value: Value<'_>) -> Result<Self, Error> {
                match value {
                    $($pattern => Ok($make),)+
                    other => mismatch($name, &other),
                }
            }
        }
    )+};
}

from_value! {
    f64, "double": Value::Double(v) => v;
    i32, "integer": Value::Int(v) => v, Value::UByte(v) => i32::from(v), Value::Byte(v) => i32::from(v);
    bool, "truth value": Value::UByte(v) => v != 0, Value::Byte(v) => v != 0, Value::Int(v) => v != 0;
    String, "string": Value::Text(v) => v.to_owned();
    Vec<String>, "string list": Value::Texts(v) => v.map(str::to_owned).collect();
    Vec<f64>, "double list": Value::Doubles(v) => v.collect();
    [f64; 2], "2D position": Value::Position2(v) => v;
    [f64; 3], "3D position": Value::Position3(v) => v;
    Vec<[f64; 2]>, "polygon": Value::Polygon(v) => v.collect();
    Color, "colour": Value::Color(v) => v;
}

impl<T: FromValue> FromValue for Option<T> {
    const LAYOUT: Layout = T::LAYOUT;

    /// For variables that may have no value at any time: "no value" becomes `None`.
    fn from_value(value: Value<'_>) -> Result<Self, Error> {
        match value {
            Value::Missing => Ok(None),
            other => T::from_value(other).map(Some),
        }
    }
}

/// Refuses a number that is not finite; `what` names it.
pub(crate) fn finite(what: &'static str, value: f64) -> Result<f64, BatchError> {
    if value.is_finite() { Ok(value) } else { Err(BatchError::BadNumber { what, value }) }
}

/// What can be sent: the value of a set or the parameter of a get. Numbers that are not finite are refused.
pub trait Shape {
    /// The argument a caller gives.
    type Arg<'a>;

    /// Number of typed items it consists of.
    const ITEMS: usize = 1;

    /// Appends it with its type.
    ///
    /// # Errors
    /// If a number is not finite.
    fn put(value: Self::Arg<'_>, out: &mut Vec<u8>) -> Result<(), BatchError>;
}

impl Shape for () {
    type Arg<'a> = ();
    const ITEMS: usize = 0;

    fn put((): (), _: &mut Vec<u8>) -> Result<(), BatchError> {
        Ok(())
    }
}

impl Shape for f64 {
    type Arg<'a> = f64;

    fn put(value: f64, out: &mut Vec<u8>) -> Result<(), BatchError> {
        out.push(tag::DOUBLE);
        put_f64(out, finite("number", value)?);
        Ok(())
    }
}

impl Shape for i32 {
    type Arg<'a> = i32;

    fn put(value: i32, out: &mut Vec<u8>) -> Result<(), BatchError> {
        out.push(tag::INT);
        put_i32(out, value);
        Ok(())
    }
}

impl Shape for i8 {
    type Arg<'a> = i8;

    fn put(value: i8, out: &mut Vec<u8>) -> Result<(), BatchError> {
        out.push(tag::BYTE);
        out.extend_from_slice(&value.to_be_bytes());
        Ok(())
    }
}

impl Shape for u8 {
    type Arg<'a> = u8;

    fn put(value: u8, out: &mut Vec<u8>) -> Result<(), BatchError> {
        out.extend_from_slice(&[tag::UBYTE, value]);
        Ok(())
    }
}

impl Shape for String {
    type Arg<'a> = &'a str;

    fn put(value: &str, out: &mut Vec<u8>) -> Result<(), BatchError> {
        out.push(tag::TEXT);
        put_text(out, value);
        Ok(())
    }
}

impl Shape for Vec<String> {
    type Arg<'a> = &'a [&'a str];

    fn put(value: &[&str], out: &mut Vec<u8>) -> Result<(), BatchError> {
        out.push(tag::TEXTS);
        put_count(out, value.len());
        for text in value {
            put_text(out, text);
        }
        Ok(())
    }
}

impl Shape for Color {
    type Arg<'a> = Color;

    fn put(value: Color, out: &mut Vec<u8>) -> Result<(), BatchError> {
        out.extend_from_slice(&[tag::COLOR, value.red, value.green, value.blue, value.alpha]);
        Ok(())
    }
}

/// A place on a road: edge, distance from its start \[m\], lane index.
#[derive(Debug, Clone, Copy)]
pub struct RoadPosition<'a> {
    /// The edge.
    pub edge: &'a str,
    /// Distance from its start \[m\].
    pub position_m: f64,
    /// Lane, 0 is the outermost.
    pub lane: u8,
}

/// [`RoadPosition`] as a type of the table.
#[derive(Debug)]
pub enum OnRoad {}

impl Shape for OnRoad {
    type Arg<'a> = RoadPosition<'a>;

    fn put(value: RoadPosition<'_>, out: &mut Vec<u8>) -> Result<(), BatchError> {
        out.push(0x04);
        put_text(out, value.edge);
        put_f64(out, finite("position", value.position_m)?);
        out.push(value.lane);
        Ok(())
    }
}

/// How a distance is measured. On the wire it is, unlike all other parameters, a byte without a type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Distance {
    /// As the crow flies.
    Air = 0x00,
    /// Along the roads.
    Driving = 0x01,
}

impl Shape for Distance {
    type Arg<'a> = Distance;

    fn put(value: Distance, out: &mut Vec<u8>) -> Result<(), BatchError> {
        out.push(value as u8);
        Ok(())
    }
}

/// A plane position x, y \[m\] as a type of the table.
impl Shape for [f64; 2] {
    type Arg<'a> = [f64; 2];

    fn put(value: [f64; 2], out: &mut Vec<u8>) -> Result<(), BatchError> {
        out.push(tag::POSITION2);
        for coordinate in value {
            put_f64(out, finite("coordinate", coordinate)?);
        }
        Ok(())
    }
}

/// A compound without items, as commands without arguments want it.
#[derive(Debug)]
pub enum Nothing {}

impl Shape for Nothing {
    type Arg<'a> = ();

    fn put((): (), out: &mut Vec<u8>) -> Result<(), BatchError> {
        put_compound(out, 0);
        Ok(())
    }
}

macro_rules! tuples {
    ($($($name:ident)+;)+) => {$(
        impl<$($name: Shape),+> Shape for ($($name,)+) {
            type Arg<'a> = ($($name::Arg<'a>,)+);

            fn put(value: Self::Arg<'_>, out: &mut Vec<u8>) -> Result<(), BatchError> {
                #[allow(non_snake_case)]
                let ($($name,)+) = value;
                put_compound(out, 0 $(+ $name::ITEMS)+);
                $($name::put($name, out)?;)+
                Ok(())
            }
        }
    )+};
}

// A tuple is a compound of its items.
tuples! {
    A;
    A B;
    A B C;
    A B C D;
    A B C D E;
    A B C D E F;
    A B C D E F G;
}
