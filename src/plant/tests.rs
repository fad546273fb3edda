//! Bodies against their sources, and laws that every model of the plant keeps.

use super::body::GRAVITY_MPS2;
use super::*;
use crate::lanes::{Flags, LANES};

const PERIOD_S: f64 = 0.01;
const FIRST: Flags = {
    let mut first = [0.0; LANES];
    first[0] = 1.0;
    first
};

fn named(name: &str) -> Body {
    (BODIES.iter().find(|entry| entry.name == name).unwrap().build)()
}

/// A plant with default keys.
fn plant(name: &str) -> Box<dyn Plant> {
    let entry = PLANTS.iter().find(|entry| entry.name == name).unwrap();
    (entry.build)(&Values::defaults(entry.keys))
}

/// Slot 0 of a block: a body in a state.
fn block_of(body: &Body, state: &State) -> PlantBlock {
    let mut block = PlantBlock::default();
    block.set_body(0, body);
    block.set_state(0, state);
    block
}

fn inputs(torque_nm: f64, steer_rad: f64, grade_rad: f64) -> Inputs {
    let mut inputs = Inputs::default();
    (inputs.torque_nm[0], inputs.steer_rad[0], inputs.grade_rad[0]) = (torque_nm, steer_rad, grade_rad);
    inputs
}

fn run(plant: &dyn Plant, block: &mut PlantBlock, inputs: &Inputs, seconds: f64) -> State {
    for _ in 0..(seconds / PERIOD_S).round() as usize {
        plant.advance(block, inputs, &FIRST, PERIOD_S);
    }
    block.state(0)
}

fn near(got: f64, wanted: f64, share: f64, what: &str) {
    assert!((got - wanted).abs() <= share * wanted.abs(), "{what}: {got} instead of {wanted}");
}

/// Mass, wheelbase, share of the weight on the front axle and radius of gyration, from the sources that `body.rs` names.
#[test]
fn val_bodies_have_the_measures_of_their_sources() {
    let slender_m = |length_m: f64| length_m / 12_f64.sqrt();
    for (name, mass_kg, wheelbase_m, front_share, gyration_m) in [
        ("car", 1719.0, 2.708, 0.5587, 1.3855),
        ("ford_escort", 1225.888, 2.39268, 0.6306, 1.1204),
        ("bmw_320i", 1093.295, 2.578913, 0.5517, 1.2801),
        ("vw_vanagon", 1478.898, 2.471928, 0.5345, 1.2932),
        ("van", 2800.0, 3.665, 0.5, 3.665 / 2.0),
        ("bus", 14_000.0, 5.845, 7.245 / (7.245 + 12.0), slender_m(11.95)),
        ("truck", 12_000.0, 4.2, 0.4, slender_m(7.1)),
    ] {
        let body = named(name);
        near(body.mass_kg, mass_kg, 1e-9, name);
        near(body.wheelbase_m(), wheelbase_m, 1e-9, name);
        near(2.0 * body.static_load_n()[0] / (mass_kg * GRAVITY_MPS2), front_share, 2e-3, name);
        near((body.yaw_inertia_kgm2 / mass_kg).sqrt(), gyration_m, 2e-3, name);
    }
}

/// `parameters_tire.yaml` of CommonRoad gives stiffnesses per load (p_kx1 = 22.303, |p_ky1| = 21.92) and peaks per load
/// (p_dx1 = 1.1739, p_dy1 = 1.0489); across, the force beyond the peak hardly falls (p_ey1 = −0.0074722).
#[test]
fn val_common_road_tyres_have_the_published_stiffness_and_peaks() {
    for name in ["ford_escort", "bmw_320i", "vw_vanagon"] {
        let body = named(name);
        let load_n = body.static_load_n();
        for axle in [0, 1] {
            let axle_load_n = 2.0 * load_n[2 * axle];
            near(body.friction[2 * axle] * body.longitudinal[axle].slope_per_peak(), 22.303, 1e-9, name);
            near(body.cornering_stiffness_nprad()[axle] / axle_load_n, 21.92, 1e-9, name);
            near(body.friction[2 * axle], 1.1739, 1e-9, name);
            near(body.friction[2 * axle] * body.lateral_grip, 1.0489, 1e-9, name);
            near(body.lateral[axle].e, -0.0074722, 1e-9, name);
        }
    }
}

