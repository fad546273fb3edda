//! Laws, oracles and limits of the plant.

use sumo_mfc::keys::Values;
use sumo_mfc::lanes::{Flags, InstructionSet, LANES};
use sumo_mfc::plant::body::GRAVITY_MPS2;
use sumo_mfc::plant::oracle::Reference;
use sumo_mfc::plant::{BODIES, Body, BodyKeys, Inputs, PLANTS, Plant, PlantBlock, SevenDof, State};
use sumo_mfc::random::Stream;

const PERIOD_S: f64 = 0.01;
const SUBSTEPS_S: [f64; 5] = [0.01, 0.005, 0.002, 0.001, 0.0005];
const ALL: Flags = [1.0; LANES];
const FIRST: Flags = {
    let mut first = [0.0; LANES];
    first[0] = 1.0;
    first
};

fn car() -> Body {
    (BODIES[0].build)()
}

/// Slot 0 of a block: a body in a state.
fn block_of(body: &Body, state: &State) -> PlantBlock {
    let mut block = PlantBlock::default();
    block.set_body(0, body);
    block.set_state(0, state);
    block
}

fn inputs(torque_nm: f64, steer_rad: f64) -> Inputs {
    let mut inputs = Inputs::default();
    inputs.torque_nm[0] = torque_nm;
    inputs.steer_rad[0] = steer_rad;
    inputs
}

/// Advances slot 0 by `seconds` with constant inputs.
fn run(plant: &dyn Plant, block: &mut PlantBlock, inputs: &Inputs, seconds: f64) -> State {
    for _ in 0..(seconds / PERIOD_S).round() as usize {
        plant.advance(block, inputs, &FIRST, PERIOD_S);
    }
    block.state(0)
}

/// Torque and steering of a car whose driver follows `target` (the speed wanted at each period [m/s] and its rate) round
/// bends, one pair per period; a stop is braked at 3 m/s² to the end.
fn driven(targets: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let plant = SevenDof::new(0.001);
    let mut block = PlantBlock::default();
    let scale = car().nominal_nm_per_mps2();
    targets
        .enumerate()
        .map(|(k, (target, rate))| {
            let t = k as f64 * PERIOD_S;
            let v = block.vx_mps[0];
            let stopping = target == 0.0 && v < 0.3;
            let accel = if stopping { -3.0 } else { 3.0 * (target - v) + rate };
            let low_speed_steer = if v < 4.0 { 0.2 * libm::sin(0.3 * t) } else { 0.0 };
            let bends = if v < 15.0 { 0.06 } else { 0.02 };
            let inputs = inputs(scale * accel.clamp(-9.0, 4.0), bends * libm::sin(0.7 * t) + low_speed_steer);
            plant.advance(&mut block, &inputs, &FIRST, PERIOD_S);
            (inputs.torque_nm[0], inputs.steer_rad[0])
        })
        .collect()
}

/// An urban drive: away from a red light, round bends, back to a stop, again every 20 s; with jumps of the torque by up
/// to 7 m/s² between two periods.
fn urban_drive(seconds: usize) -> Vec<(f64, f64)> {
    let mut target: f64 = 0.0;
    driven((0..seconds * 100).map(|k| {
        let (wish, rate): (f64, f64) = match k as f64 * PERIOD_S % 20.0 {
            s if s < 2.0 => (0.0, 4.0),
            s if s < 10.0 => (13.9, 2.6),
            s if s < 12.0 => (8.0, 4.5),
            s if s < 15.0 => (11.0, 1.5),
            _ => (0.0, 4.5),
        };
        let step = (wish - target).clamp(-PERIOD_S * rate, PERIOD_S * rate);
        target += step;
        (target, step / PERIOD_S)
    }))
}

/// The first `seconds` of the EPA urban cycle, straight between its points of 1 Hz.
fn udds_drive(seconds: usize) -> Vec<(f64, f64)> {
    let rows = include_str!("../scenarios/paper/data/udds.csv").lines().skip(1);
    let speeds: Vec<f64> = rows.map(|row| row.split_once(',').unwrap().1.parse().unwrap()).collect();
    driven((0..seconds * 100).map(|k| {
        let (a, b) = (speeds[k / 100], speeds[k / 100 + 1]);
        (a + (b - a) * (k % 100) as f64 / 100.0, b - a)
    }))
}

/// The states of the default car after each period of a drive that starts at `vx_mps`.
fn replay(plant: &dyn Plant, drive: &[(f64, f64)], vx_mps: f64) -> Vec<State> {
    let mut block = block_of(&car(), &State::rolling(&car(), vx_mps));
    drive.iter().map(|&(torque, steer)| run(plant, &mut block, &inputs(torque, steer), PERIOD_S)).collect()
}

fn worst_speed_error(run: &[State], exact: &[State]) -> f64 {
    run.iter().zip(exact).map(|(a, b)| (a.vx_mps - b.vx_mps).abs()).fold(0.0, f64::max)
}

fn values(state: &State) -> [f64; 7] {
    let w = state.wheel_speed_radps;
    [state.vx_mps, state.vy_mps, state.yaw_rate_radps, w[0], w[1], w[2], w[3]]
}

