//! The TraCI client against real SUMO, oldest and newest supported version. A missing SUMO is a failure, not a skip.

use std::path::{Path, PathBuf};
use std::time::Duration;

use sumo_mfc::traci::{
    Batch, BatchError, Client, Color, Distance, Domain, Error, MAX_ID_BYTES, Never, NewVehicle, OnRoad, Prefix,
    RoadPosition, Row, Subscribed, SumoBinary, SumoProcess, TABLE, Var, edge, find_sumo, junction, lane, route,
    simulation, trafficlight, vehicle, vehicletype,
};

const NEW: &str = "1.28.0";
const OLD: &str = "1.15.0";
const LIMIT: Duration = Duration::from_secs(10);

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The SUMO of this version below `.sumo/`; `make` installs it.
fn binary(version: &str) -> SumoBinary {
    let lib = repository(".sumo").join(version).join("lib");
    let pythons = std::fs::read_dir(&lib).unwrap_or_else(|_| panic!("no SUMO {version} below .sumo/: type make"));
    let paths = pythons.flatten().map(|python| python.path().join("site-packages/sumo/bin/sumo"));
    let path = paths.into_iter().find(|path| path.is_file()).expect("a SUMO binary below .sumo/");
    find_sumo(Some(&path)).unwrap()
}

struct World {
    process: SumoProcess,
    client: Client,
    _log: tempfile::TempDir,
}

fn grid_args(extra: &[&str]) -> Vec<String> {
    let data = repository("tests/data/traci");
    let additional = data.join("grid.add.xml");
    let text = |path: PathBuf| path.to_str().unwrap().to_owned();
    let mut args = vec!["-n".into(), text(data.join("grid.net.xml")), "-r".into(), text(data.join("grid.rou.xml"))];
    args.extend(["-a".to_owned(), text(additional)]);
    args.extend(["--no-step-log", "--step-length", "0.5", "--default.speeddev", "0"].map(String::from));
    args.extend(extra.iter().map(|&arg| arg.to_owned()));
    args
}

async fn world(version: &str, extra: &[&str]) -> World {
    let log = tempfile::tempdir().unwrap();
    let mut process = SumoProcess::spawn(&binary(version), &grid_args(extra), None, log.path()).unwrap();
    let client = process.connect(LIMIT).await.unwrap();
    World { process, client, _log: log }
}

async fn end(world: World) {
    world.client.close().await.unwrap();
    assert!(world.process.shut_down(LIMIT).await.unwrap().success());
}

fn object(row: &Row) -> &'static str {
    match (row.domain, row.name) {
        (_, "IDS" | "COUNT" | "LOADED" | "TELEPORTING") => "",
        (Domain::Simulation, "OPTION") => "step-length",
        (Domain::Simulation, "BUS_STOP_WAITING") => "halt",
        (Domain::Simulation, _) => "",
        (Domain::Vehicle, _) => "v0",
        (Domain::VehicleType, _) => "ego",
        (Domain::Route, _) => "side",
        (Domain::Edge, _) => "A0A1",
        (Domain::Lane, _) => "A0A1_0",
        (Domain::Junction | Domain::TrafficLight, _) => "B1",
    }
}

const PLACE: RoadPosition<'static> = RoadPosition { edge: "A1A2", position_m: 50.0, lane: 0 };
const FARTHER: RoadPosition<'static> = RoadPosition { edge: "A2B2", position_m: 50.0, lane: 0 };

/// Appends the get of a row with the parameter that it needs.
fn push_get(batch: &mut Batch, row: &Row) -> usize {
    macro_rules! get {
        ($shape:ty, $argument:expr) => {{
            let variable = Var::<Option<String>, Never, $shape>::new(row.domain, row.id);
            batch.get_with(variable, object(row), $argument).unwrap().index()
        }};
    }
    match (row.parameter, row.name) {
        (None, _) => get!((), ()),
        (Some("f64"), "LEADER" | "FOLLOWER" | "FOES") => get!(f64, 100.0),
        (Some("f64"), _) => get!(f64, 10.0),
        (Some("i32"), _) => get!(i32, 0),
        (Some("u8"), _) => get!(u8, 2),
        (Some("String"), "FOES") => get!(String, "A1A2_0"),
        (Some("String"), _) => get!(String, "has.mfc.device"),
        (Some("(OnRoad, u8)"), _) => get!((OnRoad, u8), (PLACE, 1)),
        (Some("(OnRoad, Distance)"), _) => get!((OnRoad, Distance), (PLACE, Distance::Driving)),
        (Some("(OnRoad, OnRoad, Distance)"), _) => {
            get!((OnRoad, OnRoad, Distance), (PLACE, FARTHER, Distance::Driving))
        }
        (Some("(f64, f64)"), _) => get!((f64, f64), (10.0, 30.0)),
        (Some("(f64, f64, f64, String)"), _) => get!((f64, f64, f64, String), (10.0, 8.0, 4.5, "v0")),
        (Some("(f64, f64, f64, f64, String)"), _) => {
            get!((f64, f64, f64, f64, String), (10.0, 30.0, 8.0, 4.5, "v0"))
        }
        (Some(_), "FIND_ROUTE") => get!((String, String, String, f64, i32), ("A0A1", "B1B0", "ego", 0.0, 0)),
        (Some(other), name) => panic!("no parameter {other} for {name}"),
    }
}

