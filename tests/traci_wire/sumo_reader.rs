//! How SUMO reads our requests, written down from its side (`tcpip::Storage`, `TraCIServer::dispatchCommand` and the handlers
//! of the domains, SUMO 1.15 to 1.28), apart from the code under test. What makes SUMO quit, hang or die is an error here:
//! a length that is not that of its command, a type that its handler does not read, a text beyond the end, a step that is
//! not the last command, a number that is none, and an error text that does not fit the one byte of a status.

/// SUMO has a byte for the length of a status, of which seven are not the text.
const STATUS_TEXT_MAX: usize = 248;
/// The longest text around the id of an object that does not exist.
const AROUND_ID: usize = 60;
/// In a refused subscription there is one for each variable, with at least so much around the id ...
const AROUND_ID_OF_EACH: usize = 40;
/// ... and for a variable that this SUMO does not have.
const UNSUPPORTED: usize = 70;

/// A value as it was read.
#[derive(Debug, Clone, PartialEq)]
pub enum Read {
    Double(f64),
    Int(i32),
    Byte(i8),
    UByte(u8),
    Text(String),
    Texts(Vec<String>),
    Color([u8; 4]),
    Compound(Vec<Read>),
    OnRoad(String, f64, u8),
    /// A byte without a type.
    Bare(u8),
}

/// What a handler reads.
#[derive(Debug, Clone, Copy)]
enum Want {
    Double,
    Int,
    Byte,
    UByte,
    Text,
    Texts,
    Color,
    Compound(&'static [Want]),
    OnRoad,
    Bare,
}

/// A command as SUMO understood it.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    Version,
    Step { until_s: f64 },
    Order(i32),
    ExecuteMove,
    Close,
    Get { domain: u8, variable: u8, id: String, parameter: Option<Read> },
    Set { domain: u8, variable: u8, id: String, value: Option<Read> },
    Subscribe { domain: u8, id: String, begin_s: f64, end_s: f64, variables: Vec<(u8, Option<Read>)> },
}

/// Reads a whole message.
pub fn read(message: &[u8]) -> Result<Vec<Command>, String> {
    let mut storage = Storage { bytes: message, at: 0 };
    let total = usize::try_from(storage.int()?).map_err(|_| "a negative length")?;
    if total != message.len() {
        return Err(format!("SUMO waits for {total} bytes and gets {}", message.len()));
    }
    let mut commands = Vec::new();
    while storage.at < message.len() {
        if matches!(commands.last(), Some(Command::Step { .. } | Command::ExecuteMove)) {
            return Err("a command behind a step".to_owned());
        }
        let start = storage.at;
        let length = match storage.byte()? {
            0 => usize::try_from(storage.int()?).map_err(|_| "a negative length")?,
            short => usize::from(short),
        };
        let id = storage.byte()?;
        commands.push(storage.command(id).map_err(|what| format!("command 0x{id:02x} at {start}: {what}"))?);
        if storage.at != start + length {
            return Err(format!("command 0x{id:02x} at {start} has {length} bytes, SUMO reads {}", storage.at - start));
        }
    }
    Ok(commands)
}