fn energy_j(body: &Body, state: &State) -> f64 {
    let spin: f64 = state.wheel_speed_radps.iter().map(|w| w * w).sum();
    let speed = state.vx_mps * state.vx_mps + state.vy_mps * state.vy_mps;
    let yaw = state.yaw_rate_radps * state.yaw_rate_radps;
    0.5 * (body.mass_kg * speed + body.yaw_inertia_kgm2 * yaw + body.wheel_inertia_kgm2 * spin)
}

fn any_state(random: &mut Stream, body: &Body) -> State {
    let mut between = |a: f64, b: f64| a + (b - a) * random.uniform();
    let vx_mps = between(0.0, 40.0);
    let mut state = State::rolling(body, vx_mps);
    state.vy_mps = between(-3.0, 3.0);
    state.yaw_rate_radps = between(-1.0, 1.0);
    for speed in &mut state.wheel_speed_radps {
        *speed *= between(0.0, 2.0);
    }
    state
}

#[test]
fn law_rest_stays_rest() {
    for entry in PLANTS.iter() {
        let plant = (entry.build)(&Values::defaults(entry.keys));
        for torque in [0.0, -500.0, -5000.0] {
            for steer in [0.0, 0.3, -0.3] {
                let mut block = block_of(&car(), &State::default());
                let state = run(&*plant, &mut block, &inputs(torque, steer), 0.5);
                assert_eq!(values(&state), [0.0; 7], "{} at {torque} N·m, {steer} rad", entry.name);
                assert_eq!(block.distance_m[0], 0.0);
            }
        }
    }
}

#[test]
fn law_wheel_loads_balance() {
    for entry in BODIES.iter() {
        let body = (entry.build)();
        let [fl, fr, rl, rr] = body.static_load_n();
        assert!(((fl + fr + rl + rr) / (body.mass_kg * GRAVITY_MPS2) - 1.0).abs() < 1e-12, "{}", entry.name);
        let moment = body.front_axle_m * (fl + fr) - body.rear_axle_m * (rl + rr);
        assert!(moment.abs() < 1e-9 * body.mass_kg, "{}: {moment} N·m", entry.name);
        assert!(fl == fr && rl == rr);
    }
}

#[test]
fn law_forces_in_balance_keep_the_speed() {
    // Uphill, against drag, wind and rolling resistance, at the torque that holds them; and rolling free on the flat.
    for (speed, grade) in [(0.5, 0.0), (20.0, 0.0), (5.0, 0.08), (25.0, -0.05)] {
        for substep in SUBSTEPS_S {
            let mut body = car();
            let (mut inputs, mut torque) = (inputs(0.0, 0.0), 0.0);
            if grade != 0.0 {
                (body.drag_area_m2, body.rolling_resistance) = (0.7, 0.012);
                (inputs.grade_rad[0], inputs.headwind_mps[0]) = (grade, 4.0);
                let air = 0.5 * 1.225 * 0.7 * (speed + 4.0) * (speed + 4.0);
                let weight = body.mass_kg * GRAVITY_MPS2;
                torque = (air + weight * (0.012 + libm::sin(grade))) * body.wheel_radius_m;
            }
            inputs.torque_nm[0] = torque;
            let mut block = block_of(&body, &State::rolling(&body, speed));
            let plant = SevenDof::new(substep);
            // The wheels first take up their slip, at the cost of a little speed.
            let before = run(&plant, &mut block, &inputs, 3.0);
            let after = run(&plant, &mut block, &inputs, 10.0);
            assert!((before.vx_mps - speed).abs() < 0.03, "{speed} m/s, {grade}, {substep} s: {before:?}");
            for (a, b) in std::iter::zip(values(&before), values(&after)) {
                assert!((a - b).abs() < 2e-3, "{speed} m/s, {grade}, {substep} s: {before:?}, {after:?}");
            }
        }
    }
}

#[test]
fn law_left_and_right_mirror() {
    let plant = SevenDof::new(PERIOD_S);
    let mut body = car();
    body.track_width_m = 1.5;
    body.friction = [0.9, 0.4, 0.8, 0.5];
    let mut mirrored = body.clone();
    mirrored.friction = [0.4, 0.9, 0.5, 0.8];
    for torque in [800.0, -3000.0] {
        let mut left = block_of(&body, &State::rolling(&body, 15.0));
        let mut right = block_of(&mirrored, &State::rolling(&body, 15.0));
        let a = run(&plant, &mut left, &inputs(torque, 0.03), 1.0);
        let b = run(&plant, &mut right, &inputs(torque, -0.03), 1.0);
        let w = b.wheel_speed_radps;
        let back = [b.vx_mps, -b.vy_mps, -b.yaw_rate_radps, w[1], w[0], w[3], w[2]];
        for (x, y) in values(&a).iter().zip(back) {
            assert!((x - y).abs() < 1e-9, "{a:?} against {b:?}");
        }
        assert!(a.vy_mps.abs() > 1e-3 && a.yaw_rate_radps.abs() > 1e-3, "the drive must be a bend");
    }
}

