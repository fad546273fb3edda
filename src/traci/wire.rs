//! The bytes of TraCI, without sockets: big-endian primitives, typed values, frames and command headers.
//!
//! Decoding never panics and never trusts a length: every answer is a value, "need more" or a [`DecodeError`] with the
//! offset of the offending byte. Values borrow from the frame they were read from.

/// The double (and, cast, the integer) with which SUMO says "no value": not departed, teleporting.
pub(crate) const NO_VALUE: f64 = -1_073_741_824.0;

/// Bytes that are not what TraCI says they must be. The connection cannot be used after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("bad TraCI bytes at offset {offset}: {what}")]
pub struct DecodeError {
    /// Offset in the frame, its 4-byte length included.
    pub offset: usize,
    /// What is wrong there.
    pub what: &'static str,
}

/// Type tags in front of values.
pub(super) mod tag {
    pub const POSITION2: u8 = 0x01;
    pub const POSITION3: u8 = 0x03;
    pub const POLYGON: u8 = 0x06;
    pub const UBYTE: u8 = 0x07;
    pub const BYTE: u8 = 0x08;
    pub const INT: u8 = 0x09;
    pub const DOUBLE: u8 = 0x0b;
    pub const TEXT: u8 = 0x0c;
    pub const TEXTS: u8 = 0x0e;
    pub const COMPOUND: u8 = 0x0f;
    pub const DOUBLES: u8 = 0x10;
    pub const COLOR: u8 = 0x11;
}

/// The longest frame that is believed to be one \[bytes\]: a step's answers about a million vehicles are shorter.
const FRAME_BYTES: usize = 1 << 28;

/// Length of the frame that starts at `bytes`; `None` means "need more". The frame is complete once that many bytes
/// are there.
///
/// # Errors
/// If the length is smaller than its own four bytes, or so large that whoever sent it does not speak TraCI.
pub fn frame_length(bytes: &[u8]) -> Result<Option<usize>, DecodeError> {
    let Some(head) = bytes.first_chunk::<4>() else { return Ok(None) };
    match usize::try_from(i32::from_be_bytes(*head)) {
        Ok(length) if length > FRAME_BYTES => Err(DecodeError { offset: 0, what: "frame length above 256 MiB" }),
        Ok(length) if length >= 4 => Ok(Some(length)),
        _ => Err(DecodeError { offset: 0, what: "frame length below 4" }),
    }
}

