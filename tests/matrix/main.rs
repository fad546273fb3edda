//! Every controller in every condition in which people use it, on real SUMO: does the traffic still flow, does anybody
//! touch, and how large are the errors? `make matrix` prints all of it; a part that takes seconds is a test with bounds.

#[allow(dead_code, reason = "the other tests against SUMO use the rest")]
#[path = "../live/support.rs"]
mod support;

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
};

use sumo_mfc::{control::CONTROLLERS, registry::find};
use support::{Ended, NEW, Running, foreign, json, program, run_command, sumo_home, table};

/// The laws that drive a body, and SUMO's own cars, which come first: the others are compared with them.
fn controllers() -> Vec<&'static str> {
    let mut names: Vec<&str> = CONTROLLERS.iter().map(|entry| entry.name).collect();
    names.sort_by_key(|name| *name != "ideal");
    names
}

/// What is wrong with the vehicles, the drivers or the steps: a name, our options, SUMO's options.
const CONDITIONS: &[(&str, &[&str], &[&str])] = &[
    ("clean", &[], &[]),
    ("sigma 0.5", &["--set", "traffic.sigma=0.5"], &[]),
    ("noise -6 dB", &["--set", "noise.power_db=-6"], &[]),
    ("lag 0.3 s", &["--set", "actuator.lag_s=0.3"], &[]),
    ("dead time 0.1 s", &["--set", "actuator.delay_s=0.1"], &[]),
    ("dead time 0.25 s", &["--set", "actuator.delay_s=0.25"], &[]),
    ("0.25 s, headway", &["--set", "actuator.delay_s=0.25", "--set", "traffic.headway_margin_s=auto"], &[]),
    ("sigma + 0.1 s", &["--set", "traffic.sigma=0.5", "--set", "actuator.delay_s=0.1"], &[]),
    ("noise + 0.1 s", &["--set", "noise.power_db=-6", "--set", "actuator.delay_s=0.1"], &[]),
    ("mass x 0.7 to 1.5", &["--set", "vehicle.mass_factor={distribution=\"uniform\",min=0.7,max=1.5}"], &[]),
    ("scale x 0.25", &["--set", "controller.accel_per_unit_mps2=0.25"], &[]),
    ("scale x 4", &["--set", "controller.accel_per_unit_mps2=4"], &[]),
    ("action step 1 s", &[], &["--default.action-step-length", "1"]),
    ("IDM", &[], &["--default.carfollowmodel", "IDM"]),
    ("EIDM", &[], &["--default.carfollowmodel", "EIDM"]),
    ("KraussPS", &[], &["--default.carfollowmodel", "KraussPS"]),
    ("ACC", &[], &["--default.carfollowmodel", "ACC"]),
    ("step 1 s", &["--step-length", "1"], &[]),
];

/// One run of the matrix.
struct Case<'a> {
    scenario: &'a Path,
    condition: &'a (&'a str, &'a [&'a str], &'a [&'a str]),
    controller: &'a str,
}

/// What a run comes to.
#[derive(Debug, Clone)]
struct Cell {
    inserted: u64,
    arrived: u64,
    time_loss_s: Option<f64>,
    contacts: u64,
    teleports: u64,
    crept: u64,
    error_rms_mps: [f64; 2],
    rows: u64,
}

impl Case<'_> {
    /// Runs it; the reason if that fails.
    fn run(&self) -> Result<Cell, String> {
        let (_, ours, sumos) = self.condition;
        let has_scale = find("controller", &CONTROLLERS, self.controller)
            .is_ok_and(|law| law.keys.iter().any(|key| key.name == "accel_per_unit_mps2"));
        let ours = if ours.iter().any(|o| o.contains("accel_per_unit")) && !has_scale { &[][..] } else { ours };
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        let dir = folder.path().join("result");
        let mut command = run_command(NEW, self.scenario, &dir, &["-q", "--controller", self.controller]);
        command.args(ours).arg("--").args(*sumos);
        let Ended { code, stderr, .. } = Running::start(command).wait();
        if code != Some(0) {
            return Err(stderr);
        }
        let summary = json(&dir.join("summary.json"));
        let count = |key: &str| summary["sumo"][key].as_u64().unwrap_or_default();
        let error = |quantile: &str| summary["fleet"]["error_rms"][quantile].as_f64().unwrap_or(f64::NAN);
        Ok(Cell {
            inserted: count("inserted"),
            arrived: count("arrived"),
            time_loss_s: summary["sumo"]["time_loss_mean_s"].as_f64(),
            contacts: count("collisions"),
            teleports: count("teleports"),
            crept: summary["counts"]["crept"].as_u64().unwrap_or_default(),
            error_rms_mps: [error("p50"), error("p95")],
            rows: table(&dir.join("vehicles.csv")).len() as u64,
        })
    }
}

impl Cell {
    /// One line of the table.
    fn line(&self) -> String {
        let loss = self.time_loss_s.map_or("-".to_owned(), |s| format!("{s:.1}"));
        let [p50, p95] = self.error_rms_mps;
        format!(
            "{:>5} of {:<5} {loss:>6} {:>8} {:>9} {:>5} {p50:>7.3} {p95:>7.3}",
            self.arrived, self.inserted, self.contacts, self.teleports, self.crept
        )
    }
}

