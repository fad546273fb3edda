//! Cost of the plant: one block of 16 vehicles, one control period of 10 ms, per instruction set and substep.
//! `cargo bench --bench plant`. At the end a line for each scene and instruction set: what one vehicle costs in a simulated
//! millisecond, side by side with the scalar code.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use std::time::Instant;
use sumo_mfc::lanes::{InstructionSet, LANES};
use sumo_mfc::plant::{Inputs, Plant, PlantBlock, SevenDof, State};

fn main() {
    divan::main();
    for (name, (block, inputs)) in [("in bends", town()), ("straight ahead", straight()), ("with track width", wide())]
    {
        compare(name, block, &inputs);
    }
}

/// Times all instruction sets and the scalar code side by side.
fn compare(scene: &str, mut block: PlantBlock, inputs: &Inputs) {
    let plant = SevenDof::new(0.01);
    let mut costs_ns = Vec::new();
    for _ in 0..ROUNDS {
        let mut round = vec![ns_per_call(|| plant.advance_scalar(&mut block, inputs, &[1.0; LANES], 0.01))];
        for set in InstructionSet::available() {
            let advance = || plant.advance(black_box(&mut block), black_box(inputs), &[1.0; LANES], 0.01);
            round.push(set.during(|| ns_per_call(advance)));
        }
        costs_ns.push(round);
    }
    let names = InstructionSet::available().into_iter().map(|set| format!("{set:?}"));
    for (i, name) in ["scalar".to_owned()].into_iter().chain(names).enumerate() {
        // Of a block of 16 and 10 ms to one vehicle and millisecond.
        let cost_ns = median(costs_ns.iter().map(|round| round[i] / (10 * LANES) as f64));
        let gain = median(costs_ns.iter().map(|round| round[0] / round[i]));
        println!(
            "plant {scene:16} {name:9} {cost_ns:6.1} ns per vehicle and ms, {gain:4.1} times as fast as the scalar code"
        );
    }
}

const ROUNDS: usize = 31;

fn ns_per_call(mut call: impl FnMut()) -> f64 {
    const CALLS: u32 = 1000;
    let begin = Instant::now();
    (0..CALLS).for_each(|_| call());
    begin.elapsed().as_nanos() as f64 / f64::from(CALLS)
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

/// Cars in town: different speeds, torques and steering in every slot.
fn town() -> (PlantBlock, Inputs) {
    let mut block = PlantBlock::default();
    let mut inputs = Inputs::default();
    for slot in 0..LANES {
        let state = State::rolling(block.body(slot), 5.0 + slot as f64);
        block.set_state(slot, &state);
        inputs.torque_nm[slot] = 10.0 * slot as f64 - 75.0;
        inputs.steer_rad[slot] = 0.004 * slot as f64 - 0.03;
    }
    (block, inputs)
}

/// The same on a straight road.
fn straight() -> (PlantBlock, Inputs) {
    let (block, inputs) = town();
    (block, Inputs { steer_rad: [0.0; LANES], ..inputs })
}

/// Cars in town with track width, whose load moves in bends.
fn wide() -> (PlantBlock, Inputs) {
    let (mut block, inputs) = town();
    for slot in 0..LANES {
        let mut body = block.body(slot).clone();
        (body.track_width_m, body.cg_height_m) = (1.5, 0.5);
        block.set_body(slot, &body);
    }
    (block, inputs)
}

fn advance(bencher: Bencher, set: InstructionSet, substep_s: f64) {
    let plant = SevenDof::new(substep_s);
    let (start, inputs) = town();
    let mut block = start.clone();
    set.during(|| {
        bencher.counter(ItemsCount::new(LANES)).bench_local(|| {
            plant.advance(black_box(&mut block), black_box(&inputs), &[1.0; LANES], 0.01);
        });
    });
}

#[divan::bench(args = [0.01, 0.005])]
fn baseline(bencher: Bencher, substep_s: f64) {
    advance(bencher, InstructionSet::Baseline, substep_s);
}

#[divan::bench(args = [0.01, 0.005])]
fn avx2(bencher: Bencher, substep_s: f64) {
    advance(bencher, InstructionSet::Avx2, substep_s);
}

#[divan::bench(args = [0.01, 0.005])]
fn avx512(bencher: Bencher, substep_s: f64) {
    advance(bencher, InstructionSet::Avx512, substep_s);
}

#[divan::bench]
fn scalar_libm(bencher: Bencher) {
    let plant = SevenDof::new(0.01);
    let (start, inputs) = town();
    let mut block = start.clone();
    bencher.counter(ItemsCount::new(LANES)).bench_local(|| {
        plant.advance_scalar(black_box(&mut block), black_box(&inputs), &[1.0; LANES], 0.01);
    });
}
