//! What the fuzzer runs on any bytes, and the property tests on stable Rust as well (`fuzz/fuzz_targets/decoder.rs`).

use sumo_mfc::traci::wire::{DecodeError, frame_length};
use sumo_mfc::traci::{
    Batch, Domain, Index, Prefix, Var, junction, lane, simulation, trafficlight, vehicle, vehicletype,
};

/// What a co-simulation subscribes to.
pub const MOTION: (Var<f64, f64>, Var<f64>) = (vehicle::SPEED, vehicle::ANGLE);

/// Statuses of all kinds, subscriptions accepted and refused, and a step with blocks. Sent at 20 s.
pub fn events() -> Batch {
    let mut batch = Batch::new();
    let v0 = Prefix::new("v0").unwrap();
    batch.set_previous_speed(&v0, 6.5, 0.25).unwrap();
    batch.get(vehicle::SPEED, "v0").unwrap();
    batch.get(vehicle::SPEED, "nobody").unwrap();
    batch.subscribe_ids(Domain::Simulation, "", &[0x66, 0x74, 0x7a, 0x76, 0x78, 0x81, 0x7d], 20.0).unwrap();
    batch.subscribe(MOTION, "v0", 20.0).unwrap();
    batch.subscribe((vehicle::ROAD, vehicle::POSITION, vehicle::NEXT_LIGHTS), "v1", 20.0).unwrap();
    batch.subscribe(vehicle::SPEED, "nobody", 20.0).unwrap();
    batch.subscribe_with(vehicle::FOLLOWER, "v0", 100.0, 20.0).unwrap();
    batch.subscribe(MOTION, "late", 20.0).unwrap();
    batch.step().unwrap();
    batch
}

/// Values of all types, compounds above all. Sent after [`events`].
pub fn gets() -> Batch {
    let mut batch = Batch::new();
    batch.get(vehicle::NEXT_STOPS, "v0").unwrap();
    batch.get_with(vehicle::STOPS, "v0", 0).unwrap();
    batch.get(vehicle::NEXT_LIGHTS, "v0").unwrap();
    batch.get(vehicle::NEXT_LINKS, "v0").unwrap();
    batch.get(vehicle::BEST_LANES, "v0").unwrap();
    batch.get_with(vehicle::NEIGHBORS, "v0", 2).unwrap();
    batch.get_with(vehicle::FOES, "v0", 200.0).unwrap();
    batch.get_with(vehicle::FOLLOWER, "v0", 100.0).unwrap();
    batch.get(vehicle::POSITION, "v0").unwrap();
    batch.get(vehicle::POSITION_3D, "v0").unwrap();
    batch.get(vehicle::IDS, "").unwrap();
    batch.get(vehicletype::COLOR, "ego").unwrap();
    batch.get(lane::LINKS, "A0A1_0").unwrap();
    batch.get(junction::SHAPE, "B1").unwrap();
    batch.get(simulation::BOUNDING_BOX, "").unwrap();
    batch.get(trafficlight::PROGRAMS, "A0").unwrap();
    batch.get(trafficlight::CONTROLLED_LINKS, "A0").unwrap();
    batch
}

/// Decodes everything in a reply and counts the values.
pub fn walk(frame: &[u8], batch: &Batch) -> Result<usize, DecodeError> {
    let mut index = Index::default();
    let reply = index.read(frame, batch)?;
    let mut count = 0;
    for command in 0..reply.len() {
        let _ = (reply.refusal(command), reply.f64(command), reply.text(command));
        count += usize::from(reply.value(command)?.is_some());
        for entry in reply.subscription(command)?.iter().flat_map(|block| block.values()) {
            count += usize::from(entry?.1.is_ok());
        }
    }
    for block in reply.blocks() {
        let block = block?;
        let _ = (block.read(MOTION), block.get(vehicle::SPEED));
        for entry in block.values() {
            count += usize::from(entry?.1.is_ok());
        }
    }
    Ok(count)
}

/// Takes bytes for SUMO's answer to each of the batches, as they are and with the right length. Any error is right, a
/// panic is not; and no value is counted twice or made up.
pub fn decode(bytes: &[u8]) {
    let _ = frame_length(bytes);
    for batch in [events(), gets()] {
        for frame in [bytes.to_vec(), with_length(bytes)] {
            if let Ok(count) = walk(&frame, &batch) {
                assert!(count <= frame.len(), "{count} values in {} bytes", frame.len());
            }
        }
    }
}

/// The bytes with their number in the first four of them, if there are four.
pub fn with_length(bytes: &[u8]) -> Vec<u8> {
    let mut frame = bytes.to_vec();
    let length = i32::try_from(frame.len()).unwrap_or(i32::MAX);
    if let Some(head) = frame.first_chunk_mut() {
        *head = length.to_be_bytes();
    }
    frame
}