/// Cornering stiffness of 0.1 of the load per degree, peak friction 0.8 (UMTRI-86-12).
#[test]
fn val_heavy_tyres_are_those_of_the_factbook() {
    for name in ["bus", "truck"] {
        let body = named(name);
        let axle_loads_n = [0, 2].map(|wheel| 2.0 * body.static_load_n()[wheel]);
        for (stiffness, load_n) in body.cornering_stiffness_nprad().into_iter().zip(axle_loads_n) {
            near(stiffness / load_n, 0.1 * 180.0 / std::f64::consts::PI, 0.01, name);
        }
        assert_eq!(body.friction, [0.8; 4]);
    }
}

#[test]
fn law_load_takes_inertia_and_torques_with_it() {
    for entry in BODIES.iter() {
        let (empty, mut loaded) = ((entry.build)(), (entry.build)());
        loaded.load_to(1.5 * empty.mass_kg);
        let per_mass = |body: &Body| {
            [body.yaw_inertia_kgm2, body.drive_torque_max_nm, body.brake_torque_max_nm].map(|x| x / body.mass_kg)
        };
        for (now, before) in per_mass(&loaded).into_iter().zip(per_mass(&empty)) {
            near(now, before, 1e-12, entry.name);
        }
    }
}

#[test]
fn law_weak_brakes_and_engines_bound_what_a_body_can() {
    let mut body = named("car");
    let scale = body.effective_mass_kg() * body.wheel_radius_m;
    (body.drive_torque_max_nm, body.brake_torque_max_nm) = (0.5 * scale, 2.5 * scale);
    let [drive_mps2, brake_mps2] = body.acceleration_max_mps2();
    near(drive_mps2, 0.5, 1e-12, "engine");
    near(brake_mps2, 2.5, 1e-12, "brakes");
}

#[test]
fn law_an_axle_on_split_friction_is_as_stiff_as_on_its_mean() {
    let stiffness = |friction: [f64; 4]| {
        let mut body = named("car");
        body.friction = friction;
        body.cornering_stiffness_nprad()
    };
    let (split, even) = (stiffness([0.9, 0.3, 0.2, 0.8]), stiffness([0.6, 0.6, 0.5, 0.5]));
    (0..2).for_each(|axle| near(split[axle], even[axle], 1e-12, "axle"));
}

/// Wheels with slips of −1, −0.5, 0.2 and −0.1: the axles' are the means.
#[test]
fn the_slip_of_an_axle_is_the_mean_of_its_wheels() {
    let body = named("car");
    let mut state = State::rolling(&body, 10.0);
    let rolling = state.wheel_speed_radps[0];
    state.wheel_speed_radps = [0.0, 0.5 * rolling, 1.25 * rolling, 0.9 * rolling];
    let [front, rear] = block_of(&body, &state).slip(0, 0.0);
    near(front, -0.75, 1e-12, "front");
    near(rear, 0.05, 1e-12, "rear");
}

#[test]
fn law_a_slot_that_does_not_move_keeps_its_state() {
    for entry in PLANTS.iter() {
        let mut block = block_of(&named("car"), &State::rolling(&named("car"), 10.0));
        block.set_state(1, &State::rolling(&named("car"), 7.0));
        let mut pushed = inputs(500.0, 0.0, 0.0);
        pushed.torque_nm[1] = 500.0;
        run(&*plant(entry.name), &mut block, &pushed, 1.0);
        assert_eq!(block.state(1), State::rolling(&named("car"), 7.0), "{}", entry.name);
        assert!(block.distance_m[1] == 0.0 && block.vx_mps[0] > 10.5, "{}", entry.name);
    }
}