struct Storage<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Storage<'_> {
    fn take(&mut self, count: usize) -> Result<&[u8], String> {
        let part = self.bytes.get(self.at..self.at + count).ok_or("beyond the end of the message")?;
        self.at += count;
        Ok(part)
    }

    fn byte(&mut self) -> Result<u8, String> {
        Ok(self.take(1)?[0])
    }

    fn int(&mut self) -> Result<i32, String> {
        Ok(i32::from_be_bytes(self.take(4)?.try_into().unwrap()))
    }

    fn double(&mut self) -> Result<f64, String> {
        let value = f64::from_be_bytes(self.take(8)?.try_into().unwrap());
        if value.is_finite() { Ok(value) } else { Err(format!("the number {value}")) }
    }

    fn text(&mut self) -> Result<String, String> {
        let length = usize::try_from(self.int()?).map_err(|_| "a text of negative length")?;
        String::from_utf8(self.take(length)?.to_vec()).map_err(|error| error.to_string())
    }

    fn of_type(&mut self, wanted: u8) -> Result<(), String> {
        let found = self.byte()?;
        if found == wanted { Ok(()) } else { Err(format!("type 0x{found:02x}, the handler reads 0x{wanted:02x}")) }
    }

    fn value(&mut self, want: Want) -> Result<Read, String> {
        let tag = match want {
            Want::Double => 0x0b,
            Want::Int => 0x09,
            Want::Byte => 0x08,
            Want::UByte => 0x07,
            Want::Text => 0x0c,
            Want::Texts => 0x0e,
            Want::Color => 0x11,
            Want::Compound(_) => 0x0f,
            Want::OnRoad => 0x04,
            Want::Bare => return Ok(Read::Bare(self.byte()?)),
        };
        self.of_type(tag)?;
        Ok(match want {
            Want::Double => Read::Double(self.double()?),
            Want::Int => Read::Int(self.int()?),
            Want::Byte => Read::Byte(i8::from_be_bytes([self.byte()?])),
            Want::UByte | Want::Bare => Read::UByte(self.byte()?),
            Want::Text => Read::Text(self.text()?),
            Want::Texts => {
                let count = usize::try_from(self.int()?).map_err(|_| "a list of negative length")?;
                Read::Texts((0..count).map(|_| self.text()).collect::<Result<_, _>>()?)
            }
            Want::Color => Read::Color(self.take(4)?.try_into().unwrap()),
            Want::OnRoad => Read::OnRoad(self.text()?, self.double()?, self.byte()?),
            Want::Compound(items) => {
                let count = self.int()?;
                if usize::try_from(count) != Ok(items.len()) {
                    return Err(format!("a compound of {count} items, the handler reads {}", items.len()));
                }
                Read::Compound(items.iter().map(|item| self.value(*item)).collect::<Result<_, _>>()?)
            }
        })
    }

    fn optional(&mut self, want: Option<Want>) -> Result<Option<Read>, String> {
        want.map(|want| self.value(want)).transpose()
    }

    fn command(&mut self, id: u8) -> Result<Command, String> {
        let domain = id & 0x0f;
        match id & 0xf0 {
            0x00 | 0x70 => match id {
                0x00 => Ok(Command::Version),
                0x02 => Ok(Command::Step { until_s: self.double()? }),
                0x03 => Ok(Command::Order(self.int()?)),
                0x7d => Ok(Command::ExecuteMove),
                0x7f => Ok(Command::Close),
                _ => Err("no command of ours".to_owned()),
            },
            0xa0 => {
                let (variable, from, id) = (self.byte()?, self.at, self.text()?);
                let parameter = self.optional(parameter(domain, variable))?;
                // SUMO repeats what was asked for.
                answerable(self.at - from + AROUND_ID - 20)?;
                Ok(Command::Get { domain, variable, id, parameter })
            }
            0xc0 => {
                let (variable, id) = (self.byte()?, self.text()?);
                answerable(id.len() + AROUND_ID)?;
                let want = setting(domain, variable).ok_or(format!("no handler sets 0x{variable:02x}"))?;
                let value = self.optional(want)?;
                Ok(Command::Set { domain, variable, id, value })
            }
            0xd0 => self.subscription(domain),
            _ => Err("no command of ours".to_owned()),
        }
    }

    fn subscription(&mut self, domain: u8) -> Result<Command, String> {
        let (begin_s, end_s, id, count) = (self.double()?, self.double()?, self.text()?, self.byte()?);
        let mut variables = Vec::new();
        for _ in 0..count {
            let variable = self.byte()?;
            // Stops need no parameter in a get, but in a subscription.
            let want = if (domain, variable) == (4, 0x73) { Some(Want::Int) } else { parameter(domain, variable) };
            variables.push((variable, self.optional(want)?));
        }
        // The simulation is always there.
        if domain != 0xb {
            let of_each = (id.len() + AROUND_ID_OF_EACH).max(UNSUPPORTED);
            let text = if count <= 1 { id.len() + AROUND_ID } else { usize::from(count) * of_each };
            answerable(text)?;
        }
        Ok(Command::Subscribe { domain, id, begin_s, end_s, variables })
    }
}

