//! The same bits whatever the machine has: every instruction set, any number of threads, any place in the fleet.

use sumo_mfc::control::CONTROLLERS;
use sumo_mfc::fleet::follow::{Bound, Follow};
use sumo_mfc::fleet::{Fleet, GroupSetup, LoopConfig, Slot};
use sumo_mfc::keys::Values;
use sumo_mfc::lanes::InstructionSet;
use sumo_mfc::plant::SevenDof;
use sumo_mfc::registry::find;
use vehicle::vehicle;

#[path = "same_bits/vehicle.rs"]
mod vehicle;

/// More blocks than one thread takes alone.
const VEHICLES: usize = 200;
const STEPS: usize = 150;

/// What a vehicle is to drive in a step: speed up, bend, stop, stand, start again.
fn target_mps(number: usize, step: usize) -> f64 {
    match (number + step) % 140 {
        0..40 => 13.9,
        phase @ 40..70 => 13.9 - 0.45 * (phase - 40) as f64,
        70..100 => 0.0,
        _ => 8.0,
    }
}

/// All that can be seen of a fleet of `vehicles` after a drive, as bits.
fn drive(controller: &str, set: InstructionSet, threads: usize, vehicles: std::ops::Range<usize>) -> Vec<Vec<u64>> {
    let law = find("controller", &CONTROLLERS, controller).unwrap();
    let values = Values::defaults(law.keys);
    let group = GroupSetup { law: Box::new(move || (law.build)(&values, 0.01)), dead_time_max_s: 0.1 };
    let plant = Box::new(SevenDof::new(0.01));
    let mut fleet = Fleet::new(LoopConfig { plant, period_s: 0.01, reference_bound_mps: 1.0 }, vec![group]);
    let slots: Vec<(usize, Slot)> = vehicles.map(|n| (n, fleet.admit(0, vehicle(n)))).collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    for step in 0..STEPS {
        for (number, slot) in &slots {
            let block = fleet.block_mut(*slot);
            let target_mps = target_mps(*number, step);
            block.see_speed(slot.lane(), target_mps);
            block.see_heading(slot.lane(), 0.01 * ((number + step) % 50) as f64, 0.1);
            block.set_target(slot.lane(), target_mps, Bound::Traffic);
        }
        pool.install(|| set.during(|| fleet.advance(10, |_| true, Follow::Traffic)));
        set.during(|| fleet.close_step());
    }
    let seen = |slot: &Slot| {
        let (block, lane) = (fleet.block(*slot), slot.lane());
        let (state, stats) = (block.plant().state(lane), block.stats(lane));
        let numbers = [state.vx_mps, state.vy_mps, state.yaw_rate_radps, block.torque_nm(lane), block.distance_m(lane)];
        let numbers = numbers.into_iter().chain(state.wheel_speed_radps);
        let sums = [stats.error_mean, stats.error_rms, stats.overshoot_max, stats.jerk_rms, stats.torque_rms];
        numbers.chain(sums.into_iter().flatten()).map(f64::to_bits).collect()
    };
    slots.iter().map(|(_, slot)| seen(slot)).collect()
}

#[test]
fn law_every_instruction_set_gives_the_same_bits() {
    for controller in CONTROLLERS.iter().map(|entry| entry.name) {
        let expected = drive(controller, InstructionSet::Baseline, 1, 0..48);
        for set in InstructionSet::available() {
            assert_eq!(drive(controller, set, 1, 0..48), expected, "{controller}, {set:?}");
        }
        assert!(expected.iter().flatten().all(|bits| f64::from_bits(*bits).is_finite()), "{controller}");
    }
}

#[test]
fn law_any_number_of_threads_gives_the_same_bits() {
    let best = InstructionSet::available()[0];
    let expected = drive("adaptive", best, 1, 0..VEHICLES);
    for threads in [2, 3, 8] {
        assert_eq!(drive("adaptive", best, threads, 0..VEHICLES), expected, "{threads} threads");
    }
}

#[test]
fn law_a_vehicle_drives_the_same_alone_and_among_others() {
    let best = InstructionSet::available()[0];
    let together = drive("adaptive", best, 1, 0..VEHICLES);
    for number in [0, 17, 130] {
        assert_eq!(drive("adaptive", best, 1, number..number + 1)[0], together[number], "vehicle {number}");
    }
}
