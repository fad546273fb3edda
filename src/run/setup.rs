//! From a scenario to what the world is made of: registries are asked, files of profiles and tyres are read.

use super::RunError;
use crate::cosim::{Display, Rules, WorldSetup};
use crate::scenario::Scenario;

/// The world of a scenario.
///
/// # Errors
/// A name that no registry has, or a file of a profile or tyre that cannot be used.
pub fn world(scenario: &Scenario) -> Result<WorldSetup, RunError> {
    let groups = &scenario.groups;
    Ok(WorldSetup {
        rules: Rules {
            groups: groups.clone(),
            tyre_curves: groups.iter().map(|group| group.load_tyre_curve()).collect::<Result<_, _>>()?,
            egos: scenario.egos.clone(),
            equipped: scenario.equipped()?,
            headway: scenario.traffic.headway_margin_s,
            seed: scenario.sumo.seed,
        },
        targets: groups.iter().map(|group| group.load_target()).collect::<Result<_, _>>()?,
        blocks: groups.iter().map(|group| scenario.blocks(group)).collect(),
        loop_config: scenario.loop_config(),
        grade: scenario.coupling.grade,
        quality: scenario.output.quality,
        platoons: scenario.output.platoons,
        friction: scenario.coupling.friction,
        sigma: scenario.traffic.sigma,
        trace: (scenario.output.trace.clone(), scenario.output.trace_period_s),
        display: Display { signals: scenario.sumo.fcd, colours: scenario.sumo.gui },
        shared: scenario.sumo.is_shared(),
    })
}
