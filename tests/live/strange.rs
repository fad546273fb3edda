//! What SUMO can do besides plain traffic: every action at a collision, teleports to the end of a route and before anybody
//! looked on, left-hand traffic, the sublane model, drivers that decide rarely, states, ids of every alphabet; and egos
//! that do what no car does.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{
    CAR, NEW, OLD, Outcome, Row, attribute, configuration, elements, network, number, own, plain_sumo, refusal, run,
    straight_road, sumo_home,
};

/// A vehicle that stands on the second edge for a while, and an ego behind it.
fn standing(at_m: u32, seconds: u32) -> String {
    format!(
        r#"{CAR}<vehicle id="blocker" type="car" depart="0"><route edges="ab bc"/><stop lane="bc_0" endPos="{at_m}" duration="{seconds}"/></vehicle>
        <vehicle id="ego" type="car" depart="30"><route edges="ab bc"/></vehicle>"#
    )
}

fn reason(row: &Row) -> (&str, &str) {
    (&row["reason"], &row["collisions"])
}

#[test]
fn every_action_at_a_collision_has_its_ending() {
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), &standing(100, 100));
    for version in [NEW, OLD] {
        for (action, ending, pairs, teleports) in [
            ("none", ("arrived", "0"), 0.0, 0.0),
            ("warn", ("arrived", "1"), 1.0, 0.0),
            ("teleport", ("teleported_out", "1"), 1.0, 1.0),
            ("remove", ("collided", "1"), 1.0, 0.0),
        ] {
            // Without brakes it drives into the other one.
            let args =
                ["--step-length", "0.5", "--end", "250", "--egos", "id:ego", "--set", "vehicle.brake_torque_max_nm=0"];
            let result = run(version, &config, &[&args[..], &["--", "--collision.action", action]].concat());
            let ego = result.vehicle("ego");
            assert_eq!(reason(&ego), ending, "SUMO {version}, {action}: {ego:?}");
            assert_eq!(ego["complete"], (ending.0 == "arrived").to_string(), "SUMO {version}, {action}");
            assert_eq!(
                (result.sumo("collisions"), result.sumo("teleports")),
                (pairs, teleports),
                "SUMO {version}, {action}"
            );
        }
    }
}

/// From the last edge of its route there is no way on: SUMO takes it out as arrived, and says so in its tripinfo only.
#[test]
fn a_teleport_beyond_the_end_of_the_route_is_no_arrival() {
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), &standing(500, 1000));
    for version in [NEW, OLD] {
        let args = ["--step-length", "0.5", "--end", "200", "--", "--time-to-teleport", "20"];
        let result = run(version, &config, &args);
        let ego = result.vehicle("ego");
        assert_eq!((ego["reason"].as_str(), ego["complete"].as_str()), ("teleported_out", "false"), "SUMO {version}");
        let trips = elements(&result.dir.join("sumo/tripinfo.xml"), "tripinfo");
        let trip = trips.iter().find(|trip| attribute(trip, "id") == "ego").unwrap();
        assert_eq!(attribute(trip, "vaporized"), "teleport", "SUMO {version}: the oracle");
        assert_eq!(result.vehicle("blocker")["reason"], "running", "SUMO {version}");
    }
}

