//! SUMO as a child process.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::ExitStatus;
use std::time::Duration;

use tokio::process::Child;
use tokio::time::{Instant, timeout};

use super::client::Client;
use super::error::Error;
use super::find::SumoBinary;
use super::tie::{Tie, tied};

/// How long a SUMO whose connection broke may take until its exit code is there.
const LAST_WORDS: Duration = Duration::from_secs(2);
/// Lines and bytes of SUMO's log shown in errors.
const REPORT_LINES: usize = 12;
const REPORT_BYTES: u64 = 16_384;
/// How often a free port may be snatched away before we give up.
const PORT_ATTEMPTS: usize = 5;

/// A SUMO that we started. Dropping it kills it, and so does the end of this program; better is [`SumoProcess::shut_down`].
#[derive(Debug)]
pub struct SumoProcess {
    child: Child,
    tie: Tie,
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
        let (child, tie) = start(binary, args, port, &log)?;
        tracing::debug!(binary = %binary.path.display(), port, "started SUMO");
        Ok(Self { child, tie, port, log, again })
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
        let (child, tie) = start(&options.binary, &options.args, self.port, &self.log)?;
        self.child = child;
        std::mem::replace(&mut self.tie, tie).release();
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

    /// Waits up to `grace` for SUMO to end because all its clients have left, and otherwise leaves it to those that have not.
    pub async fn leave(mut self, grace: Duration) -> Option<ExitStatus> {
        let ended = timeout(grace, self.child.wait()).await.ok().and_then(Result::ok);
        self.tie.release();
        if ended.is_none() {
            // What is dropped is killed.
            std::mem::forget(self.child);
        }
        ended
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
        let by_itself = timeout(grace, self.child.wait()).await;
        let ended = match by_itself {
            Ok(ended) => ended,
            Err(_) => {
                tracing::warn!("SUMO does not end by itself; killing it");
                match self.child.kill().await {
                    Ok(()) => self.child.wait().await,
                    Err(error) => Err(error),
                }
            }
        };
        let ended = ended.map_err(|_| self.died(None));
        self.tie.release();
        ended
    }
}

fn start(binary: &SumoBinary, args: &[String], port: u16, log: &Path) -> Result<(Child, Tie), Error> {
    let log_error = |source| Error::Start { path: log.to_path_buf(), source };
    let out = File::create(log).and_then(|_| OpenOptions::new().append(true).open(log)).map_err(log_error)?;
    let err = out.try_clone().map_err(log_error)?;
    let failed = |source| Error::Start { path: binary.path.clone(), source };
    let (tie, theirs) = Tie::new().map_err(failed)?;
    let mut command = tied(&binary.path, theirs);
    command.args(args).arg("--remote-port").arg(port.to_string());
    if let Some(home) = &binary.home {
        command.env("SUMO_HOME", home);
    }
    command.stdout(out).stderr(err).kill_on_drop(true);
    // A terminal's Ctrl-C must reach us only: SUMO is ended in order, with its outputs complete.
    #[cfg(unix)]
    command.process_group(0);
    command.spawn().map(|child| (child, tie)).map_err(failed)
}

/// A port that is free at this moment.
fn free_port() -> std::io::Result<u16> {
    TcpListener::bind((Ipv4Addr::UNSPECIFIED, 0))?.local_addr().map(|address| address.port())
}

/// The last lines of a log, without the step counter and what SUMO says of commands that it declined: those are not why
/// it ended.
pub(crate) fn last_words(log: &Path) -> String {
    let (mut bytes, mut begin) = (Vec::new(), 0);
    let read = File::open(log).and_then(|mut file| {
        begin = file.metadata()?.len().saturating_sub(REPORT_BYTES);
        file.seek(SeekFrom::Start(begin))?;
        file.read_to_end(&mut bytes)
    });
    if let Err(error) = read {
        return if error.kind() == ErrorKind::NotFound { String::new() } else { error.to_string() };
    }
    let mut text = String::from_utf8_lossy(&bytes).into_owned();
    if let (true, Some((_, whole_lines))) = (begin > 0, text.split_once('\n')) {
        text = whole_lines.to_owned();
    }
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
    use super::super::find::find_sumo;
    use super::*;

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
        let long = "word ".repeat(REPORT_BYTES as usize);
        std::fs::write(&log, format!("{long}\nError: bad")).unwrap();
        assert_eq!(last_words(&log), "Error: bad", "nothing begins in the middle of a line");
    }

    #[tokio::test]
    async fn a_free_port_that_was_snatched_is_replaced() {
        let binary = find_sumo(None).expect("type make");
        let root = tempfile::tempdir().unwrap();
        let thief = TcpListener::bind((Ipv4Addr::UNSPECIFIED, 0)).unwrap();
        let port = thief.local_addr().unwrap().port();
        let log = root.path().join("console.log");
        let net = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/traci/grid.net.xml");
        let args = vec!["-n".to_owned(), net.display().to_string()];
        let (child, tie) = start(&binary, &args, port, &log).unwrap();
        let mut process =
            SumoProcess { child, tie, port, log, again: Some(SpawnOptions { binary, args, attempts: PORT_ATTEMPTS }) };
        let limit = Duration::from_secs(20);
        let client = process.connect(limit).await.unwrap();
        assert_ne!(process.port(), port);
        client.close().await.unwrap();
        assert!(process.shut_down(limit).await.unwrap().success());
    }
}