/// Every row that can be read, read alone and in one batch, decodes to the type of its row.
async fn walk_gets(version: &str) {
    let mut world = world(version, &[]).await;
    world.client.step_until(12.0).await.unwrap();
    let mut all = Batch::new();
    let mut sent = Vec::new();
    let mut problems = Vec::new();
    for row in TABLE.iter().filter(|row| row.probe.is_some()) {
        let mut one = Batch::new();
        push_get(&mut one, row);
        let reply = match world.client.exchange(&one).await {
            Ok(reply) => reply,
            Err(error) => panic!("{:?} {}: {}", row.domain, row.name, world.process.explain(error).await),
        };
        let answer = match reply.refusal(0) {
            Some(refusal) => Err(refusal.text.to_owned()),
            None => row.probe.unwrap()(reply.value(0).unwrap().unwrap()).map_err(|error| error.to_string()),
        };
        match answer {
            Ok(text) if std::env::var_os("TRACI_SHOW").is_some() => println!("{:?} {} = {text}", row.domain, row.name),
            Ok(_) if row.newer && version == OLD => {
                problems.push(format!("{:?} {}: answered by the old version", row.domain, row.name))
            }
            Ok(_) => {}
            Err(_) if row.newer && version == OLD => continue,
            Err(error) => {
                problems.push(format!("{:?} {}: {error}", row.domain, row.name));
                continue;
            }
        }
        sent.push((row, push_get(&mut all, row)));
    }
    assert!(problems.is_empty(), "{version}:\n{}", problems.join("\n"));
    assert!(sent.len() > 150, "{} rows", sent.len());
    let reply = world.client.exchange(&all).await.unwrap();
    assert_eq!(reply.refusals().count(), 0);
    for (row, index) in sent {
        let value = reply.value(index).unwrap().unwrap();
        assert!(row.probe.unwrap()(value).is_ok(), "{}", row.name);
    }
    end(world).await;
}

#[tokio::test]
async fn every_get_of_the_table_answers_on_1_28() {
    walk_gets(NEW).await;
}

#[tokio::test]
async fn every_get_of_the_table_answers_on_1_15() {
    walk_gets(OLD).await;
}

/// Values that the network, the demand and 12 s of driving leave no choice about.
async fn plausible(version: &str) {
    let mut world = world(version, &[]).await;
    let client = &mut world.client;
    client.step_until(12.0).await.unwrap();
    assert_eq!(client.get(simulation::TIME, "").await.unwrap(), 12.0);
    assert_eq!(client.get(simulation::STEP_LENGTH, "").await.unwrap(), 0.5);
    assert_eq!(client.get(lane::LENGTH, "A0A1_0").await.unwrap(), 103.2);
    assert_eq!(client.get(lane::SHAPE, "A0A1_0").await.unwrap(), [[4.8, 6.4], [4.8, 109.6]]);
    assert_eq!(client.get(edge::LANE_COUNT, "A0A1").await.unwrap(), 2);
    assert_eq!(client.get(junction::POSITION, "B1").await.unwrap(), [120.0, 120.0]);
    assert_eq!(client.get(vehicletype::DECEL, "ego").await.unwrap(), 4.5);
    assert_eq!(client.get(route::EDGES, "across").await.unwrap(), ["C1B1", "B1A1"]);
    assert_eq!(client.get(vehicle::ALLOWED_SPEED, "v0").await.unwrap(), 13.89);
    assert_eq!(client.get_with(vehicle::PARAMETER, "v0", "has.mfc.device").await.unwrap(), "false");
    assert_eq!(client.get_with(vehicletype::PARAMETER, "ego", "has.mfc.device").await.unwrap(), "true");
    let ids = client.get(vehicle::IDS, "").await.unwrap();
    assert_eq!(client.get(vehicle::COUNT, "").await.unwrap(), i32::try_from(ids.len()).unwrap());
    let [low, high] = client.get(simulation::BOUNDING_BOX, "").await.unwrap()[..] else { panic!("two corners") };
    for id in &ids {
        let speed_mps = client.get(vehicle::SPEED, id).await.unwrap();
        assert!((0.0..=13.89).contains(&speed_mps), "{id}: {speed_mps} m/s");
        let [x_m, y_m] = client.get(vehicle::POSITION, id).await.unwrap();
        assert!((low[0]..=high[0]).contains(&x_m) && (low[1]..=high[1]).contains(&y_m), "{id}: {x_m} {y_m}");
        let lane = client.get(vehicle::LANE, id).await.unwrap();
        assert_eq!(client.get(lane::EDGE, &lane).await.unwrap(), client.get(vehicle::ROAD, id).await.unwrap());
        assert!(client.get(lane::VEHICLES, &lane).await.unwrap().contains(id));
        let distance_m = client.get(vehicle::DISTANCE, id).await.unwrap();
        assert!((0.0..=12.0 * 13.89).contains(&distance_m), "{id}: {distance_m} m");
        if let Some(leader) = client.get_with(vehicle::LEADER, id, 200.0).await.unwrap() {
            assert!(ids.contains(&leader.id) && leader.gap_m > 0.0 && leader.gap_m < 200.0);
        }
    }
    end(world).await;
}