#[test]
fn law_coasting_never_gains_energy() {
    let mut random = Stream::new(1, "plant", "energy");
    let mut body = car();
    for case in 0..200 {
        body.track_width_m = if case % 2 == 0 { 0.0 } else { 1.5 };
        body.combined_slip = case % 3 == 0;
        let mut block = block_of(&body, &any_state(&mut random, &body));
        let inputs = inputs(0.0, 0.6 * random.uniform() - 0.3);
        let plant = SevenDof::new(SUBSTEPS_S[case % SUBSTEPS_S.len()]);
        let mut before = energy_j(&body, &block.state(0));
        for _ in 0..100 {
            let now = energy_j(&body, &run(&plant, &mut block, &inputs, PERIOD_S));
            assert!(now <= before * (1.0 + 1e-9), "case {case}: {before} -> {now} J");
            before = now;
        }
    }
}

#[test]
fn law_constant_torque_below_the_peak() {
    for substep in SUBSTEPS_S {
        for torque in [200.0, 1000.0, -1500.0] {
            let body = car();
            let mut block = block_of(&body, &State::rolling(&body, 20.0));
            let plant = SevenDof::new(substep);
            let early = run(&plant, &mut block, &inputs(torque, 0.0), 1.0);
            let late = run(&plant, &mut block, &inputs(torque, 0.0), 1.0);
            let r = body.wheel_radius_m;
            let expected = torque / (r * (body.mass_kg + 4.0 * body.wheel_inertia_kgm2 / (r * r)));
            // What the slip still changes is its share of the wheels' inertia.
            assert!(((late.vx_mps - early.vx_mps) / expected - 1.0).abs() < 2e-3, "{torque} N·m, {substep} s");
        }
    }
}

#[test]
fn law_torque_becomes_momentum() {
    for substep in SUBSTEPS_S {
        let body = car();
        let mut block = block_of(&body, &State::default());
        let state = run(&SevenDof::new(substep), &mut block, &inputs(1000.0, 0.0), 3.0);
        let spin: f64 = state.wheel_speed_radps.iter().sum();
        let momentum = body.mass_kg * state.vx_mps + body.wheel_inertia_kgm2 * spin / body.wheel_radius_m;
        let expected = 1000.0 / body.wheel_radius_m * 3.0;
        assert!((momentum / expected - 1.0).abs() < 1e-12, "{momentum} against {expected}");
    }
}

#[test]
fn law_locked_wheel_braking_distance() {
    for (substep, friction) in SUBSTEPS_S.iter().zip([1.0, 0.8, 0.3, 0.1, 1.0]) {
        let mut body = car();
        body.friction = [friction; 4];
        let mut block = block_of(&body, &State { vx_mps: 20.0, ..State::default() });
        let state = run(&SevenDof::new(*substep), &mut block, &inputs(-50_000.0, 0.0), 30.0);
        let sliding = body.longitudinal[0].force_per_peak(1.0);
        let expected = 400.0 / (2.0 * friction * GRAVITY_MPS2 * sliding);
        assert_eq!(values(&state), [0.0; 7]);
        assert!((block.distance_m[0] / expected - 1.0).abs() < 0.002, "{} m, not {expected} m", block.distance_m[0]);
    }
}

#[test]
fn law_terminal_speed_with_drag_and_wind() {
    let mut body = car();
    body.drag_area_m2 = 0.7;
    body.rolling_resistance = 0.012;
    for wind in [0.0, 8.0] {
        let force = 300.0 / body.wheel_radius_m - 0.012 * body.mass_kg * GRAVITY_MPS2;
        let expected = (force / (0.5 * 1.225 * 0.7)).sqrt() - wind;
        let mut block = block_of(&body, &State::rolling(&body, expected - 3.0));
        let mut inputs = inputs(300.0, 0.0);
        inputs.headwind_mps[0] = wind;
        let state = run(&SevenDof::new(PERIOD_S), &mut block, &inputs, 300.0);
        assert!((state.vx_mps / expected - 1.0).abs() < 1e-3, "{} against {expected}", state.vx_mps);
    }
}

#[test]
fn law_understeer_gradient_of_separate_axle_stiffness() {
    let mut body = car();
    body.set_cornering_stiffness([170_550.0, 137_844.0]);
    let (mass, l_f, l_r) = (body.mass_kg, body.front_axle_m, body.rear_axle_m);
    let expected = mass / (l_f + l_r) * (l_r / 170_550.0 - l_f / 137_844.0);
    assert!((body.understeer_gradient() / expected - 1.0).abs() < 1e-12);
    let steer = 1e-3;
    let mut block = block_of(&body, &State::rolling(&body, 20.0));
    let plant = SevenDof::new(PERIOD_S);
    run(&plant, &mut block, &inputs(0.0, steer), 5.0);
    let state = run(&plant, &mut block, &inputs(0.0, steer), PERIOD_S);
    let curvature = state.yaw_rate_radps / state.vx_mps;
    let lateral = state.yaw_rate_radps * state.vx_mps;
    let measured = (steer - body.wheelbase_m() * curvature) / lateral;
    assert!((measured / expected - 1.0).abs() < 0.01, "{measured} against {expected} rad per m/s²");
    // The same body with equal tyres and μ steers neutrally.
    assert!(car().understeer_gradient().abs() < 1e-12);
}

