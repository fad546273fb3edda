//! What goes wrong around a run: the message says what, nothing that was computed is lost, no SUMO stays behind.

use crate::support::{
    CAR, NEW, OLD, Running, TOO_OLD, children, configuration, json, own, refusal, repository, run, run_command, stays,
    straight_road, table,
};
use std::fs;
use std::net::TcpListener;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

#[test]
fn a_network_that_sumo_rejects_is_reported_in_sumos_words() {
    let folder = tempfile::tempdir().unwrap();
    let net = folder.path().join("made.net.xml");
    let text = fs::read_to_string(repository("sumo_nets/light/light.net.xml")).unwrap();
    fs::write(&net, text.replace("from=\"a\"", "from=\"nowhere\"")).unwrap();
    let demand = format!(r#"{CAR}<vehicle id="ego" type="car" depart="0"><route edges="before after"/></vehicle>"#);
    let config = configuration(folder.path(), &net, &demand, "");
    for version in [NEW, OLD] {
        let said = refusal(version, &config, &[]);
        assert!(said.contains("nowhere") && said.contains("before"), "{said}");
    }
}

#[test]
fn a_bad_route_breaks_the_run_off_in_sumos_words() {
    let folder = tempfile::tempdir().unwrap();
    let good = r#"<vehicle id="good" type="car" depart="0"><route edges="ab bc"/></vehicle>"#;
    // SUMO reads routes as they are needed: the bad one is met on the way.
    let between = r#"<vehicle id="between" type="car" depart="400"><route edges="ab bc"/></vehicle>"#;
    let bad = r#"<vehicle id="bad" type="car" depart="600"><route edges="ab nowhere"/></vehicle>"#;
    let config = straight_road(folder.path(), &format!("{CAR}{good}{between}{bad}"));
    let dir = folder.path().join("result");
    let ended = Running::start(run_command(NEW, &config, &dir, &["--step-length", "1"])).wait();
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("nowhere"), "{}", ended.stderr);
    let rows = table(&dir.join("vehicles.csv"));
    assert_eq!((rows[0]["id"].as_str(), rows[0]["reason"].as_str()), ("good", "arrived"));
    assert_eq!(json(&dir.join("run.json"))["status"], "incomplete");
}

#[test]
fn a_port_in_use_is_named() {
    let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let port = listener.local_addr().unwrap().port().to_string();
    let said = refusal(NEW, &own("light"), &["--port", &port]);
    assert!(said.contains(&port) && said.contains("in use"), "{said}");
}

#[test]
fn nobody_listening_is_said_at_once() {
    let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let address = format!("127.0.0.1:{}", listener.local_addr().unwrap().port());
    drop(listener);
    let begun = Instant::now();
    let said = refusal(NEW, &own("light"), &["--connect", &address]);
    assert!(said.contains(&address), "{said}");
    assert!(begun.elapsed() < Duration::from_secs(30), "{:?}", begun.elapsed());
}

#[test]
fn a_sumo_that_is_too_old_is_refused() {
    let said = refusal(TOO_OLD, &own("light"), &[]);
    assert!(said.contains("1.14.1") && said.contains("1.15"), "{said}");
}

#[test]
fn a_run_without_a_single_departure_ends_well() {
    let folder = tempfile::tempdir().unwrap();
    let late = r#"<vehicle id="late" type="car" depart="500"><route edges="ab bc"/></vehicle>"#;
    let config = straight_road(folder.path(), &format!("{CAR}{late}"));
    let result = run(NEW, &config, &["--end", "20"]);
    assert!(result.vehicles().is_empty());
    assert_eq!(result.json("run.json")["status"], "complete");
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let ended = Running::start(run_command(NEW, &own("light"), &file.join("result"), &[])).wait();
    assert_eq!(ended.code, Some(1));
    assert!(ended.stderr.contains("file"), "{}", ended.stderr);
}

fn send(signal: &str, pid: u32) {
    assert!(Command::new("kill").args([signal, &pid.to_string()]).status().unwrap().success());
}

/// Starts a run of the city and waits until it is well under way. Returns it and its SUMO.
fn under_way(dir: &Path) -> (Running, u32) {
    let mut command = run_command(NEW, &own("city"), dir, &["--trace", "all", "--step-length", "0.05"]);
    command.arg("--quiet");
    until_under_way(command, dir)
}

fn until_under_way(command: Command, dir: &Path) -> (Running, u32) {
    let run = Running::start(command);
    let deadline = Instant::now() + Duration::from_secs(60);
    while fs::metadata(dir.join("trace.csv.part")).map_or(0, |meta| meta.len()) < 100_000 {
        assert!(Instant::now() < deadline, "the run does not get under way");
        std::thread::sleep(Duration::from_millis(10));
    }
    let sumo = children(run.child.id());
    assert_eq!(sumo.len(), 1, "SUMO is the only child: {sumo:?}");
    (run, sumo[0])
}

