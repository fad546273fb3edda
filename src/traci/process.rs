//! Finding SUMO, and running it as a child.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{ExitStatus, Stdio};
use std::time::Duration;

use tokio::process::{Child, Command};
use tokio::time::{Instant, timeout};

use super::client::Client;
use super::error::Error;

/// How long a SUMO whose connection broke may take until its exit code is there.
const LAST_WORDS: Duration = Duration::from_secs(2);
/// Lines and bytes of SUMO's log shown in errors.
const REPORT_LINES: usize = 12;
const REPORT_BYTES: u64 = 16_384;
/// How often a free port may be snatched away before we give up.
const PORT_ATTEMPTS: usize = 5;

/// Environment variable with the path of the SUMO binary to use.
pub const SUMO_BINARY_VARIABLE: &str = "SUMO_BINARY";

/// A SUMO binary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SumoBinary {
    /// The real binary, never the Python package's launcher script: killing a launcher would leave SUMO running.
    pub path: PathBuf,
    /// `SUMO_HOME` for it (data files and schemas), if one was found.
    pub home: Option<PathBuf>,
    /// Where it came from, in words.
    pub origin: String,
}

impl SumoBinary {
    fn new(path: PathBuf, origin: impl Into<String>) -> Self {
        let home = std::env::var_os("SUMO_HOME").map(PathBuf::from);
        let beside = path.parent().and_then(Path::parent).filter(|home| home.join("data").is_dir());
        let debian = Path::new("/usr/share/sumo");
        let home = beside.map(Path::to_path_buf).or(home).or_else(|| debian.is_dir().then(|| debian.to_path_buf()));
        Self { path, home, origin: origin.into() }
    }
}

/// Finds SUMO. An explicit path (`given`, else the variable `SUMO_BINARY`) must hold; without one these are tried in
/// turn: `SUMO_HOME/bin`, the PATH, the Python package `eclipse-sumo` of any `python3` on the PATH, and `.sumo/` in the
/// working directory (newest version first).
///
/// # Errors
/// [`Error::NotFound`] whose text says what to type.
pub fn find_sumo(given: Option<&Path>) -> Result<SumoBinary, Error> {
    find_named(given, "sumo")
}

/// Like [`find_sumo`], for `sumo` or `sumo-gui`.
///
/// # Errors
/// As [`find_sumo`].
pub fn find_named(given: Option<&Path>, name: &str) -> Result<SumoBinary, Error> {
    let variable = std::env::var_os(SUMO_BINARY_VARIABLE).map(PathBuf::from);
    let explicit = match (given, &variable) {
        (Some(path), _) => Some((path, "as given")),
        (None, Some(path)) => Some((path.as_path(), SUMO_BINARY_VARIABLE)),
        (None, None) => None,
    };
    if let Some((path, origin)) = explicit {
        let found = real_binary(path, name).map(|path| SumoBinary::new(path, origin));
        return found.ok_or_else(|| Error::NotFound(format!("no SUMO binary at {} ({origin})", path.display())));
    }
    let home = std::env::var_os("SUMO_HOME").map(PathBuf::from);
    let path = std::env::var_os("PATH").unwrap_or_default();
    search(home.as_deref(), &std::env::split_paths(&path).collect::<Vec<_>>(), Path::new(".sumo"), name)
        .ok_or_else(|| Error::NotFound(what_to_type(home.as_deref(), name)))
}

fn what_to_type(home: Option<&Path>, name: &str) -> String {
    let home = home.map_or("SUMO_HOME is not set".to_owned(), |home| format!("SUMO_HOME is {}", home.display()));
    format!(
        "no `{name}` found ({home}; nor on the PATH, in a Python package, or below .sumo/). Type one of:\n  \
         python3 -m venv .sumo/1.28.0 && .sumo/1.28.0/bin/pip install eclipse-sumo==1.28.0\n  \
         sudo apt-get install sumo\n  \
         make setup (in a checkout of sumo-mfc)\n  \
         export SUMO_HOME=/path/to/sumo"
    )
}

/// The search itself, on given places.
fn search(home: Option<&Path>, path: &[PathBuf], local: &Path, name: &str) -> Option<SumoBinary> {
    let from_home = home.and_then(|home| real_binary(&home.join("bin").join(name), name));
    if let Some(binary) = from_home {
        return Some(SumoBinary::new(binary, "SUMO_HOME"));
    }
    if let Some(binary) = path.iter().find_map(|folder| real_binary(&folder.join(name), name)) {
        return Some(SumoBinary::new(binary, "PATH"));
    }
    let pythons = path.iter().map(|folder| folder.join("python3")).filter(|python| python.is_file());
    for python in pythons {
        if let Some(binary) = in_package(&python, name) {
            return Some(SumoBinary::new(binary, format!("Python package of {}", python.display())));
        }
    }
    let mut versions = folders(local);
    versions.sort_by_key(|folder| std::cmp::Reverse(version_key(folder)));
    let (binary, folder) = versions.iter().find_map(|folder| Some((in_prefix(folder, name)?, folder)))?;
    Some(SumoBinary::new(binary, folder.display().to_string()))
}