#[test]
fn law_second_order() {
    // Without stops: a brake that lets go at rest is a kink that no method crosses with its order.
    let drive: Vec<_> = (0..120)
        .map(|k| {
            let t = k as f64 * PERIOD_S;
            (900.0 * libm::sin(2.0 * t) - 200.0, 0.05 * libm::sin(3.0 * t))
        })
        .collect();
    let exact = replay(&Reference::new(1e-10), &drive, 15.0);
    let error = |substep: f64| {
        let run = replay(&SevenDof::new(substep), &drive, 15.0);
        run.iter()
            .zip(&exact)
            .flat_map(|(a, b)| std::iter::zip(values(a), values(b)).map(|(x, y)| (x - y).abs()))
            .fold(0.0, f64::max)
    };
    let errors = [2.5e-4, 1.25e-4, 6.25e-5].map(error);
    let orders: Vec<f64> = errors.windows(2).map(|e| libm::log2(e[0] / e[1])).collect();
    println!("errors {errors:?}, orders {orders:?}");
    assert!(orders.iter().all(|order| (1.9..2.1).contains(order)), "{errors:?}: {orders:?}");
}

#[test]
fn val_default_substep_against_the_implicit_reference() {
    let drive = urban_drive(60);
    let exact = replay(&Reference::new(1e-7), &drive, 0.0);
    let seven_dof = &PLANTS[0];
    let plant = (seven_dof.build)(&Values::defaults(seven_dof.keys));
    let error = worst_speed_error(&replay(&*plant, &drive, 0.0), &exact);
    println!("worst speed error at the default substep over 60 s of stop and go: {error:e} m/s");
    let finer = worst_speed_error(&replay(&SevenDof::new(0.005), &drive, 0.0), &exact);
    println!("at half of it: {finer:e} m/s");
    assert!(exact.iter().any(|s| s.vx_mps > 13.0) && exact.iter().any(|s| s.yaw_rate_radps.abs() > 0.2));
    assert!(error <= 1e-3, "{error} m/s");
}

#[test]
fn val_rough_torques_against_the_implicit_reference() {
    let mut random = Stream::new(1, "torque", "rough");
    let noisy: Vec<_> =
        urban_drive(60).iter().map(|&(torque, steer)| (torque + 1000.0 * random.normal(), steer)).collect();
    // From standstill with several times the torque that the tyres bear, the wheels spin at once.
    let spin = vec![(8000.0, 0.0); 300];
    for (name, drive, bounds) in [("noise of 1 000 N·m", &noisy, [0.05, 0.05]), ("spinning wheels", &spin, [0.15, 0.1])]
    {
        let exact = replay(&Reference::new(1e-7), drive, 0.0);
        for (substep_s, bound) in [0.01, 0.005].into_iter().zip(bounds) {
            let run = replay(&SevenDof::new(substep_s), drive, 0.0);
            let square = run.iter().zip(&exact).map(|(a, b)| (a.vx_mps - b.vx_mps).powi(2)).sum::<f64>();
            let (worst, rms) = (worst_speed_error(&run, &exact), (square / run.len() as f64).sqrt());
            println!("{name}, substep {substep_s} s: worst speed error {worst:.1e}, RMS {rms:.1e} m/s");
            assert!(worst <= bound, "{name}, {substep_s} s: {worst} m/s");
        }
    }
}

#[test]
fn val_default_substep_over_the_urban_cycle() {
    // Its first 505 s, the cold-start phase, which has its fastest part; the whole cycle gives 3e-4 m/s as well.
    let drive = udds_drive(505);
    let exact = replay(&Reference::new(1e-7), &drive, 0.0);
    let seven_dof = &PLANTS[0];
    let plant = (seven_dof.build)(&Values::defaults(seven_dof.keys));
    let error = worst_speed_error(&replay(&*plant, &drive, 0.0), &exact);
    println!("worst speed error at the default substep over 505 s of the UDDS: {error:e} m/s");
    let stops = exact.windows(2).filter(|pair| pair[0].vx_mps > 0.0 && pair[1].vx_mps == 0.0).count();
    assert!(stops >= 4 && exact.iter().any(|s| s.vx_mps > 24.0), "{stops} stops");
    assert!(error <= 1e-3, "{error} m/s");
}

#[test]
fn val_vector_code_against_scalar_libm() {
    let drive = urban_drive(60);
    let plant = SevenDof::new(PERIOD_S);
    let mut vector = PlantBlock::default();
    let mut scalar = PlantBlock::default();
    let mut worst: f64 = 0.0;
    for &(torque, steer) in &drive {
        let inputs = inputs(torque, steer);
        plant.advance(&mut vector, &inputs, &FIRST, PERIOD_S);
        plant.advance_scalar(&mut scalar, &inputs, &FIRST, PERIOD_S);
        for (a, b) in std::iter::zip(values(&vector.state(0)), values(&scalar.state(0))) {
            worst = worst.max((a - b).abs() / b.abs().max(1.0));
        }
    }
    println!("vector code and libm differ by at most {worst:e}");
    assert!(worst < 1e-9);
}

