//! Finding SUMO, running the program and SUMO itself with a time limit, and reading what they wrote.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

/// The newest SUMO that is tested.
pub const NEW: &str = "1.28.0";
/// The oldest that is supported.
pub const OLD: &str = "1.15.0";
/// One that is too old.
pub const TOO_OLD: &str = "1.14.1";
/// No run of these tests takes this long unless something hangs.
const LIMIT: Duration = Duration::from_secs(300);

/// A path below the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The folder `site-packages` of an installation below `.sumo/`.
fn site_packages(names: &[&str]) -> PathBuf {
    let found = names.iter().flat_map(|name| fs::read_dir(repository(".sumo").join(name).join("lib"))).flatten();
    let mut pythons = found.flatten().map(|python| python.path().join("site-packages"));
    pythons.find(|site| site.is_dir()).unwrap_or_else(|| panic!("no {} below .sumo/: type make setup-test", names[0]))
}

/// The `SUMO_HOME` of a version.
pub fn sumo_home(version: &str) -> PathBuf {
    let home = site_packages(&[version]).join("sumo");
    assert!(home.join("bin/sumo").is_file(), "no SUMO {version} below .sumo/: type make setup-test");
    home
}

/// A configuration of the foreign networks.
pub fn foreign(name: &str) -> PathBuf {
    let path = site_packages(&["sumo-rl", "rl"]).join(format!("sumo_rl/nets/RESCO/{name}/{name}.sumocfg"));
    assert!(path.is_file(), "no network {name} in sumo-rl below .sumo/: type make setup-test");
    path
}

/// One of our own configurations.
pub fn own(name: &str) -> PathBuf {
    repository("sumo_nets").join(name).join(format!("{name}.sumocfg"))
}

/// A finished process.
pub struct Ended {
    /// Exit code; `None` = killed by a signal.
    pub code: Option<i32>,
    /// What it printed.
    pub stdout: String,
    /// What it complained of.
    pub stderr: String,
}

/// A process that is under way, with its output in files so that it can never block.
pub struct Running {
    pub child: Child,
    folder: TempDir,
    limit: Duration,
}

impl Running {
    /// Starts a command.
    pub fn start(command: Command) -> Self {
        Self::start_for(command, LIMIT)
    }

    /// Starts a command that may take as long as this.
    pub fn start_for(mut command: Command, limit: Duration) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| File::create(folder.path().join(name)).unwrap();
        command.stdin(Stdio::null()).stdout(file("stdout")).stderr(file("stderr"));
        let child = command.spawn().unwrap_or_else(|error| panic!("{command:?}: {error}"));
        Self { child, folder, limit }
    }

    /// Waits for its end.
    pub fn wait(mut self) -> Ended {
        let deadline = Instant::now() + self.limit;
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            if Instant::now() > deadline {
                self.child.kill().unwrap();
                panic!("not ended after {:?}:\n{}", self.limit, self.read("stderr"));
            }
            std::thread::sleep(Duration::from_millis(5));
        };
        Ended { code: status.code(), stdout: self.read("stdout"), stderr: self.read("stderr") }
    }

    fn read(&self, name: &str) -> String {
        String::from_utf8_lossy(&fs::read(self.folder.path().join(name)).unwrap()).into_owned()
    }
}

fn is_alive(pid: u32) -> bool {
    let Ok(stat) = fs::read_to_string(format!("/proc/{pid}/stat")) else { return false };
    !stat.rsplit(')').next().unwrap().trim_start().starts_with('Z')
}

/// True if the process is there for good: one that was killed takes a moment to go.
pub fn stays(pid: u32) -> bool {
    let deadline = Instant::now() + Duration::from_secs(5);
    while is_alive(pid) && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(10));
    }
    is_alive(pid)
}

/// Processes that a process has started.
pub fn children(pid: u32) -> Vec<u32> {
    let list = fs::read_dir(format!("/proc/{pid}/task")).into_iter().flatten().flatten();
    let texts = list.filter_map(|task| fs::read_to_string(task.path().join("children")).ok());
    texts.flat_map(|t| t.split_whitespace().filter_map(|p| p.parse().ok()).collect::<Vec<_>>()).collect()
}

/// Processes whose command line names a folder, as SUMO's does.
pub fn naming(folder: &Path) -> Vec<u32> {
    let wanted = folder.to_str().unwrap();
    let pids = fs::read_dir("/proc").unwrap().flatten().filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    let named = |pid: &u32| {
        let line = fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
        String::from_utf8_lossy(&line).contains(wanted)
    };
    pids.filter(named).collect()
}

/// A small file system of its own, as root; it goes with this value.
pub struct SmallDisk(TempDir);

impl SmallDisk {
    /// `None` where only root could.
    pub fn new(kilobytes: u32) -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let size = format!("size={kilobytes}k");
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", &size, "tmpfs"]).arg(folder.path());
        let mounted = mount.stderr(Stdio::null()).status().is_ok_and(|status| status.success());
        mounted.then_some(Self(folder))
    }

    /// Where it is.
    pub fn folder(&self) -> &Path {
        self.0.path()
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(self.0.path()).status();
    }
}

/// The program, with this version of SUMO to be found.
pub fn program(version: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sumo-mfc"));
    command.env("SUMO_HOME", sumo_home(version)).env_remove("SUMO_BINARY");
    command
}

/// `sumo-mfc run SCENARIO -o DIR` with further arguments.
pub fn run_command(version: &str, scenario: &Path, dir: &Path, args: &[&str]) -> Command {
    let mut command = program(version);
    command.arg("run").arg(scenario).arg("-o").arg(dir).args(args);
    command
}