/// Whether SUMO could say in a status that something is wrong.
fn answerable(text: usize) -> Result<(), String> {
    if text <= STATUS_TEXT_MAX { Ok(()) } else { Err(format!("an error of {text} bytes, which ends SUMO")) }
}

/// What the handler of a get reads behind the id.
fn parameter(domain: u8, variable: u8) -> Option<Want> {
    use Want::{Bare, Compound, Double, Int, OnRoad, Text, UByte};
    Some(match (domain, variable) {
        (_, 0x7e) => Text,
        (4, 0x68 | 0x78 | 0x37) => Double,
        (4, 0x74) => Int,
        (4, 0xbf) => UByte,
        (4, 0x1c) => Compound(&[Double, Double, Double, Double, Text]),
        (4, 0x1d) => Compound(&[Double, Double]),
        (4, 0x1e) => Compound(&[Double, Double, Double, Text]),
        (4, 0x83) => Compound(&[OnRoad, Bare]),
        (0xb, 0x83) => Compound(&[OnRoad, OnRoad, Bare]),
        (0xb, 0x82) => Compound(&[OnRoad, UByte]),
        (0xb, 0x86) => Compound(&[Text, Text, Text, Double, Int]),
        (0xa, 0x58 | 0x59 | 0x43) | (3, 0x43) => Double,
        (3, 0x37) => Text,
        (2, 0x25 | 0x30 | 0x31) => Int,
        _ => return None,
    })
}

/// What the handler of a set reads behind the id; the inner `None` is one that reads nothing.
fn setting(domain: u8, variable: u8) -> Option<Option<Want>> {
    use Want::{Byte, Color, Compound, Double, Int, Text, Texts};
    const TEXT_TWICE: Want = Compound(&[Text, Text]);
    const DOUBLE_TWICE: Want = Compound(&[Double, Double]);
    let adding: Want = Compound(&[Text, Text, Text, Text, Text, Text, Text, Text, Text, Text, Text, Text, Int, Int]);
    Some(Some(match (domain, variable) {
        (_, 0x7e) => TEXT_TWICE,
        (0xb, 0x8e) => Double,
        (0xb, 0x94 | 0x65) => Text,
        (4, 0x3c | 0x72 | 0x14) => DOUBLE_TWICE,
        (4, 0xb3 | 0x89 | 0x5b | 0xb6) => Int,
        (4, 0x4f | 0x49 | 0x4b | 0x4a | 0xb9 | 0x53 | 0x31 | 0xbd) => Text,
        (4 | 5, 0x45) => Color,
        (4, 0x57 | 0xbe) => Texts,
        (4, 0x90 | 0x19) => Compound(&[]),
        (4, 0x13) => Compound(&[Byte, Double]),
        (4, 0x5c) => Compound(&[Text, Double]),
        (4, 0x12) => Compound(&[Text, Double, Byte, Double, Byte, Double, Double]),
        (4, 0x85) => adding,
        (4, 0x81) => Byte,
        (4, 0x40 | 0x41 | 0x5e | 0xb8 | 0x44 | 0x4d | 0xbc | 0xc8 | 0x4c | 0xbb | 0xba | 0x46 | 0x47 | 0x7b | 0x7c)
        | (4, 0x5d | 0x48 | 0x7d | 0x15) => Double,
        (5, 0xb9 | 0x49 | 0x4a | 0x4b | 0x88) => Text,
        (5, 0x38) => Int,
        (5, 0x44 | 0x4d | 0xbc | 0xc8 | 0x41 | 0x5e | 0x5f | 0x46 | 0x47 | 0x7b | 0x7c | 0x5d | 0x26 | 0x48 | 0x4c)
        | (5, 0xbb | 0xba | 0x7d | 0x8e) => Double,
        (6, 0x80) => Texts,
        (6, 0x81) => return Some(None),
        (0xa, 0x58 | 0x59) => Compound(&[Double]),
        (0xa, 0x41) | (3, 0x44 | 0x41) => Double,
        (0xa | 3, 0x34 | 0x35) => Texts,
        (2, 0x20 | 0x23 | 0x1b) => Text,
        (2, 0x22) => Int,
        (2, 0x24) => Double,
        _ => return None,
    }))
}
