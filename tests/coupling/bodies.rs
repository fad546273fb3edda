//! Which bodies vehicles get, what is told of odd ones, and what bodies feel of the road.

use super::{Fake, end, ids, step, world};
use crate::fake::{Car, FRICTION};
use sumo_mfc::cosim::{Counters, World};

fn counters(sets: &[&str], cars: impl IntoIterator<Item = Car>) -> Counters {
    let mut world = world(Fake::new(cars), sets);
    step(&mut world, 20);
    end(world).counters
}

#[test]
fn what_a_type_asks_for_beyond_its_body_is_told_for_accel_and_braking_alone() {
    let beyond = |sets: &[&str]| {
        let cars = [Car::new("a", 0, 0), Car::new("b", 1, 5)];
        counters(sets, cars).beyond_body.remove("car")
    };
    assert_eq!(beyond(&["vehicle.preset=car"]), None);
    for (set, [accel, brake]) in [
        ("vehicle.drive_torque_max_nm=500", [true, false]),
        ("vehicle.brake_torque_max_nm=1000", [false, true]),
        ("vehicle.torque_factor=0.1", [true, true]),
    ] {
        let [asked, given] = beyond(&["vehicle.preset=car", "vehicle.friction=1.2", set]).unwrap();
        assert_eq!(asked, [2.6, 9.0], "{set}");
        assert_eq!([asked[0] > given[0], asked[1] > given[1]], [accel, brake], "{set}: {given:?}");
    }
    assert_eq!(beyond(&["controller.name=ideal", "vehicle.torque_factor=0.1"]), None, "nothing limits it");
}

#[test]
fn a_mass_that_no_such_vehicle_has_is_told() {
    let odd = |factor: &str| counters(&[factor], [Car::new("a", 0, 0), Car::new("b", 1, 0)]).odd_masses;
    for usual in ["vehicle.mass_factor=1", "vehicle.mass_factor=0.6", "vehicle.mass_factor=1.9"] {
        assert_eq!((odd(usual).count, odd(usual).first), (0, None), "{usual}");
    }
    for (unusual, share) in [("vehicle.mass_factor=0.4", 0.4), ("vehicle.mass_factor=2.5", 2.5)] {
        let told = odd(unusual);
        let words = told.first.unwrap();
        let kg: Vec<f64> = words.split(' ').filter_map(|word| word.parse().ok()).collect();
        assert!(told.count == 2 && words.starts_with("\"a\": "), "{words}");
        assert!((kg[0] / kg[1] - share).abs() < 1e-3, "{words}");
    }
}

#[test]
fn an_ordinary_drive_has_nothing_to_be_told() {
    let counters = counters(&[], [Car::new("a", 0, 0), Car { arrives_at_m: 3.0, ..Car::new("b", 1, 0) }]);
    assert_eq!(counters.implausible.notes().collect::<Vec<_>>(), [""; 0]);
}

#[test]
fn a_speed_that_no_vehicle_reaches_and_brakes_that_do_nothing_are_told() {
    let shape = ["target.shape=step", "target.step_at=0, 300", "target.step_speeds_mps=130, 130"];
    let fast = counters(&[&["target.name=profile"][..], &shape].concat(), [Car::new("a", 0, 0)]);
    let notes: Vec<_> = fast.implausible.notes().collect();
    let said = "implausible: 1 egos had a speed error of more than 100 m/s; the worst, \"a\" at 0.1 s: -129.";
    assert!(notes.len() == 1 && notes[0].starts_with(said), "{notes:?}");

    let mut world = world(Fake::new([Car::new("a", 0, 0)]), &["vehicle.brake_torque_max_nm=1"]);
    step(&mut world, 150);
    world.hand().reference("a", Some(6.0)).unwrap();
    step(&mut world, 60);
    let notes: Vec<_> = end(world).counters.implausible.notes().collect();
    let said = "implausible: 1 egos hardly braked; the worst, \"a\" up to 21 s: asked to brake for 6.0 s";
    assert!(notes.len() == 1 && notes[0].starts_with(said), "{notes:?}");
}

/// `device.mfc.probability` of a vType, drawn for each vehicle from the seed.
#[test]
fn the_probability_of_a_type_is_the_share_that_becomes_egos() {
    let sampled = |id: &str, lane| Car { type_id: "sampled".to_owned(), ..Car::new(id, lane, 1) };
    let of_seed = |seed: &str| {
        let cars = (0..400).map(|i| sampled(&format!("v{i}"), i)).chain([Car::new("plain", 900, 1)]);
        let mut world = world(Fake::new(cars), &["egos.select=param", seed]);
        step(&mut world, 3);
        ids(&world)
    };
    let (first, again, other) = (of_seed("sumo.seed=1"), of_seed("sumo.seed=1"), of_seed("sumo.seed=2"));
    assert!((90..150).contains(&first.len()) && (90..150).contains(&other.len()), "{} {}", first.len(), other.len());
    assert!(first == again && first != other && !first.contains(&"plain".to_owned()));
}

