//! Bodies that lead: their limits, their gaps, and the time that they lose.

use super::{Fake, end, now, record, speed_mps, step, world};
use crate::fake::{Car, LIMIT_MPS, STEP_S};
use sumo_mfc::cosim::World;

/// A car of SUMO's own.
fn slow(position_m: f64, speed_max_mps: f64) -> Car {
    Car { position_m, speed_max_mps, type_id: "bicycle".to_owned(), ..Car::new("slow", 0, 0) }
}

fn reference_mps(world: &World<Fake>, id: &str) -> f64 {
    let (ego, block) = world.driving().find(|(ego, _)| **ego.id() == *id).unwrap();
    block.reference_mps(ego.slot.lane())
}

/// A driver who likes to drive a tenth faster does so at the limit of each lane, as in SUMO.
#[test]
fn law_the_limit_is_that_of_the_lane_times_the_drivers_own_factor() {
    for (target, lag_s) in [("limit", 0.0), ("ctg_acc", 12.0)] {
        let mut fake = Fake::new([Car { speed_factor: 1.1, ..Car::new("a", 0, 0) }]);
        fake.ahead = Some((800.0, 10.0));
        let mut world = world(fake, &[&format!("target.name={target}"), "vehicle.preset=car"]);
        step(&mut world, 300);
        assert!(
            (reference_mps(&world, "a") - 1.1 * LIMIT_MPS).abs() < 0.05,
            "{target}: {}",
            reference_mps(&world, "a")
        );
        step(&mut world, 200 + (lag_s / STEP_S) as u32);
        assert!((reference_mps(&world, "a") - 11.0).abs() < 0.1, "{target}: {}", reference_mps(&world, "a"));
    }
}

/// As in SUMO's tripinfo; the stop was planned.
#[test]
fn law_the_time_lost_is_the_time_driven_less_that_of_the_free_road() {
    let lost_s = |stop| {
        let mut fake = Fake::new([Car { stop, speed_factor: 0.9, ..Car::new("a", 0, 0) }]);
        fake.euler = true;
        let mut world = world(fake, &["target.name=limit"]);
        step(&mut world, 300);
        let row_of = end(world);
        let row = record(&row_of, "a");
        let way_m = row.distance_m + row.odometer_gap_m.unwrap();
        (row.time_loss_s.unwrap(), 30.0 - way_m / (0.9 * LIMIT_MPS))
    };
    let (driven_s, wanted_s) = lost_s(None);
    assert!(driven_s > 2.0 && (driven_s - wanted_s).abs() < 1e-6, "{driven_s} {wanted_s}");
    let (stopped_s, with_stop_s) = lost_s(Some((150, 200)));
    assert!((with_stop_s - stopped_s - 5.0).abs() < 1e-6, "{stopped_s} {with_stop_s}");
}

/// In the steady state the gap is h·v, whatever the speed ahead.
#[test]
fn law_the_time_gap_is_kept_behind_a_slow_car() {
    for (ahead_mps, time_gap_s) in [(8.0, 1.6), (14.0, 2.2)] {
        let fake = Fake::new([Car::new("a", 0, 0), slow(150.0, ahead_mps)]);
        let mut world = world(fake, &["target.name=ctg_acc", &format!("target.time_gap_s={time_gap_s}")]);
        step(&mut world, 1200);
        let gap_m = world.sumo_mut().gap_m("a");
        assert!((speed_mps(&world, "a") - ahead_mps).abs() < 0.02, "{}", speed_mps(&world, "a"));
        assert!((gap_m - time_gap_s * ahead_mps).abs() < 0.2, "{gap_m} m at {ahead_mps} m/s");
        let stats = record(&end(world), "a").stats;
        assert!(stats.share_profile.unwrap() > 0.8 && stats.share_limit.unwrap() > 0.0, "{stats:?}");
    }
}

/// The speed ahead is known from the gap's rate: a law that hears nothing but that goes as fast as who is ahead.
#[test]
fn a_law_of_speeds_alone_follows_the_speed_ahead() {
    let sets = ["target.name=ctg_acc", "target.gap_per_s2=0", "target.speed_per_s=0.5", "target.decel_max_mps2=3"];
    let mut world = world(
        Fake::new([Car { speed_mps: 16.0, ..Car::new("a", 0, 0) }, Car { speed_mps: 12.0, ..slow(90.0, 12.0) }]),
        &sets,
    );
    step(&mut world, 200);
    assert!((speed_mps(&world, "a") - 12.0).abs() < 0.05, "{}", speed_mps(&world, "a"));
    assert_eq!(record(&end(world), "a").stats.clamped_steps, 0, "SUMO had no need to brake it");
}

#[test]
fn a_gap_is_closed_no_harder_than_comfort_allows() {
    let sets = ["target.name=ctg_acc", "target.accel_max_mps2=1.5", "coupling.lead_mps=5"];
    let mut world = world(Fake::new([Car::new("a", 0, 0)]), &sets);
    step(&mut world, 10);
    let mut before_mps = speed_mps(&world, "a");
    for _ in 0..40 {
        step(&mut world, 1);
        let accel_mps2 = (speed_mps(&world, "a") - before_mps) / STEP_S;
        assert!((1.2..1.7).contains(&accel_mps2), "{accel_mps2} m/s²");
        before_mps = speed_mps(&world, "a");
    }
}

/// SUMO allows 5 m/s behind the slow car; who is to drive at 3 m/s drives at 3 m/s at once.
#[test]
fn a_lower_target_counts_also_while_sumo_clamps() {
    let mut world = world(Fake::new([Car::new("a", 0, 0), slow(150.0, 5.0)]), &["target.name=limit"]);
    step(&mut world, 400);
    assert!((reference_mps(&world, "a") - 5.0).abs() < 0.1, "{}", reference_mps(&world, "a"));
    world.hand().reference("a", Some(3.0)).unwrap();
    step(&mut world, 1);
    assert_eq!(reference_mps(&world, "a"), 3.0);
}

/// SUMO would warn of a command to a vehicle that is not on the road.
#[test]
fn a_leading_body_that_is_carried_commands_nothing() {
    let mut world = world(Fake::new([Car { teleport: Some((50, 70)), ..Car::new("a", 0, 0) }]), &["target.name=limit"]);
    step(&mut world, 50);
    let told = world.sumo_mut().told.len();
    step(&mut world, 20);
    assert_eq!(world.sumo_mut().told.len(), told);
    step(&mut world, 100);
    assert!(speed_mps(&world, "a") > 10.0, "{}", speed_mps(&world, "a"));
    now(world.hand_back()).unwrap();
}