/// Against slope, wind and rolling resistance, at the torque that holds them, every model keeps its speed and drives
/// speed times time.
#[test]
fn law_forces_in_balance_keep_the_speed_of_every_model() {
    for name in ["seven_dof", "point_mass"] {
        for (speed_mps, wind_mps, grade_rad) in [(20.0_f64, 4.0, 0.05_f64), (25.0, -30.0, -0.02), (5.0, 0.0, 0.08)] {
            let mut body = named("car");
            (body.drag_area_m2, body.rolling_resistance) = (0.7, 0.012);
            let air_n = 0.5 * 1.225 * 0.7 * (speed_mps + wind_mps) * (speed_mps + wind_mps).abs();
            let road_n = body.mass_kg * GRAVITY_MPS2 * (0.012 + grade_rad.sin());
            let mut inputs = inputs((air_n + road_n) * body.wheel_radius_m, 0.0, grade_rad);
            inputs.headwind_mps[0] = wind_mps;
            let mut block = block_of(&body, &State::rolling(&body, speed_mps));
            let state = run(&*plant(name), &mut block, &inputs, 10.0);
            assert!((state.vx_mps - speed_mps).abs() < 0.03, "{name}: {state:?}");
            near(block.distance_m[0], 10.0 * speed_mps, 2e-3, name);
        }
    }
}

/// Resistances stop nobody who stands: without torque a vehicle stays, with a brake it stays on a slope as far as that goes.
#[test]
fn law_every_model_stands_where_its_brake_holds() {
    let mut body = named("car");
    body.rolling_resistance = 0.012;
    let needed_nm = body.mass_kg * GRAVITY_MPS2 * libm::sin(0.05) * body.wheel_radius_m;
    for name in ["seven_dof", "point_mass"] {
        let after = |torque_nm: f64, grade_rad: f64| {
            let mut block = block_of(&body, &State::default());
            run(&*plant(name), &mut block, &inputs(torque_nm, 0.0, grade_rad), 1.0).vx_mps
        };
        assert_eq!(after(0.0, 0.0), 0.0, "{name}");
        assert_eq!(after(-1.001 * needed_nm, 0.05), 0.0, "{name}");
        assert!(after(-0.9 * needed_nm, 0.05) < 0.0 && after(0.0, 0.05) < -0.1, "{name}");
    }
}

/// Under steady torque the distance is the area under a straight line.
#[test]
fn law_distance_is_the_area_below_the_speed() {
    for name in ["seven_dof", "point_mass"] {
        let body = named("car");
        let mut block = block_of(&body, &State::rolling(&body, 10.0));
        let state = run(&*plant(name), &mut block, &inputs(500.0, 0.0, 0.0), 4.0);
        near(block.distance_m[0], 4.0 * 0.5 * (10.0 + state.vx_mps), 1e-3, name);
        assert!(state.vx_mps > 13.0);
    }
}

/// The acceleration that shifts the wheel loads is the change of the velocity as somebody beside the road sees it.
#[test]
fn law_the_acceleration_is_that_of_the_ground() {
    let body = named("car");
    let plant = SevenDof::new(0.001);
    let mut block = block_of(&body, &State::rolling(&body, 15.0));
    run(&plant, &mut block, &inputs(0.0, 0.08, 0.0), 1.0);
    for _ in 0..50 {
        let before = block.state(0);
        plant.advance(&mut block, &inputs(-1000.0, 0.08, 0.0), &FIRST, 0.001);
        let now = block.state(0);
        let turned_rad = 0.001 * 0.5 * (before.yaw_rate_radps + now.yaw_rate_radps);
        let (sin, cos) = turned_rad.sin_cos();
        let along = cos * now.vx_mps - sin * now.vy_mps - before.vx_mps;
        let across = sin * now.vx_mps + cos * now.vy_mps - before.vy_mps;
        let got = block.acceleration_mps2.map(|column| column[0]);
        assert!((got[0] - along / 0.001).abs() < 0.02 && (got[1] - across / 0.001).abs() < 0.02, "{got:?}, {along}");
        assert!(got[1] > 2.0 && now.vy_mps.abs() > 0.03, "a bend: {got:?}, {now:?}");
    }
}

/// Sliding sideways on locked wheels, tyres that hold half across brake half as much, and turn nobody.
#[test]
fn law_lateral_grip_scales_what_tyres_hold_across() {
    let skid = |lateral_grip: f64| {
        let body = Body { lateral_grip, ..named("car") };
        let mut block = block_of(&body, &State { vy_mps: 5.0, ..State::default() });
        let state = run(&SevenDof::new(0.001), &mut block, &inputs(-5000.0, 0.0, 0.0), 0.1);
        assert!(state.yaw_rate_radps.abs() < 1e-9, "{state:?}");
        5.0 - state.vy_mps
    };
    near(skid(0.5), 0.5 * skid(1.0), 1e-3, "half the grip");
}