/// Runs the cases on all processors, in order; `done` hears of each as it ends.
fn run_all(cases: &[Case], done: impl Fn(&Case, &Result<Cell, String>) + Sync) -> Vec<Result<Cell, String>> {
    let next = AtomicUsize::new(0);
    let cells = Mutex::new(vec![Err("not run".to_owned()); cases.len()]);
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some((i, case)) =
                    Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|i| Some((i, cases.get(i)?)))
                {
                    let cell = case.run();
                    done(case, &cell);
                    cells.lock().unwrap()[i] = cell;
                }
            });
        }
    });
    cells.into_inner().unwrap()
}

/// SUMO's grid of five by five streets with traffic of its default type, for 300 s, run until all have arrived.
fn grid(folder: &Path) -> PathBuf {
    let home = sumo_home(NEW);
    let run = |mut command: std::process::Command| {
        let ended = Running::start({
            command.current_dir(folder).env("SUMO_HOME", &home);
            command
        })
        .wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    };
    let mut netgenerate = std::process::Command::new(home.join("bin/netgenerate"));
    netgenerate.args(["--grid", "--grid.number", "5", "--grid.length", "200", "--seed", "1", "-o", "grid.net.xml"]);
    run(netgenerate);
    let mut trips = std::process::Command::new("python3");
    trips.arg(home.join("tools/randomTrips.py"));
    trips.args(["-n", "grid.net.xml", "-o", "grid.trips.xml", "-e", "300", "-p", "1.73", "--seed", "4"]);
    run(trips);
    let path = folder.join("grid.sumocfg");
    let text = r#"<configuration><input><net-file value="grid.net.xml"/><route-files value="grid.trips.xml"/></input><time><end value="900"/></time></configuration>"#;
    fs::write(&path, text).unwrap();
    path
}

fn cases<'a>(scenarios: &'a [PathBuf], conditions: &'a [(&'a str, &'a [&'a str], &'a [&'a str])]) -> Vec<Case<'a>> {
    let of =
        |scenario, condition| controllers().into_iter().map(move |controller| Case { scenario, condition, controller });
    scenarios.iter().flat_map(|s| conditions.iter().flat_map(move |c| of(s, c))).collect()
}

/// The laws that `list` names are those of the matrix.
#[test]
fn every_controller_is_in_the_matrix() {
    let mut command = program(NEW);
    command.arg("list");
    let listed = Running::start(command).wait().stdout;
    let mut laws: Vec<&str> =
        listed.lines().filter_map(|l| l.strip_prefix("controller\t")?.split('\t').next()).collect();
    let mut ours = controllers();
    laws.sort_unstable();
    ours.sort_unstable();
    assert_eq!(laws, ours);
}

/// On the grid, whatever is wrong: nobody is lost, nobody creeps, nobody touches.
#[test]
fn on_a_grid_all_arrive_whatever_the_condition() {
    let folder = tempfile::tempdir().unwrap();
    let scenarios = [grid(folder.path())];
    let cases = cases(&scenarios, CONDITIONS);
    let cells = run_all(&cases, |_, _| {});
    let mut ideal = None;
    for (case, cell) in cases.iter().zip(&cells) {
        let (name, controller) = (case.condition.0, case.controller);
        let cell = cell.as_ref().unwrap_or_else(|error| panic!("{name}, {controller}: {error}"));
        let reference = if controller == "ideal" { ideal.insert(cell.clone()) } else { ideal.as_mut().unwrap() };
        println!("{name:<18}{controller:<12}{}", cell.line());
        assert_eq!(cell.rows, cell.inserted, "{name}, {controller}: a row for every vehicle");
        assert!(cell.arrived as f64 >= 0.97 * reference.arrived as f64, "{name}, {controller}: {}", cell.line());
        let loss_s = cell.time_loss_s.unwrap();
        assert!(loss_s < 1.25 * reference.time_loss_s.unwrap() + 1.0, "{name}, {controller}: {}", cell.line());
        assert_eq!(cell.crept, 0, "{name}, {controller}: {}", cell.line());
        if !name.contains("0.25 s") {
            assert_eq!((cell.contacts, cell.teleports), (0, 0), "{name}, {controller}");
        }
    }
}

/// The whole matrix, for `make matrix`.
#[test]
#[ignore = "an hour and a half; make matrix"]
fn the_whole_matrix() {
    let folder = tempfile::tempdir().unwrap();
    let scenarios = [
        grid(folder.path()),
        support::repository("scenarios/city.toml"),
        support::repository("scenarios/motorway.toml"),
        foreign("cologne1"),
    ];
    let mut cases = cases(&scenarios, CONDITIONS);
    if let Ok(laws) = std::env::var("SUMO_MFC_MATRIX_LAWS") {
        let laws: Vec<&str> = laws.split(',').collect();
        assert!(
            laws.iter().all(|law| controllers().contains(law)),
            "found {laws:?}, wanted some of {:?}",
            controllers()
        );
        cases.retain(|case| laws.contains(&case.controller));
    }
    println!(
        "scenario      condition         controller    arrived         loss s contacts teleports crept  error RMS p50, p95 m/s"
    );
    let failed = AtomicUsize::new(0);
    run_all(&cases, |case, cell| {
        let scenario = case.scenario.file_stem().unwrap().to_string_lossy();
        let shown = match cell {
            Ok(cell) => cell.line(),
            Err(error) => {
                failed.fetch_add(1, Ordering::Relaxed);
                error.lines().next().unwrap_or_default().to_owned()
            }
        };
        println!("{scenario:<14}{:<18}{:<12}{shown}", case.condition.0, case.controller);
    });
    assert_eq!(failed.into_inner(), 0, "runs of the matrix that failed");
}