#[tokio::test]
async fn values_are_plausible_on_1_28() {
    plausible(NEW).await;
}

#[tokio::test]
async fn values_are_plausible_on_1_15() {
    plausible(OLD).await;
}

const BLUE: Color = Color { red: 1, green: 2, blue: 250, alpha: 255 };
const CARS: [&str; 2] = ["passenger", "taxi"];

/// Every row that can be set is accepted, and reads back what was set where SUMO keeps the value as it is.
async fn walk_sets(version: &str) {
    let mut world = world(version, &["--lateral-resolution", "0.8"]).await;
    world.client.step_until(12.0).await.unwrap();
    let client = &mut world.client;
    let (mut done, mut problems) = (Vec::new(), Vec::new());
    macro_rules! set {
        ($($module:ident $name:ident $id:literal $value:expr;)*) => {$({
            let row = TABLE.iter().find(|row| {
                row.name == stringify!($name) && row.domain == $module::$name.domain && row.id == $module::$name.id
            });
            let result = client.set($module::$name, $id, $value).await;
            match result {
                Err(Error::Refused { .. }) if version == OLD && row.unwrap().newer => {}
                Err(error) => problems.push(format!("{} {}: {error}", stringify!($module), stringify!($name))),
                Ok(()) => {}
            }
            done.push(($module::$name.domain, stringify!($name)));
        })*};
    }
    // Sets the value and reads it back.
    macro_rules! keep {
        ($($module:ident $name:ident $id:literal $value:expr;)*) => {$({
            set!($module $name $id $value;);
            match client.get($module::$name, $id).await {
                Err(Error::Refused { .. }) if version == OLD => {}
                other if other.as_ref().is_ok_and(|got| *got == $value) => {}
                other => problems.push(format!("{} {}: {other:?}", stringify!($module), stringify!($name))),
            }
        })*};
    }
    keep! {
        simulation SCALE "" 1.5;
        vehicle SPEED_MODE "v0" 27;
        vehicle MAX_SPEED "v0" 30.0;
        vehicle CLASS "v0" "taxi";
        vehicle SHAPE_CLASS "v0" "taxi";
        vehicle EMISSION_CLASS "v0" "Zero/default";
        vehicle COLOR "v0" BLUE;
        vehicle LENGTH "v0" 4.5;
        vehicle WIDTH "v0" 1.7;
        vehicle HEIGHT "v0" 1.4;
        vehicle MASS "v0" 1700.0;
        vehicle MIN_GAP "v0" 2.0;
        vehicle LATERAL_MIN_GAP "v0" 0.5;
        vehicle MAX_LATERAL_SPEED "v0" 1.2;
        vehicle LATERAL_ALIGNMENT "v0" "right";
        vehicle ACCEL "v0" 2.0;
        vehicle DECEL "v0" 4.0;
        vehicle EMERGENCY_DECEL "v0" 8.0;
        vehicle APPARENT_DECEL "v0" 4.2;
        vehicle IMPERFECTION "v0" 0.25;
        vehicle TAU "v0" 1.25;
        vehicle ACTION_STEP_LENGTH "v0" 1.0;
        vehicle SPEED_FACTOR "v0" 1.25;
        vehicle ROUTING_MODE "v0" 1;
        vehicle LINE "v0" "7";
        vehicle LANE_CHANGE_MODE "v0" 512;
        vehicletype LENGTH "ego" 4.5;
        vehicletype WIDTH "ego" 1.7;
        vehicletype HEIGHT "ego" 1.4;
        vehicletype MASS "ego" 1700.0;
        vehicletype MAX_SPEED "ego" 30.0;
        vehicletype SPEED_FACTOR "ego" 1.25;
        vehicletype SPEED_DEVIATION "ego" 0.1;
        vehicletype ACCEL "ego" 2.0;
        vehicletype DECEL "ego" 4.0;
        vehicletype EMERGENCY_DECEL "ego" 8.0;
        vehicletype APPARENT_DECEL "ego" 4.2;
        vehicletype IMPERFECTION "ego" 0.25;
        vehicletype IMPATIENCE "ego" 0.5;
        vehicletype TAU "ego" 1.25;
        vehicletype MIN_GAP "ego" 2.0;
        vehicletype LATERAL_MIN_GAP "ego" 0.5;
        vehicletype MAX_LATERAL_SPEED "ego" 1.2;
        vehicletype LATERAL_ALIGNMENT "ego" "right";
        vehicletype ACTION_STEP_LENGTH "ego" 1.0;
        vehicletype CLASS "ego" "taxi";
        vehicletype EMISSION_CLASS "ego" "Zero/default";
        vehicletype SHAPE_CLASS "ego" "taxi";
        vehicletype COLOR "ego" BLUE;
        vehicletype SCALE "ego" 0.5;
        lane LENGTH "C0B0_0" 90.0;
        lane MAX_SPEED "C0B0_0" 10.0;
        trafficlight STATE "B1" "rrrrrrrrrrrrrrrr";
        trafficlight PROGRAM "B1" "0";
        trafficlight PHASE "B1" 2;
        trafficlight PHASE_NAME "B1" "green";
    }
    set! {
        vehicle SPEED "v0" 3.0;
        vehicle SPEED "v0" -1.0;
        vehicle PREVIOUS_SPEED "v0" (4.0, 0.5);
        vehicle ACCELERATION "v0" (0.5, 1.0);
        vehicle SLOW_DOWN "v0" (4.0, 1.0);
        vehicle SHIFT "v0" 0.1;
        vehicle TYPE "v1" "ego";
        vehicle ROUTE_ID "late" "spare";
        vehicle ROUTE_ID "late" "across";
        vehicle ROUTE "v1" &["A0A1", "A1A2", "A2B2"];
        vehicle CHANGE_TARGET "v1" "B1C1";
        vehicle REROUTE "v1" ();
        vehicle VIA "v1" &["B1C1"];
        vehicle SIGNALS "v0" 2;
        vehicle CHANGE_LANE "v1" (1, 5.0);
        vehicle CHANGE_SUBLANE "v1" 0.2;
        vehicle STOP "v1" ("B1C1", 60.0, 0, 5.0, 0, 50.0, -1_073_741_824.0);
        vehicle MOVE_TO "v1" ("A0A1_1", 40.0);
        vehicle ADD "new" NewVehicle { route: "spare", ..NewVehicle::default() };
        vehicle PARAMETER "v0" ("mfc.mass", "1719");
        vehicle REMOVE "late" 3;
        vehicletype COPY "ego" "copy";
        vehicletype PARAMETER "ego" ("a", "b");
        route ADD "added" &["C0B0", "B0A0"];
        route PARAMETER "added" ("a", "b");
        route REMOVE "added" ();
        edge ADAPT_TRAVEL_TIME "C0B0" (12.0,);
        edge ADAPT_EFFORT "C0B0" (13.0,);
        edge MAX_SPEED "C1C0" 9.0;
        edge ALLOWED "C1C0" &CARS;
        edge DISALLOWED "C1C0" &["truck"];
        edge PARAMETER "C1C0" ("a", "b");
        lane ALLOWED "C0B0_0" &CARS;
        lane DISALLOWED "C0B0_0" &["truck"];
        lane PARAMETER "C0B0_0" ("a", "b");
        junction PARAMETER "B1" ("a", "b");
        trafficlight PHASE_DURATION "B1" 5.0;
        trafficlight PARAMETER "B1" ("a", "b");
        simulation PARAMETER "" ("a", "b");
        simulation CLEAR_PENDING "" "";
        simulation MESSAGE "" "hello";
    }
    // Stops can be ended only when standing.
    while client.get(vehicle::STOP_STATE, "v0").await.unwrap() != 1 {
        client.step().await.unwrap();
    }
    assert_eq!(client.get(vehicle::STOP_STATE, "v0").await.unwrap(), 1);
    set!(vehicle RESUME "v0" (););
    assert_eq!(client.get(vehicle::STOP_STATE, "v0").await.unwrap(), 0);
    assert_eq!(client.get_with(vehicle::PARAMETER, "v0", "mfc.mass").await.unwrap(), "1719");
    assert_eq!(client.get_with(edge::TRAVEL_TIME, "C0B0", 20.0).await.unwrap(), 12.0);
    assert_eq!(client.get_with(edge::EFFORT, "C0B0", 20.0).await.unwrap(), 13.0);
    assert_eq!(client.get(lane::MAX_SPEED, "C1C0_1").await.unwrap(), 9.0);
    assert_eq!(client.get(lane::DISALLOWED, "C0B0_0").await.unwrap(), ["truck"]);
    assert!(problems.is_empty(), "{version}:\n{}", problems.join("\n"));
    for row in TABLE.iter().filter(|row| row.set.is_some()) {
        assert!(done.contains(&(row.domain, row.name)), "{:?} {} is not tried", row.domain, row.name);
    }
    end(world).await;
}