/// A block of different bodies, states and inputs, changing from period to period.
fn crowd(seed: u64) -> (PlantBlock, Vec<Inputs>) {
    let mut random = Stream::new(seed, "plant", "crowd");
    let mut block = PlantBlock::default();
    for slot in 0..LANES {
        let mut body = (BODIES[slot % BODIES.len()].build)();
        body.combined_slip = slot % 2 == 0;
        body.track_width_m = if slot % 3 == 0 { 1.5 } else { 0.0 };
        body.cg_height_m = if slot % 4 == 0 { 0.5 } else { 0.0 };
        body.drag_area_m2 = 0.1 * slot as f64;
        body.friction = [0.3 + 0.7 * random.uniform(); 4];
        let state = any_state(&mut random, &body);
        block.set_body(slot, &body);
        block.set_state(slot, &state);
    }
    let inputs = (0..300)
        .map(|_| {
            let mut inputs = Inputs::default();
            for slot in 0..LANES {
                let scale = block.body(slot).nominal_nm_per_mps2();
                inputs.torque_nm[slot] = scale * (14.0 * random.uniform() - 10.0);
                inputs.steer_rad[slot] = 0.6 * random.uniform() - 0.3;
                inputs.grade_rad[slot] = 0.2 * random.uniform() - 0.1;
                inputs.bank_rad[slot] = 0.2 * random.uniform() - 0.1;
                inputs.headwind_mps[slot] = 20.0 * random.uniform() - 10.0;
            }
            inputs
        })
        .collect();
    (block, inputs)
}

fn bits(block: &PlantBlock, slot: usize) -> Vec<u64> {
    let distance = [block.distance_m[slot]];
    values(&block.state(slot)).iter().chain(&distance).map(|value| value.to_bits()).collect()
}

#[test]
fn law_instruction_sets_give_the_same_bits() {
    let (start, drive) = crowd(2);
    let results: Vec<_> = InstructionSet::available()
        .into_iter()
        .map(|set| {
            let plant = SevenDof::new(0.005);
            let mut block = start.clone();
            for inputs in &drive {
                set.during(|| plant.advance(&mut block, inputs, &ALL, PERIOD_S));
            }
            (0..LANES).map(|slot| bits(&block, slot)).collect::<Vec<_>>()
        })
        .collect();
    println!("compared {:?}", InstructionSet::available());
    assert!(results.iter().all(|result| result == &results[0]));
}

#[test]
fn law_many_slots_equal_one_slot_runs() {
    let (start, drive) = crowd(3);
    let plant = SevenDof::new(PERIOD_S);
    let mut together = start.clone();
    for inputs in &drive {
        plant.advance(&mut together, inputs, &ALL, PERIOD_S);
    }
    for slot in 0..LANES {
        let mut alone = PlantBlock::default();
        alone.set_body(5, start.body(slot));
        alone.set_state(5, &start.state(slot));
        let others = bits(&alone, 6);
        for inputs in &drive {
            let mut own = Inputs::default();
            own.torque_nm[5] = inputs.torque_nm[slot];
            own.steer_rad[5] = inputs.steer_rad[slot];
            own.grade_rad[5] = inputs.grade_rad[slot];
            own.bank_rad[5] = inputs.bank_rad[slot];
            own.headwind_mps[5] = inputs.headwind_mps[slot];
            let mut moving = [0.0; LANES];
            moving[5] = 1.0;
            plant.advance(&mut alone, &own, &moving, PERIOD_S);
        }
        assert_eq!(bits(&together, slot), bits(&alone, 5), "slot {slot}");
        assert_eq!(bits(&alone, 6), others, "a slot that does not move stays untouched");
    }
}

/// What is left out where nothing steers, drifts or differs from left to right must not show: sixteen cars that run
/// straight, with locked and with spinning wheels, at rest and on slopes, with company of their kind and with a neighbour
/// that needs every tyre computed.
#[test]
fn law_a_straight_run_is_the_same_in_any_company() {
    let mut random = Stream::new(4, "plant", "straight");
    let mut straight = PlantBlock::default();
    for slot in 0..LANES {
        let mut body = (BODIES[slot % BODIES.len()].build)();
        body.track_width_m = if slot % 3 == 0 { 1.5 } else { 0.0 };
        body.cg_height_m = if slot % 4 == 0 { 0.5 } else { 0.0 };
        let speed = if slot % 5 == 0 { 0.0 } else { 30.0 * random.uniform() };
        let mut state = State::rolling(&body, speed);
        let [front, rear] = [random.uniform(), random.uniform()].map(|r| if r < 0.3 { 0.0 } else { 3.0 * r });
        for (wheel, factor) in [front, front, rear, rear].into_iter().enumerate() {
            state.wheel_speed_radps[wheel] *= factor;
        }
        straight.set_body(slot, &body);
        straight.set_state(slot, &state);
    }
    let (crowd, _) = crowd(5);
    let mut mixed = straight.clone();
    let mut neighbour = crowd.body(0).clone();
    neighbour.friction = [0.2, 0.9, 0.5, 1.0];
    mixed.set_body(0, &neighbour);
    mixed.set_state(0, &crowd.state(0));
    let plant = SevenDof::new(PERIOD_S);
    for _ in 0..300 {
        let mut inputs = Inputs::default();
        for slot in 0..LANES {
            inputs.torque_nm[slot] = straight.body(slot).nominal_nm_per_mps2() * (24.0 * random.uniform() - 16.0);
            inputs.grade_rad[slot] = if slot % 2 == 0 { 0.1 * random.uniform() } else { 0.0 };
        }
        plant.advance(&mut straight, &inputs, &ALL, PERIOD_S);
        (inputs.steer_rad[0], inputs.bank_rad[0]) = (0.3 * random.uniform(), 0.1);
        plant.advance(&mut mixed, &inputs, &ALL, PERIOD_S);
        for slot in 1..LANES {
            assert_eq!(bits(&straight, slot), bits(&mixed, slot), "slot {slot}");
            assert_eq!((straight.vy_mps[slot], straight.yaw_rate_radps[slot]), (0.0, 0.0));
        }
    }
    let braked = (1..LANES).filter(|slot| straight.vx_mps[*slot] == 0.0).count();
    assert!(braked > 0 && straight.vx_mps.iter().any(|v| *v > 1.0), "some stand, some drive: {braked}");
}

