//! Where a block of vehicles is connected to the law of its group.

use super::signals::Actuation;
use crate::lanes::{LANES, Lanes};

/// What a block and the law of its group leave for each other.
#[derive(Debug, Clone, Copy, Default)]
pub struct Port {
    /// What the law remembers of a slot is void.
    pub(super) starts: [bool; LANES],
    /// What the actuators made of the last command.
    pub(super) actuation: Actuation,
    /// The law's answer [N·m].
    pub(super) torque_nm: Lanes,
}
