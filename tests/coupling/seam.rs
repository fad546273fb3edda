//! Clocks, counters and questions: what is asked when, and what belongs to which time.

use super::{Fake, end, ids, now, record, step, world};
use crate::fake::{Car, LIMIT_MPS, STEP_S};
use std::path::Path;
use sumo_mfc::cosim::{CosimError, Reason, Tell, World};
use sumo_mfc::run;
use sumo_mfc::scenario::{Catalog, Override, Request, Scenario};

#[test]
fn sumos_step_is_a_whole_number_of_control_periods() {
    let joined = |period_s: &str| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("sumo_nets/self_check");
        let file = |name: &str| folder.join(name).to_str().unwrap().to_owned();
        let mut request = Request::default()
            .with(Override::text("--net", "sumo.net", &file("self_check.net.xml")))
            .with(Override::texts("--routes", "sumo.routes", &[file("self_check.rou.xml")]));
        // The SUMO that is joined has a step of its own.
        let sets = [format!("sumo.step_length_s={period_s}"), format!("coupling.control_period_s={period_s}")];
        request.overrides.extend(sets.iter().map(|set| Override::set(set).unwrap()));
        let scenario = Scenario::load(&request, &Catalog::installed()).unwrap();
        now(World::over(Fake::default(), run::world(&scenario).unwrap()))
    };
    for (text, period_s) in [("0.1", 0.1), ("0.05", 0.05), ("0.02", 0.02)] {
        let world = joined(text).ok().unwrap();
        assert_eq!((world.step_s(), world.period_s(), world.time_s()), (STEP_S, period_s, 0.0));
    }
    for text in ["0.03", "0.08", "0.25", "1"] {
        let Err(error) = joined(text) else { panic!("{text} s do not fit") };
        assert!(matches!(error, CosimError::Step { step_s: STEP_S, .. }), "{error}");
    }
}

#[test]
fn time_goes_by_sumos_steps_and_records_are_taken_once() {
    let mut world = world(Fake::new([Car { arrives_at_m: 5.0, ..Car::new("a", 0, 0) }, Car::new("b", 1, 0)]), &[]);
    world.time_fleet();
    step(&mut world, 40);
    assert!((world.time_s() - 40.0 * STEP_S).abs() < 1e-12, "{}", world.time_s());
    assert_eq!(world.waited().as_millis(), 40, "a millisecond for each step, says the world in memory");
    assert!(!world.fleet().time_spent().plant.is_zero());
    assert_eq!(world.take_finished().iter().map(|row| &*row.id).collect::<Vec<_>>(), ["a"]);
    assert!(world.take_finished().is_empty());
    let records = end(world);
    assert_eq!(record(&records, "b").depart_s, 0.0, "it was there at the beginning");
}

/// SUMO goes on with the acceleration that it is told until the driver decides again: that is to be the driver's own.
#[test]
fn who_decides_less_often_than_sumo_steps_is_told_with_its_drivers_acceleration() {
    let ponderer = Car { type_id: "ponderer".to_owned(), ..Car::new("ponderer", 0, 0) };
    let sets = ["actuator.delay_s=0.3"];
    let mut world = world(Fake::new([ponderer, Car::new("car", 1, 0)]), &sets);
    let mut differ = 0;
    for _ in 0..60 {
        step(&mut world, 1);
        let all: Vec<_> = world
            .driving()
            .map(|(ego, block)| {
                let lane = ego.slot.lane();
                (ego.id().clone(), block.speed_mps(lane), block.asked_mps2(lane), block.acceleration_mps2(lane))
            })
            .collect();
        for (id, speed_mps, asked_mps2, acceleration_mps2) in all {
            let wanted_mps2 = if &*id == "ponderer" { asked_mps2 } else { acceleration_mps2 };
            let told = *world.sumo_mut().told_to(&id).last().unwrap();
            // Who stands and is to stand is told nothing.
            if told != Tell::PreviousSpeed(0.0, 0.0) {
                assert_eq!(told, Tell::PreviousSpeed(speed_mps, wanted_mps2), "{id}");
            }
            differ += u32::from((asked_mps2 - acceleration_mps2).abs() > 0.1);
        }
    }
    assert!(differ > 10, "{differ}");
}

#[test]
fn who_is_there_when_we_come_counts_from_then_on() {
    let mut fake = Fake::new([Car::new("a", 0, 0)]);
    fake.begins_s = 50.0;
    let mut world = world(fake, &[]);
    assert_eq!((world.time_s(), world.expected()), (50.0, 1));
    step(&mut world, 5);
    assert_eq!(record(&end(world), "a").depart_s, 50.0);
}

/// It was in a teleport when we came, so nobody has told of it.
#[test]
fn who_is_put_down_after_we_came_was_present_and_becomes_an_ego() {
    let carried = Car { teleport: Some((0, 20)), ..Car::new("carried", 0, 0) };
    let mut world = world(Fake::new([carried, Car::new("a", 1, 0)]), &[]);
    step(&mut world, 19);
    assert_eq!((ids(&world), world.records().counters.present), (vec!["a".to_owned()], 1));
    step(&mut world, 2);
    let counters = &world.records().counters;
    assert_eq!((counters.present, counters.departed, counters.teleports), (2, 0, 0));
    assert_eq!(ids(&world), ["a", "carried"]);
}

