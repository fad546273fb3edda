//! What the statistics are told: the end of a control period, the end of a SUMO step.

use crate::lanes::{Flags, Lanes};

/// The end of one control period of a block.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sample {
    /// True speed V_x [m/s].
    pub speed_mps: Lanes,
    /// Reference speed y_ref [m/s].
    pub reference_mps: Lanes,
    /// Torque applied, sum over the wheels, positive drives [N·m].
    pub torque_nm: Lanes,
    /// 1 where a vehicle drove. Other slots' values are not looked at.
    pub active: Flags,
}

/// The end of one SUMO step of a block. Of the four `bound_*` exactly one is 1 for an active slot.
#[derive(Debug, Clone, Copy, Default)]
pub struct StepSample {
    /// V_x − v* [m/s].
    pub speed_gap_mps: Lanes,
    /// 1 where the reference's memory hit its bound.
    pub lead_limited: Flags,
    /// 1 where the curvature had to be limited.
    pub curvature_limited: Flags,
    /// 1 where the traffic (SUMO's car-following, lights, ...) gave the target.
    pub bound_traffic: Flags,
    /// 1 where a speed limit gave the target.
    pub bound_limit: Flags,
    /// 1 where a profile gave the target.
    pub bound_profile: Flags,
    /// 1 where SUMO clamped the commanded speed.
    pub bound_clamp: Flags,
    /// 1 where a vehicle drove.
    pub active: Flags,
}
