//! The coupling against a small traffic world in memory: comings and goings, body-leads mode, hand-back. What SUMO itself
//! does is tested in `tests/live`.

mod bodies;
mod fake;
mod leads;
mod orders;
mod seam;

use std::{collections::BTreeMap, path::Path};

use fake::{Car, Fake, LIMIT_MPS, STEP_S, YELLOW};
use sumo_mfc::cosim::{Finished, Place, Presence, Reason, Records, Tell, World};
use sumo_mfc::run;
use sumo_mfc::scenario::{Catalog, Override, Request, Scenario};
use sumo_mfc::traci::Color;

/// A world over a traffic world in memory, with these settings of the scenario.
fn world(fake: Fake, sets: &[&str]) -> World<Fake> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("sumo_nets/self_check");
    let file = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let mut request = Request::default()
        .with(Override::text("--net", "sumo.net", &file("self_check.net.xml")))
        .with(Override::texts("--routes", "sumo.routes", &[file("self_check.rou.xml")]));
    request.overrides.extend(sets.iter().map(|set| Override::set(set).unwrap()));
    let scenario = Scenario::load(&request, &Catalog::installed()).unwrap();
    now(World::over(fake, run::world(&scenario).unwrap())).unwrap()
}

/// Nothing of the traffic world in memory waits.
fn now<T>(future: impl Future<Output = T>) -> T {
    tokio::runtime::Builder::new_current_thread().build().unwrap().block_on(future)
}

fn step(world: &mut World<Fake>, count: u32) {
    for _ in 0..count {
        now(world.step()).unwrap();
    }
}

/// Hands the vehicles back and leaves.
fn end(mut world: World<Fake>) -> Records {
    now(world.hand_back()).unwrap();
    let (records, left) = now(world.close());
    left.unwrap();
    records
}

fn record<'a>(records: &'a Records, id: &str) -> &'a Finished {
    records.finished.iter().find(|record| *record.id == *id).unwrap_or_else(|| panic!("no record of {id}"))
}

fn ids(world: &World<Fake>) -> Vec<String> {
    world.egos().iter().map(|ego| ego.id().to_string()).collect()
}

fn speed_mps(world: &World<Fake>, id: &str) -> f64 {
    let (ego, block) = world.driving().find(|(ego, _)| **ego.id() == *id).unwrap();
    block.speed_mps(ego.slot.lane())
}

#[test]
fn an_ego_is_driven_from_the_step_after_its_departure_to_its_arrival() {
    let mut world = world(Fake::new([Car { arrives_at_m: 200.0, ..Car::new("a", 0, 3) }]), &[]);
    step(&mut world, 3);
    assert_eq!((world.egos().len(), world.records().counters.departed), (0, 1), "reported, but it has not moved");
    step(&mut world, 1);
    assert_eq!(world.take_admitted().iter().map(|id| &**id).collect::<Vec<_>>(), ["a"]);
    assert!((speed_mps(&world, "a") - 0.26).abs() < 0.1, "{}", speed_mps(&world, "a"));
    step(&mut world, 300);
    assert_eq!(world.egos().len(), 0);
    let records = end(world);
    let row = record(&records, "a");
    assert_eq!(row.reason, Reason::Arrived);
    // Inserted after the cars had moved in the step from 0.2 s, as in tripinfo.
    assert!((row.depart_s - 0.2).abs() < 1e-12, "{}", row.depart_s);
    // 200 m from rest with 2.6 m/s² to 20 m/s: 7.7 s + 6.2 s.
    assert!((row.arrival_s.unwrap() - 14.2).abs() < 0.3, "{:?}", row.arrival_s);
    assert!((row.distance_m - 200.0).abs() < 2.5, "{}", row.distance_m);
    assert!(row.odometer_gap_m.unwrap().abs() < 0.1, "{:?}", row.odometer_gap_m);
    assert!(row.stats.error_max_abs.unwrap() < 0.3 && row.stats.share_traffic == Some(1.0), "{:?}", row.stats);
    assert_eq!(records.counters.arrived, 1);
    assert_eq!(records.roads.iter().map(|(road, _)| road).collect::<Vec<_>>(), ["road"]);
}