/// Axles with tyres of their own: vector code and the oracle from `libm` know them apart, along and across.
#[test]
fn val_unequal_axles_against_scalar_libm() {
    let mut body = named("car");
    (body.longitudinal[1].b, body.lateral[1].b, body.lateral[1].c) = (20.0, 14.0, 1.4);
    let plant = SevenDof::new(PERIOD_S);
    let [mut vector, mut scalar] = [(); 2].map(|()| block_of(&body, &State::rolling(&body, 20.0)));
    for k in 0..300 {
        let inputs = inputs(if k < 150 { 800.0 } else { -3000.0 }, 0.03, 0.0);
        plant.advance(&mut vector, &inputs, &FIRST, PERIOD_S);
        plant.advance_scalar(&mut scalar, &inputs, &FIRST, PERIOD_S);
        let (a, b) = (vector.state(0), scalar.state(0));
        let differ = (a.vx_mps - b.vx_mps).abs().max((a.vy_mps - b.vy_mps).abs());
        assert!(differ.max((a.yaw_rate_radps - b.yaw_rate_radps).abs()) < 1e-9, "{k}: {a:?} against {b:?}");
    }
    // The stiffer rear axle slips less under the same brake.
    let slip = vector.slip(0, 0.03);
    assert!(slip[1].abs() < slip[0].abs(), "{slip:?}");
}

/// Where the road rises to the left gravity pushes to the right, against y; the tyres have hardly begun to hold.
#[test]
fn law_a_banked_road_pushes_downhill() {
    let body = named("car");
    for bank_rad in [0.05, -0.05] {
        let mut block = block_of(&body, &State::rolling(&body, 15.0));
        let mut inputs = inputs(0.0, 0.0, 0.02);
        inputs.bank_rad[0] = bank_rad;
        let after = run(&SevenDof::new(PERIOD_S), &mut block, &inputs, PERIOD_S);
        near(after.vy_mps, -9.81 * bank_rad.sin() * 0.02_f64.cos() * PERIOD_S, 0.15, "sideways");
    }
}

/// A body that stands on wheels that turn takes their momentum over, however weakly they are braked.
#[test]
fn law_turning_wheels_push_a_standing_body() {
    let body = named("car");
    let state = State { wheel_speed_radps: [0.09 / body.wheel_radius_m; 4], ..State::default() };
    let mut block = block_of(&body, &state);
    let spin = |state: &State| body.wheel_inertia_kgm2 * state.wheel_speed_radps.iter().sum::<f64>();
    let momentum = |state: &State| body.mass_kg * state.vx_mps + spin(state) / body.wheel_radius_m;
    let after = run(&SevenDof::new(PERIOD_S), &mut block, &inputs(-0.1, 0.0, 0.0), PERIOD_S);
    near(momentum(&after), momentum(&state), 0.05, "momentum");
}

/// Brakes stop wheels at their instants even where the tolerance would allow another: a rough reference stops as a
/// fine one does.
#[test]
fn law_the_reference_finds_when_a_wheel_stops() {
    for (friction, brake_front_share, torque_nm) in [(1.0, 0.6, -1500.0), (0.3, 1.0, -4000.0), (0.3, 0.0, -2500.0)] {
        let body = Body { friction: [friction; 4], brake_front_share, ..named("car") };
        let ways = [1e-3, 1e-10].map(|tolerance| {
            let mut block = block_of(&body, &State::rolling(&body, 1.5));
            let way = (0..100).map(|_| {
                let state = run(&oracle::Reference::new(tolerance), &mut block, &inputs(torque_nm, 0.0, 0.0), PERIOD_S);
                let [front, _, rear, _] = state.wheel_speed_radps.map(|speed| speed * body.wheel_radius_m);
                [state.vx_mps, block.distance_m[0], front, rear]
            });
            way.collect::<Vec<_>>()
        });
        let differ = |k: usize| {
            let pairs = ways[0].iter().zip(&ways[1]);
            pairs.map(|(rough, fine)| (rough[k] - fine[k]).abs()).fold(0.0, f64::max)
        };
        let worst = [0, 1, 2, 3].map(differ).into_iter().fold(0.0, f64::max);
        assert!(worst < 1e-6, "{friction}, {brake_front_share}, {torque_nm}: {worst} m or m/s");
        assert!(ways[0][99][2..].contains(&0.0), "a wheel stops");
    }
}
