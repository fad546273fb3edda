//! All runs of a comparison, several at the same time.

use super::paired::{ControllerRow, compare};
use crate::run::Summary;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// A run of a comparison failed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the run of {controller} with seed {seed} failed: {source}")]
pub struct RunFailed<E: std::error::Error + 'static> {
    /// The controller.
    pub controller: String,
    /// The seed.
    pub seed: u64,
    /// Why.
    pub source: E,
}

/// Runs every controller with every seed, `jobs` of them at a time, and compares them. After a failure no further run is
/// started. The result does not depend on `jobs`.
///
/// # Errors
/// [`RunFailed`] with the first failure, in the order seed by seed, controller by controller.
pub fn run_all<E: std::error::Error + Send + 'static>(
    controllers: &[String],
    seeds: &[u64],
    jobs: usize,
    run: impl Fn(&str, u64) -> Result<Summary, E> + Sync,
) -> Result<Vec<ControllerRow>, RunFailed<E>> {
    let all: Vec<(&String, u64)> = seeds.iter().flat_map(|s| controllers.iter().map(move |c| (c, *s))).collect();
    let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
    let results = Mutex::new(Vec::with_capacity(all.len()));
    let work = || {
        while !failed.load(Ordering::Relaxed) {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some((controller, seed)) = all.get(place) else { break };
            let result = run(controller, *seed);
            failed.fetch_or(result.is_err(), Ordering::Relaxed);
            results.lock().unwrap_or_else(PoisonError::into_inner).push((place, result));
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..jobs.min(all.len()) {
            scope.spawn(work);
        }
        work();
    });
    let mut results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.sort_by_key(|(place, _)| *place);
    let mut runs: Vec<(String, Vec<Summary>)> = controllers.iter().map(|c| (c.clone(), Vec::new())).collect();
    for (place, result) in results {
        let (controller, seed) = all[place];
        let summary = result.map_err(|source| RunFailed { controller: controller.clone(), seed, source })?;
        runs[place % controllers.len()].1.push(summary);
    }
    Ok(compare(&runs))
}
