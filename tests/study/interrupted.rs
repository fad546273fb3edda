//! Studies that are killed, stopped, or divided.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant, SystemTime};

use super::support::{Running, children, table};
use super::{MOTORWAY, command, ended, study, tables};

/// Four settings under ten seeds: 40 cases.
const STUDY: [&str; 8] = [
    "--vary",
    "controller.name=ideal,pid,adaptive,classic",
    "--reference",
    "controller.name=ideal",
    "--seeds",
    "1..10",
    "--end",
    "30",
];

fn arguments<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&MOTORWAY[..], &STUDY, more].concat()
}

/// The files of all cases that are done, and when they were written.
fn done(dir: &Path) -> BTreeMap<PathBuf, SystemTime> {
    let mut files = BTreeMap::new();
    for case in fs::read_dir(dir.join("cases")).into_iter().flatten().flatten().map(|case| case.path()) {
        let manifest = fs::read_to_string(case.join("run.json")).unwrap_or_default();
        if !manifest.contains(r#""status": "complete""#) {
            continue;
        }
        for folder in [case.join("sumo"), case] {
            let entries = fs::read_dir(folder).unwrap().flatten().filter(|entry| entry.path().is_file());
            files.extend(entries.map(|entry| (entry.path(), entry.metadata().unwrap().modified().unwrap())));
        }
    }
    files
}

/// Waits until this many cases are done.
fn wait_for(dir: &Path, cases: usize) {
    let deadline = Instant::now() + Duration::from_secs(120);
    while done(dir).keys().filter(|file| file.ends_with("run.json")).count() < cases {
        assert!(Instant::now() < deadline, "{cases} cases take too long");
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn signal(name: &str, id: u32) {
    assert!(Command::new("kill").args([name, &id.to_string()]).status().unwrap().success());
}

/// The tables and the study of somebody who was never disturbed.
fn undisturbed(folder: &Path) -> [Vec<u8>; 4] {
    study("sweep", &folder.join("whole"), &arguments(&["-j", "2"]));
    let rows = table(&folder.join("whole/cases.csv"));
    assert_eq!((rows.len(), rows.iter().filter(|row| row["status"] == "done").count()), (40, 40));
    tables(&folder.join("whole"))
}

#[test]
fn a_study_that_is_killed_goes_on_and_comes_to_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("killed");
    let wanted = undisturbed(folder.path());
    let running = Running::start(command("sweep", &dir, &arguments(&["-j", "2"])));
    wait_for(&dir, 15);
    signal("-KILL", running.child.id());
    assert_eq!(running.wait().code, None);
    assert!(!dir.join("cases.csv").exists());
    let before = done(&dir);
    assert!(before.len() > 30, "{before:?}");
    // What the killed one had under way ends by itself.
    study("sweep", &dir, &arguments(&["-j", "1"]));
    let after = done(&dir);
    assert!(after.len() > before.len());
    for (file, written) in &before {
        assert_eq!(after.get(file), Some(written), "{} was written again", file.display());
    }
    assert_eq!(tables(&dir), wanted);
    // A third call has nothing to do.
    study("sweep", &dir, &arguments(&[]));
    assert_eq!(done(&dir), after);
}

/// The rest of a study that was killed: a case that was just being started finds its folder in the hands of the next study.
#[test]
fn regress_a_case_that_nobody_holds_any_more_leaves_its_folder_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let one = [&MOTORWAY[..], &["--vary", "controller.name=pid", "--seeds", "1", "--end", "30"]].concat();
    study("sweep", folder.path(), &one);
    let case = folder.path().join("cases/0001");
    let before = done(folder.path());
    assert!(before.len() > 3, "{before:?}");
    let tied = |keep: bool| {
        let mut command = command("run", &case, &["--quiet", "--no-report", "--force", "--tied"]);
        command
            .arg("--from")
            .arg(case.join("run.json"))
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let tie = child.stdin.take().filter(|_| keep);
        (child, tie)
    };
    let orphan = tied(false).0.wait_with_output().unwrap();
    assert_eq!(orphan.status.code(), Some(143), "{orphan:?}");
    assert_eq!(done(folder.path()), before);
    // One that somebody holds waits until another has let go of the folder.
    let lock = fs::File::open(&case).unwrap();
    lock.lock().unwrap();
    let (mut child, tie) = tied(true);
    std::thread::sleep(Duration::from_secs(1));
    assert_eq!((child.try_wait().unwrap(), &done(folder.path())), (None, &before));
    drop(lock);
    let ended = child.wait_with_output().unwrap();
    drop(tie);
    assert_eq!(ended.status.code(), Some(0), "{ended:?}");
    assert_ne!(done(folder.path()), before);
}