#[test]
fn the_parameters_of_the_demand_reach_the_body() {
    let heavy =
        Car { parameters: vec![("mfc.mass_factor", "1.5"), ("mfc.friction", "0.7")], ..Car::new("heavy", 0, 0) };
    let mut world = world(Fake::new([heavy, Car::new("plain", 1, 0)]), &["vehicle.preset=car"]);
    step(&mut world, 1);
    let [heavy, plain] = ["heavy", "plain"].map(|id| {
        let (ego, block) = world.driving().find(|(ego, _)| **ego.id() == *id).unwrap();
        block.plant().body(ego.slot.lane()).clone()
    });
    assert!((heavy.mass_kg / plain.mass_kg - 1.5).abs() < 1e-12 && heavy.friction == [0.7; 4], "{heavy:?}");
}

/// Also where its group has left it no drive and no brakes.
#[test]
fn regress_a_vehicles_own_torque_factor_takes_the_place_of_its_groups() {
    let strong = |group: &str| {
        let own = Car { parameters: vec![("mfc.torque_factor", "1.5")], ..Car::new("own", 0, 0) };
        let mut world = world(Fake::new([own, Car::new("plain", 1, 0)]), &["vehicle.preset=car", group]);
        step(&mut world, 1);
        ["own", "plain"].map(|id| {
            let (ego, block) = world.driving().find(|(ego, _)| **ego.id() == *id).unwrap();
            let body = block.plant().body(ego.slot.lane());
            [body.drive_torque_max_nm, body.brake_torque_max_nm]
        })
    };
    let [own, half] = strong("vehicle.torque_factor=0.5");
    assert_eq!(strong("vehicle.torque_factor=0"), [own, [0.0; 2]]);
    assert!(own.iter().zip(half).all(|(own, half)| (own / half - 3.0).abs() < 1e-12), "{own:?} {half:?}");
}

fn friction(world: &World<Fake>) -> f64 {
    let (ego, block) = world.driving().next().unwrap();
    block.plant().body(ego.slot.lane()).friction[0]
}

/// The ice begins at 50 m.
#[test]
fn the_friction_changes_where_the_lane_changes() {
    let mut fake = Fake::new([Car { speed_mps: 10.0, ..Car::new("a", 0, 0) }]);
    fake.ahead = Some((50.0, 20.0));
    let mut world = world(fake, &["coupling.friction=true", "vehicle.preset=car", "vehicle.friction=1"]);
    step(&mut world, 30);
    assert_eq!(friction(&world), FRICTION);
    step(&mut world, 60);
    assert_eq!(friction(&world), 2.0 * FRICTION);
}

/// A lane is asked about once, however many come to it; and not at all where nothing depends on it.
#[test]
fn lanes_are_asked_about_once_and_only_where_bodies_need_them() {
    let lanes_asked = |sets: &[&str]| {
        let mut fake = Fake::new((0..5).map(|i| Car { speed_mps: 10.0, ..Car::new(&format!("a{i}"), i, 0) }));
        fake.ahead = Some((20.0, 15.0));
        let mut world = world(fake, sets);
        step(&mut world, 50);
        world.sumo_mut().lanes_asked
    };
    assert_eq!(
        ["target.name=limit", "coupling.friction=true", "target.name=traffic"].map(|set| lanes_asked(&[set])),
        [2, 2, 0]
    );
}

/// It keeps what it has felt last, and nobody asks about a lane without a name.
#[test]
fn who_is_on_no_lane_feels_the_last_one() {
    let mut fake = Fake::new([Car { speed_mps: 10.0, ..Car::new("a", 0, 0) }]);
    (fake.ahead, fake.nowhere) = (Some((20.0, 20.0)), Some((40.0, 60.0)));
    let mut world = world(fake, &["coupling.friction=true", "vehicle.preset=car", "vehicle.friction=1"]);
    step(&mut world, 80);
    assert_eq!((friction(&world), world.sumo_mut().lanes_asked), (2.0 * FRICTION, 2));
}

#[test]
fn a_bend_to_the_left_is_driven_to_the_left() {
    let car = |bend_deg_per_m| Car { speed_mps: 10.0, bend_deg_per_m, ..Car::new("a", 0, 0) };
    for (bend_deg_per_m, sign) in [(0.5, 1.0), (-0.5, -1.0)] {
        let mut world = world(Fake::new([car(bend_deg_per_m)]), &["plant.name=seven_dof"]);
        step(&mut world, 50);
        let (ego, block) = world.driving().next().unwrap();
        let state = block.plant().state(ego.slot.lane());
        let wanted_radps = bend_deg_per_m.to_radians() * state.vx_mps;
        assert!(
            state.yaw_rate_radps * sign > 0.0 && (state.yaw_rate_radps / wanted_radps - 1.0).abs() < 0.1,
            "{state:?}"
        );
    }
}