/// SUMO is told the speed of the body in every step, and neither speed is told where both stand.
#[test]
fn sumo_is_told_what_the_body_drives() {
    let stop = Car { position_m: 150.0, speed_max_mps: 0.0, type_id: "bicycle".to_owned(), ..Car::new("stop", 0, 0) };
    let mut world = world(Fake::new([Car::new("a", 0, 0), stop]), &[]);
    for _ in 0..100 {
        step(&mut world, 1);
        let speed_mps = speed_mps(&world, "a");
        let told = world.sumo_mut().told_to("a");
        assert!(matches!(told.last(), Some(Tell::PreviousSpeed(v, _)) if *v == speed_mps), "{speed_mps} {told:?}");
    }
    step(&mut world, 300);
    assert_eq!(speed_mps(&world, "a"), 0.0, "behind the obstacle");
    let told = world.sumo_mut().told.len();
    step(&mut world, 50);
    assert_eq!(world.sumo_mut().told.len(), told);
    assert_eq!(world.records().counters.others["bicycle"], 1);
}

#[test]
fn who_arrives_in_the_step_of_its_departure_has_no_record() {
    let mut world = world(Fake::new([Car { arrives_at_m: 0.0, ..Car::new("a", 0, 2) }]), &[]);
    step(&mut world, 10);
    assert_eq!(world.sumo_mut().asked, 0, "nobody asks about it");
    let records = end(world);
    assert!(records.finished.is_empty());
    assert_eq!((records.counters.departed, records.counters.arrived), (1, 1));
}

#[test]
fn a_teleport_is_no_error_and_no_way() {
    let mut world = world(Fake::new([Car { teleport: Some((100, 120)), ..Car::new("a", 0, 0) }]), &[]);
    step(&mut world, 99);
    let before_mps = speed_mps(&world, "a");
    assert!(before_mps > 19.0);
    step(&mut world, 1);
    let told = world.sumo_mut().told.len();
    for _ in 0..19 {
        assert_eq!(world.egos().iter().next().unwrap().presence, Presence::Teleporting);
        assert_eq!(world.driving().count(), 0);
        step(&mut world, 1);
    }
    assert_eq!(world.sumo_mut().told.len(), told, "a vehicle that is carried has no speed");
    step(&mut world, 1);
    // It rolls where SUMO put it down, with SUMO's speed of 3 m/s.
    assert!((speed_mps(&world, "a") - 3.0).abs() < 0.3, "{}", speed_mps(&world, "a"));
    step(&mut world, 50);
    let records = end(world);
    let row = record(&records, "a");
    assert_eq!((row.reason, records.counters.teleports), (Reason::Running, 1));
    assert!(row.stats.error_max_abs.unwrap() < 0.3, "{:?}", row.stats);
    assert_eq!(row.stats.samples, 10 * (171 - 20 - 1), "nothing is counted while it is carried");
}

/// Carried and put down within one step.
#[test]
fn a_teleport_of_one_step_starts_the_body_afresh() {
    let mut world = world(Fake::new([Car { teleport: Some((100, 100)), ..Car::new("a", 0, 0) }]), &[]);
    step(&mut world, 100);
    assert!((speed_mps(&world, "a") - 3.0).abs() < 0.3, "{}", speed_mps(&world, "a"));
    let records = end(world);
    assert!(record(&records, "a").stats.error_max_abs.unwrap() < 0.3);
}

#[test]
fn who_arrives_while_it_is_carried_was_teleported_out() {
    let car = Car { teleport: Some((50, 200)), arrives_carried: Some(90), ..Car::new("a", 0, 0) };
    let mut world = world(Fake::new([car]), &[]);
    step(&mut world, 100);
    let records = end(world);
    let row = record(&records, "a");
    assert_eq!(row.reason, Reason::TeleportedOut);
    assert!((row.arrival_s.unwrap() - 90.0 * STEP_S).abs() < 1e-9, "{:?}", row.arrival_s);
}

#[test]
fn who_vanishes_without_a_word_was_removed() {
    for shared in [false, true] {
        let mut fake = Fake::new([Car { removed: Some(60), ..Car::new("a", 0, 0) }, Car::new("b", 1, 0)]);
        fake.shared = shared;
        let mut world = world(fake, &[]);
        step(&mut world, 60);
        assert_eq!(ids(&world), ["b"]);
        let records = end(world);
        assert_eq!(record(&records, "a").reason, Reason::Removed);
        assert_eq!(record(&records, "a").arrival_s, None);
        assert_eq!(record(&records, "b").reason, Reason::Running);
    }
}

