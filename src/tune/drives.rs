//! What one set of gains is tried on: vehicles along recordings, each with noise and draws of its own.

use super::condition::{Condition, Slope};
use super::error::TuneError;
use super::gains::Gain;
use super::request::Request;
use crate::offline::{End, OfflineError, Outcome, Road, Trip};
use crate::reference::Profile;
use crate::scenario::{self, Catalog, Override, Scenario};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The cost of a vehicle that did not come to the end [m/s].
const UNFINISHED_MPS: f64 = 1000.0;
/// Vehicles that judge have other numbers than those that were tuned on, hence other noise.
const TEST: usize = 1_000_000;

/// A recording, and where it ends.
struct Recording {
    profile: Arc<Profile>,
    begin_mps: f64,
    end: End,
}

/// The recordings of one law in one condition.
pub struct Drives<'a> {
    catalog: &'a Catalog,
    request: scenario::Request,
    scenario: Scenario,
    train: Vec<Recording>,
    test: Vec<Recording>,
    seeds: usize,
    slope: Slope,
    torque_scale: f64,
}

/// How the vehicles of a trial did: RMS errors [m/s] by seed and recording; `None` did not come to the end.
pub struct Trial {
    errors_mps: Vec<Vec<Option<f64>>>,
}

impl<'a> Drives<'a> {
    pub fn new(
        request: &Request,
        catalog: &'a Catalog,
        condition: &Condition,
        controller: &str,
    ) -> Result<Self, TuneError> {
        let mut own = request.scenario.clone();
        own.overrides.push(Override::text("--controllers", "controller.name", controller));
        own.overrides.extend(condition.sets.iter().cloned());
        let recordings = |flag: &str, files: &[PathBuf]| -> Result<Vec<Recording>, TuneError> {
            files.iter().map(|file| recording(&own, catalog, flag, file)).collect()
        };
        let (train, test) = (recordings("--train", &request.train)?, recordings("--test", &request.test)?);
        let scenario = Scenario::load_offline(&own, catalog)?;
        let Condition { slope, torque_scale, .. } = *condition;
        Ok(Self { catalog, request: own, scenario, train, test, seeds: request.seeds, slope, torque_scale })
    }

    /// The scenario with the law's own gains.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Tries gains on the recordings to tune on.
    pub fn train(&self, gains: &[Gain], values: &[f64]) -> Result<Trial, TuneError> {
        self.trial(gains, values, &self.train, 0)
    }

    /// Tries gains on the recordings to judge on.
    pub fn test(&self, gains: &[Gain], values: &[f64]) -> Result<Trial, TuneError> {
        self.trial(gains, values, &self.test, TEST)
    }

    fn trial(
        &self,
        gains: &[Gain],
        values: &[f64],
        recordings: &[Recording],
        first: usize,
    ) -> Result<Trial, TuneError> {
        let mut request = self.request.clone();
        let set = |(gain, value): (&Gain, &f64)| {
            Override::literal("tune", &format!("controller.{}", gain.key), format!("{value:?}"))
        };
        request.overrides.extend(gains.iter().zip(values).map(set));
        let scenario = Scenario::load_offline(&request, self.catalog)?;
        let roads = recordings.iter().map(|recording| Road::with_profile(&scenario, Arc::clone(&recording.profile)));
        let roads: Vec<Road> = roads.collect::<Result<_, _>>()?;
        let mut trips: Vec<Trip> = Vec::new();
        for seed in 0..self.seeds {
            for (road, Recording { begin_mps, end, .. }) in roads.iter().zip(recordings) {
                let mut trip = road.trip(first + seed, *begin_mps, *end)?;
                trip.vehicle.nominal_nm_per_mps2 *= self.torque_scale;
                trips.push(trip);
            }
        }
        // A trip has its own profile, so that all share the blocks of one road.
        let outcomes = roads[0].drive(&trips, |vehicle| {
            let place_m = vehicle.distance_m();
            vehicle.set_grade(self.slope.at(place_m));
        })?;
        let error = |outcome: &Outcome| outcome.stats.error_rms.filter(|e| outcome.finished && e.is_finite());
        let by_seed = outcomes.chunks(recordings.len()).map(|seed| seed.iter().map(error).collect());
        Ok(Trial { errors_mps: by_seed.collect() })
    }
}

/// Reads a recording as the scenario's target would.
fn recording(request: &scenario::Request, catalog: &Catalog, flag: &str, file: &Path) -> Result<Recording, TuneError> {
    let mut request = request.clone();
    let file = file.to_string_lossy();
    for (key, value) in [("target.name", "profile"), ("target.shape", "file"), ("target.file", &*file)] {
        request.overrides.push(Override::text(flag, key, value));
    }
    // By time, so that a vehicle that hardly moves comes to the end as well.
    request.overrides.push(Override::text(flag, "target.by", "time"));
    let scenario = Scenario::load_offline(&request, catalog)?;
    let road = Road::new(&scenario)?;
    let end = road.end().ok_or(OfflineError::NoProfile)?;
    Ok(Recording { begin_mps: road.first_speed_mps(), end, profile: road.profile })
}

impl Trial {
    /// Mean RMS error over all vehicles [m/s].
    pub fn cost(&self) -> f64 {
        let all = self.errors_mps.iter().flatten();
        let count = all.clone().count() as f64;
        all.map(|error| error.unwrap_or(UNFINISHED_MPS)).sum::<f64>() / count
    }

    /// Mean RMS error over the recordings by seed [m/s]; none of a seed that did not come to all ends.
    pub fn by_seed(&self) -> Vec<Option<f64>> {
        let mean = |errors: &Vec<Option<f64>>| {
            let all: Option<Vec<f64>> = errors.iter().copied().collect();
            all.map(|all| all.iter().sum::<f64>() / all.len() as f64)
        };
        self.errors_mps.iter().map(mean).collect()
    }

    /// Vehicles that did not come to the end.
    pub fn unfinished(&self) -> usize {
        self.errors_mps.iter().flatten().filter(|error| error.is_none()).count()
    }
}