#[tokio::test]
async fn every_set_of_the_table_is_accepted_by_1_28() {
    walk_sets(NEW).await;
}

#[tokio::test]
async fn every_set_of_the_table_is_accepted_by_1_15() {
    walk_sets(OLD).await;
}

/// The loop of a co-simulation: one write and one wait per step, previous speeds set, newcomers subscribed, gets behind
/// the step.
async fn drive(version: &str) {
    let mut world = world(version, &["--step-method.ballistic"]).await;
    let client = &mut world.client;
    let (mut batch, mut gets) = (Batch::new(), Batch::new());
    let begin_s = client.get(simulation::TIME, "").await.unwrap();
    let events = [0x66, 0x74, 0x7a, 0x76, 0x78, 0x81, 0x7d];
    assert_eq!(batch.subscribe_ids(Domain::Simulation, "", &events, begin_s).unwrap().len(), 1);
    batch.step().unwrap();
    let mut egos: Vec<(String, Prefix, f64)> = Vec::new();
    let (mut seen, mut arrived_ids, mut slowest) = (0, Vec::new(), f64::INFINITY);
    for _ in 0..150 {
        gets.clear();
        let asked: Vec<_> =
            egos.iter().map(|(_, prefix, _)| gets.get_by_prefix(vehicle::DISTANCE, prefix).unwrap()).collect();
        let time = gets.get(simulation::TIME, "").unwrap();
        let (stepped, got) = (client.queue(&batch).unwrap(), client.queue(&gets).unwrap());
        let reply = client.receive(stepped).await.unwrap();
        assert_eq!(reply.refusals().count(), 0, "{:?}", reply.refusals().collect::<Vec<_>>());
        let (mut time_s, mut departed, mut arrived) = (0.0, Vec::new(), Vec::new());
        let mut speeds = Vec::new();
        for block in reply.blocks() {
            let block = block.unwrap();
            match block.domain {
                Some(Domain::Simulation) => {
                    time_s = block.get(simulation::TIME).unwrap().unwrap();
                    departed = block.get(simulation::DEPARTED).unwrap().unwrap();
                    arrived = block.get(simulation::ARRIVED).unwrap().unwrap();
                    assert_eq!(block.values().count(), events.len());
                }
                _ => speeds.push((block.id.to_owned(), block.read((vehicle::SPEED, vehicle::ANGLE)).unwrap())),
            }
        }
        let values = client.receive(got).await.unwrap();
        assert_eq!(values.get(time).unwrap(), time_s, "the gets see the state after the step");
        for ((id, _, _), handle) in egos.iter().zip(asked) {
            assert_eq!(values.refusal(handle.index()).is_some(), arrived.contains(id), "{id}");
            assert_eq!(values.f64(handle.index()).is_some(), !arrived.contains(id), "{id}");
        }
        batch.clear();
        egos.retain(|(id, _, _)| !arrived.contains(id));
        assert_eq!(speeds.len(), egos.len());
        for ((id, prefix, speed_mps), (block_id, read)) in egos.iter_mut().zip(speeds) {
            let Subscribed::Own((Some(read_mps), Some(angle_deg))) = read else { panic!("{id}: {read:?}") };
            assert_eq!(*id, block_id, "blocks come in the order of subscribing");
            // A sluggish car: it drives at nine tenths of what SUMO wants.
            *speed_mps = 0.9 * read_mps;
            slowest = slowest.min(*speed_mps);
            assert!((0.0..=360.0).contains(&angle_deg));
            batch.set_previous_speed(prefix, *speed_mps, 0.0).unwrap();
        }
        for id in departed.iter().filter(|id| !arrived.contains(id)) {
            batch.subscribe((vehicle::SPEED, vehicle::ANGLE), id, time_s).unwrap();
            egos.push((id.clone(), Prefix::new(id).unwrap(), 0.0));
            seen += 1;
        }
        arrived_ids.extend(arrived);
        batch.step().unwrap();
    }
    assert!(seen > 10 && arrived_ids.len() > 5, "{seen} departed, {} arrived", arrived_ids.len());
    assert_eq!(slowest, 0.0, "somebody stops at a light or stop");
    end(world).await;
}