/// Speeds, steer angles and accelerations of the stability grid, 16 to a block.
fn grid() -> Vec<(f64, f64, f64)> {
    let mut cases = Vec::new();
    for speed in [0.0, 0.05, 0.2, 0.5, 1.0, 2.0, 3.0, 10.0, 30.0, 70.0] {
        for steer in [0.0, 0.02, -0.3, 0.3] {
            for accel in [-12.0, -4.0, 0.0, 1.0, 8.0] {
                cases.push((speed, steer, accel));
            }
        }
    }
    cases
}

#[test]
fn law_every_substep_is_stable_at_every_speed() {
    let body = car();
    for substep in [0.01, 0.007, 0.005, 0.0025, 0.001] {
        let (mut locked, mut spinning) = (0, 0);
        let plant = SevenDof::new(substep);
        for cases in grid().chunks(LANES) {
            let mut block = PlantBlock::default();
            for (slot, case) in cases.iter().enumerate() {
                block.set_state(slot, &State::rolling(&body, case.0));
            }
            for period in 0..200 {
                let mut inputs = Inputs::default();
                for (slot, case) in cases.iter().enumerate() {
                    // The wheel is turned from side to side on the way.
                    inputs.steer_rad[slot] = if period % 100 < 50 { case.1 } else { -case.1 };
                    inputs.torque_nm[slot] = case.2 * body.nominal_nm_per_mps2();
                }
                let before = block.clone();
                plant.advance(&mut block, &inputs, &ALL, PERIOD_S);
                for (slot, case) in cases.iter().enumerate() {
                    check_step(
                        *case,
                        &before.state(slot),
                        &block.state(slot),
                        &format!("{substep} s, {period}, {case:?}"),
                    );
                    let state = block.state(slot);
                    let rims = state.wheel_speed_radps.map(|w| w * body.wheel_radius_m);
                    locked += usize::from(state.vx_mps > 5.0 && rims.contains(&0.0));
                    spinning += usize::from(rims.iter().any(|rim| *rim > 2.0 * state.vx_mps.max(1.0)));
                }
            }
        }
        assert!(locked > 100 && spinning > 100, "{substep} s: {locked} locked, {spinning} spinning");
    }
}

/// What one period may do to a vehicle, whatever the driver does.
fn check_step((speed, steer, accel): (f64, f64, f64), before: &State, now: &State, at: &str) {
    assert!(values(now).iter().all(|value| value.is_finite()), "{at}: {now:?}");
    assert!(now.vx_mps.abs() < 90.0 && now.vy_mps.abs() < 71.0, "{at}: {now:?}");
    // The tyres hold no more than g; the rest is the frame that turns.
    let turn = 0.011 * (now.yaw_rate_radps * now.vy_mps).abs();
    let jump = (now.vx_mps - before.vx_mps).abs();
    assert!(jump < 0.011 * GRAVITY_MPS2 + turn + 0.06, "{at}: jump of {jump} m/s to {now:?}");
    if accel < 0.0 && speed < 40.0 && steer.abs() < 0.1 {
        assert!(now.vx_mps >= 0.0, "{at}: backwards, {now:?}");
    }
    let turned_back = accel < 0.0 && now.wheel_speed_radps.iter().any(|w| *w < 0.0);
    assert!(!turned_back || now.vx_mps < 0.0, "{at}: brakes turned a wheel back, {now:?}");
}

#[test]
fn brakes_stop_at_exactly_zero_and_let_go() {
    for substep in SUBSTEPS_S {
        for (torque, steer) in [(-300.0, 0.0), (-1500.0, 0.3), (-4700.0, -0.1), (-20_000.0, 0.0)] {
            let body = car();
            let plant = SevenDof::new(substep);
            let mut block = block_of(&body, &State::rolling(&body, 3.0));
            let mut slowest: f64 = 3.0;
            for _ in 0..650 {
                slowest = slowest.min(run(&plant, &mut block, &inputs(torque, steer), PERIOD_S).vx_mps);
            }
            assert_eq!(values(&block.state(0)), [0.0; 7], "{torque} N·m, {steer} rad, {substep} s");
            assert_eq!(slowest, 0.0);
            let released = run(&plant, &mut block, &inputs(500.0, steer), 1.0);
            assert!(released.vx_mps > 0.5, "{released:?}");
        }
    }
}

#[test]
fn a_brake_holds_on_a_slope_as_far_as_it_goes() {
    let body = car();
    let needed = body.mass_kg * GRAVITY_MPS2 * libm::sin(0.05) * body.wheel_radius_m;
    for (torque, holds) in [(-1.1 * needed, true), (-0.9 * needed, false), (0.0, false)] {
        let mut block = block_of(&body, &State::default());
        let mut inputs = inputs(torque, 0.0);
        inputs.grade_rad[0] = 0.05;
        let state = run(&SevenDof::new(PERIOD_S), &mut block, &inputs, 2.0);
        assert_eq!(state.vx_mps == 0.0, holds, "{torque} N·m: {state:?}");
        let expected = 2.0 * (-needed - torque) / body.wheel_radius_m / body.effective_mass_kg();
        assert!(holds || (state.vx_mps / expected - 1.0).abs() < 0.01, "{} against {expected}", state.vx_mps);
    }
}

