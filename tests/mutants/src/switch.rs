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
        UNREAD | RECORDING => first_time(number),
        active => active == number,
    }
}

#[cold]
fn first_time(number: u32) -> bool {
    static SEEN: [AtomicBool; 1 << 14] = [const { AtomicBool::new(false) }; 1 << 14];
    static LOG: OnceLock<File> = OnceLock::new();
    if let Some(path) = std::env::var_os("MUTANTS_RECORD") {
        ACTIVE.store(RECORDING, Relaxed);
        if !SEEN[number as usize].swap(true, Relaxed) {
            // Appended at once: a program that is killed later has told where it was.
            let mut log = LOG.get_or_init(|| OpenOptions::new().create(true).append(true).open(path).unwrap());
            log.write_all(format!("{number}\n").as_bytes()).unwrap();
        }
        return false;
    }
    let active = std::env::var("MUTANTS_ACTIVE").ok().and_then(|text| text.parse().ok()).unwrap_or(0);
    ACTIVE.store(active, Relaxed);
    active == number
}