#[tokio::test]
async fn the_coupling_loop_runs_on_1_28() {
    drive(NEW).await;
}

#[tokio::test]
async fn the_coupling_loop_runs_on_1_15() {
    drive(OLD).await;
}

async fn speeds(version: &str) {
    let mut world = world(version, &[]).await;
    let client = &mut world.client;
    client.step_until(5.0).await.unwrap();
    let v0 = Prefix::new("v0").unwrap();
    let mut batch = Batch::new();
    batch.set_previous_speed(&v0, 7.25, 0.5).unwrap();
    let (speed, acceleration) =
        (batch.get(vehicle::SPEED, "v0").unwrap(), batch.get(vehicle::ACCELERATION, "v0").unwrap());
    let gone = batch.get(vehicle::SPEED, "nobody").unwrap();
    batch.set(vehicle::SPEED_MODE, "v0", 32).unwrap();
    batch.set_speed(&v0, 6.125).unwrap();
    batch.step().unwrap();
    let reply = client.exchange(&batch).await.unwrap();
    assert_eq!(reply.get(speed).unwrap(), 7.25);
    assert_eq!(reply.get(acceleration).unwrap(), 0.5);
    assert!(matches!(reply.get(gone), Err(Error::Refused { text, .. }) if text.contains("nobody")));
    assert_eq!(reply.refusals().map(|(index, _)| index).collect::<Vec<_>>(), [gone.index()], "the rest is carried out");
    assert_eq!(client.get(vehicle::SPEED, "v0").await.unwrap(), 6.125);
    batch.clear();
    batch.release_speed(&v0).unwrap();
    batch.step().unwrap();
    client.exchange(&batch).await.unwrap();
    assert!(client.get(vehicle::SPEED, "v0").await.unwrap() > 6.125);
    assert!(matches!(client.get(vehicle::SPEED, "late").await, Err(Error::NoValue | Error::Refused { .. })));
    assert!(matches!(client.exchange(&Batch::new()).await, Err(Error::Empty)));
    end(world).await;
}

