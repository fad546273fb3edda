//! The one reader of SUMO's XML: a stream of elements with their lines, from plain or gzipped files in any encoding.
//!
//! Whether a file is gzipped is seen from its first bytes, never from its name. The encoding is that of the byte order
//! mark or the XML declaration, else UTF-8. The reader keeps nothing but the names of the open elements, bounds their
//! number and the size of one element, and expands no entities but the five of XML, so that no file exhausts the memory.

use std::{
    fs::File,
    io::{self, BufRead, BufReader, Cursor, ErrorKind, Read},
    ops::{ControlFlow, Range},
    path::{Path, PathBuf},
};

use encoding_rs::{CoderResult, Decoder, Encoding, UTF_8, UTF_16BE, UTF_16LE};
use flate2::bufread::MultiGzDecoder;
use quick_xml::{
    Error, Reader, XmlVersion,
    events::{BytesStart, Event},
};

use super::error::{SumoFileError, unreadable};

/// SUMO's files nest some ten elements.
const DEPTH_MAX: usize = 256;

/// The largest element, comment or text \[bytes\].
const EVENT_MAX: usize = 64 << 20;

/// The largest text that is written by hand \[bytes\].
const TEXT_MAX: u64 = 64 << 20;

/// The bytes in which the XML declaration must stand.
const HEAD: u64 = 256;

/// Bytes that are decoded at once.
const CHUNK: usize = 32 << 10;

/// An element as a visitor sees it.
pub(super) struct Element<'a> {
    tag: &'a BytesStart<'a>,
    /// The name of the element around it; empty for the root.
    pub parent: &'a str,
    /// The line on which it begins, from 1.
    pub line: usize,
}

impl Element<'_> {
    pub fn name(&self) -> &str {
        self.tag.name().into_inner()
    }

    pub fn attribute(&self, name: &str) -> Option<String> {
        attribute(self.tag, name)
    }

    /// Whether it has an attribute with such a name.
    pub fn has_attribute(&self, is_such: impl Fn(&str) -> bool) -> bool {
        self.tag.attributes().with_checks(false).flatten().any(|found| is_such(found.key.into_inner()))
    }

    /// Whether this is a parameter of this key.
    pub fn is_param(&self, key: &str) -> bool {
        self.name() == "param" && self.attribute("key").as_deref() == Some(key)
    }
}

/// An attribute of an element. References to entities that XML does not define stay as they are written.
pub(super) fn attribute(tag: &BytesStart<'_>, name: &str) -> Option<String> {
    let found = tag.attributes().with_checks(false).flatten().find(|a| a.key.as_ref() == name)?;
    Some(found.normalized_value(XmlVersion::Implicit1_0).map_or_else(|_| found.value.to_string(), |v| v.to_string()))
}

/// What stands next in a file.
pub(super) struct Item<'a> {
    pub event: Event<'a>,
    /// The name of the element around it; empty for the root.
    pub parent: &'a str,
    /// The line on which it begins, from 1.
    pub line: usize,
    /// The bytes that it takes of the decoded text.
    pub span: Range<usize>,
}

/// A file under reading.
pub(super) struct Xml<'a> {
    path: PathBuf,
    reader: Reader<Utf8<'a>>,
    buffer: Vec<u8>,
    /// The names of the open elements, outermost first.
    open: Vec<String>,
    rooted: bool,
    cut: bool,
}

impl<'a> Xml<'a> {
    pub fn open(path: &Path) -> Result<Self, SumoFileError> {
        Ok(Self::new(path, Utf8::open(path).map_err(unreadable(path))?))
    }

    /// A text that was decoded already.
    pub fn of(path: &Path, text: &'a str) -> Self {
        Self::new(path, Utf8::new(Box::new(text.as_bytes()), UTF_8))
    }

    fn new(path: &Path, text: Utf8<'a>) -> Self {
        let reader = Reader::from_reader(text);
        Self { path: path.to_owned(), reader, buffer: Vec::new(), open: Vec::new(), rooted: false, cut: false }
    }

