//! The codec alone, without a socket: the message of a step for 1 000 vehicles, and SUMO's answer to it.
//! `cargo bench --bench codec`

use divan::counter::{BytesCount, ItemsCount};
use divan::{Bencher, black_box};
use sumo_mfc::traci::{Batch, Domain, Index, Prefix, Subscribed, Var, vehicle};

const VEHICLES: usize = 1_000;
const READ: (Var<f64, f64>, Var<f64>) = (vehicle::SPEED, vehicle::ANGLE);

fn main() {
    divan::main();
}

fn id(number: usize) -> String {
    format!("vehicle.{number}")
}

fn encode_into(batch: &mut Batch, prefixes: &[Prefix]) {
    batch.clear();
    for prefix in prefixes {
        batch.set_previous_speed(prefix, black_box(13.9), black_box(0.1)).expect("a speed");
    }
    batch.step().expect("a step");
}

fn prefixes() -> Vec<Prefix> {
    (0..VEHICLES).map(|number| Prefix::new(&id(number)).expect("a short id")).collect()
}

/// What SUMO answers: a status per command, then a block of two doubles per vehicle.
fn answer() -> Vec<u8> {
    let mut frame = vec![0; 4];
    let status = |command: u8| [7, command, 0, 0, 0, 0, 0];
    for _ in 0..VEHICLES {
        frame.extend(status(0xc4));
    }
    frame.extend(status(0x02));
    frame.extend((VEHICLES as i32).to_be_bytes());
    for number in 0..VEHICLES {
        let id = id(number);
        let mut block = vec![0xe4];
        block.extend((id.len() as i32).to_be_bytes());
        block.extend(id.bytes());
        block.push(2);
        for variable in [READ.0.id, READ.1.id] {
            block.extend([variable, 0, 0x0b]);
            block.extend(13.9_f64.to_be_bytes());
        }
        frame.push(0);
        frame.extend((block.len() as i32 + 5).to_be_bytes());
        frame.extend(block);
    }
    let length = (frame.len() as i32).to_be_bytes();
    frame[..4].copy_from_slice(&length);
    frame
}

#[divan::bench]
fn encode(bencher: Bencher) {
    let prefixes = prefixes();
    let mut batch = Batch::new();
    encode_into(&mut batch, &prefixes);
    let bytes = BytesCount::new(batch.bytes().len());
    bencher.counter(bytes).counter(ItemsCount::new(VEHICLES)).bench_local(|| encode_into(&mut batch, &prefixes));
}

#[divan::bench]
fn decode(bencher: Bencher) {
    let mut batch = Batch::new();
    encode_into(&mut batch, &prefixes());
    let (frame, mut index) = (answer(), Index::default());
    bencher.counter(BytesCount::new(frame.len())).counter(ItemsCount::new(VEHICLES)).bench_local(|| {
        let reply = index.read(black_box(&frame), &batch).expect("an answer");
        let mut sum_mps = 0.0;
        for block in reply.blocks() {
            let block = block.expect("a block");
            assert_eq!(block.domain, Some(Domain::Vehicle));
            let Subscribed::Own((speed, angle)) = block.read(READ).expect("two doubles") else { panic!("not there") };
            sum_mps += speed.unwrap_or(0.0) + angle.unwrap_or(0.0);
        }
        sum_mps
    });
}
