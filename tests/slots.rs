//! A slot is used by one vehicle after the other. Nothing of a vehicle may be left for the next one.

use sumo_mfc::control::{Actuation, Build, CONTROLLERS, Command, Controller, Observation, law};
use sumo_mfc::fleet::block::Block;
use sumo_mfc::fleet::follow::{Bound, Follow};
use sumo_mfc::fleet::{ActuatorSetup, Fleet, GroupSetup, LoopConfig, Slot, VehicleSetup};
use sumo_mfc::keys::{NoKeys, Values};
use sumo_mfc::lanes::{LANES, Lanes};
use sumo_mfc::plant::{BODIES, PLANTS};
use sumo_mfc::random::Stream;
use sumo_mfc::reference::{Axis, Profile};
use sumo_mfc::registry::{Entry, find};

const PERIODS: u32 = 10;
const STEP_S: f64 = 0.1;
const STEPS: u32 = 60;
/// After how many steps the vehicle before leaves: on the move, at rest, and while it is off the road.
const LEAVES_AFTER: [u32; 3] = [12, 22, 32];
const KINDS: usize = 4;

/// Vehicles that differ in all that a slot is told at admission.
fn vehicle(kind: usize) -> VehicleSetup {
    let mut body = (BODIES[kind % BODIES.len()].build)();
    if kind == 1 {
        (body.track_width_m, body.cg_height_m, body.combined_slip) = (1.5, 0.5, true);
        body.friction = [0.4, 0.8, 0.5, 0.9];
    }
    let [dead_time_s, lag_s] = [[0.0, 0.0], [0.07, 0.05], [0.013, 0.0], [0.1, 0.02]][kind];
    VehicleSetup {
        nominal_nm_per_mps2: (0.8 + 0.1 * kind as f64) * body.nominal_nm_per_mps2(),
        actuator: ActuatorSetup { dead_time_s, lag_s },
        noise: (kind % 2 == 1).then(|| (Stream::new(5, "noise", &kind.to_string()), 0.3)),
        speed_mps: [0.0, 12.0, 5.0, 20.0][kind],
        body,
    }
}

/// A block costs as much with one vehicle as when it is full: whoever comes takes the lowest slot that is free.
#[test]
fn vehicles_gather_in_the_first_blocks() {
    let mut fleet = fleet(find("controller", &CONTROLLERS, "pid").unwrap(), PLANTS[0].name);
    let slots: Vec<Slot> = (0..40).map(|_| fleet.admit(0, vehicle(0))).collect();
    assert!(slots.iter().enumerate().all(|(place, slot)| slot.index() == place), "{slots:?}");
    for place in [3, 37, 20] {
        fleet.release(slots[place]);
    }
    let taken: Vec<usize> = (0..4).map(|_| fleet.admit(0, vehicle(0)).index()).collect();
    assert_eq!(taken, [3, 20, 37, 40]);
}

/// What a kind of vehicle is asked for in a step: traffic, speeds that are held, a profile over time; it comes to a stop,
/// starts again, is carried away and put back.
fn steer(block: &mut Block, slot: usize, kind: usize, step: u32) {
    let phase = (step as usize + 7 * kind) % 40;
    let target_mps = if (15..25).contains(&phase) { 0.0 } else { 6.0 + 3.0 * kind as f64 };
    let bound = [Bound::Traffic, Bound::Limit, Bound::Profile, Bound::Clamp][(step as usize + kind) % 4];
    block.set_target(slot, target_mps, bound);
    // Nothing is told in the first steps: what stands there then was left by the vehicle before.
    if step < 5 {
        return;
    }
    match kind {
        0 => block.set_grade(slot, 0.03),
        1 => block.inputs_mut().headwind_mps[slot] = 8.0,
        2 => block.inputs_mut().bank_rad[slot] = 0.02,
        _ => block.steering.set_curvature(slot, 0.02),
    }
    block.see_speed(slot, target_mps + 0.1);
    block.see_heading(slot, 0.02 * f64::from(step), STEP_S);
    match step {
        20 if kind == 2 => {
            let mut body = block.plant().body(slot).clone();
            body.load_to(1.3 * body.mass_kg);
            block.plant_mut().set_body(slot, &body);
        }
        30 if kind == 3 => block.vanish(slot),
        35 if kind == 3 => block.appear(slot, 9.0),
        _ => {}
    }
}

/// All that can be seen of a slot, as bits; takes the sums.
fn seen(block: &mut Block, slot: usize) -> Vec<u64> {
    let (state, inputs) = (block.plant().state(slot), *block.inputs_mut());
    let of_plant = [state.vx_mps, state.vy_mps, state.yaw_rate_radps, block.distance_m(slot)];
    let accelerations = block.plant().acceleration_mps2.map(|column| column[slot]);
    let road = [inputs.steer_rad, inputs.grade_rad, inputs.bank_rad, inputs.headwind_mps].map(|column| column[slot]);
    let shown = block.snapshot(slot);
    let of_loop = [shown.torque_nm, shown.target_mps, shown.reference_mps, shown.measured_mps];
    let ends = [block.acceleration_mps2(slot), block.sumo_mps(slot), f64::from(u8::from(block.rests(slot)))];
    let (limits, sums, stats) = (block.acceleration_limits_mps2(slot), block.take_sums(slot), block.stats(slot));
    let of_law = [shown.alpha_ratio, shown.f_hat_mps2];
    let sums = [sums.samples as f64, sums.error_mps, sums.error_squared, sums.speed_mps];
    let numbers = of_plant.into_iter().chain(state.wheel_speed_radps).chain(accelerations).chain(road).chain(of_loop);
    let numbers = numbers.chain(ends).chain(limits).chain(of_law).chain(sums).chain(shown.slip);
    // Every statistic: the shortest text that gives the same number back.
    numbers.map(f64::to_bits).chain(format!("{stats:?}").bytes().map(u64::from)).collect()
}