#[tokio::test]
async fn speeds_arrive_bit_for_bit_on_1_28() {
    speeds(NEW).await;
}

#[tokio::test]
async fn speeds_arrive_bit_for_bit_on_1_15() {
    speeds(OLD).await;
}

/// Requests that end or hang SUMO when sent naively: many variables of unknown vehicles, unknown variables, long ids.
async fn hardships(version: &str) {
    let mut world = world(version, &[]).await;
    let client = &mut world.client;
    client.step_until(5.0).await.unwrap();
    let many: Vec<u8> = vec![0x40, 0x43, 0x50, 0x51, 0x52, 0x56, 0x84, 0xb1, 0xb7, 0x36, 0x42, 0x39];
    let unsupported = [0xf0, 0xf1, 0xf2, 0xf3, 0xf4, 0xf5];
    let long = "x".repeat(MAX_ID_BYTES);
    for (id, variables) in [("nobody", &many[..]), (&long, &many[..]), ("v0", &unsupported[..])] {
        let mut batch = Batch::new();
        let commands = batch.subscribe_ids(Domain::Vehicle, id, variables, 5.0).unwrap();
        assert!(commands.len() > 1);
        let reply = match client.exchange(&batch).await {
            Ok(reply) => reply,
            Err(error) => panic!("{id}: {}", world.process.explain(error).await),
        };
        for command in commands {
            assert!(reply.refusal(command).is_some());
            if let Some(block) = reply.subscription(command).unwrap() {
                assert!(block.values().all(|entry| entry.unwrap().1.is_err()));
            }
        }
    }
    assert!(matches!(client.get(vehicle::SPEED, &long).await, Err(Error::Refused { .. })));
    assert!(matches!(client.set(vehicle::SPEED, &long, 1.0).await, Err(Error::Refused { .. })));
    for domain in Domain::ALL {
        let mut batch = Batch::new();
        let unknown: Var<f64, f64> = Var::new(domain, 0xfe);
        batch.get(unknown, &long).unwrap();
        batch.set(unknown, &long, 1.0).unwrap();
        batch.subscribe_ids(domain, &long, &[0xfc, 0xfd, 0xfe], 5.0).unwrap();
        let reply = client.exchange(&batch).await.unwrap();
        assert!(reply.refusal(0).is_some() && reply.refusal(1).is_some(), "{domain:?}");
    }
    // The parameter is repeated in SUMO's text too.
    let key = format!("device.{}", "x".repeat(MAX_ID_BYTES));
    let naive = client.get_with(vehicle::PARAMETER, "v0", &key).await;
    assert!(matches!(naive, Err(Error::Refused { .. })), "{naive:?}");
    let naive = client.get_with(vehicle::PARAMETER, &long, &key).await;
    assert!(matches!(naive, Err(Error::Batch(BatchError::IdTooLong { .. }))));
    let too_long = "x".repeat(MAX_ID_BYTES + 1);
    assert!(matches!(client.get(vehicle::SPEED, &too_long).await, Err(Error::Batch(BatchError::IdTooLong { .. }))));
    let wrong: Var<f64> = Var::new(Domain::Vehicle, vehicle::ROAD.id);
    assert!(matches!(client.get(wrong, "v0").await, Err(Error::Type { got: "string", .. })));

    let naive = Batch::new().subscribe_ids(Domain::Vehicle, "v0", &[0x40, vehicle::LEADER.id], 5.0);
    assert!(matches!(naive, Err(BatchError::NeedsParameter { id: 0x68 })));

    // Many variables, several commands, one block; and one with a parameter.
    let mut batch = Batch::new();
    let commands = batch.subscribe_ids(Domain::Vehicle, "v0", &many, 5.0).unwrap();
    let reply = client.exchange(&batch).await.unwrap();
    let block = reply.subscription(commands.end - 1).unwrap().unwrap();
    assert_eq!(block.id, "v0");
    let mut batch = Batch::new();
    batch.subscribe_with(vehicle::FOLLOWER, "v0", 500.0, 5.0).unwrap();
    batch.subscribe_with(vehicle::PARAMETER, "v0", "has.mfc.device", 5.0).unwrap();
    batch.step().unwrap();
    let reply = client.exchange(&batch).await.unwrap();
    let block = reply.blocks().next().unwrap().unwrap();
    assert_eq!(block.values().count(), many.len() + 2);
    assert_eq!(block.get(vehicle::FOLLOWER).unwrap().unwrap().unwrap().id, "v1");
    assert!(block.get(vehicle::SPEED).unwrap().unwrap() > 0.0);
    assert!(block.get(vehicle::LANE_INDEX).unwrap().is_some() && block.get(vehicle::TAU).unwrap().is_none());
    assert!(matches!(block.read((vehicle::SPEED, vehicle::LANE_INDEX)).unwrap(), Subscribed::Own((Some(_), Some(_)))));
    assert_eq!(block.read((vehicle::SPEED, vehicle::TAU)).unwrap(), Subscribed::Foreign);
    client.unsubscribe(Domain::Vehicle, "v0").await.unwrap();
    assert_eq!(client.step().await.unwrap().block_count(), 0);

    // Removed by command: never listed as arrived, shows as a block that says so.
    client.subscribe(vehicle::SPEED, "v0", 6.0).await.unwrap();
    client.set(vehicle::REMOVE, "v0", 2).await.unwrap();
    let reply = client.step().await.unwrap();
    assert_eq!(reply.blocks().next().unwrap().unwrap().read(vehicle::SPEED).unwrap(), Subscribed::Removed);
    end(world).await;
}

