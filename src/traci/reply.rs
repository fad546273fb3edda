//! A reply, read in place: one status per command, values of gets, blocks of subscribed values.
//!
//! When a frame arrives its outer structure is checked in one quick pass (statuses in order, lengths that add up, no
//! byte left over); values are decoded when asked for, without copies.

use super::batch::{Answer, Batch, Expected, Handle};
use super::error::Error;
use super::subscription::{Block, SUBSCRIBED};
use super::typed::FromValue;
use super::value::Value;
use super::variables::layout;
use super::wire::{DecodeError, Reader, frame_length};

/// High four bits of the answer to a get; the low ones are the domain.
const GOT: u8 = 0xb0;

/// SUMO declined a command. The connection is well, the other commands of the batch were carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Refusal<'a> {
    /// SUMO's reason.
    pub text: &'a str,
    /// True if this SUMO does not know the command at all.
    pub not_implemented: bool,
}

impl From<Refusal<'_>> for Error {
    fn from(refusal: Refusal<'_>) -> Self {
        Self::Refused { text: refusal.text.to_owned(), not_implemented: refusal.not_implemented }
    }
}

/// Offsets in the frame: of the status if it is a refusal, and of what follows it; 0 means there is none.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Mark {
    refusal: u32,
    answer: u32,
}

/// Where the answers lie in a frame: what the first pass finds. Reusable; keeps its memory.
#[derive(Debug, Clone, Default)]
pub struct Index {
    marks: Vec<Mark>,
    refusals: usize,
    blocks: usize,
    blocks_at: usize,
}

/// Offsets fit because a frame's length is an `i32`.
fn offset(at: usize) -> u32 {
    u32::try_from(at).unwrap_or(u32::MAX)
}

impl Index {
    /// Matches a complete frame (length included, see [`super::wire::frame_length`]) with the batch it answers.
    ///
    /// # Errors
    /// If the statuses are not those of the batch, a length does not add up, or bytes are left over.
    pub fn read<'a>(&'a mut self, frame: &'a [u8], batch: &Batch) -> Result<Reply<'a>, DecodeError> {
        if frame_length(frame)? != Some(frame.len()) {
            return Err(DecodeError { offset: 0, what: "frame length differs from the bytes there" });
        }
        self.fill(frame, batch.expected().iter().copied())?;
        Ok(self.reply(frame))
    }

    pub(super) fn fill(
        &mut self,
        frame: &[u8],
        expected: impl IntoIterator<Item = Expected>,
    ) -> Result<(), DecodeError> {
        self.marks.clear();
        (self.refusals, self.blocks, self.blocks_at) = (0, 0, 0);
        let mut reader = Reader::new(frame, 4);
        for command in expected {
            let mark = self.answer(&mut reader, command)?;
            self.refusals += usize::from(mark.refusal != 0);
            self.marks.push(mark);
        }
        reader.finish()
    }

    fn answer(&mut self, reader: &mut Reader<'_>, expected: Expected) -> Result<Mark, DecodeError> {
        let status_at = reader.offset();
        let accepted = status(reader, expected.command)?;
        let mut mark = Mark::default();
        if !accepted {
            mark.refusal = offset(status_at);
        }
        let answer_at = reader.offset();
        match expected.answer {
            Answer::Get(variable) if accepted => {
                let start = *reader;
                let (command, mut body) = reader.command()?;
                if command != expected.command.wrapping_add(0x10) || body.u8()? != variable {
                    return Err(start.error("answer to another get than asked"));
                }
                mark.answer = offset(answer_at);
            }
            // A refused subscription is mostly, but not always, followed by a block with the reasons. A status never
            // starts with 0 and a block always does.
            Answer::Subscription if accepted || next_is_block(reader, expected.command) => {
                let start = *reader;
                if reader.command()?.0 != expected.command.wrapping_add(0x10) {
                    return Err(start.error("block of another domain than subscribed"));
                }
                mark.answer = offset(answer_at);
            }
            Answer::Version if accepted => {
                let start = *reader;
                if reader.command()?.0 != expected.command {
                    return Err(start.error("not a version"));
                }
                mark.answer = offset(answer_at);
            }
            Answer::Step if accepted => {
                self.blocks = reader.count()?;
                self.blocks_at = reader.offset();
                for _ in 0..self.blocks {
                    reader.command()?;
                }
            }
            _ => {}
        }
        Ok(mark)
    }

    pub(super) fn reply<'a>(&'a self, frame: &'a [u8]) -> Reply<'a> {
        Reply { frame, index: self }
    }
}

/// Consumes a status; true if it is OK.
fn status(reader: &mut Reader<'_>, command: u8) -> Result<bool, DecodeError> {
    if reader.rest().first_chunk::<7>() == Some(&[7, command, 0, 0, 0, 0, 0]) {
        reader.skip(7)?;
        return Ok(true);
    }
    let start = *reader;
    let (found, mut body) = reader.command()?;
    if found != command {
        return Err(start.error("status of another command than sent"));
    }
    let result = body.u8()?;
    body.text()?;
    body.finish()?;
    match result {
        0x00 => Ok(true),
        0x01 | 0xff => Ok(false),
        _ => Err(start.error("unknown status")),
    }
}

fn next_is_block(reader: &Reader<'_>, command: u8) -> bool {
    let rest = reader.rest();
    rest.first() == Some(&0) && rest.get(5) == Some(&command.wrapping_add(0x10))
}

/// The answers to one batch, borrowed from the client's buffer.
#[derive(Debug, Clone, Copy)]
pub struct Reply<'a> {
    frame: &'a [u8],
    index: &'a Index,
}

