//! What a case came to, read from its folder alone.

use super::case::State;
use super::error::StudyError;
use super::metrics::{METRIC_COUNT, METRICS, Totals};
use super::plan::{Case, Plan};
use super::vehicles::Vehicles;
use crate::output::file_error;
use crate::run::{MANIFEST, Manifest, Summary};
use crate::sumo_files::{Conflicts, Trips};

/// What a case came to.
#[derive(Debug)]
pub struct CaseResult {
    /// How far it is.
    pub state: State,
    /// As [`METRICS`]; none of a case that is not done.
    pub values: [Option<f64>; METRIC_COUNT],
    /// Its vehicles; none of a case that is not done.
    pub vehicles: Vehicles,
}

impl CaseResult {
    /// Reads a case.
    ///
    /// # Errors
    /// [`StudyError::Output`] if a file of a whole result cannot be read.
    pub fn read(plan: &Plan, case: &Case) -> Result<Self, StudyError> {
        let state = State::of(plan, case);
        if state != State::Done {
            return Ok(Self { state, values: [None; METRIC_COUNT], vehicles: Vehicles::default() });
        }
        let (dir, setting) = (plan.case_dir(case), &plan.settings[case.setting]);
        let path = dir.join("summary.json");
        let text = std::fs::read_to_string(&path).map_err(file_error("read", &path))?;
        let summary: Summary = serde_json::from_str(&text).map_err(|error| file_error("read", &path)(error.into()))?;
        let manifest = Manifest::read(&dir.join(MANIFEST))?;
        // A run whose tripinfo cannot be read has said so; its time losses are missing.
        let named = |option| manifest.written(&dir, option);
        let trips = named("--tripinfo-output").and_then(|path| Trips::read(&path).ok()).unwrap_or_default();
        let mut vehicles = Vehicles::of_trips(&trips);
        vehicles.take_table(&dir.join(&setting.scenario.output.vehicles))?;
        if setting.scenario.output.quality {
            vehicles.take_table(&dir.join("quality.csv"))?;
        }
        // SUMO writes this file if any vehicle has the device, whoever asked for it.
        if let Some(path) = named("--device.ssm.file").filter(|path| path.is_file()) {
            vehicles.take_conflicts(&Conflicts::read(&path)?, setting.scenario.sumo.safety);
        }
        let totals = Totals { summary: &summary, vehicles: &vehicles };
        let values = METRICS.each_ref().map(|metric| (metric.read)(totals).filter(|value| value.is_finite()));
        Ok(Self { state, values, vehicles })
    }
}