#[tokio::test]
async fn sumo_survives_what_would_kill_it_1_28() {
    hardships(NEW).await;
}

#[tokio::test]
async fn sumo_survives_what_would_kill_it_1_15() {
    hardships(OLD).await;
}

#[tokio::test]
async fn a_stop_is_decoded_in_both_forms() {
    for version in [NEW, OLD] {
        let mut world = world(version, &[]).await;
        world.client.step_until(2.0).await.unwrap();
        let short = world.client.get(vehicle::NEXT_STOPS, "v0").await.unwrap();
        let full = world.client.get_with(vehicle::STOPS, "v0", 0).await.unwrap();
        assert_eq!((short.len(), full.len()), (1, 1));
        assert_eq!((short[0].lane.as_str(), short[0].end_m, short[0].until_s), ("A2B2_0", 80.0, None));
        assert_eq!((full[0].lane.as_str(), full[0].duration_s, full[0].arrival_s), ("A2B2_0", Some(10.0), None));
        let lights = world.client.get(vehicle::NEXT_LIGHTS, "v0").await.unwrap();
        assert!(lights.iter().any(|light| light.id == "A1" && light.distance_m > 0.0));
        let programs = world.client.get(trafficlight::PROGRAMS, "B1").await.unwrap();
        let links = world.client.get(trafficlight::CONTROLLED_LINKS, "B1").await.unwrap();
        assert_eq!(programs[0].phases[0].state.len(), links.0.len());
        assert!(!world.client.get_with(lane::FOES, "A1B1_0", "B1B0_0").await.unwrap().is_empty() || version == OLD);
        end(world).await;
    }
}