/// Drives one kind of vehicle for some steps; what was seen after admission and after every step.
fn drive(fleet: &mut Fleet, slot: Slot, kind: usize, steps: u32) -> Vec<Vec<u64>> {
    let profile = Profile::sine(Axis::Time, 8.0, 3.0, 4.0).unwrap();
    let mut rows = vec![seen(fleet.block_mut(slot), slot.lane())];
    for step in 0..steps {
        steer(fleet.block_mut(slot), slot.lane(), kind, step);
        let follow = match step % 20 {
            0..12 => Follow::Traffic,
            12..15 => Follow::Target,
            _ => Follow::Profile(&profile),
        };
        fleet.advance(PERIODS, |_| true, follow);
        fleet.close_step();
        rows.push(seen(fleet.block_mut(slot), slot.lane()));
    }
    rows
}

fn fleet(controller: &Entry<Build>, plant: &str) -> Fleet {
    let (build, values) = (controller.build.clone(), Values::defaults(controller.keys));
    let group = GroupSetup { law: Box::new(move || build(&values, 0.01)), dead_time_max_s: 0.2 };
    let plant = find("plant", &PLANTS, plant).unwrap();
    let plant = (plant.build)(&Values::defaults(plant.keys));
    Fleet::new(LoopConfig { plant, period_s: 0.01, reference_bound_mps: 1.0 }, vec![group])
}

/// Drives a vehicle of each kind for some steps after every other. The error is the first difference from a vehicle in a
/// fresh slot.
fn compare(controller: &Entry<Build>, plant: &str, leaves_after: &[u32], steps: u32) -> Result<(), String> {
    let fresh: Vec<_> = (0..KINDS)
        .map(|kind| {
            let mut fleet = fleet(controller, plant);
            let slot = fleet.admit(0, vehicle(kind));
            (drive(&mut fleet, slot, kind, steps), fleet.release(slot))
        })
        .collect();
    for (before, released_after) in (0..KINDS).flat_map(|kind| leaves_after.iter().map(move |steps| (kind, *steps))) {
        let mut used = fleet(controller, plant);
        for (kind, (expected, stats)) in fresh.iter().enumerate() {
            let slot = used.admit(0, vehicle(before));
            drive(&mut used, slot, before, released_after);
            used.release(slot);
            // Free for a while beside another vehicle.
            let other = [used.admit(0, vehicle(0)), used.admit(0, vehicle(1))];
            used.release(other[0]);
            used.advance(7, |_| true, Follow::Traffic);
            let again = used.admit(0, vehicle(kind));
            assert_eq!(again, slot, "the slot that was used");
            let rows = drive(&mut used, again, kind, steps);
            if let Some(step) = (0..rows.len()).find(|step| rows[*step] != expected[*step]) {
                let law = controller.name;
                return Err(format!("{law}, {plant}: {kind} after {before} for {released_after}, step {step}"));
            }
            assert_eq!(used.release(again), *stats);
            used.release(other[1]);
        }
    }
    Ok(())
}

#[test]
fn law_a_used_slot_is_a_fresh_one_with_every_law() {
    for controller in CONTROLLERS.iter() {
        compare(controller, "seven_dof", &LEAVES_AFTER, STEPS).unwrap();
    }
}

#[test]
fn law_a_used_slot_is_a_fresh_one_with_every_plant() {
    let adaptive = find("controller", &CONTROLLERS, "adaptive").unwrap();
    for plant in PLANTS.iter() {
        compare(adaptive, plant.name, &LEAVES_AFTER[..1], 15).unwrap();
    }
}

/// An integral law that forgets, or does not forget, its integral when a vehicle leaves.
struct Integral {
    forgets: bool,
    integral_m: Lanes,
}

impl Controller for Integral {
    fn command(&mut self, observation: &Observation, command: &mut Command) {
        for (i, torque_nm) in command.torque_nm.iter_mut().enumerate() {
            let error_mps = observation.measured_mps[i] - observation.reference_mps[i];
            self.integral_m[i] += 0.01 * error_mps;
            *torque_nm = -(error_mps + 0.1 * self.integral_m[i]) * observation.nominal_nm_per_mps2[i];
        }
    }

    fn feedback(&mut self, _actuation: &Actuation) {}

    fn reset(&mut self, slot: usize, _speed_mps: f64) {
        if self.forgets {
            self.integral_m[slot] = 0.0;
        }
    }
}

/// The test above can fail.
#[test]
fn a_law_that_remembers_the_vehicle_before_is_found_out() {
    let integral = |forgets| law("integral", "", move |_: NoKeys, _| Integral { forgets, integral_m: [0.0; LANES] });
    compare(&integral(true), "point_mass", &LEAVES_AFTER, STEPS).unwrap();
    let found = compare(&integral(false), "point_mass", &LEAVES_AFTER, STEPS).unwrap_err();
    assert!(found.starts_with("integral, point_mass: "), "{found}");
}
