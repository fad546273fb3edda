//! Is the loop of a law stable, by how much, and what does a string of vehicles make of it?
//!
//! For every law, lag and dead time of the actuators: gain and delay margin of the linear loop, computed from its response and found again by
//! raising gain and delay in the full model until the loop swings up; and a leader with ten followers, each with body, lower law and an
//! upper law that keeps the gap, through sinusoids of many periods and a step. Vehicles drive without SUMO, in the fleet that `run` uses.

mod closed_loop;
mod error;
mod job;
mod margins;
mod request;
mod rows;
mod strings;

use crate::scenario::{Catalog, Override, Scenario};
use closed_loop::ClosedLoop;
pub use error::StabilityError;
use indicatif::ProgressBar;
use job::Job;
use rayon::prelude::*;
pub use request::Request;
pub use rows::{MarginRow, StringRow, SweepRow, margin_layout, string_layout, sweep_layout};

/// What was found.
#[derive(Debug, Clone, Default)]
pub struct Found {
    /// A row per law, lag and dead time.
    pub margins: Vec<MarginRow>,
    /// A row per upper law, law, lag and dead time.
    pub strings: Vec<StringRow>,
    /// The same for every period of the leader.
    pub sweep: Vec<SweepRow>,
}

/// Examines all laws.
///
/// # Errors
/// [`StabilityError`] if the scenario is wrong, a name is not known, a controller is no law, or an upper law keeps no gap.
pub fn examine(request: &Request, catalog: &Catalog) -> Result<Found, StabilityError> {
    let mut jobs = Vec::new();
    for controller in request.laws(catalog)? {
        for &lag_s in &request.lags_s {
            for &delay_s in &request.delays_s {
                jobs.push(Job { controller: controller.clone(), lag_s, delay_s });
            }
        }
    }
    let bar = if request.progress { ProgressBar::new(jobs.len() as u64) } else { ProgressBar::hidden() };
    let found = jobs.par_iter().map(|job| {
        let found = one(job, request, catalog);
        bar.inc(1);
        found
    });
    let found: Vec<Found> = found.collect::<Result<_, StabilityError>>()?;
    bar.finish_and_clear();
    let mut whole = Found::default();
    for found in found {
        whole.margins.extend(found.margins);
        whole.strings.extend(found.strings);
        whole.sweep.extend(found.sweep);
    }
    whole.strings.sort_by_key(|row| request.place(&row.upper));
    whole.sweep.sort_by_key(|row| request.place(&row.upper));
    Ok(whole)
}

fn one(job: &Job, request: &Request, catalog: &Catalog) -> Result<Found, StabilityError> {
    let scenario = |upper: Option<&str>| -> Result<Scenario, StabilityError> {
        let mut own = request.scenario.clone();
        own.overrides.push(Override::text("--controllers", "controller.name", &job.controller));
        own.overrides.push(Override::literal("--lag", "actuator.lag_s", format!("{:?}", job.lag_s)));
        own.overrides.push(Override::literal("--delay", "actuator.delay_s", format!("{:?}", job.delay_s)));
        own.overrides.extend(upper.map(|upper| Override::text("--uppers", "target.name", upper)));
        Ok(Scenario::load_offline(&own, catalog)?)
    };
    let alone = scenario(None)?;
    let margins = vec![rows::margin_row(job, &margins::margins(&ClosedLoop::new(&alone)?)?)];
    let (mut strings, mut sweep) = (Vec::new(), Vec::new());
    for upper in &request.uppers {
        let found = strings::string(&scenario(Some(upper))?, upper)?;
        strings.push(rows::string_row(job, upper, &found));
        sweep.extend(rows::sweep_rows(job, upper, &found));
    }
    Ok(Found { margins, strings, sweep })
}
