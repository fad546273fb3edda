//! Cost of the plant: one block of 16 vehicles, one control period of 10 ms, per instruction set and substep.
//! `cargo bench --bench plant`; divide by 16 for one vehicle (the item throughput says it directly).

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use sumo_mfc::lanes::{InstructionSet, LANES};
use sumo_mfc::plant::{Inputs, Plant, PlantBlock, SevenDof, State};

fn main() {
    divan::main();
}

/// Cars in town: different speeds, torques and steering in every slot.
fn town() -> (PlantBlock, Inputs) {
    let mut block = PlantBlock::new();
    let mut inputs = Inputs::default();
    for slot in 0..LANES {
        let state = State::rolling(block.body(slot), 5.0 + slot as f64);
        block.set_state(slot, &state);
        inputs.torque_nm[slot] = 10.0 * slot as f64 - 75.0;
        inputs.steer_rad[slot] = 0.004 * slot as f64 - 0.03;
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