/// A cursor over a frame. Offsets stay those of the whole frame, also in the cursor over a part of it.
#[derive(Debug, Clone, Copy)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    /// Starts at `offset` of `frame` (clamped to its end).
    #[must_use]
    pub fn new(frame: &'a [u8], offset: usize) -> Self {
        Self { bytes: frame, at: offset.min(frame.len()) }
    }

    pub(super) fn offset(&self) -> usize {
        self.at
    }

    /// True if nothing is left.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.at == self.bytes.len()
    }

    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    pub(super) fn error(&self, what: &'static str) -> DecodeError {
        DecodeError { offset: self.at, what }
    }

    /// Requires that nothing is left.
    ///
    /// # Errors
    /// On leftover bytes.
    pub fn finish(&self) -> Result<(), DecodeError> {
        if self.is_empty() { Ok(()) } else { Err(self.error("leftover bytes")) }
    }

    pub(super) fn take<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        let chunk = *self.rest().first_chunk::<N>().ok_or(self.error("value runs past its end"))?;
        self.at += N;
        Ok(chunk)
    }

    pub(super) fn skip(&mut self, count: usize) -> Result<(), DecodeError> {
        if count > self.rest().len() {
            return Err(self.error("value runs past its end"));
        }
        self.at += count;
        Ok(())
    }

    /// The next `count` bytes as a cursor of their own.
    pub(super) fn part(&mut self, count: usize) -> Result<Reader<'a>, DecodeError> {
        let start = self.at;
        self.skip(count)?;
        Ok(Reader { bytes: &self.bytes[..self.at], at: start })
    }

    /// The bytes from `start` to here as a cursor of their own.
    pub(super) fn since(&self, start: &Self) -> Reader<'a> {
        Reader { bytes: &self.bytes[..self.at], at: start.at }
    }

    /// An unsigned byte.
    ///
    /// # Errors
    /// At the end of the bytes; so do all the following.
    pub fn u8(&mut self) -> Result<u8, DecodeError> {
        Ok(self.take::<1>()?[0])
    }

    /// A 32-bit integer.
    ///
    /// # Errors
    /// At the end of the bytes.
    pub fn i32(&mut self) -> Result<i32, DecodeError> {
        Ok(i32::from_be_bytes(self.take()?))
    }

    /// A double.
    ///
    /// # Errors
    /// At the end of the bytes.
    pub fn f64(&mut self) -> Result<f64, DecodeError> {
        Ok(f64::from_be_bytes(self.take()?))
    }

    /// A 32-bit count, not negative.
    ///
    /// # Errors
    /// If it is negative or cut off.
    pub fn count(&mut self) -> Result<usize, DecodeError> {
        let before = *self;
        usize::try_from(self.i32()?).map_err(|_| before.error("negative count"))
    }

    /// A string: count and UTF-8.
    ///
    /// # Errors
    /// If it is cut off or not UTF-8.
    pub fn text(&mut self) -> Result<&'a str, DecodeError> {
        let length = self.count()?;
        let part = self.part(length)?;
        std::str::from_utf8(part.rest())
            .map_err(|e| DecodeError { offset: part.at + e.valid_up_to(), what: "not UTF-8" })
    }

    /// Consumes a type tag.
    pub(super) fn tag(&mut self, expected: u8) -> Result<(), DecodeError> {
        let before = *self;
        if self.u8()? == expected { Ok(()) } else { Err(before.error("another type than expected")) }
    }

    pub(super) fn typed_text(&mut self) -> Result<&'a str, DecodeError> {
        self.tag(tag::TEXT)?;
        self.text()
    }

    /// A typed double; SUMO's "no value" becomes `None`.
    pub(super) fn typed_f64(&mut self) -> Result<Option<f64>, DecodeError> {
        self.tag(tag::DOUBLE)?;
        Ok(Some(self.f64()?).filter(|v| *v != NO_VALUE))
    }

    pub(super) fn typed_i32(&mut self) -> Result<i32, DecodeError> {
        self.tag(tag::INT)?;
        self.i32()
    }

    /// A typed byte, signed or unsigned.
    pub(super) fn typed_u8(&mut self) -> Result<u8, DecodeError> {
        let before = *self;
        match self.u8()? {
            tag::UBYTE | tag::BYTE => self.u8(),
            _ => Err(before.error("another type than expected")),
        }
    }

    /// A command: the header, long or short; gives its identifier and a cursor over its payload.
    pub(super) fn command(&mut self) -> Result<(u8, Reader<'a>), DecodeError> {
        let start = *self;
        let length = match self.u8()? {
            0 => self.count()?.checked_sub(5),
            short => usize::from(short).checked_sub(1),
        };
        let Some(length) = length.filter(|length| *length >= 1) else {
            return Err(start.error("command shorter than its own header"));
        };
        let mut body = self.part(length)?;
        Ok((body.u8()?, body))
    }

    /// A typed, not negative integer.
    pub(super) fn typed_count(&mut self) -> Result<usize, DecodeError> {
        let before = *self;
        usize::try_from(self.typed_i32()?).map_err(|_| before.error("negative count"))
    }
}

pub(super) fn put_i32(out: &mut Vec<u8>, value: i32) {
    out.extend_from_slice(&value.to_be_bytes());
}

pub(super) fn put_f64(out: &mut Vec<u8>, value: f64) {
    out.extend_from_slice(&value.to_be_bytes());
}

/// A count or length; batches refuse to grow beyond `i32::MAX`, so the cast is exact there.
pub(super) fn put_count(out: &mut Vec<u8>, count: usize) {
    put_i32(out, i32::try_from(count).unwrap_or(i32::MAX));
}

pub(super) fn put_text(out: &mut Vec<u8>, text: &str) {
    put_count(out, text.len());
    out.extend_from_slice(text.as_bytes());
}

/// Writes the header over a command whose two header bytes (reserved) start at `start`; the long form moves the payload.
pub(super) fn close_command(out: &mut Vec<u8>, start: usize) {
    let length = out.len() - start;
    if let Ok(short) = u8::try_from(length) {
        out[start] = short;
        return;
    }
    let identifier = out[start + 1];
    let payload_end = out.len();
    out.extend_from_slice(&[0; 4]);
    out.copy_within(start + 2..payload_end, start + 6);
    out[start] = 0;
    let long = i32::try_from(length + 4).unwrap_or(i32::MAX);
    out[start + 1..start + 5].copy_from_slice(&long.to_be_bytes());
    out[start + 5] = identifier;
}

/// Writes a compound header.
pub(super) fn put_compound(out: &mut Vec<u8>, items: usize) {
    out.push(tag::COMPOUND);
    put_count(out, items);
}