#[test]
fn a_pair_that_collides_counts_once_also_where_it_leaves_in_that_step() {
    let leaves = Car { removed: Some(30), ..Car::new("leaves", 0, 0) };
    let mut fake = Fake::new([leaves, Car::new("stays", 1, 0), Car::new("apart", 2, 0)]);
    for step in 29..40 {
        fake.collisions.insert(step, vec![["stays", "leaves"], ["leaves", "stays"]]);
    }
    fake.collisions.insert(45, vec![["stays", "stranger"]]);
    let mut world = world(fake, &[]);
    step(&mut world, 50);
    let records = end(world);
    let collisions = ["leaves", "stays", "apart"].map(|id| record(&records, id).collisions);
    assert_eq!((collisions, records.counters.collision_pairs), ([1, 2, 0], 2));
}

#[test]
fn a_leading_body_drives_the_limit_and_is_clamped_behind_a_slow_car() {
    let slow = Car { position_m: 150.0, speed_max_mps: 5.0, type_id: "bicycle".to_owned(), ..Car::new("slow", 0, 0) };
    let mut world = world(Fake::new([Car::new("a", 0, 0), slow]), &["target.name=limit"]);
    step(&mut world, 30);
    let rising_mps = speed_mps(&world, "a");
    assert!(rising_mps > 5.5 && rising_mps < LIMIT_MPS, "{rising_mps}");
    step(&mut world, 330);
    assert!((speed_mps(&world, "a") - 5.0).abs() < 0.5, "{}", speed_mps(&world, "a"));
    let stats = record(&end(world), "a").stats;
    let (limit, clamp) = (stats.share_limit.unwrap(), stats.share_clamp.unwrap());
    assert!(limit > 0.05 && clamp > 0.5 && (limit + clamp - 1.0).abs() < 1e-12, "{stats:?}");
    assert!(stats.clamped_steps > 100, "{stats:?}");
}

/// A car that SUMO holds at 0 asks with a small speed whether it may go.
#[test]
fn a_leading_body_that_is_held_asks_whether_it_may_go() {
    let stop = Car { position_m: 8.0, speed_max_mps: 0.0, type_id: "bicycle".to_owned(), ..Car::new("stop", 0, 0) };
    let mut world = world(Fake::new([Car::new("a", 0, 0), stop]), &["target.name=limit"]);
    step(&mut world, 300);
    assert_eq!(world.sumo_mut().told_to("a").last(), Some(&Tell::Speed(0.1)));
}

#[test]
fn a_profile_is_driven_above_the_limit_without_clamps() {
    let sets = ["target.name=profile", "target.shape=step", "target.step_at=0, 300", "target.step_speeds_mps=25, 25"];
    let mut world = world(Fake::new([Car::new("a", 0, 0)]), &sets);
    step(&mut world, 300);
    assert!((speed_mps(&world, "a") - 25.0).abs() < 0.5, "{}", speed_mps(&world, "a"));
    let stats = record(&end(world), "a").stats;
    assert_eq!((stats.share_profile, stats.clamped_steps), (Some(1.0), 0));
}

#[test]
fn hand_back_restores_what_was_changed() {
    let sets = ["target.name=limit", "traffic.sigma=0"];
    let mut world = world(Fake::new([Car::new("a", 0, 0)]), &sets);
    step(&mut world, 50);
    let taken = world.sumo_mut().told_to("a");
    assert_eq!(taken[0], Tell::Imperfection(0.0));
    assert!(matches!(taken[1], Tell::Accel(a) if a >= 2.6) && matches!(taken[2], Tell::Decel(b) if b >= 4.5));
    // Accel and decel before the factor, which they would undo.
    assert_eq!(taken[3..5], [Tell::SpeedFactor(100.0), Tell::SpeedMode(27)]);
    assert_eq!(world.sumo_mut().watched.len(), 1);
    now(world.hand_back()).unwrap();
    let told = world.sumo_mut().told_to("a");
    let restored = [
        Tell::Imperfection(0.5),
        Tell::SpeedMode(31),
        Tell::Accel(2.6),
        Tell::Decel(4.5),
        Tell::SpeedFactor(1.0),
        Tell::ReleaseSpeed,
    ];
    assert_eq!(told[told.len() - restored.len()..], restored);
    assert!(world.sumo_mut().watched.is_empty());
    assert_eq!(record(&end(world), "a").reason, Reason::Running);
}

