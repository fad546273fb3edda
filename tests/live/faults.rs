//! What goes wrong around a run: the message says what, nothing that was computed is lost, no SUMO stays behind.

use crate::support::{
    CAR, NEW, OLD, Running, SmallDisk, TOO_OLD, children, configuration, json, naming, number, own, program, refusal,
    repository, run, run_command, stays, straight_road, table,
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

#[test]
fn a_folder_that_sumo_takes_for_an_address_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let ended = Running::start(run_command(NEW, &own("light"), &folder.path().join("12:30/result"), &[])).wait();
    assert_eq!(ended.code, Some(1));
    let said = ended.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("12:30/result/sumo") && said.contains("for a network address"), "{said}");
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
    command.arg("-c").arg("ulimit -f 2000; exec \"$@\"").arg("bash").arg(inner.get_program());
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

/// A SUMO that hangs is waited for, but not in silence, and not longer than the user wants.
#[test]
fn a_sumo_that_hangs_is_told_and_can_be_given_up() {
    for (signal, timeout) in [(true, "600"), (false, "12")] {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("result");
        let args = ["--trace", "all", "--step-length", "0.05", "--timeout", timeout];
        let (run, sumo) = until_under_way(run_command(NEW, &own("city"), &dir, &args), &dir);
        send("-STOP", sumo);
        let begun = Instant::now();
        if signal {
            std::thread::sleep(Duration::from_secs(11));
            send("-TERM", run.child.id());
        }
        let ended = run.wait();
        assert!(begun.elapsed() < Duration::from_secs(25), "{:?}", begun.elapsed());
        assert_eq!(ended.code, Some(if signal { 143 } else { 1 }), "{}", ended.stderr);
        assert!(ended.stderr.contains("SUMO has not answered for 10 s"), "{}", ended.stderr);
        is_kept_but_incomplete(&dir);
        assert!(!stays(sumo));
    }
}

/// Who listens at the address that is to be joined need not be SUMO.
#[test]
fn a_server_that_is_no_sumo_is_given_up() {
    use std::io::{Read, Write};
    let folder = tempfile::tempdir().unwrap();
    let server = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let address = server.local_addr().unwrap().to_string();
    let join = |more: &[&str]| {
        let args = [&["--connect", address.as_str()], more].concat();
        Running::start(run_command(NEW, &own("light"), &folder.path().join("result"), &args))
    };
    // It never answers: a signal ends the wait, and so does the limit.
    let silent = join(&[]);
    let (connection, _) = server.accept().unwrap();
    std::thread::sleep(Duration::from_millis(300));
    send("-INT", silent.child.id());
    assert_eq!(silent.wait().code, Some(130));
    drop(connection);
    let limited = join(&["--timeout", "1"]);
    let (connection, _) = server.accept().unwrap();
    let ended = limited.wait();
    assert!(ended.code == Some(1) && ended.stderr.contains("did not answer within 1.0 s"), "{}", ended.stderr);
    drop(connection);
    // It announces two gigabytes.
    let flooded = join(&[]);
    let (mut connection, _) = server.accept().unwrap();
    connection.read_exact(&mut [0; 4]).unwrap();
    connection.write_all(&0x7fff_fff0_u32.to_be_bytes()).unwrap();
    let ended = flooded.wait();
    assert!(ended.code == Some(1) && ended.stderr.contains("frame length above 256 MiB"), "{}", ended.stderr);
}

