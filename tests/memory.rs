//! Memory: nothing is allocated in steady state, an ego takes at most 4 kB, and nothing grows, neither with time nor with
//! the vehicles that have left. Against real SUMO, with an allocator that counts.

#[allow(dead_code, reason = "the other tests against SUMO use the rest")]
#[path = "live/support.rs"]
mod support;

use std::alloc::System;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use stats_alloc::{INSTRUMENTED_SYSTEM, Region, Stats, StatsAlloc};
use sumo_mfc::control::CONTROLLERS;
use sumo_mfc::cosim::World;
use sumo_mfc::fleet::{ActuatorSetup, Fleet, GroupSetup, LoopConfig, VehicleSetup};
use sumo_mfc::keys::Values;
use sumo_mfc::plant::{BODIES, SevenDof};
use sumo_mfc::random::Stream;
use sumo_mfc::registry::find;
use sumo_mfc::run::{self, Session, SessionOptions};
use sumo_mfc::scenario::{Catalog, Override, Request, Scenario};
use sumo_mfc::traci::{SumoProcess, find_sumo};
use support::{CAR, NEW, Running, run_command, straight_road, sumo_home};

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
    for controller in CONTROLLERS.iter().map(|entry| entry.name) {
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
    let group = GroupSetup { law: Box::new(move || (adaptive.build)(&values, 0.01)), dead_time_max_s };
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

/// A short road of four lanes on which so many vehicles spend a few seconds each, two a second.
fn short_trips(folder: &Path, vehicles: u32) -> PathBuf {
    let nodes = r#"<node id="a" x="0" y="0"/><node id="b" x="60" y="0"/><node id="c" x="120" y="0"/>"#;
    let edges = r#"<edge id="ab" from="a" to="b" numLanes="4" speed="30"/><edge id="bc" from="b" to="c" numLanes="4" speed="30"/>"#;
    let net = support::network(folder, nodes, edges);
    let flow = format!(
        r#"{CAR}<flow id="f" type="car" begin="0" end="{}" number="{vehicles}" from="ab" to="bc" departSpeed="max" departLane="free" arrivalLane="current"/>"#,
        vehicles / 2
    );
    support::configuration(folder, &net, &flow, "")
}

/// Bytes that a run holds after so many of its vehicles have left.
#[test]
fn law_memory_does_not_grow_with_the_vehicles_that_have_left() {
    let _turn = TURN.lock();
    let folder = tempfile::tempdir().unwrap();
    let request = Request::file(short_trips(folder.path(), 3000))
        .with(Override::text("--controller", "controller.name", "classic"))
        .with(Override::literal("--step-length", "sumo.step_length_s", 1.0));
    let scenario = Scenario::load(&request, &Catalog::installed()).unwrap();
    let sumo = Some(sumo_home(NEW).join("bin/sumo"));
    let options = SessionOptions { out_dir: folder.path().join("result"), sumo, ..SessionOptions::default() };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let drive = async || {
        let mut session = Session::open(&scenario, &options).await.unwrap();
        // The sample of 200 vehicles is full by then, and all buffers have their size.
        while session.time_s() < 500.0 {
            session.step().await.unwrap();
        }
        let left = |session: &Session| session.world().records().counters.arrived;
        let (before, region) = (left(&session), Region::new(COUNTING));
        while session.time_s() < 1400.0 {
            session.step().await.unwrap();
        }
        let (left, held) = (left(&session) - before, held(&region.change()));
        session.finish().await.unwrap();
        (left as i64, held)
    };
    let (left, held) = pool.install(|| runtime.block_on(drive()));
    println!("bytes per vehicle that has left: {:.2}", held as f64 / left as f64);
    assert!(left > 1500, "{left} vehicles have left");
    assert!(held < 4 * left, "{held} bytes more after {left} vehicles");
}

/// The largest memory of the program while it runs so many short trips \[kB\], and how long that took.
fn peak_kb(vehicles: u32) -> (u64, Duration) {
    let folder = tempfile::tempdir().unwrap();
    let config = short_trips(folder.path(), vehicles);
    let dir = folder.path().join("result");
    let args = ["--step-length", "1", "--controller", "classic", "--no-report", "--quiet"];
    let begun = Instant::now();
    let mut run = Running::start_for(run_command(NEW, &config, &dir, &args), Duration::from_secs(1800));
    let mut peak_kb = 0;
    while run.child.try_wait().unwrap().is_none() {
        peak_kb = peak_kb.max(status_kb(run.child.id(), "VmHWM"));
        std::thread::sleep(Duration::from_millis(5));
    }
    let took = begun.elapsed();
    let ended = run.wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(support::table(&dir.join("vehicles.csv")).len(), vehicles as usize);
    (peak_kb, took)
}

/// A line of `/proc/PID/status` \[kB\], 0 once the process has ended.
fn status_kb(pid: u32, name: &str) -> u64 {
    let status = fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'));
    line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}

/// The program from its start to its last byte, the sorting of its tables included.
#[test]
#[ignore = "some minutes; cargo test --release --test memory -- --ignored --nocapture short_trips"]
fn law_the_program_is_as_large_after_sixty_thousand_short_trips_as_after_twenty_thousand() {
    let _turn = TURN.lock();
    let [few, many] = [20_000, 60_000].map(|vehicles| {
        let (peak_kb, took) = peak_kb(vehicles);
        println!("{vehicles} vehicles: largest memory {peak_kb} kB, {:.0} s", took.as_secs_f64());
        peak_kb
    });
    let growth = (many as f64 - few as f64) / 40_000.0;
    println!("growth: {growth:.3} kB per vehicle");
    assert!(growth < 0.05, "{growth:.3} kB per vehicle");
}

/// Seconds of a day, in as many steps.
const DAY_S: f64 = 86_400.0;

/// 24 hours with 200 vehicles always on the road, 50 000 in all: what grows, and what drifts?
#[test]
#[ignore = "ten minutes; make day"]
fn law_a_day_leaves_clock_odometer_and_memory_as_they_were() {
    let _turn = TURN.lock();
    let folder = tempfile::tempdir().unwrap();
    let nodes = r#"<node id="a" x="0" y="0"/><node id="b" x="3500" y="0"/><node id="c" x="7000" y="0"/>"#;
    let edges = r#"<edge id="ab" from="a" to="b" numLanes="3" speed="20"/><edge id="bc" from="b" to="c" numLanes="3" speed="20"/>"#;
    let net = support::network(folder.path(), nodes, edges);
    let flow = r#"<flow id="f" type="car" begin="0" end="86400" number="50200" from="ab" to="bc" departSpeed="max" departLane="free"/>"#;
    let end = r#"<time><end value="86400"/></time>"#;
    let config = support::configuration(folder.path(), &net, &format!("{CAR}{flow}"), end);
    let request = Request::file(config).with(Override::literal("--step-length", "sumo.step_length_s", 1.0));
    let scenario = Scenario::load(&request, &Catalog::installed()).unwrap();
    let dir = folder.path().join("result");
    let sumo = Some(sumo_home(NEW).join("bin/sumo"));
    let options = SessionOptions { out_dir: dir.clone(), sumo, ..SessionOptions::default() };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let begun = Instant::now();
    let drive = async || {
        let mut session = Session::open(&scenario, &options).await.unwrap();
        let mut seen = Vec::new();
        let (mut steps, mut apart_s) = (0_u32, 0.0_f64);
        while !session.is_over() {
            session.step().await.unwrap();
            steps += 1;
            apart_s = apart_s.max((f64::from(steps) * session.world().step_s() - session.time_s()).abs());
            if steps.is_multiple_of(3600) {
                let rss_kb = status_kb(std::process::id(), "VmRSS");
                let handles = fs::read_dir("/proc/self/fd").unwrap().count();
                let (egos, left) = (session.world().egos().len(), session.world().records().counters.arrived);
                println!("hour {:>2}: {rss_kb} kB, {handles} open files, {egos} egos, {left} have left", steps / 3600);
                seen.push((rss_kb, handles, egos));
            }
        }
        println!("clock: {steps} steps, at most {apart_s:e} s apart from SUMO's time");
        assert_eq!(apart_s, 0.0);
        (session.finish().await.unwrap().summary, seen)
    };
    let (summary, seen) = pool.install(|| runtime.block_on(drive()));
    println!("largest memory, the end included: {} kB", status_kb(std::process::id(), "VmHWM"));
    let rows = support::table(&dir.join("vehicles.csv"));
    let arrived = rows.iter().filter(|row| row["reason"] == "arrived");
    let (mut ours_m, mut gap_m, mut count) = (0.0, 0.0_f64, 0_u32);
    for row in arrived {
        ours_m += support::number(row, "distance");
        gap_m = gap_m.max(support::number(row, "odometer_gap").abs());
        count += 1;
    }
    let trips = support::elements(&dir.join("sumo/tripinfo.xml"), "tripinfo");
    let trips = trips.iter().filter(|trip| support::attribute(trip, "arrival") != "-1.00");
    let theirs_m: f64 = trips.map(|trip| support::attribute(trip, "routeLength").parse::<f64>().unwrap()).sum();
    println!("odometer: {count} arrived, bodies {ours_m:.1} m, SUMO {theirs_m:.1} m, largest gap of one {gap_m:.2} m");
    let took_s = begun.elapsed().as_secs_f64();
    println!("{took_s:.0} s, {:.0} x real time; {} egos in all", DAY_S / took_s, summary.count("vehicles"));
    let ((first_kb, first, _), (last_kb, last, _)) = (seen[0], seen[23]);
    assert!(seen[1..].iter().all(|(.., egos)| *egos > 150), "{seen:?}");
    assert_eq!(first, last, "open files");
    assert!(last_kb < first_kb + 4096, "{first_kb} kB after an hour, {last_kb} kB after a day");
    // SUMO takes an arriving vehicle out within a step; its body has not driven that part of it.
    let last_step_m = (theirs_m - ours_m) / f64::from(count);
    println!("last step of a trip, which only SUMO makes: {last_step_m:.2} m of at most 20 m");
    assert!(count > 49_000 && (0.0..=20.0).contains(&last_step_m), "{ours_m} m against {theirs_m} m");
    assert!(gap_m < 0.01, "{gap_m} m");
}
