//! Every file of a result has the same bytes whichever way SUMO was reached.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use sumo_mfc::control::CONTROLLERS;

use super::support::{CAR, NEW, Running, foreign, own, repository, run_command, straight_road};

/// The files of a result, by name, without what tells times of day and of computing.
fn files(dir: &Path) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let mut folders = vec![dir.to_owned()];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(dir).unwrap().display().to_string();
            let text = String::from_utf8_lossy(&fs::read(&path).unwrap()).into_owned();
            found.insert(name.clone(), without_times(&name, &text));
        }
    }
    found
}

fn without_times(name: &str, text: &str) -> String {
    // SUMO's outputs begin with a comment of when and how they were made.
    let text = match (name.ends_with(".xml"), text.split_once("<!--"), text.split_once("-->")) {
        (true, Some((before, _)), Some((_, after))) => format!("{before}{after}"),
        _ => text.to_owned(),
    };
    let timed = |line: &&str| match name {
        "summary.json" => line.contains("\"wall_s\"") || line.contains("\"real_time_factor\""),
        "sumo/statistics.xml" => line.contains("<performance "),
        "sumo/console.log" => true,
        // Loading takes so many milliseconds, and the server has a port; warnings are the same.
        _ if name.ends_with("log") => !line.starts_with("Warning"),
        _ => false,
    };
    text.lines().filter(|line| !timed(line)).map(|line| format!("{line}\n")).collect()
}

/// Runs a scenario both ways, in a folder of the same name, and compares.
fn compare(scenario: &Path, args: &[&str]) -> BTreeMap<String, String> {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("result");
    let result = |backend: &str| {
        let mut command = run_command(NEW, scenario, &dir, &["--backend", backend, "--no-report", "-q"]);
        command.args(args);
        let ended = Running::start(command).wait();
        assert_eq!(ended.code, Some(0), "{backend}, {}, {args:?}:\n{}", scenario.display(), ended.stderr);
        let found = files(&dir);
        fs::remove_dir_all(&dir).unwrap();
        found
    };
    let (traci, libsumo) = (result("traci"), result("libsumo"));
    let names = |files: &BTreeMap<String, String>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&traci), names(&libsumo), "{} {args:?}", scenario.display());
    for (name, text) in &traci {
        let first = text.lines().zip(libsumo[name].lines()).find(|(a, b)| a != b);
        assert!(text == &libsumo[name], "{} {args:?}: {name} differs: {first:?}", scenario.display());
    }
    for name in ["vehicles.csv", "edges.csv", "sample.csv", "schema.json", "summary.json", "run.json"] {
        assert!(traci[name].len() > 10, "{name} is empty");
    }
    traci
}

/// Every controller on four networks, one of them geographic, one with steps of a second.
#[test]
fn law_every_controller_on_four_networks() {
    for controller in CONTROLLERS.iter().map(|entry| entry.name) {
        let of = |scenario: PathBuf, args: &[&str]| {
            let files = compare(&scenario, &[&["--controller", controller, "--trace", "all"], args].concat());
            assert!(files["trace.csv"].lines().count() > 500, "{}", scenario.display());
        };
        of(repository("scenarios/city.toml"), &["--end", "120"]);
        of(repository("scenarios/motorway.toml"), &["--end", "60"]);
        of(foreign("cologne1"), &["--end", "25300"]);
        of(foreign("ingolstadt21"), &["--end", "57700", "--step-length", "1"]);
    }
}