impl<'a> Reply<'a> {
    /// Number of commands answered.
    #[must_use]
    pub fn len(&self) -> usize {
        self.index.marks.len()
    }

    /// True if the batch had no commands.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.index.marks.is_empty()
    }

    /// The bytes of the whole answer, length included.
    #[must_use]
    pub fn frame(&self) -> &'a [u8] {
        self.frame
    }

    fn answer_at(&self, command: usize) -> Option<usize> {
        usize::try_from(self.mark(command).answer).ok().filter(|at| *at != 0)
    }

    fn mark(&self, command: usize) -> Mark {
        self.index.marks.get(command).copied().unwrap_or_default()
    }

    /// Why SUMO declined the command with this number; `None` if it did not.
    #[must_use]
    pub fn refusal(&self, command: usize) -> Option<Refusal<'a>> {
        let at = usize::try_from(self.mark(command).refusal).ok().filter(|at| *at != 0)?;
        let (_, mut body) = Reader::new(self.frame, at).command().ok()?;
        let result = body.u8().ok()?;
        Some(Refusal { text: body.text().ok()?, not_implemented: result == 0x01 })
    }

    /// All declined commands: number and reason. Costs nothing when there are none.
    pub fn refusals(&self) -> impl Iterator<Item = (usize, Refusal<'a>)> + use<'a> {
        let reply = *self;
        let commands = if reply.index.refusals == 0 { 0 } else { reply.len() };
        (0..commands).filter_map(move |command| Some((command, reply.refusal(command)?)))
    }

    /// Cursor behind the header of a get's answer, and its variable.
    fn got(&self, command: usize) -> Option<(u8, u8, Reader<'a>)> {
        let at = self.answer_at(command)?;
        let (domain, mut body) = Reader::new(self.frame, at).command().ok()?;
        let variable = body.u8().ok().filter(|_| domain & 0xf0 == GOT)?;
        let id = body.count().ok()?;
        body.skip(id).ok()?;
        Some((domain, variable, body))
    }

    /// The value that a get brought; `Ok(None)` if SUMO declined it or the command was no get.
    ///
    /// # Errors
    /// If the bytes of the value are bad.
    pub fn value(&self, command: usize) -> Result<Option<Value<'a>>, DecodeError> {
        let Some((domain, variable, mut body)) = self.got(command) else { return Ok(None) };
        let value = Value::read(&mut body, layout(domain, variable))?;
        body.finish()?;
        Ok(Some(value))
    }

    /// The double that a get brought; `None` if SUMO declined it or has no value now.
    #[must_use]
    pub fn f64(&self, command: usize) -> Option<f64> {
        let (_, _, mut body) = self.got(command)?;
        body.typed_f64().ok()?.filter(|_| body.is_empty())
    }

    /// The string that a get brought; `None` if SUMO declined it.
    #[must_use]
    pub fn text(&self, command: usize) -> Option<&'a str> {
        let (_, _, mut body) = self.got(command)?;
        body.typed_text().ok().filter(|_| body.is_empty())
    }

    /// The typed answer to a get of this batch.
    ///
    /// # Errors
    /// [`Error::Refused`] if SUMO declined, [`Error::NoValue`] if it has no value now, [`Error::Type`] for another type
    /// than the table says, [`Error::Decode`] for bad bytes.
    pub fn get<T: FromValue>(&self, handle: Handle<T>) -> Result<T, Error> {
        if let Some(refusal) = self.refusal(handle.index) {
            return Err(refusal.into());
        }
        match self.value(handle.index)? {
            Some(value) => T::from_value(value),
            None => Err(Error::NotAsked { command: handle.index }),
        }
    }

    /// The block with the present values that answered a subscribe command; `None` for other commands, and if SUMO
    /// declined it without a block.
    ///
    /// # Errors
    /// If its bytes are bad.
    pub fn subscription(&self, command: usize) -> Result<Option<Block<'a>>, DecodeError> {
        let Some(at) = self.answer_at(command) else { return Ok(None) };
        let (response, _) = Reader::new(self.frame, at).command()?;
        if response & 0xf0 != SUBSCRIBED {
            return Ok(None);
        }
        Block::decode(&mut Reader::new(self.frame, at)).map(Some)
    }

    /// Number of blocks that came with the step.
    #[must_use]
    pub fn block_count(&self) -> usize {
        self.index.blocks
    }

    /// The blocks that came with the step, in SUMO's order (that of subscribing). With several clients they include
    /// what others subscribed, so match ids, do not count.
    #[must_use]
    pub fn blocks(&self) -> Blocks<'a> {
        Blocks { left: self.index.blocks, reader: Reader::new(self.frame, self.index.blocks_at) }
    }

    /// API number and text, the answer to getVersion.
    pub(super) fn version(&self) -> Result<Option<(i32, &'a str)>, DecodeError> {
        let Some(at) = self.answer_at(0) else { return Ok(None) };
        let (_, mut body) = Reader::new(self.frame, at).command()?;
        let version = (body.i32()?, body.text()?);
        body.finish()?;
        Ok(Some(version))
    }
}

/// Iterator over the blocks of a step.
#[derive(Debug, Clone)]
pub struct Blocks<'a> {
    left: usize,
    reader: Reader<'a>,
}

impl<'a> Iterator for Blocks<'a> {
    type Item = Result<Block<'a>, DecodeError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.left = self.left.checked_sub(1)?;
        let block = Block::decode(&mut self.reader);
        if block.is_err() {
            self.left = 0;
        }
        Some(block)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (0, Some(self.left))
    }
}
