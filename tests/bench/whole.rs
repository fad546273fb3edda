//! Whole processes as a user starts them: plain `sumo -c` with the same step and options against `run` with each law.
//!
//! ```text
//! .ci/with-sumo cargo bench --bench whole [--features libsumo] [-- SCENE...] [-- LAW...]
//! ```
//! With the feature `libsumo` every law runs a second time, with SUMO in its own process.
//! The processes of a scene take turns, five rounds of them. A ratio is that of two processes of one round, wall and
//! processor time (SUMO's and ours together), and the figure is the median over the rounds. Everything is in it: loading,
//! stepping, tables and the report page. What of this does not grow with the length of a run is shown apart: the time of
//! a run of one second. Networks that are not kept in the repository are made below `target/bench`.

use nix::sys::resource::{UsageWho, getrusage};
use nix::sys::time::TimeValLike;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;
use sumo_mfc::control::CONTROLLERS;
use sumo_mfc::traci::{SumoBinary, find_sumo};

const ROUNDS: usize = 5;

/// Where a network comes from.
enum Net {
    /// One of the RESCO networks in sumo-rl.
    Foreign(&'static str),
    /// Below `sumo_nets`.
    Own(&'static str),
    /// The circuit that comes with SUMO.
    Racing,
    /// The grid of `sumo_nets/large` with this number of cars.
    Grid(u32),
}

/// A network, and which part of it is run.
struct Scene {
    name: &'static str,
    net: Net,
    step_s: f64,
    begin_s: f64,
    length_s: f64,
}

/// Wall and processor time [s].
type Times = [f64; 2];

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let sumo = find_sumo(None).expect("a SUMO: .ci/with-sumo cargo bench --bench whole");
    let all: Vec<&str> = CONTROLLERS.iter().map(|entry| entry.name).collect();
    let is_law = |name: &str| all.contains(&name);
    let laws: Vec<&str> = all.iter().copied().filter(|law| wanted.iter().any(|w| w == law)).collect();
    let laws = if laws.is_empty() { all.clone() } else { laws };
    let some = wanted.iter().any(|w| !is_law(w));
    for scene in scenes().iter().filter(|scene| !some || wanted.iter().any(|w| w == scene.name)) {
        measure(scene, &sumo, &laws);
    }
}

fn scenes() -> Vec<Scene> {
    let scene = |name, net, step_s, begin_s, length_s| Scene { name, net, step_s, begin_s, length_s };
    vec![
        scene("cologne1", Net::Foreign("cologne1"), 0.1, 25_200.0, 1_200.0),
        scene("cologne8", Net::Foreign("cologne8"), 0.1, 25_200.0, 600.0),
        scene("ingolstadt1", Net::Foreign("ingolstadt1"), 0.1, 57_600.0, 1_200.0),
        scene("ingolstadt21", Net::Foreign("ingolstadt21"), 0.1, 57_600.0, 600.0),
        scene("ingolstadt21-1s", Net::Foreign("ingolstadt21"), 1.0, 57_600.0, 3_600.0),
        scene("city", Net::Own("city/city.sumocfg"), 0.1, 0.0, 900.0),
        scene("motorway", Net::Own("motorway/motorway.sumocfg"), 0.1, 0.0, 900.0),
        scene("racing", Net::Racing, 0.1, 0.0, 600.0),
        scene("grid400", Net::Grid(400), 0.1, 0.0, 300.0),
        scene("grid1000", Net::Grid(1_000), 0.1, 0.0, 150.0),
        scene("grid5000", Net::Grid(5_000), 0.1, 0.0, 90.0),
    ]
}

impl Net {
    /// Its configuration, which is made if it must be.
    fn config(&self, home: &Path) -> PathBuf {
        match self {
            Self::Foreign(net) => {
                let inside = format!("site-packages/sumo_rl/nets/RESCO/{net}/{net}.sumocfg");
                let libs = std::fs::read_dir(repository(".sumo/sumo-rl/lib")).into_iter().flatten().flatten();
                let mut configs = libs.map(|lib| lib.path().join(&inside));
                configs.find(|config| config.is_file()).expect("sumo-rl's networks: make setup-test")
            }
            Self::Own(config) => repository("sumo_nets").join(config),
            Self::Racing => home.join("tools/game/racing/racing.sumocfg"),
            Self::Grid(cars) => {
                let folder = repository("target/bench").join(cars.to_string());
                let config = folder.join("large.sumocfg");
                if !config.exists() {
                    let mut make = Command::new(repository("sumo_nets/large/make.sh"));
                    make.arg(&folder).arg(cars.to_string()).stdout(Stdio::null()).env("MAKE_SUMO_HOME", home);
                    assert!(make.status().expect("a shell").success());
                }
                config
            }
        }
    }
}

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Lets plain SUMO and the laws take turns, and prints a line for each.
fn measure(scene: &Scene, sumo: &SumoBinary, laws: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let end_s = scene.begin_s + scene.length_s;
    let backends: &[&str] = if cfg!(feature = "libsumo") { &["traci", "libsumo"] } else { &["traci"] };
    let kinds: Vec<(&str, &str)> = laws.iter().flat_map(|law| backends.iter().map(move |way| (*law, *way))).collect();
    let (mut plain, mut ours) = (Vec::new(), vec![Vec::new(); kinds.len()]);
    let home = std::path::absolute(sumo.home.as_ref().expect("SUMO_HOME")).expect("an absolute path");
    let config = scene.net.config(&home);
    let bare = |end_s: f64| timed(plain_command(scene, &config, sumo, end_s));
    let run = |(law, backend): (&str, &str), end_s: f64| {
        let out = folder.path().join("out");
        let mut command = ours_command(scene, &config, law, end_s, &out);
        if cfg!(feature = "libsumo") {
            command.args(["--backend", backend]);
        }
        let times = timed(command);
        std::fs::remove_dir_all(out).expect("a result");
        times
    };
    for _ in 0..ROUNDS {
        plain.push(bare(end_s));
        for (kind, times) in kinds.iter().zip(&mut ours) {
            times.push(run(*kind, end_s));
        }
    }
    let median_of = |times: &[Times], which: usize| median(times.iter().map(|t| t[which]));
    let name = scene.name;
    let [wall_s, processor_s] = [median_of(&plain, 0), median_of(&plain, 1)];
    println!("{name:16} {:21} {wall_s:7.2} s wall, {processor_s:7.2} s processor", "sumo -c");
    for ((law, backend), times) in kinds.iter().zip(&ours) {
        let ratio = |which: usize| median(times.iter().zip(&plain).map(|(a, b)| a[which] / b[which]));
        let [wall_s, wall, processor] = [median_of(times, 0), ratio(0), ratio(1)];
        println!(
            "{name:16} {law:13} {backend:7} {wall_s:7.2} s wall, {wall:5.2} x sumo -c, processor {processor:5.2} x"
        );
    }
    let short_s = scene.begin_s + 1.0;
    let plain_s = median((0..ROUNDS).map(|_| bare(short_s)[0]));
    let ours_s = median((0..ROUNDS).map(|_| run(("adaptive", "traci"), short_s)[0]));
    println!("{name:16} {:21} {ours_s:7.2} s wall for one second of adaptive, sumo -c {plain_s:.2} s", "start-up");
}

/// Plain SUMO with the options that a run gives it.
fn plain_command(scene: &Scene, config: &Path, sumo: &SumoBinary, end_s: f64) -> Command {
    let mut command = Command::new(&sumo.path);
    command.arg("-c").arg(config).args(["--step-length", &scene.step_s.to_string()]);
    command.args(["--end", &end_s.to_string(), "--step-method.ballistic", "true", "--collision.mingap-factor", "0"]);
    command.args(["--no-step-log", "true", "--no-warnings", "true"]);
    if let Some(home) = &sumo.home {
        command.env("SUMO_HOME", home);
    }
    command
}

fn ours_command(scene: &Scene, config: &Path, law: &str, end_s: f64, out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sumo-mfc"));
    command.arg("run").arg(config).args(["--step-length", &scene.step_s.to_string()]);
    command.args(["--end", &end_s.to_string(), "--controller", law, "--out"]).arg(out);
    command
}

/// Wall and processor time of a process and all its children.
fn timed(mut command: Command) -> Times {
    let (begun, before_s) = (Instant::now(), processor_s());
    let status = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    let wall_s = begun.elapsed().as_secs_f64();
    assert!(status.as_ref().is_ok_and(|status| status.success()), "{command:?}: {status:?}");
    [wall_s, processor_s() - before_s]
}

/// Processor time of all children that have ended [s].
fn processor_s() -> f64 {
    let usage = getrusage(UsageWho::RUSAGE_CHILDREN).expect("the usage of children");
    1e-6 * (usage.user_time() + usage.system_time()).num_microseconds() as f64
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