/// As a calibrator does it.
#[test]
fn who_is_taken_off_the_road_without_a_teleport_was_removed() {
    let car = Car { teleport: Some((50, 200)), silently: true, arrives_carried: Some(90), ..Car::new("a", 0, 0) };
    let mut world = world(Fake::new([car]), &[]);
    step(&mut world, 100);
    let records = end(world);
    assert_eq!((record(&records, "a").reason, record(&records, "a").arrival_s), (Reason::Removed, None));
}

#[test]
fn who_arrives_at_once_does_not_take_others_of_its_step_along() {
    let ghost = Car { arrives_at_m: 0.0, ..Car::new("ghost", 0, 2) };
    let mut world = world(Fake::new([Car::new("a", 1, 2), ghost, Car::new("b", 2, 2)]), &[]);
    step(&mut world, 5);
    assert_eq!(ids(&world), ["a", "b"]);
}

/// Each ego is one question in every step, and one more in every tenth.
#[test]
fn odometers_are_asked_once_a_second() {
    let mut world = world(Fake::new(["a", "b"].map(|id| Car::new(id, usize::from(id == "b"), 0))), &[]);
    step(&mut world, 5);
    let asked: Vec<usize> = (6..=30)
        .map(|_| {
            let before = world.sumo_mut().asked;
            step(&mut world, 1);
            world.sumo_mut().asked - before
        })
        .collect();
    let wanted: Vec<usize> = (6..=30).map(|step| if step % 10 == 0 { 4 } else { 2 }).collect();
    assert_eq!(asked, wanted);
}

/// What is carried is no difference of the two ways; the one that was there before stays.
#[test]
fn law_a_teleport_leaves_the_gap_of_the_odometers_as_it_was() {
    let gap_m = |steps, teleport| {
        let mut fake = Fake::new([Car { teleport, ..Car::new("a", 0, 0) }]);
        fake.euler = true;
        let mut world = world(fake, &[]);
        step(&mut world, steps);
        record(&end(world), "a").odometer_gap_m.unwrap()
    };
    // Euler's rule is half a step ahead of a car that speeds up: by V·dt/2.
    let before_m = gap_m(99, None);
    assert!((before_m - 0.5 * LIMIT_MPS * STEP_S).abs() < 0.1, "{before_m} m");
    let after_m = gap_m(121, Some((100, 120)));
    assert!((after_m - before_m).abs() < 0.2, "{before_m} m, then {after_m} m");
}

#[test]
fn law_roads_add_up_to_vehicles() {
    let mut fake =
        Fake::new((0..4).map(|i| Car { arrives_at_m: 300.0, ..Car::new(&format!("a{i}"), i, 7 * i as u64) }));
    fake.ahead = Some((100.0, 12.0));
    let mut world = world(fake, &["actuator.delay_s=0.2"]);
    step(&mut world, 260);
    let records = end(world);
    let by_road =
        |value: fn(&sumo_mfc::stats::Sums) -> f64| records.roads.iter().map(|(_, sums)| value(sums)).sum::<f64>();
    let by_car = |value: fn(&sumo_mfc::cosim::Finished) -> f64| records.finished.iter().map(value).sum::<f64>();
    let samples = by_car(|row| row.stats.samples as f64);
    assert_eq!(records.roads.iter().count(), 2);
    assert_eq!(by_road(|sums| sums.samples as f64), samples);
    for (road, car) in [
        (by_road(|s| s.error_mps), by_car(|row| row.stats.samples as f64 * row.stats.error_mean.unwrap())),
        (by_road(|s| s.error_squared), by_car(|row| row.stats.samples as f64 * row.stats.error_rms.unwrap().powi(2))),
    ] {
        assert!((road - car).abs() < 1e-9 * car.abs().max(1.0), "{road} {car}");
    }
    let (way_m, driven_m) = (0.01 * by_road(|s| s.speed_mps), by_car(|row| row.distance_m));
    assert!((way_m / driven_m - 1.0).abs() < 0.01, "{way_m} m, {driven_m} m");
}

/// The second follows the first; the third is on another lane, and takes the slot of one that has left.
#[test]
fn who_follows_an_ego_has_the_gain_of_what_it_makes_of_its_swings() {
    let first = Car { position_m: 60.0, removed: Some(400), ..Car::new("first", 0, 0) };
    let other = Car::new("other", 1, 405);
    let mut world = world(Fake::new([first, Car::new("second", 0, 0), other]), &["output.platoons=true"]);
    for k in 0..600 {
        if k % 50 == 0 && k < 400 {
            world.hand().reference("first", Some(if k % 100 == 0 { 12.0 } else { 8.0 })).unwrap_or_default();
        }
        step(&mut world, 1);
    }
    let records = end(world);
    let gain = record(&records, "second").string_gain;
    // From the first reading to the last before it left.
    assert!((gain.following_time.unwrap() - 39.0).abs() < 1.1, "{gain:?}");
    assert!(gain.string_gain_l2.unwrap() > 0.1 && gain.string_gain_linf.unwrap() > 0.1, "{gain:?}");
    assert_eq!(record(&records, "other").string_gain.following_time, None);
}
