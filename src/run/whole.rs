//! A run from its beginning to its end or to a signal, on threads of its own.

use super::error::RunError;
#[cfg(target_os = "linux")]
use super::one_core::OneCore;
use super::options::SessionOptions;
use super::progress::Progress;
use super::remote::Remote;
use super::result::RunResult;
use super::result_dir::ResultDir;
use super::session::Session;
use super::signals::Signals;
use super::tied::handed_over;
use crate::scenario::Scenario;
use std::time::Duration;
#[cfg(target_os = "linux")]
use std::time::Instant;

/// A step that takes longer than this is told.
const SLOW: Duration = Duration::from_secs(10);

/// The stack of a thread, as large as that of a program's first one: SUMO may run in it.
const STACK_BYTES: usize = 8 << 20;

/// How a run is carried out; nothing here changes its result.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Where it writes.
    pub session: SessionOptions,
    /// Threads for the fleet; `None` = all cores.
    pub threads: Option<usize>,
    /// Show a progress bar.
    pub progress: bool,
    /// End as after SIGTERM when standard input ends, and tell on standard output how far the run is. The folder is cleared
    /// whatever it holds.
    pub tied: bool,
}

/// Runs a scenario to its end, or to a signal that this process gets.
///
/// # Errors
/// [`RunError`]; if SUMO or the disk fails on the way, [`RunError::Broken`] with what was computed left in the folder.
pub fn run(scenario: &Scenario, options: &RunOptions) -> Result<RunResult, RunError> {
    run_with(scenario, options, &Remote::default(), || Signals::watch(options.tied))
}

/// Runs a scenario to its end, or until `remote` is told to end it. It looks after no signals, so that it can run in
/// programs that do so themselves.
///
/// # Errors
/// As [`run`].
pub fn run_remote(scenario: &Scenario, options: &RunOptions, remote: &Remote) -> Result<RunResult, RunError> {
    run_with(scenario, options, remote, || Ok(Signals::of(remote.raised())))
}

fn run_with(
    scenario: &Scenario,
    options: &RunOptions,
    remote: &Remote,
    signals: impl FnOnce() -> std::io::Result<Signals> + Send,
) -> Result<RunResult, RunError> {
    let system = |error: &dyn std::fmt::Display| RunError::System(error.to_string());
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(options.threads.unwrap_or(0)).stack_size(STACK_BYTES).build();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let (pool, runtime) = (pool.map_err(|e| system(&e))?, runtime.map_err(|e| system(&e))?);
    pool.install(|| {
        runtime.block_on(async {
            let signals = signals().map_err(|e| system(&e))?;
            run_until(&signals, scenario, options, remote).await
        })
    })
}

/// Tells that a step takes long: SUMO may be waiting for another client, or hang.
async fn tell_if_slow(options: &SessionOptions) {
    for waited in 1.. {
        tokio::time::sleep(SLOW).await;
        let waited_s = waited * SLOW.as_secs();
        options.tell(&format!(
            "SUMO has not answered for {waited_s} s; the run waits until --timeout, Ctrl-C ends it with what there is"
        ));
    }
}

async fn run_until(
    signals: &Signals,
    scenario: &Scenario,
    options: &RunOptions,
    remote: &Remote,
) -> Result<RunResult, RunError> {
    let SessionOptions { out_dir, force, .. } = &options.session;
    let dir = if options.tied { handed_over(out_dir).await } else { ResultDir::create(out_dir, *force) }?;
    let mut session = Session::open_unless(scenario, dir, &options.session, signals.wait()).await?;
    let progress = Progress::new(options.progress, options.tied, &session);
    #[cfg(target_os = "linux")]
    let mut one_core = OneCore::of(&session);
    while signals.raised().is_none() && !session.is_over() {
        let slow = tell_if_slow(&options.session);
        #[cfg(target_os = "linux")]
        let begun = Instant::now();
        tokio::select! {
            stepped = session.step() => stepped?,
            signal = signals.overdue() => return Err(session.break_off(RunError::Interrupted(signal))),
            () = slow => unreachable!("it tells for ever"),
        }
        #[cfg(target_os = "linux")]
        one_core.iter_mut().for_each(|one_core| one_core.stepped(begun.elapsed()));
        progress.show(&session);
        remote.show(session.times());
    }
    drop(progress);
    #[cfg(target_os = "linux")]
    drop(one_core);
    let interrupted = signals.raised();
    let result = match interrupted {
        Some(signal) => session.close(Some(RunError::Interrupted(signal).to_string()), signals.overdue()).await?,
        None => session.close(None, signals.overdue()).await?,
    };
    Ok(RunResult { interrupted, ..result })
}
