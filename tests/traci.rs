//! The TraCI client against real SUMO, oldest and newest supported version. A missing SUMO is a failure, not a skip.

use std::path::{Path, PathBuf};
use std::time::Duration;

use sumo_mfc::traci::typed::{Distance, OnRoad, RoadPosition};
use sumo_mfc::traci::variables::{Row, TABLE};
use sumo_mfc::traci::{
    Batch, Client, Domain, Error, Index, Prefix, SumoBinary, SumoProcess, Value, edge, find_sumo, lane, route,
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
    assert!(world.process.shut_down().await.unwrap().success());
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
            let variable =
                sumo_mfc::traci::Var::<Option<String>, sumo_mfc::traci::Never, $shape>::new(row.domain, row.id);
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
