//! Cases out of real files: bytes are changed, and so are numbers, words and lines, because a file in which only bytes
//! are wrong is refused before its numbers are read.

use std::io::Write;
use std::ops::Range;

use flate2::{Compression, write::GzEncoder};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// No case is longer \[bytes\].
const LENGTH_MAX: usize = 64 << 10;

/// What a number may be replaced by.
const NUMBERS: &[&str] = &[
    "nan",
    "NaN",
    "-nan",
    "inf",
    "-inf",
    "Infinity",
    "1e400",
    "-1e400",
    "1e308",
    "-1e308",
    "1e-320",
    "5e-324",
    "-0",
    "0",
    "-1",
    "0.0",
    "1e18",
    "9223372036854775807",
    "9223372036854775808",
    "-9223372036854775808",
    "18446744073709551616",
    "2147483648",
    "4294967296",
    "65536",
    "255",
    "0x10",
    "1_000",
    "1,5",
    "+1",
    "1.",
    ".5",
    "1e",
    "",
    " ",
    "٣",
    "10 km/h",
    "10kmh",
    "3:00",
    "1:00:00:00",
    "-1:-1:-1",
    "1:nan:0",
    "0.1",
    "0.0001",
    "1000000",
];

/// What may stand anywhere.
const PIECES: &[&str] = &[
    "\0",
    "\u{feff}",
    "\u{fffd}",
    "\u{e9}",
    "\u{1f600}",
    "e\u{301}",
    "\u{5d0}\u{202e}",
    "\u{2028}",
    "\r",
    "\r\n",
    "\t",
    "\n",
    "\"",
    "'",
    "<",
    ">",
    "&",
    "&amp;",
    "&#0;",
    "&#x110000;",
    "&lol;",
    "<!--",
    "-->",
    "<![CDATA[",
    "]]>",
    "<?xml version=\"1.0\" encoding=\"UTF-16\"?>",
    "<!DOCTYPE a [<!ENTITY b \"c\">]>",
    "<include href=\"case.rou.xml\"/>",
    "<include href=\".\"/>",
    "<include href=\"b.rou.xml\"/>",
    "<include/>",
    "[",
    "]",
    "{",
    "}",
    "[[group]]\n",
    "[[vary]]\n",
    "=",
    ".",
    ",",
    ";",
    "#",
    "${HOME}",
    "${SUMO_HOME}",
    "${",
    "..",
    "/",
    "*",
    "(",
    ")",
    "\\",
    "%",
    "{}",
];

/// A case made of one or two of the seeds.
pub fn mutated(random: &mut ChaCha8Rng, seeds: &[Vec<u8>], words: &[&str]) -> Vec<u8> {
    let mut bytes = seeds[random.random_range(0..seeds.len())].clone();
    // One change most often: with many of them nothing is read that is not refused at once.
    let changes = 1 + [0, 0, 0, 1, 1, 2, 4, 12][random.random_range(0..8)];
    for _ in 0..changes {
        change(random, &mut bytes, seeds, words);
        bytes.truncate(LENGTH_MAX);
    }
    match random.random_range(0..60) {
        0 => gzipped(&bytes),
        1 => String::from_utf8_lossy(&bytes).encode_utf16().flat_map(u16::to_le_bytes).collect(),
        2 => [b"\xef\xbb\xbf", &bytes[..]].concat(),
        _ => bytes,
    }
}

fn change(random: &mut ChaCha8Rng, bytes: &mut Vec<u8>, seeds: &[Vec<u8>], words: &[&str]) {
    let pick = |random: &mut ChaCha8Rng, from: &[&str]| from[random.random_range(0..from.len())].as_bytes().to_vec();
    let at = random.random_range(0..=bytes.len());
    match random.random_range(0..16) {
        // Half of the changes keep the form of the file.
        0..=3 => {
            let number = pick(random, NUMBERS);
            replace_token(random, bytes, is_number, number);
        }
        4 | 5 => {
            let word = pick(random, words);
            replace_token(random, bytes, is_word, word);
        }
        6 => {
            let tokens = tokens(bytes);
            let other = tokens.get(random.random_range(0..tokens.len().max(1))).cloned().unwrap_or(0..0);
            let other = bytes[other].to_vec();
            replace_token(random, bytes, |_| true, other);
        }
        7 => move_line(random, bytes),
        8 => drop(bytes.splice(at..at, pick(random, PIECES))),
        9 => drop(bytes.splice(at..at, pick(random, words))),
        10 if !bytes.is_empty() => {
            let at = at.min(bytes.len() - 1);
            bytes[at] = if random.random() { random.random() } else { bytes[at] ^ (1 << random.random_range(0..8)) };
        }
        11 => bytes.truncate(at),
        12 => drop(bytes.drain(stretch(random, bytes.len()))),
        13 => {
            // Again and again: long, deep or often.
            let part = bytes[stretch(random, bytes.len())].to_vec();
            let times = [1, 2, 10, 300, 3000][random.random_range(0..5)];
            let times = times.min(LENGTH_MAX / part.len().max(1));
            bytes.splice(at..at, part.repeat(times));
        }
        14 => {
            let other = &seeds[random.random_range(0..seeds.len())];
            let part = other[stretch(random, other.len())].to_vec();
            bytes.splice(at..at, part);
        }
        _ => drop(bytes.splice(at..at, (0..random.random_range(1..9)).map(|_| random.random()).collect::<Vec<u8>>())),
    }
}

/// A stretch of so many bytes, mostly a short one.
fn stretch(random: &mut ChaCha8Rng, length: usize) -> Range<usize> {
    let start = random.random_range(0..=length);
    let most = [4, 32, 400, LENGTH_MAX][random.random_range(0..4)].min(length - start);
    start..start + random.random_range(0..=most)
}

fn is_number(token: &[u8]) -> bool {
    token.iter().any(u8::is_ascii_digit)
}

fn is_word(token: &[u8]) -> bool {
    token[0].is_ascii_alphabetic()
}

/// Words, numbers and single signs.
fn tokens(bytes: &[u8]) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    let is_part = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'.' | b'-' | b'+') || b >= 0x80;
    let mut open = false;
    for (i, byte) in bytes.iter().enumerate() {
        match found.last_mut() {
            Some(last) if open && is_part(*byte) => last.end = i + 1,
            _ if !byte.is_ascii_whitespace() => found.push(i..i + 1),
            _ => {}
        }
        open = is_part(*byte);
    }
    found
}

fn replace_token(random: &mut ChaCha8Rng, bytes: &mut Vec<u8>, fits: impl Fn(&[u8]) -> bool, by: Vec<u8>) {
    let mut tokens = tokens(bytes);
    tokens.retain(|token| fits(&bytes[token.clone()]));
    if !tokens.is_empty() {
        bytes.splice(tokens[random.random_range(0..tokens.len())].clone(), by);
    }
}

/// A line goes to another place, comes twice, or vanishes.
fn move_line(random: &mut ChaCha8Rng, bytes: &mut Vec<u8>) {
    let mut lines: Vec<Vec<u8>> = bytes.split_inclusive(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
    if lines.is_empty() {
        return;
    }
    let line = random.random_range(0..lines.len());
    let taken = if random.random() { lines.remove(line) } else { lines[line].clone() };
    if random.random_range(0..3) > 0 {
        lines.insert(random.random_range(0..=lines.len()), taken);
    }
    *bytes = lines.concat();
}

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}
