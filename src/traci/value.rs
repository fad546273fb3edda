//! What SUMO answers: values that borrow from the received frame.

use super::wire::{NO_VALUE, Reader};

/// A typed value inside a reply.
#[derive(Debug, Clone, Copy)]
pub enum Value<'a> {
    /// SUMO has no value now: the vehicle has not departed or is teleporting. Never a number to compute with.
    Missing,
    /// A double.
    Double(f64),
    /// A 32-bit integer.
    Int(i32),
    /// An unsigned byte.
    UByte(u8),
    /// A signed byte.
    Byte(i8),
    /// A string.
    Text(&'a str),
    /// A list of strings.
    Texts(Texts<'a>),
    /// A list of doubles.
    Doubles(Doubles<'a>),
    /// x, y in the network's coordinates \[m\].
    Position2([f64; 2]),
    /// x, y, z in the network's coordinates \[m\].
    Position3([f64; 3]),
    /// Points x, y \[m\].
    Polygon(Polygon<'a>),
    /// A colour.
    Color(Color),
    /// Several values; its meaning depends on the variable.
    Compound(Compound<'a>),
}

impl<'a> Value<'a> {
    /// The number, if it is a double.
    #[must_use]
    pub fn as_f64(&self) -> Option<f64> {
        if let Value::Double(v) = self { Some(*v) } else { None }
    }

    /// The number, if it is an integer of any width.
    #[must_use]
    pub fn as_i32(&self) -> Option<i32> {
        match self {
            Value::Int(v) => Some(*v),
            Value::UByte(v) => Some(i32::from(*v)),
            Value::Byte(v) => Some(i32::from(*v)),
            _ => None,
        }
    }

    /// The string, if it is one.
    #[must_use]
    pub fn as_str(&self) -> Option<&'a str> {
        if let Value::Text(v) = self { Some(v) } else { None }
    }

    /// The strings, if it is a list of strings.
    #[must_use]
    pub fn as_texts(&self) -> Option<Texts<'a>> {
        if let Value::Texts(v) = self { Some(*v) } else { None }
    }

    /// Name of the kind, for messages.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Missing => "no value",
            Value::Double(_) => "double",
            Value::Int(_) => "integer",
            Value::UByte(_) => "unsigned byte",
            Value::Byte(_) => "byte",
            Value::Text(_) => "string",
            Value::Texts(_) => "string list",
            Value::Doubles(_) => "double list",
            Value::Position2(_) => "2D position",
            Value::Position3(_) => "3D position",
            Value::Polygon(_) => "polygon",
            Value::Color(_) => "colour",
            Value::Compound(_) => "compound",
        }
    }
}

/// Red, green, blue, alpha, 0 to 255 each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Color {
    /// Red.
    pub red: u8,
    /// Green.
    pub green: u8,
    /// Blue.
    pub blue: u8,
    /// 255 is opaque.
    pub alpha: u8,
}

/// A list of strings inside a frame, checked when it was decoded.
#[derive(Debug, Clone, Copy)]
pub struct Texts<'a> {
    left: usize,
    reader: Reader<'a>,
}

impl<'a> Texts<'a> {
    pub(super) fn new(left: usize, reader: Reader<'a>) -> Self {
        Self { left, reader }
    }
}

impl<'a> Iterator for Texts<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        self.left = self.left.checked_sub(1)?;
        self.reader.text().ok()
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}

impl ExactSizeIterator for Texts<'_> {}

/// A list of doubles inside a frame.
#[derive(Debug, Clone, Copy)]
pub struct Doubles<'a>(Reader<'a>);

impl<'a> Doubles<'a> {
    pub(super) fn new(reader: Reader<'a>) -> Self {
        Self(reader)
    }
}

impl Iterator for Doubles<'_> {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        self.0.f64().ok()
    }
}

/// Points inside a frame: x, y \[m\].
#[derive(Debug, Clone, Copy)]
pub struct Polygon<'a>(Reader<'a>);

impl<'a> Polygon<'a> {
    pub(super) fn new(reader: Reader<'a>) -> Self {
        Self(reader)
    }
}

impl Iterator for Polygon<'_> {
    type Item = [f64; 2];

    fn next(&mut self) -> Option<[f64; 2]> {
        Some([self.0.f64().ok()?, self.0.f64().ok()?])
    }
}

/// The items of a compound. SUMO's item count is wrong for some variables; [`Compound::reader`] is limited to the
/// compound's real extent.
#[derive(Debug, Clone, Copy)]
pub struct Compound<'a> {
    pub(super) count: usize,
    reader: Reader<'a>,
}

impl<'a> Compound<'a> {
    pub(super) fn new(count: usize, reader: Reader<'a>) -> Self {
        Self { count, reader }
    }

    /// A cursor over the items, type tags included.
    #[must_use]
    pub fn reader(&self) -> Reader<'a> {
        self.reader
    }
}

/// `None` for the double with which SUMO says "no value".
#[must_use]
pub(super) fn known(value: f64) -> Option<f64> {
    if value == NO_VALUE { None } else { Some(value) }
}