/// A run that must succeed, and its files.
pub fn run(version: &str, scenario: &Path, args: &[&str]) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("result");
    let ended = Running::start(run_command(version, scenario, &dir, args)).wait();
    assert_eq!(ended.code, Some(0), "SUMO {version}, {}, {args:?}:\n{}", scenario.display(), ended.stderr);
    Outcome { dir, ended, _folder: folder }
}

/// A run that must fail with exit code 1, and what it said.
pub fn refusal(version: &str, scenario: &Path, args: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let ended = Running::start(run_command(version, scenario, &folder.path().join("result"), args)).wait();
    assert_eq!(ended.code, Some(1), "{args:?} should have failed:\n{}\n{}", ended.stdout, ended.stderr);
    assert!(!ended.stderr.contains("panicked"), "{}", ended.stderr);
    // Long messages are wrapped and indented.
    ended.stderr.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// SUMO alone; returns once it has ended well.
pub fn plain_sumo(version: &str, args: &[impl AsRef<OsStr>]) {
    let home = sumo_home(version);
    let mut command = Command::new(home.join("bin/sumo"));
    command.args(args).arg("--no-step-log").env("SUMO_HOME", &home);
    let ended = Running::start(command).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
}

/// Makes a network from nodes and edges in SUMO's plain XML. The oldest version makes it, so that all can read it.
pub fn network(folder: &Path, nodes: &str, edges: &str) -> PathBuf {
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::write(&path, text).unwrap();
        path
    };
    let home = sumo_home(OLD);
    let net = folder.join("made.net.xml");
    let mut command = Command::new(home.join("bin/netconvert"));
    command.env("SUMO_HOME", &home).args(["--no-turnarounds", "--no-warnings"]);
    command.arg("-n").arg(write("made.nod.xml", &format!("<nodes>{nodes}</nodes>")));
    command.arg("-e").arg(write("made.edg.xml", &format!("<edges>{edges}</edges>")));
    command.arg("-o").arg(&net);
    let ended = Running::start(command).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    net
}

/// A road of one lane, 2 km at 20 m/s, with the given demand. Returns the configuration.
pub fn straight_road(folder: &Path, demand: &str) -> PathBuf {
    let nodes = r#"<node id="a" x="0" y="0"/><node id="b" x="1000" y="0"/><node id="c" x="2000" y="0"/>"#;
    let edges = r#"<edge id="ab" from="a" to="b" numLanes="1" speed="20"/><edge id="bc" from="b" to="c" numLanes="1" speed="20"/>"#;
    let net = network(folder, nodes, edges);
    configuration(folder, &net, demand, "")
}

/// The vType of [`straight_road`]s: no imperfection, no spread of the desired speed.
pub const CAR: &str =
    r#"<vType id="car" accel="2.6" decel="4.5" sigma="0" speedFactor="1" speedDev="0" maxSpeed="60"/>"#;

/// A configuration beside its demand. `more` is further XML of the configuration.
pub fn configuration(folder: &Path, net: &Path, demand: &str, more: &str) -> PathBuf {
    let routes = folder.join("made.rou.xml");
    fs::write(&routes, format!("<routes>{demand}</routes>")).unwrap();
    let path = folder.join("made.sumocfg");
    let input = format!(
        r#"<input><net-file value="{}"/><route-files value="made.rou.xml"/></input>"#,
        net.file_name().unwrap().to_str().unwrap()
    );
    fs::write(&path, format!("<configuration>{input}{more}</configuration>")).unwrap();
    path
}

/// A result.
pub struct Outcome {
    /// Its folder, which goes with this value.
    pub dir: PathBuf,
    /// What the program printed.
    pub ended: Ended,
    _folder: TempDir,
}

/// A row of a table by column.
pub type Row = BTreeMap<String, String>;

/// A number of a row.
pub fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} is \"{}\"", row[column]))
}

impl Outcome {
    /// A table of the result.
    pub fn table(&self, name: &str) -> Vec<Row> {
        table(&self.dir.join(name))
    }

    /// `vehicles.csv`.
    pub fn vehicles(&self) -> Vec<Row> {
        self.table("vehicles.csv")
    }

    /// The row of a vehicle.
    pub fn vehicle(&self, id: &str) -> Row {
        self.vehicles().into_iter().find(|row| row["id"] == id).unwrap_or_else(|| panic!("no row of {id}"))
    }

    /// A JSON file of the result.
    pub fn json(&self, name: &str) -> Value {
        json(&self.dir.join(name))
    }

    /// A number of SUMO's in `summary.json`.
    pub fn sumo(&self, key: &str) -> f64 {
        self.json("summary.json")["sumo"][key].as_f64().unwrap_or_else(|| panic!("no sumo.{key} in summary.json"))
    }

    /// The bytes of a file.
    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.dir.join(name)).unwrap()
    }
}

/// A CSV file.
pub fn table(path: &Path) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    reader.deserialize().map(|row| row.unwrap()).collect()
}

/// A JSON file.
pub fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// The elements `name` of an XML file that SUMO wrote, as they are, one start tag each.
pub fn elements(path: &Path, name: &str) -> Vec<String> {
    let tag = format!("<{name} ");
    let lines = BufReader::new(File::open(path).unwrap()).lines().map(Result::unwrap);
    lines.map(|line| line.trim().to_owned()).filter(|line| line.starts_with(&tag)).collect()
}

/// An attribute of an element.
pub fn attribute<'a>(element: &'a str, name: &str) -> &'a str {
    let start =
        element.find(&format!(" {name}=\"")).unwrap_or_else(|| panic!("no {name} in {element}")) + name.len() + 3;
    &element[start..start + element[start..].find('"').unwrap()]
}
