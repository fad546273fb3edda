//! What the statistics say about one vehicle.

/// Sums of a slot since they were last taken, for tables by place: see `StatsBlock::take_sums`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sums {
    /// Control periods.
    pub samples: u64,
    /// Σ e [m/s].
    pub error_mps: f64,
    /// Σ e² [m²/s²].
    pub error_squared: f64,
    /// Σ V_x [m/s].
    pub speed_mps: f64,
}

/// The statistics of one vehicle; `None` where nothing was there to be averaged.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct VehicleStats {
    /// Control periods.
    pub samples: u64,
    /// Mean of e [m/s].
    pub error_mean: Option<f64>,
    /// Standard deviation of e, divided by n [m/s].
    pub error_std: Option<f64>,
    /// Root mean square of e [m/s].
    pub error_rms: Option<f64>,
    /// Largest |e| [m/s].
    pub error_max_abs: Option<f64>,
    /// Largest overshoot beyond a reference that has risen, else 0 [m/s].
    pub overshoot_max: Option<f64>,
    /// Root mean square of V_x − v* at the ends of SUMO steps [m/s].
    pub speed_gap_rms: Option<f64>,
    /// Root mean square of the jerk; none before two windows have passed [m/s³].
    pub jerk_rms: Option<f64>,
    /// Largest acceleration of a window; none before one has passed [m/s²].
    pub accel_max: Option<f64>,
    /// Largest deceleration of a window, positive [m/s²].
    pub decel_max: Option<f64>,
    /// Root mean square of the applied torque, sum over the wheels [N·m].
    pub torque_rms: Option<f64>,
    /// Share of SUMO steps in which the traffic gave the target.
    pub share_traffic: Option<f64>,
    /// Share of SUMO steps in which a speed limit gave it.
    pub share_limit: Option<f64>,
    /// Share of SUMO steps in which a profile gave it.
    pub share_profile: Option<f64>,
    /// Share of SUMO steps in which SUMO clamped the command.
    pub share_clamp: Option<f64>,
    /// SUMO steps in which SUMO clamped the command.
    pub clamped_steps: u64,
    /// Share of SUMO steps in which the reference's memory hit its bound.
    pub lead_limited: Option<f64>,
    /// Share of SUMO steps in which the curvature was limited.
    pub curvature_limited: Option<f64>,
}