/// All files whole, and the result says that it is not complete.
fn is_kept_but_incomplete(dir: &Path) {
    let rows = table(&dir.join("vehicles.csv"));
    assert!(rows.len() > 3, "{} rows", rows.len());
    assert!(table(&dir.join("trace.csv")).len() > 100);
    let manifest = json(&dir.join("run.json"));
    assert_eq!(manifest["status"], "incomplete");
    assert!(manifest["reason"].as_str().is_some_and(|r| !r.is_empty()), "{manifest}");
    json(&dir.join("summary.json"));
    let left = fs::read_dir(dir).unwrap().flatten().filter(|e| e.path().extension().is_some_and(|x| x == "part"));
    assert_eq!(left.count(), 0, "files left as .part");
}

#[test]
fn a_sumo_that_is_killed_leaves_a_result_marked_incomplete() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("result");
    let (run, sumo) = under_way(&dir);
    send("-KILL", sumo);
    let ended = run.wait();
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("incomplete") && ended.stderr.contains("SUMO"), "{}", ended.stderr);
    is_kept_but_incomplete(&dir);
    assert!(table(&dir.join("vehicles.csv")).iter().any(|row| row["reason"] == "incomplete"));
}

#[test]
fn signals_end_a_run_in_order() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129), ("-QUIT", 131)] {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("result");
        // These tests may have been started with SIGHUP ignored.
        let own = run_command(NEW, &own("city"), &dir, &["--trace", "all", "--step-length", "0.05", "--quiet"]);
        let mut command = Command::new("env");
        command.arg("--default-signal=HUP").arg(own.get_program()).args(own.get_args());
        command.envs(own.get_envs().filter_map(|(key, value)| Some((key, value?))));
        let (run, sumo) = until_under_way(command, &dir);
        send(signal, run.child.id());
        let ended = run.wait();
        assert_eq!(ended.code, Some(code), "{}", ended.stderr);
        is_kept_but_incomplete(&dir);
        assert!(!stays(sumo), "SUMO outlives {signal}");
    }
}

#[test]
fn who_was_started_by_nohup_does_not_hear_the_terminal_go() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("result");
    let own = run_command(NEW, &own("city"), &dir, &["--trace", "all", "--step-length", "0.05", "--quiet"]);
    let mut command = Command::new("nohup");
    command.arg(own.get_program()).args(own.get_args());
    command.envs(own.get_envs().filter_map(|(key, value)| Some((key, value?))));
    let (mut run, _) = until_under_way(command, &dir);
    send("-HUP", run.child.id());
    std::thread::sleep(Duration::from_secs(1));
    assert!(run.child.try_wait().unwrap().is_none(), "it has ended");
    send("-TERM", run.child.id());
    assert_eq!(run.wait().code, Some(143));
}

/// A signal while SUMO is waiting for other clients.
#[test]
fn a_signal_ends_the_wait_for_sumo() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("result");
    let run = Running::start(run_command(NEW, &own("light"), &dir, &["--num-clients", "2"]));
    let deadline = Instant::now() + Duration::from_secs(30);
    let sumo = loop {
        if let Some(sumo) = children(run.child.id()).first() {
            break *sumo;
        }
        assert!(Instant::now() < deadline, "SUMO does not start");
        std::thread::sleep(Duration::from_millis(10));
    };
    std::thread::sleep(Duration::from_millis(300));
    send("-INT", run.child.id());
    let ended = run.wait();
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);
    assert!(!stays(sumo), "SUMO is still there");
    assert_eq!(json(&dir.join("run.json"))["status"], "incomplete");
}

/// A limit on the size of files stands for a full disk.
#[test]
fn a_full_disk_is_reported_and_the_rest_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("result");
    let inner = run_command(NEW, &own("city"), &dir, &["--trace", "all", "--end", "200"]);
    let mut command = Command::new("bash");
    command.arg("-c").arg("trap '' XFSZ; ulimit -f 2000; exec \"$@\"").arg("bash").arg(inner.get_program());
    command.args(inner.get_args()).envs(inner.get_envs().filter_map(|(key, value)| Some((key, value?))));
    let ended = Running::start(command).wait();
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("trace.csv") && ended.stderr.contains("too large"), "{}", ended.stderr);
    let manifest = json(&dir.join("run.json"));
    assert_eq!(manifest["status"], "incomplete");
    assert!(manifest["reason"].as_str().unwrap().contains("trace.csv"), "{manifest}");
    assert!(table(&dir.join("vehicles.csv")).len() > 3);
    assert!(!dir.join("trace.csv").exists(), "a file with its name is whole");
}