#[test]
fn law_split_friction_turns_the_car_to_the_rough_side() {
    for (track, sign) in [(0.0, 0.0), (1.5, 1.0)] {
        let mut body = car();
        body.track_width_m = track;
        body.friction = [0.9, 0.3, 0.85, 0.25];
        let mut block = block_of(&body, &State::rolling(&body, 20.0));
        let state = run(&SevenDof::new(PERIOD_S), &mut block, &inputs(-2500.0, 0.0), 0.3);
        let w = state.wheel_speed_radps;
        for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (2, 3)] {
            assert!((w[i] - w[j]).abs() > 1e-3, "wheels {i} and {j} turn alike: {w:?}");
        }
        // The left side is rough: its brakes pull the nose to the left, positive yaw.
        assert!(if sign == 0.0 { state.yaw_rate_radps == 0.0 } else { state.yaw_rate_radps > 0.02 }, "{state:?}");
    }
}

#[test]
fn load_transfer_moves_grip_to_the_rear_on_the_gas() {
    let speed_after = |drive_front_share: f64, cg_height_m: f64| {
        let mut body = car();
        body.drive_front_share = drive_front_share;
        body.cg_height_m = cg_height_m;
        let mut block = block_of(&body, &State::rolling(&body, 5.0));
        run(&SevenDof::new(PERIOD_S), &mut block, &inputs(10_000.0, 0.0), 1.0).vx_mps
    };
    assert!(speed_after(1.0, 0.55) < speed_after(1.0, 0.0) - 0.1);
    assert!(speed_after(0.0, 0.55) > speed_after(0.0, 0.0) + 0.1);
}

#[test]
fn friction_ellipse_costs_lateral_force_under_braking() {
    let yaw_rate = |combined_slip: bool| {
        let mut body = car();
        body.combined_slip = combined_slip;
        let mut block = block_of(&body, &State::rolling(&body, 20.0));
        run(&SevenDof::new(PERIOD_S), &mut block, &inputs(-4500.0, 0.05), 0.5).yaw_rate_radps
    };
    assert!(yaw_rate(true) < 0.8 * yaw_rate(false), "{} against {}", yaw_rate(true), yaw_rate(false));
}

#[test]
fn every_body_covers_its_class() {
    for entry in BODIES.iter() {
        let body = (entry.build)();
        let heavy = ["bus", "truck"].contains(&entry.name);
        let (accel, decel) = if heavy { (1.3, 7.0) } else { (2.6, 9.0) };
        let plant = SevenDof::new(PERIOD_S);
        let mut block = block_of(&body, &State::rolling(&body, 10.0));
        let driven = run(&plant, &mut block, &inputs(body.drive_torque_max_nm, 0.0), 1.0);
        assert!(driven.vx_mps - 10.0 > accel, "{}: {driven:?}", entry.name);
        let mut block = block_of(&body, &State::rolling(&body, 25.0));
        let braked = run(&plant, &mut block, &inputs(-body.brake_torque_max_nm, 0.0), 1.0);
        assert!(25.0 - braked.vx_mps > 0.98 * decel, "{}: {braked:?}", entry.name);
        assert!(braked.wheel_speed_radps.iter().all(|w| *w > 0.0), "{} locks: {braked:?}", entry.name);
        assert!(body.understeer_gradient() > -1e-3);
    }
}

#[test]
fn keys_override_the_preset_and_only_what_they_name() {
    let mut body = car();
    body.apply(&BodyKeys::default());
    assert_eq!(body, car());
    let given = BodyKeys {
        mass_kg: Some(2000.0),
        friction: Some(0.5),
        friction_rear_left: Some(0.2),
        rear_stiffness_nprad: Some(80_000.0),
        combined_slip: Some(true),
        ..BodyKeys::default()
    };
    body.apply(&given);
    assert_eq!((body.mass_kg, body.friction, body.combined_slip), (2000.0, [0.5, 0.5, 0.2, 0.5], true));
    let stiffness = body.cornering_stiffness_nprad();
    assert!((stiffness[1] - 80_000.0).abs() < 1e-6 && (stiffness[0] - 80_000.0).abs() > 1.0, "{stiffness:?}");
    assert_eq!(body.yaw_inertia_kgm2, car().yaw_inertia_kgm2);
}

