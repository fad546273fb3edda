//! Memory: nothing is allocated in steady state, an ego takes at most 4 kB, and nothing grows. Against real SUMO, with
//! an allocator that counts.

#[allow(dead_code, reason = "the other tests against SUMO use the rest")]
#[path = "live/support.rs"]
mod support;

use std::alloc::System;
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use stats_alloc::{INSTRUMENTED_SYSTEM, Region, Stats, StatsAlloc};
use sumo_mfc::control::CONTROLLERS;
use sumo_mfc::cosim::World;
use sumo_mfc::fleet::{ActuatorSetup, Fleet, GroupSetup, LoopConfig, VehicleSetup};
use sumo_mfc::keys::Values;
use sumo_mfc::plant::{BODIES, SevenDof};
use sumo_mfc::random::Stream;
use sumo_mfc::registry::find;
use sumo_mfc::run;
use sumo_mfc::scenario::{Catalog, Override, Request, Scenario};
use sumo_mfc::traci::{SumoProcess, find_sumo};
use support::{CAR, NEW, straight_road, sumo_home};

#[global_allocator]
static COUNTING: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// The counters are the process's, so the tests take turns.
static TURN: Mutex<()> = Mutex::new(());

const PATIENCE: Duration = Duration::from_secs(60);

/// Bytes that are held more than at the beginning of a region.
fn held(stats: &Stats) -> i64 {
    stats.bytes_allocated as i64 - stats.bytes_deallocated as i64
}

/// Every car of `config` equipped, in a pool of two threads: makes the first steps, then counts over the rest.
fn count(config: &Path, controller: &str, step_s: f64, first: u32, then: u32) -> (usize, Stats) {
    let (egos, _, then) = count_both(config, controller, step_s, first, then);
    (egos, then)
}

/// The same, and what was counted from joining SUMO to the end of the first steps.
fn count_both(config: &Path, controller: &str, step_s: f64, first: u32, then: u32) -> (usize, Stats, Stats) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let request = Request::file(config)
        .with(Override::text("--controller", "controller.name", controller))
        .with(Override::literal("--step-length", "sumo.step_length_s", step_s));
    let scenario = Scenario::load(&request, &Catalog::installed()).unwrap();
    let sumo = find_sumo(Some(&sumo_home(NEW).join("bin/sumo"))).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["-c", &config.to_string_lossy(), "--no-step-log", "--step-length", &step_s.to_string()];
    let carry_out = async {
        let mut process = SumoProcess::spawn(&sumo, &arguments.map(str::to_owned), None, folder.path()).unwrap();
        let client = process.connect(PATIENCE).await.unwrap();
        let region = Region::new(COUNTING);
        let mut world = World::join(client, run::world(&scenario).unwrap()).await.unwrap();
        for _ in 0..first {
            world.step().await.unwrap();
        }
        let begun = region.change();
        let egos = world.egos().len();
        let region = Region::new(COUNTING);
        for _ in 0..then {
            world.step().await.unwrap();
        }
        let stats = region.change();
        assert_eq!(world.egos().len(), egos, "nobody departs or arrives in this test");
        world.close().await.1.unwrap();
        process.shut_down(PATIENCE).await.unwrap();
        (egos, begun, stats)
    };
    pool.install(|| runtime.block_on(carry_out))
}

/// Cars with room between them on the two edges of the road, none of which gets to an end while it is watched.
fn queues(cars_per_edge: usize) -> String {
    let one = |route: &str, i: usize| {
        format!(
            r#"<vehicle id="{route}{i}" type="car" route="{route}" depart="0" departSpeed="0" departPos="{}"/>"#,
            15 * i + 10
        )
    };
    let cars = |route| (0..cars_per_edge).rev().map(|i| one(route, i)).collect::<String>();
    let routes = r#"<route id="long" edges="ab bc"/><route id="short" edges="bc"/>"#;
    format!("{CAR}{routes}{}{}", cars("long"), cars("short"))
}

#[test]
fn law_a_step_without_comings_and_goings_allocates_nothing() {
    let _turn = TURN.lock();
    let folder = tempfile::tempdir().unwrap();
    // As many blocks as are shared out among threads.
    let config = straight_road(folder.path(), &queues(60));
    for controller in ["adaptive", "classic", "calibrating", "pid", "ideal"] {
        let (egos, stats) = count(&config, controller, 0.1, 20, 60);
        assert_eq!(egos, 120, "{controller}");
        assert_eq!(stats.allocations + stats.reallocations, 0, "{controller}: {stats:?}");
    }
}

#[test]
fn law_an_hour_leaves_nothing_behind() {
    let _turn = TURN.lock();
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), &queues(3).replace(r#"maxSpeed="60""#, r#"maxSpeed="0.2""#));
    let (egos, stats) = count(&config, "adaptive", 1.0, 60, 3600);
    assert_eq!(egos, 6);
    assert_eq!(held(&stats), 0, "{stats:?}");
}

/// A fleet with the adaptive law, T = 200 ms, Δt = 10 ms, and actuators that may be late by `dead_time_max_s`.
fn bytes_per_vehicle(dead_time_max_s: f64) -> i64 {
    const VEHICLES: i64 = 1600;
    let adaptive = find("controller", &CONTROLLERS, "adaptive").unwrap();
    let values = Values::defaults(adaptive.keys);
    let body = (BODIES[0].build)();
    let region = Region::new(COUNTING);
    let group = GroupSetup { controller: Box::new(move || (adaptive.build)(&values, 0.01)), dead_time_max_s };
    let loop_config = LoopConfig { plant: Box::new(SevenDof::new(0.01)), period_s: 0.01, reference_bound_mps: 1.0 };
    let mut fleet = Fleet::new(loop_config, vec![group]);
    for i in 0..VEHICLES {
        fleet.admit(
            0,
            VehicleSetup {
                nominal_nm_per_mps2: body.nominal_nm_per_mps2(),
                actuator: ActuatorSetup { dead_time_s: dead_time_max_s, lag_s: 0.0 },
                noise: Some((Stream::new(1, "noise", &i.to_string()), 0.5)),
                speed_mps: 10.0,
                body: body.clone(),
            },
        );
    }
    let bytes = held(&region.change()) / VEHICLES;
    drop(fleet);
    bytes
}

#[test]
fn an_ego_takes_at_most_four_kilobytes() {
    let _turn = TURN.lock();
    let (prompt, late) = (bytes_per_vehicle(0.0), bytes_per_vehicle(0.25));
    println!("columns, bytes per ego: {prompt}, with 250 ms of dead time {late}");
    assert!(prompt < 3072 && late < 4096 - 512, "bytes per vehicle: {prompt}, with 250 ms of dead time {late}");
    assert!(late > prompt, "the dead time takes room: {late} against {prompt}");

    // All that a world holds of an ego, ids, messages and SUMO's answers included: whole blocks more or less of them.
    let folder = tempfile::tempdir().unwrap();
    let [few, many] = [32, 56].map(|cars_per_edge| {
        let config = straight_road(folder.path(), &queues(cars_per_edge));
        let (egos, begun, _) = count_both(&config, "adaptive", 0.1, 60, 1);
        (egos as i64, held(&begun))
    });
    assert_eq!((few.0, many.0), (64, 112));
    let whole = (many.1 - few.1) / (many.0 - few.0);
    println!("whole world, bytes per ego: {whole}");
    assert!(whole < 4096, "bytes per ego: {whole}");
    assert!(whole > prompt, "the columns are part of it: {whole} against {prompt}");
}
