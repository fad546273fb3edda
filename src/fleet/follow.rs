//! What a step is driven towards.

use crate::lanes::LANES;
use crate::reference::Profile;

/// Where the reference of a step comes from.
#[derive(Clone, Copy)]
pub enum Follow<'a> {
    /// SUMO chose a speed for the end of the step; the reference is the ramp to it.
    Traffic,
    /// The target speed is held for the whole step; it may have jumped.
    Target,
    /// A profile over the vehicle's own distance or time, never above the target speed.
    Profile(&'a Profile),
    /// The same with a profile for each slot.
    Profiles(&'a [&'a Profile; LANES]),
}

/// What bound the target of a slot in the running step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bound {
    /// SUMO's own choice.
    Traffic,
    /// The lane's limit.
    Limit,
    /// The profile.
    Profile,
    /// SUMO clamped the commanded speed.
    Clamp,
}