    /// What stands next; `None` at the end of the file, or where it breaks off.
    pub fn next(&mut self) -> Result<Option<Item<'_>>, SumoFileError> {
        self.buffer.clear();
        let (start, line) = (self.reader.buffer_position() as usize, self.line());
        self.reader.get_mut().since_event = 0;
        let event = match self.reader.read_event_into(&mut self.buffer) {
            Ok(Event::Eof) => return Ok(None),
            Ok(event) => event,
            // A tag, comment or quote that the file does not end, or a compressed file that breaks off.
            Err(Error::Syntax(_)) => {
                self.cut = true;
                return Ok(None);
            }
            Err(Error::Io(reason)) if reason.kind() == ErrorKind::UnexpectedEof => {
                self.cut = true;
                return Ok(None);
            }
            Err(Error::Io(reason)) => return Err(unreadable(&self.path)(io::Error::new(reason.kind(), reason))),
            Err(other) => {
                return Err(content(
                    &self.path,
                    self.reader.get_ref().line,
                    format!("not XML as SUMO writes it: {other}"),
                ));
            }
        };
        match &event {
            // SUMO would put in what it defines: further elements, attributes, or texts without end.
            Event::DocType(text) if ["[", "SYSTEM", "PUBLIC"].iter().any(|part| text.contains(part)) => {
                let what = "a document type definition, which files of SUMO have no need of";
                return Err(content(&self.path, line, what.to_owned()));
            }
            Event::Start(_) if self.open.len() == DEPTH_MAX => {
                return Err(content(&self.path, line, format!("elements nested more than {DEPTH_MAX} deep")));
            }
            Event::Start(tag) => self.open.push(tag.name().into_inner().to_owned()),
            Event::End(_) => drop(self.open.pop()),
            _ => {}
        }
        self.rooted |= matches!(event, Event::Start(_) | Event::Empty(_));
        let around = self.open.len().checked_sub(1 + usize::from(matches!(event, Event::Start(_))));
        let parent = around.map_or("", |i| self.open[i].as_str());
        let span = start..self.reader.buffer_position() as usize;
        Ok(Some(Item { event, parent, line, span }))
    }

    /// Calls `visit` with every element until it breaks. What it says is wrong becomes an error with the line.
    pub fn each(
        &mut self,
        mut visit: impl FnMut(&Element<'_>) -> Result<ControlFlow<()>, String>,
    ) -> Result<(), SumoFileError> {
        while let Some(item) = self.next()? {
            let (Event::Start(tag) | Event::Empty(tag)) = &item.event else { continue };
            match visit(&Element { tag, parent: item.parent, line: item.line }) {
                Ok(ControlFlow::Continue(())) => {}
                Ok(ControlFlow::Break(())) => return Ok(()),
                Err(what) => {
                    let line = item.line;
                    return Err(content(&self.path, line, what));
                }
            }
        }
        Ok(())
    }

    /// Whether all that was read is a whole file: its root is closed. False if it breaks off.
    pub fn is_whole(&self) -> bool {
        self.rooted && !self.cut && self.open.is_empty()
    }

    /// Whether an element was read.
    pub fn is_rooted(&self) -> bool {
        self.rooted
    }

    /// Something that is wrong with the file as a whole, told with the line that was read last.
    pub fn error(&self, what: String) -> SumoFileError {
        content(&self.path, self.line(), what)
    }

    /// The error of a file that is not whole.
    pub fn breaks_off(&self) -> SumoFileError {
        self.error("not XML as SUMO writes it: the file breaks off".to_owned())
    }

    fn line(&self) -> usize {
        self.reader.get_ref().line
    }
}

fn content(path: &Path, line: usize, what: String) -> SumoFileError {
    SumoFileError::Content { path: path.to_owned(), line, what }
}

/// A file as UTF-8, with the line that is read. Bytes that the encoding does not have become U+FFFD.
struct Utf8<'a> {
    inner: Box<dyn BufRead + 'a>,
    decoder: Decoder,
    chunk: Vec<u8>,
    /// The part of `chunk` that is decoded and not yet consumed.
    ready: Range<usize>,
    ended: bool,
    line: usize,
    /// Bytes that were decoded since the last event.
    since_event: usize,
}

impl<'a> Utf8<'a> {
    fn new(inner: Box<dyn BufRead + 'a>, encoding: &'static Encoding) -> Self {
        let decoder = encoding.new_decoder();
        Self { inner, decoder, chunk: vec![0; CHUNK], ready: 0..0, ended: false, line: 1, since_event: 0 }
    }

