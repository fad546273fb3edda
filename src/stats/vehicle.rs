//! What the statistics say about one vehicle. A statistic is declared here once: its column, unit and meaning.

use crate::table::record;

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

record! {
    /// The statistics of one vehicle; `None` where nothing was there to be averaged.
    #[derive(Debug, Clone, Copy, Default, PartialEq)]
    pub struct VehicleStats {
        samples: u64 = "Control periods";
        error_mean: Option<f64> = "Mean of e" ["m/s"];
        error_std: Option<f64> = "Standard deviation of e, divided by n" ["m/s"];
        error_rms: Option<f64> = "Root mean square of e" ["m/s"];
        error_max_abs: Option<f64> = "Largest |e|" ["m/s"];
        overshoot_max: Option<f64> = "Largest e after the vehicle first reached a reference that had risen, else 0" ["m/s"];
        speed_gap_rms: Option<f64> = "Root mean square of V_x − v* at the ends of SUMO's steps" ["m/s"];
        jerk_rms: Option<f64> = "Root mean square of the jerk, with the acceleration averaged over 0.5 s" ["m/s³"];
        accel_max: Option<f64> = "Largest acceleration, averaged over 0.5 s" ["m/s²"];
        decel_max: Option<f64> = "Largest deceleration, averaged over 0.5 s, positive" ["m/s²"];
        torque_rms: Option<f64> = "Root mean square of the applied torque, sum over the wheels" ["N·m"];
        share_traffic: Option<f64> = "Share of SUMO's steps in which the traffic gave the target";
        share_limit: Option<f64> = "Share of SUMO's steps in which a speed limit gave the target";
        share_profile: Option<f64> = "Share of SUMO's steps in which a profile gave the target";
        share_clamp: Option<f64> = "Share of SUMO's steps in which SUMO cut the speed below the command";
        clamped_steps: u64 = "SUMO's steps in which SUMO cut the speed below the command";
        lead_limited: Option<f64> = "Share of SUMO's steps in which the reference was held near the true speed";
        curvature_limited: Option<f64> = "Share of SUMO's steps in which the road's curvature was limited to what the tyres bear";
    }
}
