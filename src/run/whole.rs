//! A run from its beginning to its end or to a signal, on threads of its own.

use super::error::RunError;
use super::progress::Progress;
use super::result::RunResult;
use super::session::{Session, SessionOptions};
use super::signals::Signals;
use crate::scenario::Scenario;

/// How a run is carried out; nothing here changes its result.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Where it writes.
    pub session: SessionOptions,
    /// Threads for the fleet; `None` = all cores.
    pub threads: Option<usize>,
    /// Show a progress bar.
    pub progress: bool,
    /// End as after SIGTERM when standard input ends, and tell on standard output how far the run is.
    pub tied: bool,
}

/// Runs a scenario to its end.
///
/// # Errors
/// [`RunError`]; if SUMO or the disk fails on the way, [`RunError::Broken`] with what was computed left in the folder.
pub fn run(scenario: &Scenario, options: &RunOptions) -> Result<RunResult, RunError> {
    let system = |error: &dyn std::fmt::Display| RunError::System(error.to_string());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads.unwrap_or(0)).build();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let (pool, runtime) = (pool.map_err(|e| system(&e))?, runtime.map_err(|e| system(&e))?);
    pool.install(|| {
        runtime.block_on(async {
            let signals = Signals::watch(options.tied).map_err(|e| system(&e))?;
            run_until(&signals, scenario, options).await
        })
    })
}

async fn run_until(signals: &Signals, scenario: &Scenario, options: &RunOptions) -> Result<RunResult, RunError> {
    let mut session = Session::open_unless(scenario, &options.session, signals.wait()).await?;
    let progress = Progress::new(options.progress, options.tied, &session);
    while signals.raised().is_none() && !session.is_over() {
        tokio::select! {
            stepped = session.step() => stepped?,
            signal = signals.overdue() => return Err(session.break_off(RunError::Interrupted(signal))),
        }
        progress.show(&session);
    }
    drop(progress);
    let interrupted = signals.raised();
    let result = match interrupted {
        Some(signal) => session.close(Some(RunError::Interrupted(signal).to_string())).await?,
        None => session.finish().await?,
    };
    Ok(RunResult { interrupted, ..result })
}