#[test]
fn who_creeps_is_counted_on_its_way_and_at_the_end() {
    let slow = |id, lane| Car { speed_max_mps: 0.5, ..Car::new(id, lane, 0) };
    let arrives = Car { arrives_at_m: 35.0, ..slow("arrives", 0) };
    let mut world = world(Fake::new([arrives, slow("stays", 1), Car::new("brisk", 2, 0)]), &[]);
    step(&mut world, 590);
    assert_eq!((world.egos().len(), world.records().counters.crept), (3, 0), "not yet");
    step(&mut world, 150);
    assert_eq!((world.egos().len(), world.records().counters.crept), (2, 1), "one has arrived");
    assert_eq!(end(world).counters.crept, 2);
}

#[test]
fn the_driver_allows_for_the_actuation_until_hand_back() {
    let of_car = |sets: &[&str]| {
        let sets = [&["actuator.delay_s=0.25", "actuator.lag_s=0.125"][..], sets].concat();
        let mut world = world(Fake::new([Car::new("a", 0, 0)]), &sets);
        step(&mut world, 50);
        now(world.hand_back()).unwrap();
        let told = world.sumo_mut().told_to("a").into_iter();
        told.filter(|what| matches!(what, Tell::Headway(_))).collect::<Vec<_>>()
    };
    assert_eq!(
        of_car(&["traffic.headway_margin_s=auto", "controller.k_p=2"]),
        [Tell::Headway(1.875), Tell::Headway(1.0)]
    );
    assert_eq!(of_car(&["traffic.headway_margin_s=0.5"]), [Tell::Headway(1.5), Tell::Headway(1.0)]);
    assert_eq!(of_car(&["traffic.headway_margin_s=0.5", "controller.name=ideal"]), [], "no body, no margin");
    assert_eq!(of_car(&[]), []);
}

#[test]
fn an_id_that_is_used_again_has_two_records() {
    let twice = [5, 200].map(|departs| Car { arrives_at_m: 100.0, ..Car::new("a", 0, departs) });
    let mut world = world(Fake::new(twice), &[]);
    step(&mut world, 400);
    let records = end(world);
    let [first, second] = &records.finished[..] else { panic!("{} records", records.finished.len()) };
    assert_eq!((&*first.id, &*second.id), ("a", "a"));
    // The slot that is taken again remembers nothing.
    assert_eq!(first.stats, second.stats);
    assert!((second.depart_s - first.depart_s - 195.0 * STEP_S).abs() < 1e-9);
}

#[test]
fn a_vehicle_that_cannot_be_an_ego_is_told_with_the_reason() {
    let long = "x".repeat(200);
    let mut world = world(Fake::new([Car::new(&long, 0, 1), Car::new("a", 1, 1)]), &[]);
    step(&mut world, 5);
    assert_eq!(ids(&world), ["a"]);
    let refused = &world.records().counters.refused;
    let first = refused.first.as_deref().unwrap();
    assert_eq!(refused.count, 1);
    assert!(first.starts_with(&format!("\"{long}\": ")) && first.contains("200 bytes"), "{first}");
}

#[test]
fn selectors_leave_vehicles_to_sumo() {
    let mut world = world(Fake::new(["a", "b", "c"].map(|id| Car::new(id, 0, 1))), &["egos.select=id:[ac]"]);
    step(&mut world, 3);
    assert_eq!(ids(&world), ["a", "c"]);
    assert_eq!(world.records().counters.unequipped, 1);
}

/// What was computed until then is there, and nothing of the step that was lost.
#[test]
fn a_connection_that_is_lost_within_a_step_leaves_incomplete_records() {
    let mut fake = Fake::new([Car::new("a", 0, 0), Car { arrives_at_m: 100.0, ..Car::new("b", 1, 0) }]);
    fake.lost_in = Some(121);
    let mut world = world(fake, &[]);
    step(&mut world, 120);
    let distance_m = 20.0 * 12.0 - 20.0 * 20.0 / 2.6 / 2.0;
    let lost = now(world.step()).unwrap_err();
    assert!(lost.to_string().contains("SUMO ended the connection"), "{lost}");
    world.end_all(Reason::Incomplete);
    let records = world.records();
    let reasons = ["a", "b"].map(|id| record(records, id).reason);
    assert_eq!(reasons, [Reason::Incomplete, Reason::Arrived]);
    let row = record(records, "a");
    assert_eq!((row.stats.samples, row.arrival_s), (120 * 10, None));
    assert!((row.distance_m - distance_m).abs() < 2.0, "{} {distance_m}", row.distance_m);
}

