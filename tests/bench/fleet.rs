//! What stands around the body, and the closed loop as a whole: one block of 16 vehicles and one control period of
//! 10 ms, unless said otherwise. Throughput is in vehicles (and periods): its inverse is the cost of one.
//! `cargo bench --bench fleet`

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use sumo_mfc::control::{Actuation, CONTROLLERS, Command, Law, Observation};
use sumo_mfc::fleet::follow::{Bound, Follow};
use sumo_mfc::fleet::steering::Steering;
use sumo_mfc::fleet::{ActuatorSetup, Fleet, GroupSetup, LoopConfig, Slot, VehicleSetup};
use sumo_mfc::keys::Values;
use sumo_mfc::lanes::{InstructionSet, LANES};
use sumo_mfc::plant::{Actuators, BODIES, SevenDof};
use sumo_mfc::registry::find;
use sumo_mfc::stats::{Sample, StatsBlock};
use sumo_mfc::trig::Polynomial;

/// Control periods of a SUMO step of 0.1 s.
const PERIODS: u32 = 10;

fn main() {
    divan::main();
}

fn laws() -> impl Iterator<Item = &'static str> {
    CONTROLLERS.iter().map(|entry| entry.name)
}

fn law(name: &str) -> Law {
    let entry = find("controller", &CONTROLLERS, name).expect("a controller");
    (entry.build)(&Values::defaults(entry.keys), 0.01)
}

/// Estimator and law; the last entry has none.
#[divan::bench(args = laws().filter(|name| *name != "ideal"))]
fn controller(bencher: Bencher, name: &str) {
    let mut law = law(name).block().expect("a law");
    let observation = Observation {
        measured_mps: std::array::from_fn(|i| 5.0 + i as f64),
        reference_mps: std::array::from_fn(|i| 5.1 + i as f64),
        reference_rate_mps2: [0.5; LANES],
        nominal_nm_per_mps2: [500.0; LANES],
    };
    let mut command = Command::default();
    bencher.counter(ItemsCount::new(LANES)).bench_local(|| {
        law.command(black_box(&observation), &mut command);
        law.feedback(black_box(&Actuation { applied_mps2: [0.5; LANES], ..Actuation::default() }));
    });
}

/// The same for `mpc` while the torque limits bind, so that its program has to be solved.
#[divan::bench]
fn mpc_at_its_limits(bencher: Bencher) {
    let mut law = law("mpc").block().expect("a law");
    let observation = Observation {
        measured_mps: [5.0; LANES],
        reference_mps: [15.0; LANES],
        nominal_nm_per_mps2: [500.0; LANES],
        ..Observation::default()
    };
    let cut_off = Actuation { commanded_mps2: [3.0; LANES], saturated_mps2: [2.0; LANES], applied_mps2: [2.0; LANES] };
    let mut command = Command::default();
    bencher.counter(ItemsCount::new(LANES)).bench_local(|| {
        law.command(black_box(&observation), &mut command);
        law.feedback(black_box(&cut_off));
    });
}

/// All vehicles with the same dead time, and each with its own.
#[divan::bench(args = [0.0, 0.01])]
fn actuators(bencher: Bencher, apart_s: f64) {
    let mut actuators = Actuators::new(0.01, 0.25);
    for slot in 0..LANES {
        actuators.set(slot, 0.05 + apart_s * slot as f64, 0.05, 2000.0, 4000.0);
    }
    bencher
        .counter(ItemsCount::new(LANES))
        .bench_local(|| actuators.step(black_box(&[1000.0; LANES]), black_box(&[0.001; LANES])));
}

/// One tyre curve of each of 16 vehicles.
#[divan::bench]
fn tyre(bencher: Bencher) {
    let tyre = (BODIES[0].build)().longitudinal[0];
    let slip: [f64; LANES] = std::array::from_fn(|i| 0.02 * i as f64 - 0.16);
    bencher.counter(ItemsCount::new(LANES)).bench_local(|| black_box(&slip).map(|slip| tyre.shape::<Polynomial>(slip)));
}

#[divan::bench]
fn steering(bencher: Bencher) {
    let steering = Steering::default();
    let mut angles = [0.0; LANES];
    bencher
        .counter(ItemsCount::new(LANES))
        .bench_local(|| steering.angles_rad(black_box(0.5), black_box(&[10.0; LANES]), &mut angles));
}

#[divan::bench]
fn statistics(bencher: Bencher) {
    let mut stats = StatsBlock::new(0.01);
    let sample = Sample {
        speed_mps: [10.0; LANES],
        reference_mps: [10.1; LANES],
        torque_nm: [300.0; LANES],
        active: [1.0; LANES],
    };
    bencher.counter(ItemsCount::new(LANES)).bench_local(|| stats.sample(black_box(&sample)));
}

/// A fleet whose vehicles go back and forth between two speeds, and its next step.
fn fleet(name: &'static str, vehicles: usize) -> impl FnMut() {
    let group = GroupSetup { law: Box::new(move || law(name)), dead_time_max_s: 0.0 };
    let plant = Box::new(SevenDof::new(0.01));
    let mut fleet = Fleet::new(LoopConfig { plant, period_s: 0.01, reference_bound_mps: 1.0 }, vec![group]);
    let body = (BODIES[0].build)();
    let slots: Vec<Slot> = (0..vehicles)
        .map(|i| {
            let nominal_nm_per_mps2 = body.nominal_nm_per_mps2();
            let (actuator, speed_mps) = (ActuatorSetup::default(), 5.0 + (i % 10) as f64);
            let body = body.clone();
            fleet.admit(0, VehicleSetup { body, nominal_nm_per_mps2, actuator, noise: None, speed_mps })
        })
        .collect();
    let mut step = 0_u32;
    move || {
        step += 1;
        let change_mps = if step % 64 < 32 { 0.2 } else { -0.2 };
        for slot in &slots {
            let block = fleet.block_mut(*slot);
            let target_mps = block.speed_mps(slot.lane()) + change_mps;
            block.set_target(slot.lane(), target_mps.max(0.0), Bound::Traffic);
            // Bends to the left and to the right: straight ahead, a body would cost less.
            block.see_heading(slot.lane(), 0.005 * f64::from((step % 64).abs_diff(32)), 0.1);
        }
        fleet.advance(PERIODS, |_| true, Follow::Traffic);
        fleet.close_step();
    }
}

fn closed_loop(bencher: Bencher, name: &'static str, set: InstructionSet, vehicles: usize) {
    let step = fleet(name, vehicles);
    set.during(|| bencher.counter(ItemsCount::new(vehicles * PERIODS as usize)).bench_local(step));
}

/// A SUMO step of 0.1 s of one block: ten control periods with measurement, law, actuators, steering, body, statistics.
#[divan::bench(args = laws())]
fn step(bencher: Bencher, name: &str) {
    let name = laws().find(|law| *law == name).expect("one of them");
    closed_loop(bencher, name, InstructionSet::available()[0], LANES);
}

/// The same without AVX-512.
#[divan::bench]
fn step_adaptive_avx2(bencher: Bencher) {
    closed_loop(bencher, "adaptive", InstructionSet::Avx2, LANES);
}

/// The same for many vehicles, the blocks shared out among all cores.
#[divan::bench(args = [1_024, 16_384])]
fn step_adaptive_all_cores(bencher: Bencher, vehicles: usize) {
    closed_loop(bencher, "adaptive", InstructionSet::available()[0], vehicles);
}
