//! What a coupling is made of.

use super::admission::Rules;
use super::display::Display;
use crate::fleet::{GroupSetup, LoopConfig};
use crate::reference::Target;
use crate::scenario::Trace;

/// What a world is made of.
pub struct WorldSetup {
    /// Who becomes an ego, and what of.
    pub rules: Rules,
    /// The target of each group.
    pub targets: Vec<Target>,
    /// How each group's blocks are made.
    pub blocks: Vec<GroupSetup>,
    /// Plant, control period, bound of the reference.
    pub loop_config: LoopConfig,
    /// The drive quality of egos is kept.
    pub quality: bool,
    /// Who follows whom is kept.
    pub platoons: bool,
    /// Bodies feel the slope of SUMO's road.
    pub grade: bool,
    /// Bodies feel the friction of SUMO's lanes.
    pub friction: bool,
    /// Driver imperfection given to every ego, if any.
    pub sigma: Option<f64>,
    /// Whose trajectories are wanted, and how often \[s\] if not in every step.
    pub trace: (Trace, Option<f64>),
    /// What egos show of themselves in SUMO.
    pub display: Display,
    /// True if other clients may be at this SUMO.
    pub shared: bool,
}
