//! How a run in this process ends when it does not come to its end.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use super::here;
use super::support::{
    CAR, NEW, Running, children, configuration, json, own, program, refusal, run_command, straight_road, table,
};

fn send(signal: &str, pid: u32) {
    assert!(Command::new("kill").args([signal, &pid.to_string()]).status().unwrap().success());
}

fn lines(path: &Path) -> usize {
    fs::read_to_string(path).map_or(0, |text| text.lines().count())
}

/// Starts a run of the city and waits until so many vehicles have left.
fn under_way(dir: &Path, left: usize) -> Running {
    let args = here(&["--quiet", "--trace", "all", "--step-length", "0.05"]);
    let own = run_command(NEW, &own("city"), dir, &args);
    // These tests may have been started with SIGHUP ignored.
    let mut command = Command::new("env");
    command.arg("--default-signal=HUP").arg(own.get_program()).args(own.get_args());
    command.envs(own.get_envs().filter_map(|(key, value)| Some((key, value?))));
    let run = Running::start(command);
    let deadline = Instant::now() + Duration::from_secs(120);
    while lines(&dir.join("vehicles.csv.part")) < left {
        assert!(Instant::now() < deadline, "no vehicle leaves");
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(children(run.child.id()).is_empty(), "SUMO is in this process");
    run
}

/// A crash of SUMO is one of the program. The rows of vehicles that had left are on disk, and become tables.
#[test]
fn rows_of_vehicles_that_have_left_survive_a_crash() {
    for signal in ["-SEGV", "-ABRT"] {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("result");
        let run = under_way(&dir, 20);
        send(signal, run.child.id());
        if signal == "-SEGV" {
            // Rust hears the first one, and lets the access that has caused it happen again; a signal of ours does not.
            std::thread::sleep(Duration::from_millis(100));
            send(signal, run.child.id());
        }
        assert_eq!(run.wait().code, None, "{signal}: ended by the signal");
        let noted = lines(&dir.join("vehicles.csv.part"));
        let mut recover = program(NEW);
        recover.arg("recover").arg(&dir);
        let ended = Running::start(recover).wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let rows = table(&dir.join("vehicles.csv"));
        // The header is no row, and the last line may be broken off.
        assert!(rows.len() + 2 >= noted && noted >= 20, "{} rows of {noted} lines", rows.len());
        assert!(table(&dir.join("trace.csv")).len() > 1000);
        assert_eq!(json(&dir.join("run.json"))["status"], "incomplete");
    }
}

/// Signals end a run in order, as over TraCI, with SUMO's own outputs whole.
#[test]
fn signals_end_a_run_in_order() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("result");
        let run = under_way(&dir, 5);
        send(signal, run.child.id());
        let ended = run.wait();
        assert_eq!(ended.code, Some(code), "{signal}: {}", ended.stderr);
        assert_eq!(json(&dir.join("run.json"))["status"], "incomplete");
        assert!(table(&dir.join("vehicles.csv")).len() >= 5);
        let trips = fs::read_to_string(dir.join("sumo/tripinfo.xml")).unwrap();
        assert!(trips.trim_end().ends_with("</tripinfos>"), "SUMO's outputs break off");
    }
}

/// A signal that comes while SUMO loads is not kept waiting.
#[test]
fn a_signal_while_sumo_loads_ends_it() {
    let folder = tempfile::tempdir().unwrap();
    // Nobody ever reads it, so that SUMO waits for ever until it can open it.
    let pipe = folder.path().join("fcd.xml");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let dir = folder.path().join("result");
    let mut command = run_command(NEW, &own("light"), &dir, &here(&["--quiet"]));
    command.args(["--", "--fcd-output"]).arg(&pipe);
    let run = Running::start(command);
    let deadline = Instant::now() + Duration::from_secs(60);
    while !dir.join("sumo/console.log").exists() {
        assert!(Instant::now() < deadline, "SUMO is not loaded");
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_secs(1));
    send("-TERM", run.child.id());
    let (sent, ended) = (Instant::now(), run.wait());
    assert_eq!(ended.code, Some(143), "{}", ended.stderr);
    assert!(sent.elapsed() < Duration::from_secs(10), "it waited for SUMO");
    let manifest = json(&dir.join("run.json"));
    assert_eq!(manifest["status"], "incomplete", "{manifest}");
}

/// What SUMO has against its inputs is said as over TraCI, when it loads and on the way.
#[test]
fn errors_of_sumo_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let nowhere = configuration(folder.path(), Path::new("nowhere.net.xml"), CAR, "");
    let one_line =
        |text: &str| text.replace("exit status: 1", "in this process").replace("in process", "in this process");
    let (here_said, traci_said) =
        (refusal(NEW, &nowhere, &here(&["--end", "5"])), refusal(NEW, &nowhere, &["--end", "5"]));
    assert!(here_said.contains("nowhere.net.xml"), "{here_said}");
    assert_eq!(one_line(&here_said), one_line(&traci_said));

    let broken = tempfile::tempdir().unwrap();
    let demand = format!(
        r#"{CAR}<vehicle id="good" type="car" depart="0" arrivalPos="100"><route edges="ab"/></vehicle><vehicle id="later" type="car" depart="590"><route edges="ab"/></vehicle><vehicle id="bad" type="car" depart="600"><route edges="ab nowhere"/></vehicle>"#
    );
    let config = straight_road(broken.path(), &demand);
    let dir = broken.path().join("result");
    let mut command = run_command(NEW, &config, &dir, &here(&["--end", "900"]));
    command.args(["--", "--route-steps", "100"]);
    let ended = Running::start(command).wait();
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("nowhere") && ended.stderr.contains("broke off at"), "{}", ended.stderr);
    assert_eq!(table(&dir.join("vehicles.csv")).len(), 1);
    assert_eq!(json(&dir.join("run.json"))["status"], "incomplete");
}
