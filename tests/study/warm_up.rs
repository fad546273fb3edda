//! Warm-up: simulated once per seed by SUMO alone, and loaded by every case of that seed.

use super::support::{attribute, elements, run_command};
use super::*;

/// Seconds of warm-up.
const UNTIL: &str = "40";

fn trips(dir: &Path, case: &str) -> Vec<String> {
    elements(&dir.join("cases").join(case).join("sumo/tripinfo.xml"), "tripinfo")
}

/// What of a trip the devices of a vehicle do not change.
fn told(trip: &str) -> [&str; 4] {
    ["id", "depart", "arrival", "timeLoss"].map(|name| attribute(trip, name))
}

#[test]
fn a_warm_up_is_simulated_once_per_seed_and_goes_on_as_if_never_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, warm) = (folder.path().join("whole"), folder.path().join("warm"));
    let vary = ["--vary", "controller.name=plain,adaptive", "--seeds", "5,6", "--end", "120"];
    let args = [&MOTORWAY[..], &vary].concat();
    study("sweep", &whole, &args);
    let args = [&args[..], &["--warm-up", UNTIL]].concat();
    study("sweep", &warm, &args);
    let states = || {
        let all = fs::read_dir(warm.join("warm_up")).unwrap().map(|entry| entry.unwrap());
        let mut all: Vec<_> = all.map(|entry| (entry.path(), entry.metadata().unwrap().modified().unwrap())).collect();
        all.sort();
        all
    };
    let made = states();
    assert_eq!(made.len(), 2, "one state per seed: {made:?}");
    // `plain` goes on as if it had not been stopped. The trips that ended before are not in its output.
    for case in ["0001", "0003"] {
        let (all, after) = (trips(&whole, case), trips(&warm, case));
        let ended = |trip: &&String| {
            let arrival: f64 = attribute(trip, "arrival").parse().unwrap();
            (0.0..UNTIL.parse().unwrap()).contains(&arrival)
        };
        let late: Vec<_> = all.iter().filter(|trip| !ended(trip)).map(|trip| told(trip)).collect();
        assert!(after.len() > 20 && after.iter().any(|trip| attribute(trip, "depart").parse::<f64>().unwrap() < 40.0));
        assert_eq!(after.iter().map(|trip| told(trip)).collect::<Vec<_>>(), late);
    }
    // A case is what one run that loads this state is.
    let text = fs::read_to_string(warm.join("cases/0002/run.json")).unwrap();
    let (state, _) =
        made.iter().find(|(path, _)| text.contains(&*path.file_name().unwrap().to_string_lossy())).unwrap();
    let alone = folder.path().join("alone");
    let load = format!("sumo.load_state={:?}", state.to_str().unwrap());
    let args =
        ["--set", "traffic.sigma=0.5", "-q", "--end", "120", "--seed", "5", "--controller", "adaptive", "--set", &load];
    let ended = Running::start(run_command(NEW, &repository("scenarios/motorway.toml"), &alone, &args)).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let bytes = |dir: &Path, file: &str| fs::read(dir.join(file)).unwrap();
    for file in ["vehicles.csv", "quality.csv", "sample.csv", "edges.csv"] {
        assert_eq!(bytes(&alone, file), bytes(&warm.join("cases/0002"), file), "{file}");
    }
    // The cars that were on the road are egos, and are counted.
    let rows = table(&warm.join("cases.csv"));
    let vehicles = table(&alone.join("vehicles.csv"));
    assert!(vehicles.iter().any(|row| number(row, "depart") < 30.0 && number(row, "error_rms") > 0.0));
    assert_eq!(number(&rows[1], "egos"), vehicles.len() as f64);
    for row in &rows {
        assert_eq!(number(row, "unfinished"), number(row, "inserted") - number(row, "arrived"));
    }
    let running = trips(&warm, "0001").iter().filter(|trip| attribute(trip, "arrival").starts_with('-')).count();
    assert_eq!(number(&rows[0], "unfinished"), running as f64);
    // More seeds need their own state and no other.
    study(
        "sweep",
        &warm,
        &[
            &MOTORWAY[..],
            &["--vary", "controller.name=plain,adaptive", "--seeds", "5..7", "--end", "120", "--warm-up", UNTIL],
        ]
        .concat(),
    );
    let more = states();
    assert!(more.len() == 3 && made.iter().all(|state| more.contains(state)), "{more:?}");
}

#[test]
fn a_warm_up_longer_than_the_simulation_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |more: &[&str]| {
        let args = [&["scenarios/motorway.toml", "--end", "50", "--vary", "controller.k_p=1,2"], more].concat();
        let ended = ended("sweep", folder.path(), &args);
        assert_eq!(ended.code, Some(1));
        ended.stderr.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let text = refused(&["--warm-up", "60"]);
    assert!(text.contains("warm_up_s: found 60, which ends at 60 s, wanted less than the simulation lasts"), "{text}");
    let text = refused(&["--warm-up", "soon"]);
    assert!(text.contains("warm_up_s") && text.contains("soon"), "{text}");
    assert!(!folder.path().join("cases").exists());
}

#[test]
fn an_interrupted_warm_up_leaves_nothing_and_no_sumo() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["scenarios/studies/city.toml", "--seeds", "1", "--end", "590", "--warm-up", "580"];
    let running = Running::start(command("sweep", folder.path(), &args));
    let deadline = std::time::Instant::now() + std::time::Duration::from_secs(60);
    let sumo = loop {
        // Earlier a SUMO is only asked for its version.
        let begun = fs::read_dir(folder.path().join("warm_up")).is_ok_and(|mut entries| entries.next().is_some());
        if let (true, Some(sumo)) = (begun, support::children(running.child.id()).first()) {
            break *sumo;
        }
        assert!(std::time::Instant::now() < deadline, "SUMO does not start");
        std::thread::sleep(std::time::Duration::from_millis(10));
    };
    let id = running.child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let ended = running.wait();
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);
    assert!(ended.stderr.contains("stopped: 0 of 1 cases are done"), "{}", ended.stderr);
    assert!(!support::stays(sumo), "SUMO goes on");
    assert_eq!(fs::read_dir(folder.path().join("warm_up")).unwrap().count(), 0);
}
