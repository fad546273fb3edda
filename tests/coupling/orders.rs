//! What a caller orders for single vehicles between the steps.

use super::{Fake, end, now, speed_mps, step, world};
use crate::fake::{Car, LIMIT_MPS};
use sumo_mfc::cosim::{OrderError, Tell, World};

fn reference(world: &mut World<Fake>, id: &str, speed_mps: Option<f64>) {
    world.hand().reference(id, speed_mps).unwrap();
}

fn parameter(world: &mut World<Fake>, name: &str, text: Option<&str>) -> Result<(), OrderError> {
    world.hand().parameter("a", name, text)
}

#[test]
fn sumo_drives_at_an_ordered_speed_until_it_is_released() {
    let mut world = world(Fake::new(["a", "b"].map(|id| Car::new(id, usize::from(id == "b"), 0))), &[]);
    step(&mut world, 200);
    reference(&mut world, "a", Some(8.0));
    step(&mut world, 200);
    assert!((speed_mps(&world, "a") - 8.0).abs() < 0.05, "{}", speed_mps(&world, "a"));
    assert!((speed_mps(&world, "b") - LIMIT_MPS).abs() < 0.05, "{}", speed_mps(&world, "b"));
    reference(&mut world, "a", None);
    step(&mut world, 200);
    assert!((speed_mps(&world, "a") - LIMIT_MPS).abs() < 0.05, "{}", speed_mps(&world, "a"));
    reference(&mut world, "b", Some(12.0));
    step(&mut world, 5);
    let notes = world.orders().notes();
    assert_eq!(notes, ["references of 2 vehicles were set by the caller between steps (\"a\", for one)"]);
    now(world.hand_back()).unwrap();
    assert_eq!(world.sumo_mut().told_to("b").last(), Some(&Tell::ReleaseSpeed));
    assert!(!matches!(world.sumo_mut().told_to("a").last(), Some(Tell::ReleaseSpeed)), "it has been given back before");
}

/// Where the body leads, the speed is the reference at once, whatever the limit or the profile; but never against SUMO.
#[test]
fn a_leading_body_has_the_ordered_speed_as_its_reference() {
    let profile = ["target.name=profile", "target.shape=step", "target.step_at=0, 300", "target.step_speeds_mps=9, 9"];
    for sets in [&["target.name=limit"][..], &profile] {
        let slow =
            Car { position_m: 1500.0, speed_max_mps: 3.0, type_id: "bicycle".to_owned(), ..Car::new("slow", 0, 0) };
        let mut world = world(Fake::new([Car::new("a", 0, 0), slow]), sets);
        step(&mut world, 150);
        reference(&mut world, "a", Some(14.0));
        step(&mut world, 1);
        let (ego, block) = world.driving().next().unwrap();
        assert_eq!(block.reference_mps(ego.slot.lane()), 14.0, "{sets:?}");
        step(&mut world, 200);
        assert!((speed_mps(&world, "a") - 14.0).abs() < 0.05, "{sets:?}: {}", speed_mps(&world, "a"));
        reference(&mut world, "a", None);
        step(&mut world, 300);
        let own_mps = if sets.len() > 1 { 9.0 } else { LIMIT_MPS };
        assert!((speed_mps(&world, "a") - own_mps).abs() < 0.1, "{sets:?}: {}", speed_mps(&world, "a"));
        reference(&mut world, "a", Some(14.0));
        step(&mut world, 1500);
        assert!(speed_mps(&world, "a") < 4.0, "behind the slow car: {sets:?}: {}", speed_mps(&world, "a"));
    }
}

