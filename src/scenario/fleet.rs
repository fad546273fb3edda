//! What a fleet is built from, as the scenario says.

use std::path::Path;

use super::{
    error::ScenarioError,
    model::{Choice, Group, Scenario},
};
use crate::{
    control::with_model,
    fleet::{GroupSetup, LoopConfig},
    keys::Keys,
    plant::{
        ActuatorKeys, BodyKeys,
        tyre::{identify, read_curve},
    },
    reference::{ReferenceError, Target},
};

impl Scenario {
    /// What all blocks of the fleet share.
    pub fn loop_config(&self) -> LoopConfig {
        LoopConfig {
            plant: (self.plant.entry.build)(&self.plant.values),
            period_s: self.coupling.control_period_s,
            reference_bound_mps: self.coupling.lead_mps,
        }
    }

    /// How the blocks of a group are made.
    pub fn blocks(&self, group: &Group) -> GroupSetup {
        let Choice { entry, values } = group.controller.clone();
        // A law with a model has the actuators of the group for it, those in the middle where they differ.
        let actuator = ActuatorKeys::from_values(&group.actuator.middle());
        let values = with_model(&values, actuator.delay_s, actuator.lag_s);
        let period_s = self.coupling.control_period_s;
        GroupSetup {
            law: Box::new(move || (entry.build)(&values, period_s)),
            dead_time_max_s: ActuatorKeys::from_values(&group.actuator.largest()).delay_s.max(self.dead_time_max_s),
        }
    }
}

impl Group {
    /// The group's target.
    ///
    /// # Errors
    /// [`ReferenceError`] if the profile cannot be read.
    pub fn load_target(&self) -> Result<Target, ReferenceError> {
        (self.target.entry.build)(&self.target.values, Path::new(""))
    }

    /// The content of the group's tyre curve, known to be one; none if the group names no file.
    ///
    /// # Errors
    /// [`ScenarioError::Tyre`]
    pub fn load_tyre_curve(&self) -> Result<Option<String>, ScenarioError> {
        let Some(path) = BodyKeys::from_values(&self.vehicle.body.values).tyre_curve else { return Ok(None) };
        let wrong = |what: String| ScenarioError::Tyre { path: path.clone(), what };
        let text = std::fs::read_to_string(&path).map_err(|e| wrong(e.to_string()))?;
        identify(&read_curve(&text).map_err(|e| wrong(e.to_string()))?).map_err(|e| wrong(e.to_string()))?;
        Ok(Some(text))
    }
}