/// A short edge that somebody fills, so slow that SUMO carries a vehicle across it for nine seconds; the state is saved
/// meanwhile.
#[test]
fn who_is_carried_when_we_come_is_an_ego_once_it_is_put_down() {
    let folder = tempfile::tempdir().unwrap();
    let node = |(id, x): (char, u32)| format!(r#"<node id="{id}" x="{x}" y="0"/>"#);
    let nodes: String = [('a', 0), ('b', 500), ('c', 520), ('d', 528), ('e', 1500)].into_iter().map(node).collect();
    let edge = |(from, to, speed): (char, char, f64)| {
        format!(r#"<edge id="{from}{to}" from="{from}" to="{to}" numLanes="1" speed="{speed}"/>"#)
    };
    let edges = [('a', 'b', 20.0), ('b', 'c', 20.0), ('c', 'd', 0.3), ('d', 'e', 20.0)].into_iter().map(edge);
    let net = network(folder.path(), &nodes, &edges.collect::<String>());
    let demand = format!(
        r#"{CAR}<vehicle id="blocker" type="car" depart="0"><route edges="cd de"/><stop lane="cd_0" endPos="7" duration="300"/></vehicle>
        <vehicle id="ego" type="car" depart="5"><route edges="ab bc cd de"/></vehicle>"#
    );
    let config = configuration(folder.path(), &net, &demand, "");
    let text = |path: &Path| path.to_str().unwrap().to_owned();
    for version in [NEW, OLD] {
        let state = folder.path().join(format!("{version}.xml"));
        let mut args = ["-c", &text(&config), "--end", "53", "--step-length", "0.5"].map(str::to_owned).to_vec();
        let saving = ["--time-to-teleport", "10", "--save-state.times", "52", "--save-state.files", &text(&state)];
        args.extend(saving.map(str::to_owned));
        plain_sumo(version, &args);
        assert!(fs::read_to_string(&state).unwrap().contains("<vehicleTransfer id=\"ego\""), "SUMO {version}");
        let options = ["--load-state", &text(&state), "--begin", "52", "--time-to-teleport", "10"];
        let result = run(version, &config, &[&["--step-length", "0.5", "--end", "200", "--"][..], &options].concat());
        let ego = result.vehicle("ego");
        assert_eq!(ego["reason"], "arrived", "SUMO {version}: {ego:?}");
        assert!(
            (800.0..970.0).contains(&number(&ego, "distance")),
            "SUMO {version}: from where it was put down: {ego:?}"
        );
        assert!(number(&ego, "odometer_gap").abs() < 1.0, "SUMO {version}: {ego:?}");
    }
}

/// A turn to the left and one to the right, as the rule of the road has them.
fn crossing(folder: &Path, rule: &[&str]) -> PathBuf {
    let node = |(id, x, y): (&str, i32, i32)| format!(r#"<node id="{id}" x="{x}" y="{y}"/>"#);
    let nodes = [("s", 0, -200), ("m", 0, 0), ("w", -300, 0), ("e", 300, 0), ("n", 0, 200)].map(node).concat();
    let edge = |(id, from, to): (&str, &str, &str)| {
        format!(r#"<edge id="{id}" from="{from}" to="{to}" numLanes="2" speed="14"/>"#)
    };
    let edges = [("in", "s", "m"), ("left", "m", "w"), ("right", "m", "e"), ("ahead", "m", "n"), ("back", "n", "m")]
        .map(edge)
        .concat();
    let write = |name: &str, text: String| {
        fs::write(folder.join(name), text).unwrap();
        folder.join(name)
    };
    let home = sumo_home(OLD);
    let net = folder.join("crossing.net.xml");
    let mut command = std::process::Command::new(home.join("bin/netconvert"));
    command.env("SUMO_HOME", &home).args(["--no-warnings"]).args(rule);
    command.arg("-n").arg(write("c.nod.xml", format!("<nodes>{nodes}</nodes>")));
    command.arg("-e").arg(write("c.edg.xml", format!("<edges>{edges}</edges>"))).arg("-o").arg(&net);
    assert!(command.output().unwrap().status.success());
    let trip = |(id, to, depart): (&str, &str, u32)| {
        format!(
            r#"<vehicle id="{id}" type="car" depart="{depart}" departLane="best"><route edges="in {to}"/></vehicle>"#
        )
    };
    let trips = [("left", "left", 0), ("right", "right", 20), ("ahead", "ahead", 40)].map(trip).concat();
    let oncoming = r#"<flow id="oncoming" type="car" begin="0" end="60" period="6"><route edges="back left"/></flow>"#;
    configuration(folder, &net, &format!("{CAR}{oncoming}{trips}"), "")
}

/// Yaw rates of a vehicle while it turns, their mean [rad/s].
fn turned(trace: &[Row], id: &str) -> f64 {
    let rates = trace.iter().filter(|row| row["id"] == id).map(|row| number(row, "yaw_rate"));
    let rates: Vec<f64> = rates.filter(|rate| rate.abs() > 0.02).collect();
    rates.iter().sum::<f64>() / rates.len().max(1) as f64
}

#[test]
fn left_hand_traffic_turns_the_way_it_turns() {
    for version in [NEW, OLD] {
        let mut times = Vec::new();
        for rule in [&["--lefthand", "true"][..], &[]] {
            let folder = tempfile::tempdir().unwrap();
            let config = crossing(folder.path(), rule);
            assert_eq!(
                fs::read_to_string(folder.path().join("crossing.net.xml")).unwrap().contains("lefthand=\"true\""),
                !rule.is_empty()
            );
            let result = run(version, &config, &["--end", "150", "--trace", "all"]);
            assert_eq!(result.sumo("collisions"), 0.0, "SUMO {version}, {rule:?}");
            assert!(result.vehicles().iter().all(|row| row["reason"] == "arrived"), "SUMO {version}, {rule:?}");
            let trace = result.table("trace.csv");
            let [left, right, ahead] = ["left", "right", "ahead"].map(|id| turned(&trace, id));
            assert!(left > 0.05 && right < -0.05, "SUMO {version}, {rule:?}: {left} and {right} rad/s");
            assert!(ahead.abs() < 0.05, "SUMO {version}, {rule:?}: {ahead} rad/s");
            times.push(number(&result.vehicle("left"), "duration"));
        }
        // On the left, a turn to the left crosses nobody.
        assert!(times[0] < times[1], "SUMO {version}: {times:?}");
    }
}

/// In the sublane model vehicles keep to no lane. Bodies change the traffic no more than elsewhere.
#[test]
fn the_sublane_model_keeps_its_traffic() {
    for version in [NEW, OLD] {
        let drive = |controller: &str| {
            let args = ["--end", "120", "--controller", controller, "--", "--lateral-resolution", "0.8"];
            run(version, &own("city"), &args)
        };
        let (ours, ideal) = (drive("adaptive"), drive("ideal"));
        let driven_m = |result: &Outcome| result.vehicles().iter().map(|row| number(row, "distance")).sum::<f64>();
        let [ours_m, ideal_m] = [&ours, &ideal].map(driven_m);
        assert!(
            ideal_m > 50_000.0 && (ours_m / ideal_m - 1.0).abs() < 0.02,
            "SUMO {version}: {ours_m} and {ideal_m} m"
        );
        assert_eq!(ours.sumo("collisions"), ideal.sumo("collisions"), "SUMO {version}");
        let errors = ours.vehicles().into_iter().filter(|row| !row["error_rms"].is_empty());
        let worst = errors.map(|row| number(&row, "error_rms")).fold(0.0, f64::max);
        assert!(worst < 0.3, "SUMO {version}: {worst} m/s");
    }
}

/// Drivers that decide once a second in steps of a tenth of one: they brake for a standing vehicle and go on behind it.
#[test]
fn drivers_that_decide_rarely_stop_in_time() {
    let folder = tempfile::tempdir().unwrap();
    let rarely = CAR.replace("/>", r#" actionStepLength="1"/>"#);
    let config = straight_road(folder.path(), &standing(100, 60).replace(CAR, &rarely));
    for version in [NEW, OLD] {
        let drive = |controller: &str| {
            let result = run(version, &config, &["--end", "300", "--controller", controller]);
            assert_eq!(result.sumo("collisions"), 0.0, "SUMO {version}, {controller}");
            assert!(!result.ended.stderr.contains("implausible"), "{}", result.ended.stderr);
            let ego = result.vehicle("ego");
            assert_eq!(ego["reason"], "arrived", "SUMO {version}, {controller}");
            number(&ego, "duration")
        };
        let (ours, ideal) = (drive("adaptive"), drive("ideal"));
        assert!((ours - ideal).abs() < 3.0, "SUMO {version}: {ours} s, without a body {ideal} s");
    }
}

/// A state that SUMO saves during a run of ours lies in the result, and plain SUMO goes on from it.
#[test]
fn a_state_that_is_saved_among_egos_can_be_loaded() {
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), &standing(100, 60));
    for version in [NEW, OLD] {
        let state = folder.path().join(format!("{version}.xml"));
        let state_text = state.to_str().unwrap();
        let saving = ["--save-state.times", "60", "--save-state.files", state_text];
        let result = run(version, &config, &[&["--step-length", "0.5", "--end", "250", "--"][..], &saving].concat());
        assert!(result.vehicles().iter().all(|row| row["reason"] == "arrived"), "SUMO {version}");
        let trips = folder.path().join("trips.xml");
        let [config, trips_text] = [&config, &trips].map(|path| path.to_str().unwrap());
        let args = ["-c", config, "--load-state", state_text, "--begin", "60", "--end", "250", "--step-length", "0.5"];
        plain_sumo(version, &[&args[..], &["--tripinfo-output", trips_text]].concat());
        let arrivals: Vec<f64> =
            elements(&trips, "tripinfo").iter().map(|t| attribute(t, "arrival").parse().unwrap()).collect();
        let mut ours: Vec<f64> = result.vehicles().iter().map(|row| number(row, "arrival")).collect();
        ours.sort_by(f64::total_cmp);
        assert_eq!(arrivals.len(), 2, "SUMO {version}");
        assert!(
            arrivals.iter().zip(&ours).all(|(theirs, ours)| (theirs - ours).abs() < 15.0),
            "SUMO {version}: {arrivals:?} {ours:?}"
        );
    }
}

/// One id of every kind of text. Those that SUMO takes become egos, or, if they are too long to be asked about, stay SUMO's
/// own and are told. Those that SUMO does not take end the run in its words.
#[test]
fn ids_of_every_kind_of_text_are_driven_or_told() {
    let driven = [
        "plain_id.0",
        "Grüße-Ñandú",
        "東京の車",
        "😀🚗",
        "e\u{301}a\u{308}",
        "\u{5d0}\u{5d1}\u{202e}\u{627}\u{200f}",
        "zero\u{200b}width\u{feff}",
    ];
    let long = ["x".repeat(250), "ä".repeat(125), "😀".repeat(62) + "zz"];
    assert!(long.iter().all(|id| id.len() == 250));
    let vehicle = |(i, id): (usize, &str)| {
        format!(r#"<vehicle id="{id}" type="car" depart="{}"><route edges="ab bc"/></vehicle>"#, 4 * i)
    };
    let all: Vec<&str> = driven.iter().copied().chain(long.iter().map(String::as_str)).collect();
    let demand: String = all.iter().copied().enumerate().map(vehicle).collect();
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), &format!("{CAR}{demand}"));
    for version in [NEW, OLD] {
        let result = run(version, &config, &["--step-length", "1", "--trace", "all"]);
        let rows = result.vehicles();
        let found: Vec<&str> = rows.iter().map(|row| row["id"].as_str()).collect();
        assert_eq!(found, driven, "SUMO {version}");
        assert!(rows.iter().all(|row| row["reason"] == "arrived"), "SUMO {version}");
        assert!(result.ended.stderr.contains("3 vehicles cannot be egos; the first, \"xxx"), "{}", result.ended.stderr);
        assert_eq!(result.sumo("arrived"), all.len() as f64, "SUMO {version} was there to the end");
        assert!(
            driven.iter().all(|id| result.table("trace.csv").iter().any(|row| row["id"] == **id)),
            "SUMO {version}"
        );
    }
    for (written, id) in
        [("a&amp;b", "a&b"), ("q&quot;q", "q\"q"), ("q&apos;q", "q'q"), ("a&lt;b", "a<b"), ("a b", "a b")]
    {
        let config = straight_road(folder.path(), &format!("{CAR}{}", vehicle((0, written))));
        for version in [NEW, OLD] {
            let said = refusal(version, &config, &["--step-length", "1"]);
            assert!(said.contains(&format!("nvalid vehicle id '{id}'")), "SUMO {version}: {said}");
        }
    }
}

/// Legal settings, and nothing breaks off; what no car does is told in one line with vehicle, time and quantity.
#[test]
fn what_no_car_does_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), &standing(100, 1000));
    let said = |args: &[&str]| {
        let result = run(NEW, &config, &[&["--end", "150", "--egos", "id:ego"], args].concat());
        let lines =
            result.ended.stderr.lines().filter(|line| line.contains("implausible") || line.contains("diverged"));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    let brakeless = ["--set", "vehicle.brake_torque_max_nm=0", "--", "--collision.action", "none"];
    let lines = said(&brakeless);
    assert!(
        lines.iter().any(|line| line.contains("1 egos hardly braked; the worst, \"ego\" up to")
            && line.contains("asked to brake for")),
        "{lines:?}"
    );
    let far = ["--target", "profile", "--set", "target.shape=step", "--set", "target.step_speeds_mps=\"180, 180\""];
    let [line] = said(&far).try_into().unwrap();
    let said_so = "1 egos had a speed error of more than 100 m/s; the worst, \"ego\" at ";
    assert!(line.contains(said_so) && line.ends_with(" s: -179.6 m/s"), "{line}");
    let rocket = ["--target", "limit", "--set", "vehicle.drive_torque_max_nm=1000000", "--set", "vehicle.friction=2"];
    let wild = [
        "--set",
        "vehicle.mass_kg=50",
        "--set",
        "noise.power_db=60",
        "--set",
        "controller.k_p=1000",
        "--step-length",
        "1",
    ];
    let lines = said(&[&rocket[..], &wild].concat());
    let first = |line: &&String| line.contains("1 egos diverged") && line.contains("the first, \"ego\" at ");
    assert!(lines.iter().find(first).is_some_and(|line| line.contains(" s: V_x = 2")), "{lines:?}");
    assert_eq!(said(&[]), [""; 0]);
}