    fn open(path: &Path) -> io::Result<Self> {
        let mut file = BufReader::new(File::open(path)?);
        let mut bytes: Box<dyn BufRead> = match file.fill_buf()? {
            [0x1f, 0x8b, ..] => Box::new(BufReader::new(MultiGzDecoder::new(file))),
            _ => Box::new(file),
        };
        let mut head = Vec::new();
        // A compressed file that breaks off this early is told where it is read.
        let _ = bytes.by_ref().take(HEAD).read_to_end(&mut head);
        let encoding = declared(&head)?;
        Ok(Self::new(Box::new(Cursor::new(head).chain(bytes)), encoding))
    }
}

impl Read for Utf8<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(into)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Utf8<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.ready.is_empty() && !self.ended {
            let bytes = self.inner.fill_buf()?;
            let last = bytes.is_empty();
            let (result, read, written, _) = self.decoder.decode_to_utf8(bytes, &mut self.chunk, last);
            self.inner.consume(read);
            self.ended = last && result == CoderResult::InputEmpty;
            self.ready = 0..written;
            self.since_event += written;
            // SUMO reads encodings that are not known here, and XML knows no such character.
            if self.chunk[..written].contains(&0) {
                return Err(io::Error::new(ErrorKind::InvalidData, "a character 0: its encoding is not known"));
            }
            if self.since_event > EVENT_MAX {
                let what = format!("one element or text of more than {EVENT_MAX} bytes");
                return Err(io::Error::new(ErrorKind::InvalidData, what));
            }
        }
        Ok(&self.chunk[self.ready.clone()])
    }

    fn consume(&mut self, count: usize) {
        let end = self.ready.start + count;
        self.line += self.chunk[self.ready.start..end].iter().filter(|b| **b == b'\n').count();
        self.ready.start = end;
    }
}

/// The encoding that the first bytes of a file declare. The decoder itself looks for byte order marks.
fn declared(head: &[u8]) -> io::Result<&'static Encoding> {
    match head {
        [b'<', 0, ..] => return Ok(UTF_16LE),
        [0, b'<', ..] => return Ok(UTF_16BE),
        _ => {}
    }
    let text = String::from_utf8_lossy(head);
    if text.len() as u64 >= HEAD && text.contains("<?xml ") && !text.contains("?>") {
        return Err(io::Error::new(ErrorKind::InvalidData, format!("an XML declaration of more than {HEAD} bytes")));
    }
    let declaration = text.trim_start_matches('\u{feff}').strip_prefix("<?xml").and_then(|t| t.split("?>").next());
    let Some(value) = declaration.and_then(|d| d.split_once("encoding")).map(|(_, v)| v.trim_start_matches([' ', '=']))
    else {
        return Ok(UTF_8);
    };
    let label = value.trim_start_matches(['"', '\'']).split(['"', '\'']).next().unwrap_or_default();
    match Encoding::for_label(label.as_bytes()) {
        // The declaration was read byte by byte, so the file is not that.
        Some(encoding) if encoding == UTF_16LE || encoding == UTF_16BE => Ok(UTF_8),
        Some(encoding) => Ok(encoding),
        None => Err(io::Error::new(ErrorKind::InvalidData, format!("its encoding \"{label}\" is not known"))),
    }
}

/// The decoded text of a file.
pub(super) fn text(path: &Path) -> Result<String, SumoFileError> {
    let mut text = String::new();
    Utf8::open(path).and_then(|mut file| file.read_to_string(&mut text)).map_err(unreadable(path))?;
    Ok(text)
}

/// The decoded text of a file that somebody wrote by hand.
pub(super) fn short_text(path: &Path) -> Result<String, SumoFileError> {
    Utf8::open(path).and_then(bounded).map_err(unreadable(path))
}

/// Reads a text that somebody wrote by hand, unless it is one without end.
pub(crate) fn bounded(file: impl Read) -> io::Result<String> {
    let mut text = String::new();
    file.take(TEXT_MAX + 1).read_to_string(&mut text)?;
    if text.len() as u64 <= TEXT_MAX {
        return Ok(text);
    }
    Err(io::Error::new(ErrorKind::FileTooLarge, format!("more than {TEXT_MAX} bytes")))
}

/// Whether a file is XML: what its first character that is no space says.
pub(crate) fn is_xml(path: &Path) -> Result<bool, SumoFileError> {
    let mut head = Vec::new();
    Utf8::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head)).map_err(unreadable(path))?;
    Ok(head.trim_ascii_start().starts_with(b"<"))
}

#[cfg(test)]
mod tests;