/// The torque acts on the wheels, not on the law: it shows in the error, and in what the law answers.
#[test]
fn a_disturbance_shows_in_the_error_until_it_ends() {
    let cars = || Fake::new(["a", "b"].map(|id| Car::new(id, usize::from(id == "b"), 0)));
    let mut disturbed = world(cars(), &["controller.name=pid"]);
    let mut calm = world(cars(), &["controller.name=pid"]);
    let error_mps = |world: &World<Fake>, id: &str| {
        let (ego, block) = world.driving().find(|(ego, _)| **ego.id() == *id).unwrap();
        let lane = ego.slot.lane();
        (block.speed_mps(lane) - block.reference_mps(lane), block.torque_nm(lane))
    };
    for world in [&mut disturbed, &mut calm] {
        step(world, 200);
    }
    disturbed.hand().disturbance("a", -1500.0).unwrap();
    let mut largest_mps: f64 = 0.0;
    for _ in 0..100 {
        for world in [&mut disturbed, &mut calm] {
            step(world, 1);
        }
        largest_mps = largest_mps.min(error_mps(&disturbed, "a").0);
        assert_eq!(error_mps(&disturbed, "b"), error_mps(&calm, "b"), "beside it nothing is different");
    }
    assert!(largest_mps < -0.1, "{largest_mps} m/s");
    let (_, answer_nm) = error_mps(&disturbed, "a");
    assert!((answer_nm - 1500.0).abs() < 50.0, "the law answers with {answer_nm} N·m");
    disturbed.hand().disturbance("a", 0.0).unwrap();
    step(&mut disturbed, 100);
    let (error, torque_nm) = error_mps(&disturbed, "a");
    assert!(error.abs() < 0.05 && torque_nm.abs() < 50.0, "{error} m/s, {torque_nm} N·m");
    assert_eq!(
        disturbed.orders().notes(),
        ["torque disturbances of 1 vehicle were set by the caller between steps (\"a\")"]
    );
}

/// Whatever is ordered on the way, the body is the one that the demand would have given it.
#[test]
fn law_an_ordered_parameter_makes_the_body_of_the_demand() {
    let sets = ["vehicle.preset=car", "vehicle.mass_factor=1.2"];
    let mut world = world(Fake::new([Car::new("a", 0, 0)]), &sets);
    let body = |world: &World<Fake>| {
        let (ego, block) = world.driving().next().unwrap();
        (block.plant().body(ego.slot.lane()).clone(), block.plant().state(ego.slot.lane()))
    };
    step(&mut world, 100);
    let (before, moves) = body(&world);
    parameter(&mut world, "mfc.mass_factor", Some("1.8")).unwrap();
    parameter(&mut world, "mfc.friction", Some("0.6")).unwrap();
    let (heavy, still) = body(&world);
    assert!((heavy.mass_kg / before.mass_kg - 1.5).abs() < 1e-12, "{} {}", before.mass_kg, heavy.mass_kg);
    assert_eq!((heavy.friction, still), ([0.6; 4], moves), "it goes on as it moves");
    parameter(&mut world, "mfc.mass", Some("900")).unwrap();
    parameter(&mut world, "mfc.mass_factor", None).unwrap();
    assert_eq!(body(&world).0.mass_kg, 900.0);
    parameter(&mut world, "mfc.mass_kg", None).unwrap();
    parameter(&mut world, "mfc.friction", None).unwrap();
    assert_eq!(body(&world).0, before);
    step(&mut world, 50);
}

/// A dead time that nobody has asked for before is one from the next step on.
#[test]
fn actuators_change_on_the_way() {
    let mut world = world(Fake::new([Car::new("a", 0, 0)]), &["controller.name=pid", "vehicle.preset=car"]);
    let torque_nm = |world: &World<Fake>| {
        let (ego, block) = world.driving().next().unwrap();
        block.torque_nm(ego.slot.lane())
    };
    step(&mut world, 200);
    parameter(&mut world, "mfc.delay_s", Some("0.5")).unwrap();
    reference(&mut world, "a", Some(5.0));
    let torques_nm: Vec<f64> = (0..8)
        .map(|_| {
            step(&mut world, 1);
            torque_nm(&world)
        })
        .collect();
    assert!(torques_nm[..5].iter().all(|t| t.abs() < 20.0) && torques_nm[6] < -1000.0, "{torques_nm:?}");
    parameter(&mut world, "mfc.drive_torque_max_nm", Some("0")).unwrap();
    reference(&mut world, "a", Some(19.9));
    let before_mps = speed_mps(&world, "a");
    step(&mut world, 200);
    let after_mps = speed_mps(&world, "a");
    assert!(before_mps < 19.0 && after_mps < before_mps, "it has no drive any more: {before_mps}, {after_mps}");
}

