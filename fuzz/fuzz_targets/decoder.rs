//! Any bytes as SUMO's answer, guided by coverage: `cargo +nightly fuzz run decoder fuzz/corpus/decoder tests/data/traci/replies`.
#![no_main]

#[path = "../../tests/traci_wire/harness.rs"]
mod harness;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| harness::decode(bytes));
