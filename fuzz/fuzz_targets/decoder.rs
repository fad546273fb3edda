//! Any bytes as SUMO's answer: `make fuzz`.
#![no_main]

#[path = "../../tests/traci_wire/harness.rs"]
mod harness;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| harness::decode(bytes));