#[tokio::test]
async fn an_old_sumo_is_refused() {
    let log = tempfile::tempdir().unwrap();
    let mut process = SumoProcess::spawn(&binary("1.14.1"), &grid_args(&[]), None, log.path()).unwrap();
    let error = process.connect(LIMIT).await.unwrap_err();
    assert_eq!(error.to_string(), "SUMO 1.14.1 is too old, SUMO 1.15 or newer is needed");
}

#[tokio::test]
async fn sumos_own_message_is_shown_when_it_rejects_the_network() {
    for version in [NEW, OLD] {
        let log = tempfile::tempdir().unwrap();
        let net = log.path().join("broken.net.xml");
        std::fs::write(&net, "<net version=\"1.9\"><edge id=\"a\" from=\"nowhere\" to=\"b\"/></net>").unwrap();
        let args = ["-n".to_owned(), net.to_str().unwrap().to_owned()];
        let mut process = SumoProcess::spawn(&binary(version), &args, None, log.path()).unwrap();
        let error = process.connect(LIMIT).await.unwrap_err();
        let Error::Died { status, report } = &error else { panic!("{error}") };
        assert!(status.contains('1') && report.contains("Error"), "{error}");
    }
}

#[tokio::test]
async fn a_busy_port_is_named() {
    let other = std::net::TcpListener::bind("0.0.0.0:0").unwrap();
    let port = other.local_addr().unwrap().port();
    let log = tempfile::tempdir().unwrap();
    let error = SumoProcess::spawn(&binary(NEW), &grid_args(&[]), Some(port), log.path()).unwrap_err();
    assert_eq!(error.to_string(), format!("port {port} is in use"));
    assert!(matches!(
        Client::connect(format!("127.0.0.1:{port}"), Duration::from_millis(200)).await,
        Err(Error::Timeout { .. })
    ));
    drop(other);
    assert!(matches!(
        Client::connect(format!("127.0.0.1:{port}"), Duration::from_millis(50)).await,
        Err(Error::Connect { .. })
    ));
}

#[tokio::test]
async fn a_killed_sumo_is_reported_with_its_signal() {
    let mut world = world(NEW, &[]).await;
    world.client.step().await.unwrap();
    let id = world.process.id().unwrap().to_string();
    assert!(std::process::Command::new("kill").args(["-9", &id]).status().unwrap().success());
    let error = world.client.step().await.unwrap_err();
    assert!(matches!(error, Error::Disconnected(_)), "{error}");
    assert!(matches!(world.client.step().await, Err(Error::Finished)));
    let error = world.process.explain(error).await;
    assert!(matches!(&error, Error::Died { status, .. } if status.contains('9')), "{error}");
    assert!(!world.process.is_running());
}

#[tokio::test]
async fn a_silent_sumo_ends_in_a_timeout() {
    let mut world = world(NEW, &[]).await;
    let id = world.process.id().unwrap().to_string();
    assert!(std::process::Command::new("kill").args(["-STOP", &id]).status().unwrap().success());
    world.client.set_timeout(Duration::from_millis(100));
    assert!(matches!(world.client.step().await, Err(Error::Timeout { .. })));
    assert!(matches!(world.client.step().await, Err(Error::Finished)));
}

#[tokio::test]
async fn two_clients_take_turns_and_see_each_others_blocks() {
    let log = tempfile::tempdir().unwrap();
    let args = grid_args(&["--num-clients", "2"]);
    let mut process = SumoProcess::spawn(&binary(NEW), &args, None, log.path()).unwrap();
    let address = format!("127.0.0.1:{}", process.port());
    // SUMO answers the second client only when the first has told its order.
    let first = async {
        let mut client = process.connect(LIMIT).await.unwrap();
        client.set_order(1).await.unwrap();
        client
    };
    let second = async {
        let mut client = Client::connect(address, LIMIT).await.unwrap();
        client.set_order(2).await.unwrap();
        client
    };
    let (mut first, mut second) = tokio::join!(first, second);
    first.subscribe(simulation::TIME, "", 0.0).await.unwrap();
    let (one, two) = tokio::join!(first.step(), second.step());
    assert_eq!((one.unwrap().block_count(), two.unwrap().block_count()), (1, 1));
    first.close().await.unwrap();
    second.step().await.unwrap();
    second.close().await.unwrap();
    assert!(process.shut_down(LIMIT).await.unwrap().success());
}
