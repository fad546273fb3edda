//! What SUMO answers: values that borrow from the received frame.

use super::wire::{DecodeError, NO_VALUE, Reader, tag};

/// The integer with which SUMO says "no value".
const NO_VALUE_INT: i32 = NO_VALUE as i32;

/// Compounds inside compounds: SUMO's deepest has 3 levels.
const MAX_DEPTH: u8 = 6;

/// How the items of a compound lie. SUMO's own item count is wrong for stops and neighbours, so it is believed only
/// where nothing better is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// As many typed items as the count says.
    Counted,
    /// A typed integer n, then n groups of so many typed items.
    Groups(usize),
    /// A typed integer n, then n groups: a typed integer k and k typed items.
    Nested,
    /// The count is the number of pairs of an untyped string and an untyped double.
    Neighbours,
}

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
    /// Reads a typed value. `layout` says how a compound lies.
    pub(super) fn read(reader: &mut Reader<'a>, layout: Layout) -> Result<Self, DecodeError> {
        Self::read_at(reader, layout, 0)
    }

    fn read_at(reader: &mut Reader<'a>, layout: Layout, depth: u8) -> Result<Self, DecodeError> {
        let before = *reader;
        Ok(match reader.u8()? {
            tag::DOUBLE => known(reader.f64()?).map_or(Self::Missing, Self::Double),
            tag::INT => match reader.i32()? {
                NO_VALUE_INT => Self::Missing,
                v => Self::Int(v),
            },
            tag::TEXT => Self::Text(reader.text()?),
            tag::UBYTE => Self::UByte(reader.u8()?),
            tag::BYTE => Self::Byte(i8::from_be_bytes(reader.take()?)),
            tag::POSITION2 => position(reader, Self::Position2)?,
            tag::POSITION3 => position(reader, Self::Position3)?,
            tag::COLOR => {
                let [red, green, blue, alpha] = reader.take()?;
                Self::Color(Color { red, green, blue, alpha })
            }
            tag::TEXTS => {
                let left = reader.count()?;
                let start = *reader;
                for _ in 0..left {
                    reader.text()?;
                }
                Self::Texts(Texts { left, reader: start })
            }
            tag::DOUBLES => {
                let count = reader.count()?;
                Self::Doubles(Doubles(reader.part(count.saturating_mul(8))?))
            }
            tag::POLYGON => {
                let count = match reader.u8()? {
                    0 => reader.count()?,
                    short => usize::from(short),
                };
                Self::Polygon(Polygon(reader.part(count.saturating_mul(16))?))
            }
            tag::COMPOUND if depth < MAX_DEPTH => Self::Compound(Compound::read(reader, layout, depth)?),
            tag::COMPOUND => return Err(before.error("compounds nested too deep")),
            _ => return Err(before.error("unknown type tag")),
        })
    }

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

impl Iterator for Doubles<'_> {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        self.0.f64().ok()
    }
}

/// Points inside a frame: x, y \[m\].
#[derive(Debug, Clone, Copy)]
pub struct Polygon<'a>(Reader<'a>);

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
    fn read(reader: &mut Reader<'a>, layout: Layout, depth: u8) -> Result<Self, DecodeError> {
        let count = reader.count()?;
        let start = *reader;
        let items = |reader: &mut Reader<'a>, count: usize| -> Result<(), DecodeError> {
            (0..count).try_for_each(|_| Value::read_at(reader, Layout::Counted, depth + 1).map(drop))
        };
        match layout {
            Layout::Counted => items(reader, count)?,
            Layout::Groups(size) => {
                for _ in 0..reader.typed_count()? {
                    items(reader, size)?;
                }
            }
            Layout::Nested => {
                for _ in 0..reader.typed_count()? {
                    let inner = reader.typed_count()?;
                    items(reader, inner)?;
                }
            }
            Layout::Neighbours => {
                for _ in 0..count {
                    reader.text()?;
                    reader.f64()?;
                }
            }
        }
        Ok(Self { count, reader: reader.since(&start) })
    }

    /// A cursor over the items, type tags included.
    #[must_use]
    pub fn reader(&self) -> Reader<'a> {
        self.reader
    }
}

/// `None` for the double with which SUMO says "no value".
fn known(value: f64) -> Option<f64> {
    if value == NO_VALUE { None } else { Some(value) }
}

fn position<'a, const N: usize>(
    reader: &mut Reader<'a>,
    make: impl Fn([f64; N]) -> Value<'a>,
) -> Result<Value<'a>, DecodeError> {
    let mut at = [0.0; N];
    for coordinate in &mut at {
        *coordinate = reader.f64()?;
    }
    Ok(if at.iter().all(|v| *v == NO_VALUE) { Value::Missing } else { make(at) })
}