/// Whatever the torque, no body gains speed faster than it is said to be able to, and with the best torque nearly as fast.
#[test]
fn law_a_body_can_gain_what_it_says_and_no_more() {
    const SECONDS: f64 = 0.5;
    let plant = SevenDof::new(0.001);
    for (front_share, cg_height_m, mu) in
        [(1.0, 0.0, 1.0), (1.0, 0.6, 0.8), (0.0, 0.6, 0.8), (0.0, 0.0, 0.3), (0.5, 0.6, 0.9)]
    {
        let mut body = car();
        (body.drive_front_share, body.cg_height_m, body.friction) = (front_share, cg_height_m, [mu; 4]);
        (body.drive_torque_max_nm, body.brake_torque_max_nm) = (1e5, 1e5);
        let [drive_mps2, brake_mps2] = body.acceleration_max_mps2();
        let gained = |share: f64| {
            let torque_nm = share * drive_mps2 * body.effective_mass_kg() * body.wheel_radius_m;
            let mut block = block_of(&body, &State::rolling(&body, 10.0));
            (run(&plant, &mut block, &inputs(torque_nm, 0.0), SECONDS).vx_mps - 10.0) / SECONDS
        };
        let best = [0.5, 0.8, 0.9, 0.95, 1.0, 1.05, 1.2, 2.0].map(gained).into_iter().fold(0.0, f64::max);
        println!("{front_share} {cg_height_m} {mu}: {best:.2} of {drive_mps2:.2} m/s2");
        assert!(
            best <= drive_mps2 && best > 0.85 * drive_mps2,
            "{front_share} {cg_height_m} {mu}: {best} {drive_mps2}"
        );
        assert!((brake_mps2 - mu * GRAVITY_MPS2).abs() < 1e-9);
        body.drive_torque_max_nm = 0.5 * body.effective_mass_kg() * body.wheel_radius_m;
        assert!((body.acceleration_max_mps2()[0] - 0.5).abs() < 1e-12, "the engine's limit");
    }
}

#[test]
fn law_factors_make_of_every_preset_the_same_kind_of_vehicle() {
    for entry in BODIES.iter() {
        let (preset, mut body) = ((entry.build)(), (entry.build)());
        body.apply(&BodyKeys {
            mass_factor: Some(1.5),
            friction_factor: Some(0.5),
            stiffness_factor: Some(0.8),
            torque_factor: Some(0.25),
            ..BodyKeys::default()
        });
        let numbers = |b: &Body| {
            let stiffness = b.cornering_stiffness_nprad()[1];
            let per_load = stiffness / b.mass_kg / b.friction[0];
            [b.mass_kg, b.yaw_inertia_kgm2, b.friction[3], per_load, b.drive_torque_max_nm, b.brake_torque_max_nm]
        };
        let wanted = [1.5, 1.5, 0.5, 0.8, 0.25, 0.25];
        for ((now, before), factor) in numbers(&body).into_iter().zip(numbers(&preset)).zip(wanted) {
            assert!((now / before / factor - 1.0).abs() < 1e-12, "{}: {now} of {before}, not {factor}", entry.name);
        }
    }
    let mut body = car();
    body.apply(&BodyKeys { mass_kg: Some(2000.0), mass_factor: Some(0.5), ..BodyKeys::default() });
    assert_eq!(body.mass_kg, 1000.0, "a factor is one of the other key's value");
}

#[test]
fn a_measured_curve_gives_tyre_and_friction() {
    let mut body = car();
    let tyre = body.longitudinal[0];
    let peak_n = 0.7 * body.static_load_n()[0];
    let rows = (1..=200).map(|k| 0.005 * f64::from(k)).map(|s| format!("{s},{}\n", peak_n * tyre.force_per_peak(s)));
    let csv = format!("slip,force_n\n{}", rows.collect::<String>());
    let found = body.apply_tyre_curve(&csv).unwrap();
    assert!((found.peak_n / peak_n - 1.0).abs() < 1e-3 && (body.friction[3] - 0.7).abs() < 1e-3, "{found:?}");
    assert!((body.longitudinal[1].b / tyre.b - 1.0).abs() < 0.02 && (body.longitudinal[1].c - tyre.c).abs() < 0.03);
    assert!(body.apply_tyre_curve("slip,force_n\n").is_err());
}

#[test]
fn a_loaded_vehicle_keeps_its_kind() {
    for entry in BODIES.iter() {
        let (empty, mut loaded) = ((entry.build)(), (entry.build)());
        loaded.load_to(1.5 * empty.mass_kg);
        let settings = [(&empty, 1.0), (&loaded, 1.5)].map(|(body, factor)| {
            let mut block = block_of(body, &State::rolling(body, 20.0));
            block.distance_m[0] = 0.0;
            let inputs = inputs(-0.5 * body.brake_torque_max_nm, 0.0);
            (run(&SevenDof::new(PERIOD_S), &mut block, &inputs, 1.0).vx_mps, body.yaw_inertia_kgm2 / factor)
        });
        assert!((settings[0].0 - settings[1].0).abs() < 0.1, "{}: {settings:?}", entry.name);
        assert!((settings[0].1 / settings[1].1 - 1.0).abs() < 1e-12);
    }
}

#[test]
fn point_mass_and_seven_dof_agree_where_tyres_do_not_matter() {
    let build = |name| PLANTS.iter().find(|e| e.name == name).map(|e| (e.build)(&Values::defaults(e.keys)));
    let drive: Vec<_> = (0..500).map(|k| (if k < 300 { 700.0 } else { -600.0 }, 0.0)).collect();
    let runs = ["seven_dof", "point_mass", "reference"].map(|name| replay(&*build(name).unwrap(), &drive, 5.0));
    assert!(worst_speed_error(&runs[0], &runs[1]) < 0.02);
    assert!(worst_speed_error(&runs[0], &runs[2]) < 1e-3);
}