#[test]
fn what_cannot_be_ordered_is_refused_and_changes_nothing() {
    let mut world = world(Fake::new([Car::new("car12", 0, 0), Car::new("a", 1, 0)]), &[]);
    let unknown = world.hand().reference("a", Some(3.0)).unwrap_err().to_string();
    assert!(unknown.contains("found no ego of this id"), "nobody is an ego before the first step: {unknown}");
    step(&mut world, 20);
    let refused = |done: Result<(), OrderError>, said: &[&str]| {
        let error = done.unwrap_err().to_string();
        assert!(said.iter().all(|said| error.contains(said)), "{error}");
    };
    refused(world.hand().reference("car13", None), &["\"car13\"", "did you mean \"car12\"?"]);
    refused(world.hand().disturbance("nobody", 1.0), &["\"nobody\"", "on the road at the end of the last step"]);
    for speed_mps in [f64::NAN, -1.0, f64::INFINITY] {
        refused(world.hand().reference("a", Some(speed_mps)), &["\"a\", reference", "from 0 to 100 m/s"]);
        refused(world.hand().disturbance("a", speed_mps * 1e7), &["\"a\", torque disturbance", "N·m"]);
    }
    refused(parameter(&mut world, "mfc.mas", Some("1000")), &["found the parameter mfc.mas", "did you mean mfc.mass?"]);
    refused(parameter(&mut world, "mfc.k_p", Some("1")), &["mfc.k_p", "a mfc.* parameter of a body or its actuators"]);
    refused(parameter(&mut world, "mfc.mass", Some("heavy")), &["mfc.mass_kg", "\"heavy\"", "50 to 100000 kg"]);
    refused(parameter(&mut world, "mfc.mass", Some("nan")), &["\"nan\"", "50 to 100000 kg"]);
    refused(parameter(&mut world, "mfc.wheel_radius", Some("0.5")), &["mfc.wheel_radius_m cannot change while"]);
    assert_eq!((world.orders().notes(), world.sumo_mut().told_to("a").len()), (Vec::<String>::new(), 21));
    let mut bodiless = self::world(Fake::new([Car::new("a", 0, 0)]), &["controller.name=ideal"]);
    step(&mut bodiless, 20);
    refused(bodiless.hand().disturbance("a", 1.0), &["\"a\"", "no body (its controller is ideal)"]);
    refused(parameter(&mut bodiless, "mfc.mass", Some("1000")), &["no body"]);
    bodiless.hand().reference("a", Some(2.0)).unwrap();
    step(&mut bodiless, 100);
    assert_eq!(speed_mps(&bodiless, "a"), 2.0);
}

/// The slot of a vehicle that was disturbed is another one's later.
#[test]
fn orders_end_with_their_vehicle() {
    let twice = [5, 300].map(|departs| Car { arrives_at_m: 150.0, ..Car::new("a", 0, departs) });
    let run = |torque_nm: f64| {
        let mut world = world(Fake::new(twice.clone()), &[]);
        step(&mut world, 50);
        world.hand().disturbance("a", torque_nm).unwrap();
        world.hand().parameter("a", "mfc.mass_factor", Some("1.3")).unwrap();
        step(&mut world, 450);
        let mut stats: Vec<_> = end(world).finished.iter().map(|record| record.stats).collect();
        (stats.remove(0), stats.remove(0))
    };
    let ((first, second), (other, same)) = (run(-2000.0), run(0.0));
    assert!(first != other, "{first:?}");
    assert_eq!(second, same);
    assert!(second != other, "the one with the parameter is another one than the one without");
}