/// Waits until so many vehicles have left.
fn until_rows(run: &mut Running, dir: &Path, rows: usize) {
    let deadline = Instant::now() + Duration::from_secs(60);
    let lines = || fs::read_to_string(dir.join("vehicles.csv.part")).map_or(0, |text| text.lines().count());
    while lines() <= rows {
        assert!(Instant::now() < deadline && run.child.try_wait().unwrap().is_none(), "the run does not get under way");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Columns that come from SUMO's own files at the end of a run.
const FROM_THE_END: [&str; 3] = ["arrival", "duration", "timeloss"];

/// Nothing can be done at SIGKILL; what was on disk by then is there, and becomes tables.
#[test]
fn rows_of_vehicles_that_have_left_survive_a_kill() {
    let whole = run(NEW, &own("city"), &["--end", "300"]);
    for name in ["vehicles.csv", "cars.parquet"] {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("result");
        let args = ["--end", "300", "--quiet", "--trace", "all", "--vehicles-output", name];
        let mut run = Running::start(run_command(NEW, &own("city"), &dir, &args));
        let deadline = Instant::now() + Duration::from_secs(60);
        let part = dir.join(format!("{name}.part"));
        while fs::read_to_string(&part).map_or(0, |text| text.lines().count()) < 20 {
            assert!(Instant::now() < deadline, "no vehicle leaves");
            std::thread::sleep(Duration::from_millis(10));
        }
        let recover = || {
            let mut command = program(NEW);
            command.arg("recover").arg(&dir);
            Running::start(command).wait()
        };
        let busy = recover();
        assert!(busy.code == Some(1) && busy.stderr.contains("another run is writing"), "{}", busy.stderr);
        run.child.kill().unwrap();
        run.child.wait().unwrap();
        let noted = fs::read_to_string(&part).unwrap();
        let ended = recover();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert!(ended.stdout.contains(&format!("{name} (")), "{}", ended.stdout);
        assert!(ended.stderr.contains("lost: edges.csv, sample.csv, summary.json"), "{}", ended.stderr);
        let manifest = json(&dir.join("run.json"));
        assert_eq!(manifest["status"], "incomplete");
        assert!(manifest["reason"].as_str().unwrap().contains("recovered"), "{manifest}");
        assert!(manifest["files"].as_array().unwrap().iter().any(|file| file == "quality.csv"));
        assert!(table(&dir.join("trace.csv")).len() > 1000);
        let again = recover();
        assert!(again.code == Some(1) && again.stderr.contains("nothing to recover"), "{}", again.stderr);
        assert!(!part.exists());
        if name.ends_with(".parquet") {
            assert!(fs::read(dir.join(name)).unwrap().starts_with(b"PAR1"));
            continue;
        }
        // The rows are those of the whole run, but for what only its end knows.
        let rows = table(&dir.join(name));
        assert_eq!(rows.len(), noted.lines().count() - 1);
        assert!(rows.is_sorted_by_key(|row| number(row, "depart")));
        for row in &rows {
            let theirs = whole.vehicles().into_iter().find(|other| other["id"] == row["id"]).unwrap();
            for (column, value) in row.iter().filter(|(column, _)| !FROM_THE_END.contains(&column.as_str())) {
                assert_eq!(*value, theirs[column], "{column} of {}", row["id"]);
            }
        }
        assert_eq!(table(&dir.join("quality.csv")).len(), rows.len());
    }
}

/// Somebody cleans up too early: all of it, or what SUMO writes.
#[test]
fn a_folder_that_is_deleted_meanwhile_costs_no_row_and_is_told() {
    for name in ["", "sumo"] {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("result");
        let mut run = Running::start(run_command(NEW, &own("city"), &dir, &["--end", "300"]));
        until_rows(&mut run, &dir, 5);
        fs::remove_dir_all(dir.join(name)).unwrap();
        let ended = run.wait();
        assert!(table(&dir.join("vehicles.csv")).len() > 50, "{}", ended.stderr);
        assert!(dir.join("schema.json").is_file());
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        let said = ended.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains("was deleted while the run was under way: what SUMO wrote is lost"), "{said}");
        let manifest = json(&dir.join("run.json"));
        assert_eq!(manifest["status"], "incomplete");
        assert!(manifest["reason"].as_str().unwrap().contains("was deleted"), "{manifest}");
    }
}

/// Wherever the disk is full first: rows of vehicles that had left are there, in the table or in its `.part`.
#[test]
fn a_full_disk_costs_no_row_that_was_known() {
    for kilobytes in [300, 500, 800, 1200] {
        let Some(disk) = SmallDisk::new(kilobytes) else {
            eprintln!("skipped: only root can make a small disk");
            return;
        };
        let dir = disk.folder().join("result");
        let ended = Running::start(run_command(NEW, &own("city"), &dir, &["--quiet"])).wait();
        assert_eq!(ended.code, Some(1), "{kilobytes} kB: {}", ended.stderr);
        assert!(ended.stderr.contains("No space left"), "{kilobytes} kB: {}", ended.stderr);
        let (whole, part) = (dir.join("vehicles.csv"), dir.join("vehicles.csv.part"));
        let kept = if whole.is_file() { table(&whole) } else { table(&part) };
        assert!(kept.len() > 5, "{kilobytes} kB: {} rows; {}", kept.len(), ended.stderr);
        let said = ended.stderr.contains("vehicles.csv.part");
        assert_eq!(said, !whole.is_file(), "{kilobytes} kB: {}", ended.stderr);
    }
}

/// Nobody may end this program in order at SIGKILL: SUMO must notice by itself, whether it loads, waits or drives.
#[test]
fn whenever_the_program_is_killed_sumo_goes_too() {
    let (mut loading, mut driving) = (0, 0);
    for kill in 0..100_u64 {
        let folder = tempfile::tempdir().unwrap();
        // Every third one waits for another client for ever.
        let clients = if kill % 3 == 0 { "2" } else { "1" };
        let args = ["--num-clients", clients, "--quiet", "--no-report"];
        let mut run = Running::start(run_command(NEW, &own("city"), &folder.path().join("result"), &args));
        // Some while it drives, however long it takes to get there.
        let deadline = Instant::now() + Duration::from_secs(30);
        while kill % 6 == 1 && !folder.path().join("result/schema.json").exists() && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(2));
        }
        std::thread::sleep(Duration::from_millis(7 * (kill * 37 % 100)));
        let sumo = children(run.child.id());
        loading += usize::from(!sumo.is_empty());
        driving += usize::from(folder.path().join("result/schema.json").exists());
        run.child.kill().unwrap();
        run.child.wait().unwrap();
        let left: Vec<u32> = naming(folder.path()).into_iter().filter(|pid| stays(*pid)).collect();
        assert!(left.is_empty(), "kill {kill}: {left:?} stay");
    }
    assert!(loading > 40 && driving > 10 && driving < loading, "{loading} of 100 with SUMO, {driving} under way");
}