/// Egos stay in the order of their admission, also where more depart than are asked about at once, and where others leave.
#[test]
fn egos_stay_in_the_order_of_their_admission() {
    let name = |i: usize| format!("car{:03}", (i * 37) % 200);
    let crowd = (0..200).map(|i| Car { removed: (i % 3 == 0).then_some(20), ..Car::new(&name(i), i, 2) });
    let present = [Car::new("z", 900, 0), Car::new("y", 901, 0)];
    let late = (0..40).map(|i| Car::new(&format!("late{i}"), 1000 + i, 25));
    let mut world = world(Fake::new(present.into_iter().chain(crowd).chain(late)), &[]);
    step(&mut world, 30);
    let crowd = (0..200).filter(|i| i % 3 != 0).map(name);
    let expected: Vec<String> =
        ["z", "y"].map(str::to_owned).into_iter().chain(crowd).chain((0..40).map(|i| format!("late{i}"))).collect();
    assert_eq!(ids(&world), expected);
    for id in &expected {
        assert_eq!(world.egos().find(id).unwrap().id().to_string(), *id);
    }
}

/// The results of a crowd in several chunks, in which things happen, as they are and in a SUMO that is shared.
fn crowd(shared: bool, others: usize) -> Vec<(String, Reason, String)> {
    let mut cars: Vec<Car> = (0..40)
        .map(|i| {
            let mut car = Car { position_m: 15.0 * i as f64, arrives_at_m: 900.0, ..Car::new(&format!("a{i}"), 0, i) };
            car.teleport = (i == 7).then_some((150, 170));
            car.removed = (i == 11).then_some(130);
            car
        })
        .collect();
    cars.extend((0..others).map(|i| Car::new(&format!("other{i}"), 1 + i, 2 + (i % 5) as u64)));
    let mut fake = Fake::new(cars);
    fake.shared = shared;
    fake.collisions.insert(160, vec![["a3", "a4"]]);
    let mut world = world(fake, &["noise.power_db=-20"]);
    for _ in 0..500 {
        step(&mut world, 1);
        let sumo = world.sumo_mut();
        assert_eq!(sumo.asked, sumo.answered, "each question is answered once, in its own step");
    }
    assert!(world.sumo_mut().asked > 500);
    let records = end(world);
    assert!(records.finished.iter().filter(|record| record.reason == Reason::Arrived).count() > 5);
    let of_interest = records.finished.iter().filter(|record| record.id.starts_with('a'));
    let mut rows: Vec<_> = of_interest
        .map(|r| (r.id.to_string(), r.reason, format!("{:?} {:?} {:?}", r.stats, r.distance_m, r.odometer_gap_m)))
        .collect();
    rows.sort_by(|a, b| a.0.cmp(&b.0));
    rows
}

#[test]
fn law_when_sumo_is_told_changes_nothing() {
    assert_eq!(crowd(false, 0), crowd(true, 0));
}

/// Vehicles that are not near do not matter, in whichever chunk they are.
#[test]
fn law_other_chunks_change_nothing() {
    assert_eq!(crowd(false, 0), crowd(false, 300));
}

/// SUMO is not woken for speeds that can go with the next step: only while another chunk is still to drive.
#[test]
fn the_speeds_of_the_last_chunk_go_with_the_next_step() {
    for (cars, handed_over) in [(40, 0), (256, 0), (257, 1), (600, 2)] {
        let mut world = world(Fake::new((0..cars).map(|i| Car::new(&format!("a{i}"), i, 0))), &[]);
        step(&mut world, 3);
        let before = world.sumo_mut().handed_over;
        step(&mut world, 1);
        assert_eq!(world.sumo_mut().handed_over - before, handed_over, "{cars} cars");
    }
}

/// What a car is carried is not counted as a difference of the two ways.
#[test]
fn a_teleport_leaves_no_gap_between_odometer_and_body() {
    for teleport in [(100, 120), (100, 100)] {
        let mut world = world(Fake::new([Car { teleport: Some(teleport), ..Car::new("a", 0, 0) }]), &[]);
        step(&mut world, 200);
        let gap_m = record(&end(world), "a").odometer_gap_m.unwrap();
        assert!(gap_m.abs() < 0.2, "{teleport:?}: {gap_m} m");
    }
}

/// With `coupling.friction` the tyres have the lane's friction from the first step on.
#[test]
fn the_friction_of_the_lane_reaches_the_tyres() {
    for (friction, wanted) in [("true", fake::FRICTION), ("false", 1.0)] {
        let set = format!("coupling.friction={friction}");
        let mut world = world(Fake::new([Car::new("a", 0, 2)]), &[&set, "vehicle.preset=car", "vehicle.friction=1"]);
        step(&mut world, 3);
        let (ego, block) = world.driving().next().unwrap();
        assert_eq!(block.plant().body(ego.slot.lane()).friction, [wanted; 4]);
    }
}

