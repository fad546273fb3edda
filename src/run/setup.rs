//! From a scenario to what the world is made of: registries are asked, files of profiles and tyres are read.

use super::error::RunError;
use crate::cosim::{Rules, WorldSetup};
use crate::fleet::{GroupSetup, LoopConfig};
use crate::plant::DEAD_TIME_MAX_S;
use crate::plant::tyre::{identify, read_curve};
use crate::scenario::{Choice, Group, Scenario};
use std::path::{Path, PathBuf};

/// The world of a scenario.
///
/// # Errors
/// A name that no registry has, or a file of a profile or tyre that cannot be used.
pub fn world(scenario: &Scenario) -> Result<WorldSetup, RunError> {
    let targets = scenario.groups.iter().map(|g| Ok((g.target.entry.build)(&g.target.values, Path::new(""))?));
    let tyre_curves = scenario.groups.iter().map(tyre_curve);
    let blocks = scenario.groups.iter().map(|group| Ok(block(group, scenario.coupling.control_period_s)));
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
        loop_config: loop_config(scenario),
        grade: scenario.coupling.grade,
        sigma: scenario.traffic.sigma,
        shared: scenario.sumo.connect.is_some() || scenario.sumo.num_clients > 1,
    })
}

/// What all blocks of a scenario's fleet share.
pub fn loop_config(scenario: &Scenario) -> LoopConfig {
    LoopConfig {
        plant: (scenario.plant.entry.build)(&scenario.plant.values),
        period_s: scenario.coupling.control_period_s,
        reference_bound_mps: scenario.coupling.lead_mps,
    }
}

/// How the blocks of a group are made.
pub fn block(group: &Group, period_s: f64) -> GroupSetup {
    let Choice { entry, values } = group.controller.clone();
    GroupSetup {
        controller: Box::new(move || (entry.build)(&values, period_s).expect("a law")),
        dead_time_max_s: group
            .actuator
            .largest("delay_s")
            .map_or(DEAD_TIME_MAX_S, |delay_s| DEAD_TIME_MAX_S.min(delay_s)),
    }
}

/// The content of the group's tyre curve, known to be one.
fn tyre_curve(group: &Group) -> Result<Option<String>, RunError> {
    let Some(path) = group.vehicle.body.values.get::<PathBuf>("tyre_curve") else { return Ok(None) };
    let wrong = |what: String| RunError::Tyre { path: path.clone(), what };
    let text = std::fs::read_to_string(&path).map_err(|e| wrong(e.to_string()))?;
    identify(&read_curve(&text).map_err(|e| wrong(e.to_string()))?).map_err(|e| wrong(e.to_string()))?;
    Ok(Some(text))
}
