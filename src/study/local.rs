//! Cases on this machine, each a process of its own with one thread and a SUMO of its own.
//!
//! A case ends with us, however we end: it watches its standard input, whose other end is held here, and ends in order
//! within a step when that is let go of. A kill closes it too.

use super::case::{State, note_failure, prepare};
use super::error::StudyError;
use super::plan::Case;
use super::work::{Ended, Work};
use crate::run::{MANIFEST, RunError, Signals};
use std::collections::BTreeMap;
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};
use tokio::process::{ChildStdin, Command};
use tokio::task::JoinSet;

/// How long the rest of a study that was killed may hold the folder of a case.
const LINGER: Duration = Duration::from_secs(20);

/// Runs the cases.
///
/// # Errors
/// [`StudyError`] if no processes can be started, or a folder cannot be written. A case that fails is no error.
pub fn execute(work: &Work<'_>) -> Result<Ended, StudyError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        let signals = Signals::watch(false)?;
        let mut pool = Pool { work, running: JoinSet::new(), ties: BTreeMap::new(), ended: 0, started: Instant::now() };
        for case in work.cases {
            while pool.running.len() >= work.jobs.max(1) && signals.raised().is_none() {
                pool.one_ends(&signals).await?;
            }
            if signals.raised().is_some() {
                break;
            }
            pool.start(case).await?;
        }
        while !pool.running.is_empty() {
            pool.one_ends(&signals).await?;
        }
        Ok(signals.raised().map_or(Ended::All, Ended::Interrupted))
    })
}

/// The cases under way.
struct Pool<'a> {
    work: &'a Work<'a>,
    running: JoinSet<(usize, std::io::Result<Output>)>,
    /// The other ends of their standard inputs, by case.
    ties: BTreeMap<usize, ChildStdin>,
    ended: usize,
    started: Instant,
}

impl Pool<'_> {
    async fn start(&mut self, case: &Case) -> Result<(), StudyError> {
        let plan = self.work.plan;
        let deadline = Instant::now() + LINGER;
        while let Err(error) = prepare(plan, case) {
            if !matches!(error, RunError::Busy { .. }) || Instant::now() > deadline {
                return Err(error.into());
            }
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
        let dir = plan.case_dir(case);
        let mut command = Command::new(self.work.program);
        command
            .args(["run", "--quiet", "--no-report", "--force", "--tied", "--threads", "1", "--from"])
            .arg(dir.join(MANIFEST));
        command.arg("-o").arg(&dir).env("SUMO_BINARY", &plan.sumo.path);
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        // A terminal's Ctrl-C reaches us only, and they end with us.
        #[cfg(unix)]
        command.process_group(0);
        let mut child = command.spawn()?;
        let number = case.number;
        self.ties.extend(child.stdin.take().map(|tie| (number, tie)));
        self.running.spawn(async move { (number, child.wait_with_output().await) });
        Ok(())
    }

    /// Waits for a case to end. After a signal all of them are told to.
    async fn one_ends(&mut self, signals: &Signals) -> Result<(), StudyError> {
        let joined = tokio::select! {
            joined = self.running.join_next() => joined,
            _ = signals.wait() => {
                self.ties.clear();
                self.running.join_next().await
            }
        };
        let Some(joined) = joined else { return Ok(()) };
        let (number, output) = joined.map_err(std::io::Error::from)?;
        self.ties.remove(&number);
        let case = &self.work.plan.cases[number - 1];
        if signals.raised().is_none() {
            note_failure(self.work.plan, case, &last_words(&output?))?;
            self.ended += 1;
            self.tell(case);
        }
        Ok(())
    }

    fn tell(&self, case: &Case) {
        let Work { plan, cases, quiet, .. } = self.work;
        if *quiet {
            return;
        }
        let (ended, all) = (self.ended, cases.len());
        let left_s = self.started.elapsed().as_secs_f64() / ended as f64 * (all - ended) as f64;
        let state = match State::of(plan, case) {
            State::Failed(reason) => format!("failed: {reason}"),
            state => state.as_str().to_owned(),
        };
        let (number, seed) = (case.number, case.seed);
        eprintln!(
            "[{ended}/{all}] case {number:04}, {}, seed {seed}: {state}; {left_s:.0} s left",
            plan.shown(case.setting)
        );
    }
}

/// Why a process has ended that did not say so itself.
fn last_words(output: &Output) -> String {
    let said = String::from_utf8_lossy(&output.stderr);
    let said: Vec<&str> = said.split_whitespace().collect();
    format!("{}: {}", output.status, said.join(" ")).trim_end_matches([':', ' ']).to_owned()
}
