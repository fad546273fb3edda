//! The environment says which change of the code is in force, if any. `make mutants` puts this file into the copy of the
//! crate that it changes; it is no part of the product.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

/// The number of the change in force; 0 is the code as it stands.
static ACTIVE: AtomicU32 = AtomicU32::new(UNREAD);
const UNREAD: u32 = u32::MAX;
/// No change is in force; the numbers of those that would have been looked for are appended to a file.
const RECORDING: u32 = u32::MAX - 1;

/// Whether the change of this number is in force.
#[inline]
pub fn on(number: u32) -> bool {
    match ACTIVE.load(Relaxed) {
        UNREAD => {
            read();
            on(number)
        }
        RECORDING => record(number),
        active => active == number,
    }
}

#[cold]
fn read() {
    let active = || std::env::var("MUTANTS_ACTIVE").ok()?.parse().ok();
    let recording = std::env::var_os("MUTANTS_RECORD").is_some();
    ACTIVE.store(if recording { RECORDING } else { active().unwrap_or(0) }, Relaxed);
}

/// Writes a number down when it comes for the first time. At once: a program that is killed later has told where it was.
fn record(number: u32) -> bool {
    static SEEN: [AtomicBool; 1 << 14] = [const { AtomicBool::new(false) }; 1 << 14];
    static LOG: OnceLock<File> = OnceLock::new();
    let seen = &SEEN[number as usize];
    if !seen.load(Relaxed) && !seen.swap(true, Relaxed) {
        let path = std::env::var_os("MUTANTS_RECORD").unwrap_or_default();
        let mut log = LOG.get_or_init(|| OpenOptions::new().create(true).append(true).open(path).unwrap());
        log.write_all(format!("{number}\n").as_bytes()).unwrap();
    }
    false
}
