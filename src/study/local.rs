//! Cases on this machine, each a process of its own with one thread and a SUMO of its own.
//!
//! A case ends with us, however we end: it watches its standard input, whose other end is held here, and ends in order
//! within a step when that is let go of. A kill closes it too.

use super::bars::{Bars, advance};
use super::case::{State, note_failure, prepare};
use super::error::StudyError;
use super::plan::Case;
use super::process;
use super::warming::warm_up;
use super::work::{Ended, Work};
use crate::run::{LINGER, RunError, Signals};
use indicatif::ProgressBar;
use std::collections::BTreeMap;
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::process::{ChildStdin, ChildStdout, Command};
use tokio::task::JoinSet;

/// Runs the cases.
///
/// # Errors
/// [`StudyError`] if no processes can be started, or a folder cannot be written. A case that fails is no error.
pub fn execute(work: &Work<'_>) -> Result<Ended, StudyError> {
    work.plan.write()?;
    let jobs = work.jobs.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    let warmed = warm_up(work.plan, work.cases, jobs, work.quiet)?;
    if warmed != Ended::All {
        return Ok(warmed);
    }
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        let signals = Signals::watch(false)?;
        let bars = Bars::new(work.cases.len(), work.quiet);
        let mut pool = Pool { work, running: JoinSet::new(), ties: BTreeMap::new(), bars };
        for case in work.cases {
            while pool.running.len() >= jobs && signals.raised().is_none() {
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
    bars: Bars,
}

impl Pool<'_> {
    async fn start(&mut self, case: &Case) -> Result<(), StudyError> {
        let plan = self.work.plan;
        let dir = plan.case_dir(case);
        let (planned, deadline) = (plan.manifest(case), Instant::now() + LINGER);
        while let Err(error) = prepare(&dir, &planned) {
            if !matches!(error, RunError::Busy { .. }) || Instant::now() > deadline {
                return Err(error.into());
            }
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
        let mut command =
            Command::from(process::command(self.work.program, (&plan.sumo.path, self.work.backend), &dir));
        command.stdout(Stdio::piped());
        // A terminal's Ctrl-C reaches us only, and they end with us.
        #[cfg(unix)]
        command.process_group(0);
        let mut child = command.spawn()?;
        let number = case.number;
        self.ties.extend(child.stdin.take().map(|tie| (number, tie)));
        let (bar, told) = (self.bars.start(plan, case), child.stdout.take());
        self.running.spawn(async move {
            let (output, ()) = tokio::join!(child.wait_with_output(), follow(told, &bar));
            bar.finish_and_clear();
            (number, output)
        });
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
            let (dir, planned) = (self.work.plan.case_dir(case), self.work.plan.manifest(case));
            note_failure(&dir, &planned, &process::last_words(&output?))?;
            self.tell(case);
        }
        Ok(())
    }

    fn tell(&self, case: &Case) {
        let plan = self.work.plan;
        let state = match State::of(plan, case) {
            State::Failed(reason) => format!("failed: {reason}"),
            state => state.as_str().to_owned(),
        };
        let (number, setting, seed) = (case.number, plan.shown(case.setting), case.seed);
        self.bars.end(&format!("case {number:04}, {setting}, seed {seed}: {state}"));
    }
}

/// Shows how far a case says it is, until it says no more.
async fn follow(told: Option<ChildStdout>, bar: &ProgressBar) {
    let Some(told) = told else { return };
    let mut lines = BufReader::new(told).lines();
    while let Ok(Some(line)) = lines.next_line().await {
        advance(bar, &line);
    }
}
