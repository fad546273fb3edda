//! Any bytes to everything that reads, guided by coverage; the first byte chooses who reads the others.
#![no_main]

#[path = "../../tests/fuzz/targets.rs"]
#[allow(dead_code, reason = "tests choose a target by its name")]
mod targets;

thread_local! {
    static ROOM: targets::Room = targets::Room::new();
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let [first, rest @ ..] = bytes else { return };
    let target = &targets::TARGETS[usize::from(*first) % targets::TARGETS.len()];
    if let Err(found) = ROOM.with(|room| (target.read)(room, rest)) {
        panic!("{}: {found}", target.name);
    }
});
