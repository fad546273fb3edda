//! The run that is struck: a short road on which a vehicle leaves every other second, and what it comes to undisturbed.

use std::collections::BTreeMap;
use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::end::listens;
use super::plan::Phase;
use super::proxy::{self, Fault, Proxy};
use super::support::{self, CAR, NEW, Row, Running, children, run_command, sumo_home, table};

/// SUMO's step, and ours \[s\].
pub const STEP_S: f64 = 0.1;

/// What a run comes to undisturbed.
pub struct Undisturbed {
    /// The rows by id.
    pub rows: BTreeMap<String, Row>,
    /// How long it is in each phase.
    lengths: BTreeMap<Phase, Duration>,
    /// Size of its folder \[kB\].
    pub size_kb: u32,
}

pub struct Scene {
    folder: TempDir,
    config: PathBuf,
    /// With a SUMO that the program starts.
    pub alone: Undisturbed,
    /// With one that it joins.
    pub joined: Undisturbed,
}

/// A SUMO that waits for the program behind a proxy; it ends with this value.
pub struct Sumo {
    child: Child,
    pub proxy: Proxy,
}

impl Drop for Sumo {
    fn drop(&mut self) {
        let _ = (self.child.kill(), self.child.wait());
    }
}

impl Scene {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let nodes = r#"<node id="a" x="0" y="0"/><node id="b" x="150" y="0"/><node id="c" x="300" y="0"/>"#;
        let edges = r#"<edge id="ab" from="a" to="b" numLanes="1" speed="20"/><edge id="bc" from="b" to="c" numLanes="1" speed="20"/>"#;
        let net = support::network(folder.path(), nodes, edges);
        let flow = r#"<flow id="f" type="car" begin="0" end="290" period="2" from="ab" to="bc" departSpeed="max"/>"#;
        let end = r#"<time><end value="300"/><step-length value="0.1"/></time>"#;
        let config = support::configuration(folder.path(), &net, &format!("{CAR}{flow}"), end);
        let nothing = || Undisturbed { rows: BTreeMap::new(), lengths: BTreeMap::new(), size_kb: 0 };
        let mut scene = Self { folder, config, alone: nothing(), joined: nothing() };
        scene.alone = scene.undisturbed(false);
        scene.joined = scene.undisturbed(true);
        scene
    }

    /// The run, to be started.
    pub fn command(&self, dir: &Path, sumo: Option<&Sumo>, args: &[&str]) -> Command {
        let address = sumo.map(|sumo| format!("127.0.0.1:{}", sumo.proxy.port));
        let joined = address.iter().flat_map(|address| ["--connect", address]);
        let args: Vec<&str> = args.iter().copied().chain(["--quiet"]).chain(joined).collect();
        let ours = run_command(NEW, &self.config, dir, &args);
        // The tests may have been started with SIGHUP ignored.
        let mut command = Command::new("env");
        command.arg("--default-signal=HUP,INT,QUIT").arg(ours.get_program()).args(ours.get_args());
        command.envs(ours.get_envs().filter_map(|(key, value)| Some((key, value?))));
        command.env_remove("SUMO_BINARY");
        command
    }

    /// A SUMO of our own that this fault befalls, once it listens.
    pub fn sumo(&self, fault: Fault) -> Sumo {
        let home = sumo_home(NEW);
        loop {
            let port = TcpListener::bind(("0.0.0.0", 0)).unwrap().local_addr().unwrap().port();
            let mut command = Command::new(home.join("bin/sumo"));
            command.arg("-c").arg(&self.config).args(["--remote-port", &port.to_string(), "--no-step-log"]);
            command.args(["--step-method.ballistic", "true", "--collision.mingap-factor", "0"]);
            command.env("SUMO_HOME", &home).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
            let mut child = command.spawn().unwrap();
            // Another program may snatch the port meanwhile; then SUMO ends.
            while child.try_wait().unwrap().is_none() {
                if listens(port) {
                    return Sumo { child, proxy: proxy::start(port, fault) };
                }
                std::thread::sleep(Duration::from_millis(5));
            }
        }
    }

    /// Such a run with or without a SUMO of its own.
    pub fn of(&self, joined: bool) -> &Undisturbed {
        if joined { &self.joined } else { &self.alone }
    }

    fn undisturbed(&self, joined: bool) -> Undisturbed {
        let dir = self.folder.path().join(if joined { "joined" } else { "alone" });
        let sumo = joined.then(|| self.sumo(Fault::None));
        let mut run = Running::start(self.command(&dir, sumo.as_ref(), &[]));
        let (mut lengths, mut since) = (BTreeMap::<Phase, Duration>::new(), Instant::now());
        while run.child.try_wait().unwrap().is_none() {
            let phase = phase(run.child.id(), &dir, joined);
            std::thread::sleep(Duration::from_millis(1));
            *lengths.entry(phase).or_default() += since.elapsed();
            since = Instant::now();
        }
        let ended = run.wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let rows = table(&dir.join("vehicles.csv")).into_iter().map(|row| (row["id"].clone(), row)).collect();
        Undisturbed { rows, lengths, size_kb: size_kb(&dir) }
    }

    /// How long undisturbed runs are in each phase, and how many rows they come to.
    pub fn told(&self) -> String {
        let of = |name: &str, run: &Undisturbed| {
            let lengths: Vec<String> = run.lengths.iter().map(|(p, l)| format!("{p:?} {} ms", l.as_millis())).collect();
            format!("{name} {} rows, {} kB, {}", run.rows.len(), run.size_kb, lengths.join(", "))
        };
        format!("{}; {}", of("alone", &self.alone), of("joined", &self.joined))
    }
}

impl Undisturbed {
    /// Vehicles that arrived before a time.
    pub fn arrived_before(&self, time_s: f64) -> impl Iterator<Item = String> {
        let arrived = self.rows.iter().filter(|(_, row)| row["reason"] == "arrived");
        let before =
            arrived.filter(move |(_, row)| row["arrival"].parse().is_ok_and(|arrival_s: f64| arrival_s < time_s));
        before.map(|(id, _)| id.clone())
    }

    /// How long such a run is in a phase.
    pub fn length(&self, phase: Phase) -> Duration {
        self.lengths.get(&phase).copied().unwrap_or_default()
    }
}

fn size_kb(folder: &Path) -> u32 {
    let entries = fs::read_dir(folder).unwrap().flatten();
    let size = |entry: fs::DirEntry| {
        let path = entry.path();
        if path.is_dir() { size_kb(&path) } else { (entry.metadata().unwrap().len() / 1024) as u32 + 1 }
    };
    entries.map(size).sum()
}

/// The phase in which a run is.
pub fn phase(pid: u32, dir: &Path, joined: bool) -> Phase {
    let (has_sumo, stepping) = (!children(pid).is_empty(), dir.join("schema.json").exists());
    match (has_sumo || joined, stepping) {
        (false, false) => Phase::Starting,
        // Who has joined starts no SUMO; its folder is there once the scenario is read.
        (true, false) if joined && !dir.join("run.json").exists() => Phase::Starting,
        (true, false) => Phase::Loading,
        (false, true) => Phase::Writing,
        (true, true) if joined && !dir.join("vehicles.csv.part").exists() => Phase::Writing,
        (true, true) => Phase::Stepping,
    }
}
