//! What a fleet and its vehicles are made of.

use crate::control::Law;
use crate::plant::{Body, Plant};
use crate::random::Stream;
use crate::stats::RoadLoad;

/// The actuators between command and wheels, for one vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ActuatorSetup {
    /// Dead time of the torque \[s\].
    pub dead_time_s: f64,
    /// First-order lag of the torque \[s\].
    pub lag_s: f64,
}

/// All that makes one vehicle, in SI.
#[derive(Debug, Clone)]
pub struct VehicleSetup {
    /// The body as it is.
    pub body: Body,
    /// Torque per acceleration of the *nominal* body, which is all that a controller may know [N·m per m/s²].
    pub nominal_nm_per_mps2: f64,
    /// Actuators.
    pub actuator: ActuatorSetup,
    /// Noise on the measured speed: the vehicle's stream and σ [m/s].
    pub noise: Option<(Stream, f64)>,
    /// Speed at which it enters [m/s].
    pub speed_mps: f64,
}

/// How blocks of one group are made.
pub struct GroupSetup {
    /// Makes the law of one block, or of the whole group.
    pub law: Box<dyn Fn() -> Law + Send + Sync>,
    /// Largest dead time that a vehicle of this group may have \[s\].
    pub dead_time_max_s: f64,
}

/// What all blocks share.
pub struct LoopConfig {
    /// The plant model.
    pub plant: Box<dyn Plant>,
    /// Control period \[s\].
    pub period_s: f64,
    /// The reference that is carried from step to step stays within this of the body's speed [m/s].
    pub reference_bound_mps: f64,
}

/// What resists a body on a flat road.
pub(super) fn road_load(body: &Body) -> RoadLoad {
    RoadLoad {
        effective_mass_kg: body.effective_mass_kg(),
        rolling_n: body.rolling_n(),
        drag_ns2pm2: body.drag_ns2pm2(),
        drive_front_share: body.drive_front_share,
        brake_front_share: body.brake_front_share,
    }
}

/// The friction of the wheel that has least.
pub(super) fn least(friction: [f64; 4]) -> f64 {
    friction.into_iter().fold(f64::INFINITY, f64::min)
}