/// `1.28.0` as numbers, so that 1.15 is newer than 1.9.
fn version_key(folder: &Path) -> Vec<u32> {
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    name.split('.').map_while(|part| part.parse().ok()).collect()
}

fn folders(parent: &Path) -> Vec<PathBuf> {
    let mut found: Vec<_> =
        std::fs::read_dir(parent).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    found.retain(|path| path.is_dir());
    found.sort();
    found
}

/// The binary inside the package `eclipse-sumo` of a Python installation at `prefix`.
fn in_prefix(prefix: &Path, name: &str) -> Option<PathBuf> {
    ["lib", "local/lib"].into_iter().flat_map(|lib| folders(&prefix.join(lib))).find_map(|python| {
        if !python.file_name().is_some_and(|file| file.to_string_lossy().starts_with("python3")) {
            return None;
        }
        ["site-packages", "dist-packages"]
            .into_iter()
            .map(|site| python.join(site).join("sumo/bin").join(name))
            .find(|binary| is_elf(binary))
    })
}

/// The binary inside the package `eclipse-sumo` as this Python finds it: only it knows user and virtual environments.
fn in_package(python: &Path, name: &str) -> Option<PathBuf> {
    let ask =
        "import importlib.util as u; s = u.find_spec('sumo'); print(s.submodule_search_locations[0] if s else '')";
    let output = std::process::Command::new(python).args(["-c", ask]).stdin(Stdio::null()).output().ok()?;
    let package = String::from_utf8(output.stdout).ok()?;
    Some(Path::new(package.trim()).join("bin").join(name)).filter(|binary| !package.trim().is_empty() && is_elf(binary))
}

/// The program at `path`, or behind it: the Python package puts a launcher script with SUMO's name on the PATH.
fn real_binary(path: &Path, name: &str) -> Option<PathBuf> {
    let path = if path.is_dir() { path.join("bin").join(name) } else { path.to_path_buf() };
    if is_elf(&path) {
        return Some(path);
    }
    let real = path.canonicalize().ok()?;
    [path.as_path(), real.as_path()].into_iter().find_map(|script| in_prefix(script.parent()?.parent()?, name))
}

/// True for a program that is not a script.
fn is_elf(path: &Path) -> bool {
    let mut start = [0; 2];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut start));
    path.is_file() && read.is_ok() && &start != b"#!"
}

/// A SUMO that we started. Dropping it kills it; better is [`SumoProcess::shut_down`].
#[derive(Debug)]
pub struct SumoProcess {
    child: Child,
    port: u16,
    log: PathBuf,
    again: Option<SpawnOptions>,
}

/// What it takes to start once more on another free port.
#[derive(Debug)]
struct SpawnOptions {
    binary: SumoBinary,
    args: Vec<String>,
    attempts: usize,
}

impl SumoProcess {
    /// Starts SUMO with `args` (configuration, options) as a TraCI server on `port`, or on a free port for `None`. What it
    /// prints goes to `console.log` in `log_dir`, so that it can never block on a full pipe.
    ///
    /// It must be called inside a tokio runtime. SUMO listens on all interfaces without asking who connects; that cannot be changed, only firewalled.
    ///
    /// # Errors
    /// [`Error::PortInUse`] for a given port, [`Error::Start`].
    pub fn spawn(binary: &SumoBinary, args: &[String], port: Option<u16>, log_dir: &Path) -> Result<Self, Error> {
        let log = log_dir.join("console.log");
        let (port, again) = match port {
            Some(port) => {
                TcpListener::bind((Ipv4Addr::UNSPECIFIED, port)).map_err(|_| Error::PortInUse { port })?;
                (port, None)
            }
            None => {
                let again = SpawnOptions { binary: binary.clone(), args: args.to_vec(), attempts: PORT_ATTEMPTS };
                (free_port().map_err(|source| Error::Start { path: binary.path.clone(), source })?, Some(again))
            }
        };
        let child = start(binary, args, port, &log)?;
        tracing::debug!(binary = %binary.path.display(), port, "started SUMO");
        Ok(Self { child, port, log, again })
    }

    /// The port it listens on.
    #[must_use]
    pub fn port(&self) -> u16 {
        self.port
    }

    /// Its process number while it runs.
    #[must_use]
    pub fn id(&self) -> Option<u32> {
        self.child.id()
    }

    /// The file with everything it prints.
    #[must_use]
    pub fn log(&self) -> &Path {
        &self.log
    }

