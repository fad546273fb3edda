//! Simulates warm-ups, each a SUMO of its own without a client.

use super::error::StudyError;
use super::plan::{Case, Plan};
use super::warm_up::WarmUp;
use super::work::Ended;
use crate::output::file_error;
use crate::run::Signals;
use crate::sumo_files::{SumoSetup, saving, sumo_arguments};
use crate::traci::{Tie, tied};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Stdio;
use std::time::Instant;
use tokio::task::JoinSet;

/// The warm-ups of these cases that are not there.
pub fn missing(plan: &Plan, cases: &[&Case]) -> Vec<WarmUp> {
    let mut seen = BTreeSet::new();
    let wanted = cases.iter().filter_map(|case| plan.warm_up(case)).filter(|w| seen.insert(w.state.clone()));
    wanted.filter(|warm_up| !warm_up.state.is_file()).collect()
}

/// Simulates the warm-ups of these cases that are not there.
///
/// # Errors
/// [`StudyError::WarmUp`] with what SUMO said, if it cannot.
pub fn warm_up(plan: &Plan, cases: &[&Case], jobs: usize, quiet: bool) -> Result<Ended, StudyError> {
    let todo = missing(plan, cases);
    if todo.is_empty() {
        return Ok(Ended::All);
    }
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        let (signals, started, all) = (Signals::watch(false)?, Instant::now(), todo.len());
        let (mut running, mut ended) = (JoinSet::new(), 0);
        let mut todo = todo.into_iter();
        loop {
            while running.len() < jobs.max(1)
                && let Some(warm_up) = todo.next()
            {
                running.spawn(simulate(plan.sumo.path.clone(), warm_up));
            }
            let joined = tokio::select! {
                joined = running.join_next() => joined,
                // What is under way ends as it is dropped.
                signal = signals.wait() => return Ok(Ended::Interrupted(signal)),
            };
            let Some(joined) = joined else { return Ok(Ended::All) };
            let seed = joined.map_err(std::io::Error::from)??;
            ended += 1;
            if !quiet {
                let took_s = started.elapsed().as_secs_f64();
                eprintln!("[warm-up {ended}/{all}] seed {seed}: done after {took_s:.0} s");
            }
        }
    })
}

/// Lets SUMO simulate, save its state, and end. The state takes its name when it is whole.
async fn simulate(sumo: PathBuf, warm_up: WarmUp) -> Result<u64, StudyError> {
    let WarmUp { setup, until_s, state } = warm_up;
    let seed = setup.seed;
    let dir = state.parent().unwrap_or(&state);
    std::fs::create_dir_all(dir).map_err(file_error("create", dir))?;
    // It goes with this function, however that ends.
    let folder = tempfile::Builder::new().prefix(".warm_up-").tempdir_in(dir).map_err(file_error("create", dir))?;
    let outputs = folder.path().join("sumo");
    std::fs::create_dir(&outputs).map_err(file_error("create", &outputs))?;
    let part = folder.path().join("state.xml.gz");
    let options = setup.options.iter().cloned().chain(saving(until_s, &part)).collect();
    let end = setup.end_s.unwrap_or(until_s).to_string();
    let mut arguments = sumo_arguments(&SumoSetup { options, ..setup }, folder.path())?.arguments;
    arguments.extend(["--end".to_owned(), end]);
    let (tie, theirs) = Tie::new()?;
    let mut command = tied(&sumo, theirs);
    command.args(arguments).stdout(Stdio::null()).stderr(Stdio::piped()).kill_on_drop(true);
    #[cfg(unix)]
    command.process_group(0);
    let output = command.output().await?;
    tie.release();
    if !output.status.success() || !part.is_file() {
        let said = String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        return Err(StudyError::WarmUp { seed, what: format!("{}: {said}", output.status) });
    }
    std::fs::rename(&part, &state).map_err(file_error("rename", &part))?;
    Ok(seed)
}
