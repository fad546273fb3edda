//! From a scenario to what the world is made of: registries are asked, files of profiles and tyres are read.

use super::RunError;
use crate::control::CONTROLLERS;
use crate::cosim::bodies::DEAD_TIME_MAX_S;
use crate::cosim::{Rules, WorldSetup};
use crate::fleet::{GroupSetup, LoopConfig};
use crate::plant::PLANTS;
use crate::plant::tyre::{identify, read_curve};
use crate::reference::TARGETS;
use crate::registry::find;
use crate::scenario::{Group, Scenario};
use std::path::{Path, PathBuf};

/// The world of a scenario.
///
/// # Errors
/// A name that no registry has, or a file of a profile or tyre that cannot be used.
pub fn world(scenario: &Scenario) -> Result<WorldSetup, RunError> {
    let targets = scenario.groups.iter().map(|group| {
        let entry = find("target", TARGETS, group.target.name)?;
        Ok((entry.build)(&group.target.values, Path::new(""))?)
    });
    let tyre_curves = scenario.groups.iter().map(tyre_curve);
    let blocks = scenario.groups.iter().map(|group| block(group, scenario.control_period_s));
    Ok(WorldSetup {
        rules: Rules {
            groups: scenario.groups.clone(),
            tyre_curves: tyre_curves.collect::<Result<_, RunError>>()?,
            egos: scenario.egos.clone(),
            equipped: scenario.equipped()?,
            seed: scenario.sumo.seed,
        },
        targets: targets.collect::<Result<_, RunError>>()?,
        blocks: blocks.collect::<Result<_, RunError>>()?,
        loop_config: loop_config(scenario)?,
        grade: scenario.coupling.grade,
        sigma: scenario.traffic.sigma,
        shared: scenario.sumo.connect.is_some() || scenario.sumo.num_clients > 1,
    })
}

/// What all blocks of a scenario's fleet share.
///
/// # Errors
/// [`RunError::Unknown`] if there is no such plant.
pub fn loop_config(scenario: &Scenario) -> Result<LoopConfig, RunError> {
    let plant = find("plant", PLANTS, scenario.plant.name)?;
    Ok(LoopConfig {
        plant: (plant.build)(&scenario.plant.values),
        period_s: scenario.control_period_s,
        reference_bound_mps: scenario.coupling.lead_mps,
    })
}

/// How the blocks of a group are made.
///
/// # Errors
/// [`RunError::Unknown`] if there is no such controller.
pub fn block(group: &Group, period_s: f64) -> Result<GroupSetup, RunError> {
    let entry = find("controller", CONTROLLERS, group.controller.name)?;
    let values = group.controller.values.clone();
    Ok(GroupSetup {
        controller: Box::new(move || (entry.build)(&values, period_s)),
        dead_time_max_s: DEAD_TIME_MAX_S.min(group.actuator.delay_s.largest()),
    })
}

/// The content of the group's tyre curve, known to be one.
fn tyre_curve(group: &Group) -> Result<Option<String>, RunError> {
    let Some(path) = group.vehicle.values.try_text("tyre_curve") else { return Ok(None) };
    let wrong = |what: String| RunError::Tyre { path: PathBuf::from(path), what };
    let text = std::fs::read_to_string(path).map_err(|e| wrong(e.to_string()))?;
    identify(&read_curve(&text).map_err(|e| wrong(e.to_string()))?).map_err(|e| wrong(e.to_string()))?;
    Ok(Some(text))
}