    /// Connects, and waits until SUMO has loaded everything; `limit` covers the loading and becomes the client's timeout.
    /// If another program snatched the free port in the meantime, SUMO is started once more on another one.
    ///
    /// # Errors
    /// [`Error::Died`] with SUMO's own message if it ends while loading, and all of [`Client::connect`].
    pub async fn connect(&mut self, limit: Duration) -> Result<Client, Error> {
        let deadline = Instant::now() + limit;
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let error = tokio::select! {
                biased;
                status = self.child.wait() => self.died(status.ok()),
                client = Client::connect(format!("127.0.0.1:{}", self.port), left) => match client {
                    // If ours has ended, a stranger answered on our port.
                    Ok(mut client) => match self.child.try_wait() {
                        Ok(Some(status)) => self.died(Some(status)),
                        _ => {
                            client.set_timeout(limit);
                            return Ok(client);
                        }
                    },
                    Err(error) => self.explain(error).await,
                },
            };
            if !self.restart_after(&error)? {
                return Err(error);
            }
        }
    }

    /// Starts SUMO again if it ended because its free port was taken meanwhile.
    fn restart_after(&mut self, error: &Error) -> Result<bool, Error> {
        let Error::Died { report, .. } = error else { return Ok(false) };
        if !is_port_trouble(report) {
            return Ok(false);
        }
        let Some(options) = self.again.as_mut().filter(|options| options.attempts > 0) else {
            return Err(Error::PortInUse { port: self.port });
        };
        options.attempts -= 1;
        self.port = free_port().map_err(|source| Error::Start { path: options.binary.path.clone(), source })?;
        self.child = start(&options.binary, &options.args, self.port, &self.log)?;
        Ok(true)
    }

    /// Makes more of an error of the client: if SUMO has ended, its exit code and what it said last.
    pub async fn explain(&mut self, error: Error) -> Error {
        if !matches!(error, Error::Disconnected(_) | Error::Finished | Error::Connect { .. }) {
            return error;
        }
        match timeout(LAST_WORDS, self.child.wait()).await {
            Ok(status) => self.died(status.ok()),
            Err(_) => error,
        }
    }

    fn died(&self, status: Option<ExitStatus>) -> Error {
        let status = status.map_or("exit code unknown".to_owned(), |status| status.to_string());
        Error::Died { status, report: last_words(&self.log) }
    }

    /// True while SUMO runs.
    pub fn is_running(&mut self) -> bool {
        matches!(self.child.try_wait(), Ok(None))
    }

    /// Waits up to `grace` for SUMO to end by itself, which it does when its clients are closed, and then kills it (SUMO
    /// ignores gentler signals). Gives its exit status: success only if it ended by itself, its outputs complete.
    ///
    /// # Errors
    /// [`Error::Died`] if it could not be waited for.
    pub async fn shut_down(mut self, grace: Duration) -> Result<ExitStatus, Error> {
        if let Ok(status) = timeout(grace, self.child.wait()).await {
            return status.map_err(|_| self.died(None));
        }
        tracing::warn!("SUMO does not end by itself; killing it");
        self.child.kill().await.map_err(|_| self.died(None))?;
        self.child.wait().await.map_err(|_| self.died(None))
    }
}

fn start(binary: &SumoBinary, args: &[String], port: u16, log: &Path) -> Result<Child, Error> {
    let log_error = |source| Error::Start { path: log.to_path_buf(), source };
    let out = File::create(log).and_then(|_| OpenOptions::new().append(true).open(log)).map_err(log_error)?;
    let err = out.try_clone().map_err(log_error)?;
    let mut command = Command::new(&binary.path);
    command.args(args).arg("--remote-port").arg(port.to_string());
    if let Some(home) = &binary.home {
        command.env("SUMO_HOME", home);
    }
    command.stdin(Stdio::null()).stdout(out).stderr(err).kill_on_drop(true);
    // A terminal's Ctrl-C must reach us only: SUMO is ended in order, with its outputs complete.
    #[cfg(unix)]
    command.process_group(0);
    command.spawn().map_err(|source| Error::Start { path: binary.path.clone(), source })
}

/// A port that is free at this moment.
fn free_port() -> std::io::Result<u16> {
    TcpListener::bind((Ipv4Addr::UNSPECIFIED, 0))?.local_addr().map(|address| address.port())
}

/// The last lines of a log, without the step counter and what SUMO says of commands that it declined: those are not why
/// it ended.
fn last_words(log: &Path) -> String {
    let mut bytes = Vec::new();
    let read = File::open(log).and_then(|mut file| {
        let length = file.metadata()?.len();
        file.seek(SeekFrom::Start(length.saturating_sub(REPORT_BYTES)))?;
        file.read_to_end(&mut bytes)
    });
    if let Err(error) = read {
        return if error.kind() == ErrorKind::NotFound { String::new() } else { error.to_string() };
    }
    let text = String::from_utf8_lossy(&bytes);
    let noise = |line: &str| line.starts_with("Step #") || line.starts_with("Error: Answered with error to command");
    let lines: Vec<_> = text.split(['\n', '\r']).filter(|line| !line.trim().is_empty() && !noise(line)).collect();
    lines[lines.len().saturating_sub(REPORT_LINES)..].join("\n")
}

