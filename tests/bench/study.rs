//! What studies cost beside their cases: how much two cases at a time gain against what two plain SUMO gain, and how long
//! planning and collecting 10 000 cases take. Everything is measured side by side in one run.
//! `SUMO_HOME=... cargo bench --bench study`

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Rounds of which the median counts.
const ROUNDS: usize = 3;
/// Cases of the large study.
const MANY: usize = 10_000;

fn main() {
    let folder = tempfile::tempdir().expect("a folder");
    speed_up(folder.path());
    large(folder.path());
}

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn sumo() -> PathBuf {
    let home = std::env::var_os("SUMO_HOME").expect("SUMO_HOME names the SUMO to measure");
    Path::new(&home).join("bin/sumo")
}

fn start(mut command: Command) -> Child {
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("a process")
}

fn ended(mut child: Child) {
    assert!(child.wait().expect("an end").success());
}

fn plain(seed: usize) -> Command {
    let mut command = Command::new(sumo());
    command.args(["--no-step-log", "--no-warnings", "--end", "600", "--seed", &seed.to_string(), "-c"]);
    command.arg(repository("sumo_nets/city/city_drivers.sumocfg"));
    command
}

fn sweep(scenario: &str, dir: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sumo-mfc"));
    command.args(["sweep", "-q"]).arg(repository(scenario)).args(args).arg("-o").arg(dir);
    command
}

fn seconds(work: impl FnOnce()) -> f64 {
    let begin = Instant::now();
    work();
    begin.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Two plain SUMO after and beside each other, and four cases one and two at a time, in turn.
fn speed_up(folder: &Path) {
    let (mut of_sumo, mut of_cases) = (Vec::new(), Vec::new());
    for round in 0..ROUNDS {
        let apart_s = seconds(|| (1..3).for_each(|seed| ended(start(plain(seed)))));
        let beside_s = seconds(|| {
            let both = [1, 2].map(|seed| start(plain(seed)));
            both.into_iter().for_each(ended);
        });
        of_sumo.push(apart_s / beside_s);
        let cases_s = |jobs: &str| {
            let dir = folder.join(format!("{round}-{jobs}"));
            let args = ["--seeds", "1..4", "--end", "150", "-j", jobs];
            seconds(|| ended(start(sweep("scenarios/studies/city.toml", &dir, &args))))
        };
        of_cases.push(cases_s("1") / cases_s("2"));
    }
    let (of_sumo, of_cases) = (median(of_sumo), median(of_cases));
    println!(
        "two at a time: plain SUMO {of_sumo:.2} times as fast, cases {of_cases:.2}: {:.2} of it",
        of_cases / of_sumo
    );
}

/// Time and largest memory of a process.
fn measured(command: Command) -> (f64, f64) {
    let begin = Instant::now();
    let mut child = start(command);
    let status = format!("/proc/{}/status", child.id());
    let mut largest_mb = 0.0_f64;
    while child.try_wait().expect("a process").is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let kb =
            text.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.parse::<f64>().ok());
        largest_mb = largest_mb.max(kb.unwrap_or(0.0) / 1024.0);
        std::thread::sleep(Duration::from_millis(5));
    }
    (begin.elapsed().as_secs_f64(), largest_mb)
}

/// A study of 10 000 seeds: one case is run, the others get its files, with their own seeds in `run.json`.
fn large(folder: &Path) {
    let dir = folder.join("large");
    let study = |seeds: &str, more: &[&str]| {
        sweep("scenarios/motorway.toml", &dir, &[&["--end", "60", "--seeds", seeds], more].concat())
    };
    ended(start(study("1", &[])));
    let (plan_s, plan_mb) = measured(study(&format!("1..{MANY}"), &["--plan"]));
    println!("planning {MANY} cases: {plan_s:.1} s, at most {plan_mb:.0} MB");
    let first = dir.join("cases/0001");
    let manifest = fs::read_to_string(first.join("run.json")).expect("run.json");
    for seed in 2..=MANY {
        let case = dir.join("cases").join(format!("{seed:04}"));
        fs::create_dir_all(case.join("sumo")).expect("a folder");
        for file in [
            "vehicles.csv",
            "quality.csv",
            "summary.json",
            "edges.csv",
            "sample.csv",
            "schema.json",
            "sumo/tripinfo.xml",
            "sumo/statistics.xml",
            "sumo/sumo.log",
            "sumo/console.log",
        ] {
            fs::hard_link(first.join(file), case.join(file)).expect("a link");
        }
        let own = manifest
            .replace("\"seed\": 1,", &format!("\"seed\": {seed},"))
            .replace("\\nseed = 1\\n", &format!("\\nseed = {seed}\\n"));
        fs::write(case.join("run.json"), own).expect("run.json");
    }
    let (collect_s, collect_mb) = measured(study(&format!("1..{MANY}"), &["--collect"]));
    let rows = fs::read_to_string(dir.join("cases.csv")).expect("cases.csv");
    let done = rows.lines().filter(|row| row.contains(",done,")).count();
    assert_eq!(done, MANY, "every case counts");
    println!("collecting {MANY} cases: {collect_s:.1} s, at most {collect_mb:.0} MB");
}