/// Whatever else is asked of SUMO or told to it.
#[test]
fn law_everything_that_is_asked_and_told() {
    let traced = ["--trace", "all"];
    for (scenario, args) in [
        // The body leads: speed mode, factor, limits, who is ahead.
        (own("city"), &["--target", "limit", "--end", "120"][..]),
        (own("city"), &["--target", "path_cacc", "--end", "120"]),
        (repository("scenarios/racing.toml"), &["--end", "40"]),
        (repository("scenarios/sine.toml"), &["--end", "30"]),
        // Parameters, SUMO's own measurements, imperfection, headway, leaders.
        (own("city"), &["--fcd", "--safety", "--end", "100"]),
        (own("city"), &["--set", "traffic.sigma=0.3", "--set", "actuator.delay_s=0.25", "--end", "100"]),
        (own("city"), &["--set", "actuator.delay_s=0.25", "--set", "traffic.headway_margin_s=auto", "--end", "100"]),
        (own("city"), &["--set", "output.platoons=true", "--set", "output.quality=true", "--end", "100"]),
        (own("city"), &["--set", "coupling.grade=true", "--set", "coupling.friction=true", "--end", "100"]),
        (own("city"), &["--egos", "share:0.5", "--step-length", "0.05", "--end", "60"]),
        // Teleports and collisions.
        (own("city"), &["--end", "200", "--", "--time-to-teleport", "5"]),
        (own("city"), &["--end", "200", "--set", "sumo.contacts=false"]),
    ] {
        let args = if args.contains(&"--fcd") { args.to_vec() } else { [&traced, args].concat() };
        compare(&scenario, &args);
    }
}

/// Vehicles of all kinds: ids of any alphabet and length, routes of one step, stops, types that are no cars, own laws of
/// following; and vehicles that touch.
#[test]
fn law_all_kinds_of_vehicles() {
    let folder = tempfile::tempdir().unwrap();
    let mut demand = String::from(CAR);
    for class in ["passenger", "bus", "truck", "bicycle", "rail"] {
        let beyond = if class == "rail" { "" } else { r#" carFollowModel="IDM""# };
        demand += &format!(
            r#"<vType id="{class}" vClass="{class}"{beyond}><param key="has.mfc.device" value="true"/></vType>"#
        );
    }
    let names = ["Größe-Ω-車", "a.b-c_d#1(e)", &"y".repeat(160), &"x".repeat(200)];
    for (index, name) in names.iter().enumerate() {
        demand +=
            &format!(r#"<vehicle id="{name}" type="car" depart="{}"><route edges="ab bc"/></vehicle>"#, 5 * index);
    }
    demand += r#"<vehicle id="stops" type="car" depart="30"><route edges="ab bc"/><stop lane="ab_0" endPos="500" duration="40"/></vehicle>"#;
    demand += r#"<vehicle id="short" type="car" depart="35" departPos="990" departSpeed="max" arrivalPos="991"><route edges="ab"/></vehicle>"#;
    for (index, class) in ["passenger", "bus", "truck", "bicycle"].iter().enumerate() {
        let depart = 40 + 5 * index;
        demand += &format!(
            r#"<vehicle id="{class}" type="{class}" depart="{depart}"><route edges="ab bc"/><param key="mfc.controller.k_p" value="2"/></vehicle>"#
        );
    }
    let config = straight_road(folder.path(), &demand);
    let files = compare(&config, &["--trace", "all", "--controller", "classic"]);
    assert!(files["vehicles.csv"].contains("車") && files["vehicles.csv"].contains("stops"));

    // A car that brakes late comes nearer than its minGap, which SUMO counts as a collision if it is told to.
    let folder = tempfile::tempdir().unwrap();
    let demand = format!(
        r#"{CAR}<vehicle id="first" type="car" depart="0" departPos="400"><route edges="ab bc"/><stop lane="ab_0" endPos="700" duration="60"/></vehicle>
        <vehicle id="ego" type="car" depart="0" departPos="0" departSpeed="20"><route edges="ab bc"/></vehicle>"#
    );
    let config = straight_road(folder.path(), &demand);
    let late = ["--controller", "pid", "--set", "actuator.delay_s=0.4", "--end", "120"];
    let files = compare(&config, &[&late[..], &["--", "--collision.mingap-factor", "1"]].concat());
    let safety = files["sumo/statistics.xml"].lines().find(|line| line.contains("<safety ")).unwrap();
    assert!(!safety.contains("collisions=\"0\""), "nobody touches: {safety}");
}