/// SUMO's words for a port that somebody else has.
fn is_port_trouble(report: &str) -> bool {
    report.contains("bind") || report.contains("Address already in use")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A program for the search: anything that is not a script.
    fn program(path: PathBuf) -> PathBuf {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, b"\x7fELF").unwrap();
        path
    }

    fn script(path: &Path) {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, b"#!/usr/bin/env python3\n").unwrap();
    }

    #[test]
    fn the_search_goes_home_path_and_newest_version() {
        let root = tempfile::tempdir().unwrap();
        let at = |path: &str| root.path().join(path);
        let site = |version: &str| at(&format!(".sumo/{version}/lib/python3.11/site-packages/sumo/bin/sumo"));
        let local = at(".sumo");
        let find = |home: Option<&Path>, path: &[PathBuf]| search(home, path, &local, "sumo").map(|found| found.path);
        assert_eq!(find(Some(&at("home")), &[at("bin")]), None);
        program(site("1.9.0"));
        let newest = program(site("1.28.0"));
        assert_eq!(find(Some(&at("home")), &[at("bin")]), Some(newest), "1.28 is newer than 1.9");
        let on_path = program(at("bin/sumo"));
        assert_eq!(find(Some(&at("home")), &[at("bin")]), Some(on_path));
        let home = program(at("home/bin/sumo"));
        assert_eq!(find(Some(&at("home")), &[at("bin")]), Some(home));
    }

    #[test]
    fn a_launcher_script_is_resolved_to_the_binary_behind_it() {
        let root = tempfile::tempdir().unwrap();
        let launcher = root.path().join("venv/bin/sumo");
        script(&launcher);
        let path = [root.path().join("venv/bin")];
        assert_eq!(search(None, &path, root.path(), "sumo"), None, "a script is no binary");
        let real = program(root.path().join("venv/lib/python3.12/site-packages/sumo/bin/sumo"));
        std::fs::create_dir_all(root.path().join("venv/lib/python3.12/site-packages/sumo/data")).unwrap();
        let found = search(None, &path, root.path(), "sumo").unwrap();
        assert_eq!(found.path, real);
        assert_eq!(found.home, Some(root.path().join("venv/lib/python3.12/site-packages/sumo")));
        assert_eq!(find_sumo(Some(&launcher)).unwrap().path, real);
    }

    #[test]
    fn a_missing_sumo_says_what_to_type() {
        let error = find_sumo(Some(Path::new("nowhere/sumo"))).unwrap_err().to_string();
        assert_eq!(error, "no SUMO binary at nowhere/sumo (as given)");
        assert!(what_to_type(None, "sumo").contains("pip install eclipse-sumo==1.28.0"));
    }

    #[test]
    fn last_words_are_the_last_lines_without_the_step_counter() {
        let root = tempfile::tempdir().unwrap();
        let log = root.path().join("console.log");
        assert_eq!(last_words(&log), "");
        let lines: String = (0..30).map(|line| format!("line {line}\nStep #{line}.00\r\nError: Answered with error to command 0xa4: Vehicle 'a' is not known.\n")).collect();
        std::fs::write(&log, lines + "Error: bad").unwrap();
        let words = last_words(&log);
        assert_eq!(words.lines().count(), REPORT_LINES);
        assert!(words.starts_with("line 19\n") && words.ends_with("Error: bad"), "{words}");
    }

    #[tokio::test]
    async fn a_free_port_that_was_snatched_is_replaced() {
        let binary =
            search(None, &[], &Path::new(env!("CARGO_MANIFEST_DIR")).join(".sumo"), "sumo").expect("type make");
        let root = tempfile::tempdir().unwrap();
        let thief = TcpListener::bind((Ipv4Addr::UNSPECIFIED, 0)).unwrap();
        let port = thief.local_addr().unwrap().port();
        let log = root.path().join("console.log");
        let net = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/traci/grid.net.xml");
        let args = vec!["-n".to_owned(), net.display().to_string()];
        let child = start(&binary, &args, port, &log).unwrap();
        let mut process =
            SumoProcess { child, port, log, again: Some(SpawnOptions { binary, args, attempts: PORT_ATTEMPTS }) };
        let limit = Duration::from_secs(20);
        let client = process.connect(limit).await.unwrap();
        assert_ne!(process.port(), port);
        client.close().await.unwrap();
        assert!(process.shut_down(limit).await.unwrap().success());
    }
}