/// The colours, and the last value of every parameter, that a vehicle was told.
fn shown(world: &mut World<Fake>, id: &str) -> (Vec<Color>, BTreeMap<&'static str, f64>) {
    let (mut colours, mut parameters) = (Vec::new(), BTreeMap::new());
    for told in world.sumo_mut().told_to(id) {
        match told {
            Tell::Colour(colour) => colours.push(colour),
            Tell::Parameter(name, value) => drop(parameters.insert(name, value)),
            _ => {}
        }
    }
    (colours, parameters)
}

#[test]
fn egos_show_their_signals_and_the_size_of_their_error() {
    // Torque that comes late makes errors of all sizes.
    let sets = ["sumo.fcd=true", "sumo.gui=true", "controller.name=adaptive", "actuator.delay_s=0.4"];
    let mut world = world(Fake::new([Car::new("a", 0, 1)]), &sets);
    step(&mut world, 300);
    let (ego, block) = world.driving().next().unwrap();
    let now_shown = block.snapshot(ego.slot.lane());
    let wanted = [now_shown.speed_mps - now_shown.reference_mps, now_shown.torque_nm, now_shown.alpha_ratio];
    let (colours, parameters) = shown(&mut world, "a");
    assert_eq!(parameters, ["mfc.err", "mfc.torque", "mfc.alpha"].into_iter().zip(wanted).collect());
    assert!((3..290).contains(&colours.len()), "told where it changes: {}", colours.len());
    assert!(colours.windows(2).all(|pair| pair[0] != pair[1]));
    // What is told after a step: the signals, then the colour if it changes. A larger error is brighter.
    let (mut error_mps, mut seen) = (0.0, Vec::new());
    for told in world.sumo_mut().told_to("a") {
        match told {
            Tell::Parameter("mfc.err", value) => error_mps = f64::abs(value),
            Tell::Colour(colour) => seen.push((error_mps, colour.green)),
            _ => {}
        }
    }
    seen.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(seen.is_sorted_by_key(|(_, green)| *green) && seen[0].1 < seen[seen.len() - 1].1, "{seen:?}");
    now(world.hand_back()).unwrap();
    assert_eq!(shown(&mut world, "a").0.last(), Some(&YELLOW), "as it was");
}

#[test]
fn nothing_is_shown_that_nobody_asked_for() {
    let mut world = world(Fake::new([Car::new("a", 0, 1)]), &[]);
    step(&mut world, 50);
    now(world.hand_back()).unwrap();
    assert_eq!(shown(&mut world, "a"), (Vec::new(), BTreeMap::new()));
}

#[test]
fn signals_and_colours_are_shown_without_each_other() {
    let shows = |set: &str| {
        let mut world = world(Fake::new([Car::new("a", 0, 1)]), &[set]);
        step(&mut world, 50);
        let (colours, parameters) = shown(&mut world, "a");
        [!colours.is_empty(), !parameters.is_empty()]
    };
    assert_eq!((shows("sumo.fcd=true"), shows("sumo.gui=true")), ([false, true], [true, false]));
}

#[test]
fn places_are_asked_of_those_that_are_followed_and_on_the_road() {
    let carried = Car { teleport: Some((40, 50)), ..Car::new("b", 1, 1) };
    let mut world = world(Fake::new([Car::new("a", 0, 1), carried, Car::new("c", 2, 1)]), &[]);
    step(&mut world, 30);
    let asked = world.sumo_mut().asked;
    let places = now(world.places(|ego| **ego.id() != *"c")).unwrap();
    assert_eq!(world.sumo_mut().asked, asked + 2);
    let mut ids: Vec<&str> = places.keys().map(|id| &**id).collect();
    ids.sort_unstable();
    assert_eq!(ids, ["a", "b"]);
    let Place { position_m, heading_deg, lane } = &places["a"];
    assert!(position_m[0] > 5.0 && position_m[1] == 1.5, "{position_m:?}");
    assert_eq!((*heading_deg, lane.as_str()), (90.0, "road_0"));
    step(&mut world, 15);
    assert_eq!(now(world.places(|ego| **ego.id() == *"b")).unwrap().len(), 0, "SUMO carries it");
}