#[test]
fn an_interrupted_study_stops_within_a_step_and_says_how_to_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let long = ["scenarios/city.toml", "--vary", "controller.name=pid,adaptive", "--seeds", "1"];
    let running = Running::start(command("sweep", folder.path(), &long));
    let deadline = Instant::now() + Duration::from_secs(60);
    while !folder.path().join("cases/0001/sumo/tripinfo.xml").exists() {
        assert!(Instant::now() < deadline, "the first case does not begin");
        std::thread::sleep(Duration::from_millis(10));
    }
    let begin = Instant::now();
    signal("-INT", running.child.id());
    let ended = running.wait();
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);
    assert!(begin.elapsed() < Duration::from_secs(10), "{:?}", begin.elapsed());
    assert!(ended.stderr.contains("stopped: 0 of 2 cases are done; the same command goes on"), "{}", ended.stderr);
    let status = study("sweep", folder.path(), &[&long[..], &["--status"]].concat()).stdout;
    assert!(status.contains("0 done, 0 failed, 2 missing"), "{status}");
}

/// A case that dies without a word fails for a reason, too, and the others are run.
#[test]
fn a_case_that_is_killed_has_failed_and_the_study_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let two =
        ["scenarios/motorway.toml", "--vary", "controller.name=pid,ideal", "--seeds", "1", "--end", "120", "-j", "1"];
    let running = Running::start(command("sweep", folder.path(), &two));
    let deadline = Instant::now() + Duration::from_secs(60);
    while !folder.path().join("cases/0001/sumo/tripinfo.xml").exists() {
        assert!(Instant::now() < deadline, "the first case does not begin");
        std::thread::sleep(Duration::from_millis(10));
    }
    let [case] = children(running.child.id())[..] else { panic!("one case at a time") };
    signal("-KILL", case);
    let ended = running.wait();
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let rows = table(&folder.path().join("cases.csv"));
    assert_eq!((&*rows[0]["status"], &*rows[1]["status"]), ("failed", "done"), "{}", ended.stderr);
    assert!(rows[0]["reason"].contains("signal: 9"), "{:?}", rows[0]["reason"]);
}

#[test]
fn shards_in_any_order_make_the_same_tables() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("shards");
    let wanted = undisturbed(folder.path());
    for shard in ["3/3", "1/3", "2/3"] {
        study("sweep", &dir, &arguments(&["--shard", shard]));
        assert!(!dir.join("comparison.csv").exists(), "a shard makes no tables");
    }
    let before = done(&dir);
    study("sweep", &dir, &arguments(&["--collect"]));
    assert_eq!(tables(&dir), wanted);
    assert_eq!(done(&dir), before, "collecting runs nothing");
}

/// Whoever comes second waits, and comes to the same.
#[test]
fn several_calls_write_the_tables_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let few = ["scenarios/straight.toml", "--end", "5", "--vary", "controller.name=pid,ideal", "--seeds", "1..3"];
    study("sweep", folder.path(), &few);
    let wanted = tables(folder.path());
    let collect = || Running::start(command("sweep", folder.path(), &[&few[..], &["--collect"]].concat()));
    let calls: Vec<Running> = (0..8).map(|_| collect()).collect();
    for call in calls {
        let ended = call.wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    }
    assert_eq!(tables(folder.path()), wanted);
    let parts =
        fs::read_dir(folder.path()).unwrap().flatten().filter(|e| e.path().extension().is_some_and(|x| x == "part"));
    assert_eq!(parts.count(), 0);
}

#[test]
fn what_is_not_there_yet_is_said_to_be_missing() {
    let folder = tempfile::tempdir().unwrap();
    let few = ["scenarios/straight.toml", "--end", "5", "--vary", "controller.name=pid,ideal", "--seeds", "1..3"];
    study("sweep", folder.path(), &[&few[..], &["--shard", "2/2"]].concat());
    let collected = ended("sweep", folder.path(), &[&few[..], &["--collect"]].concat());
    assert!(collected.stderr.contains("3 cases done, 0 failed, 3 missing"), "{}", collected.stderr);
    let rows = table(&folder.path().join("cases.csv"));
    let states: Vec<&str> = rows.iter().map(|row| &*row["status"]).collect();
    assert_eq!(states, ["missing", "done", "missing", "done", "missing", "done"]);
}
