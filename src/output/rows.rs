//! The rows of the tables and their columns, in the order of the files.

use super::EdgeRow;
use super::table::{Column, Layout};
use std::sync::Arc;

/// How a vehicle's row ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reason {
    /// It reached the end of its route.
    Arrived,
    /// It was on the road when the run ended.
    Running,
    /// Somebody else took it out.
    Removed,
    /// SUMO teleported it and it never came back.
    TeleportedOut,
    /// Its plant left the range of sensible states.
    Diverged,
    /// The run broke off.
    Incomplete,
}

impl Reason {
    /// All reasons.
    pub const ALL: [Self; 6] =
        [Self::Arrived, Self::Running, Self::Removed, Self::TeleportedOut, Self::Diverged, Self::Incomplete];

    /// As in the column `reason`.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Arrived => "arrived",
            Self::Running => "running",
            Self::Removed => "removed",
            Self::TeleportedOut => "teleported_out",
            Self::Diverged => "diverged",
            Self::Incomplete => "incomplete",
        }
    }
}

/// One ego that departed. e = V_x − y_ref on the true speed at every control period; SI units; `None` = no value.
#[derive(Debug, Clone, PartialEq)]
pub struct VehicleRow {
    /// SUMO's id.
    pub id: String,
    /// Its vType.
    pub vehicle_type: Arc<str>,
    /// The controller's name.
    pub controller: Arc<str>,
    /// The target's name.
    pub target: Arc<str>,
    /// When it departed \[s\].
    pub depart: f64,
    /// When it arrived \[s\].
    pub arrival: Option<f64>,
    /// SUMO's duration of its trip \[s\].
    pub duration: Option<f64>,
    /// SUMO's time loss \[s\].
    pub timeloss: Option<f64>,
    /// SUMO's length of the route driven \[m\].
    pub distance: Option<f64>,
    /// Control periods.
    pub samples: u64,
    /// Mean of e [m/s].
    pub error_mean: Option<f64>,
    /// Standard deviation of e [m/s].
    pub error_std: Option<f64>,
    /// Root mean square of e [m/s].
    pub error_rms: Option<f64>,
    /// Largest |e| [m/s].
    pub error_max_abs: Option<f64>,
    /// Largest e after first reaching the reference following a rise, else 0 [m/s].
    pub overshoot_max: Option<f64>,
    /// Root mean square of V_x − v* at the ends of SUMO steps [m/s].
    pub speed_gap_rms: Option<f64>,
    /// Root mean square of the jerk of V_x [m/s³].
    pub jerk_rms: Option<f64>,
    /// Largest acceleration [m/s²].
    pub accel_max: Option<f64>,
    /// Largest deceleration, positive [m/s²].
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
    /// SUMO's distance − ∫V_x dt at the end \[m\].
    pub odometer_gap: Option<f64>,
    /// Pairs of colliding vehicles that it was in.
    pub collisions: u64,
    /// How the row ended; `complete` is true for [`Reason::Arrived`] only.
    pub reason: Reason,
}

/// Orders rows as the file has them: by departure, then id. Vehicles finish in another order.
pub fn sort_vehicles(rows: &mut [VehicleRow]) {
    rows.sort_by(|a, b| a.depart.total_cmp(&b.depart).then_with(|| a.id.cmp(&b.id)));
}

/// One vehicle at one time, on request.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceRow {
    /// Simulated time \[s\].
    pub time: f64,
    /// SUMO's id.
    pub id: Arc<str>,
    /// Target speed: v*, the limit or the profile [m/s].
    pub target: f64,
    /// Reference speed y_ref [m/s].
    pub reference: f64,
    /// True speed V_x [m/s].
    pub speed: f64,
    /// Measured speed, with noise if any [m/s].
    pub measured_speed: f64,
    /// Lateral speed V_y, left positive [m/s].
    pub lateral_speed: f64,
    /// Yaw rate, left positive [rad/s].
    pub yaw_rate: f64,
    /// Slip of the front axle.
    pub slip_front: f64,
    /// Slip of the rear axle.
    pub slip_rear: f64,
    /// Applied torque, sum over the wheels [N·m].
    pub torque: f64,
    /// α̂/α_nominal.
    pub alpha_hat: f64,
    /// F̂ [m/s²].
    pub f_hat: f64,
    /// The plant's distance \[m\].
    pub distance: f64,
}

/// One of at most 200 vehicles at one second.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleRow {
    /// Simulated time \[s\].
    pub time: f64,
    /// SUMO's id.
    pub id: Arc<str>,
    /// True speed V_x [m/s].
    pub speed: f64,
    /// Target speed [m/s].
    pub target: f64,
    /// The plant's distance \[m\].
    pub distance: f64,
    /// Applied torque, sum over the wheels [N·m].
    pub torque: f64,
}

/// `vehicles.csv`.
pub static VEHICLES: Layout<VehicleRow> = Layout {
    table: "vehicles",
    row: "vehicle",
    by_time: false,
    columns: &[
        Column::text("id", |r| Some(&r.id)),
        Column::text("type", |r| Some(&r.vehicle_type)),
        Column::text("controller", |r| Some(&r.controller)),
        Column::text("target", |r| Some(&r.target)),
        Column::number("depart", |r| Some(r.depart)),
        Column::number("arrival", |r| r.arrival),
        Column::number("duration", |r| r.duration),
        Column::number("timeloss", |r| r.timeloss),
        Column::number("distance", |r| r.distance),
        Column::count("samples", |r| r.samples),
        Column::number("error_mean", |r| r.error_mean),
        Column::number("error_std", |r| r.error_std),
        Column::number("error_rms", |r| r.error_rms),
        Column::number("error_max_abs", |r| r.error_max_abs),
        Column::number("overshoot_max", |r| r.overshoot_max),
        Column::number("speed_gap_rms", |r| r.speed_gap_rms),
        Column::number("jerk_rms", |r| r.jerk_rms),
        Column::number("accel_max", |r| r.accel_max),
        Column::number("decel_max", |r| r.decel_max),
        Column::number("torque_rms", |r| r.torque_rms),
        Column::number("share_traffic", |r| r.share_traffic),
        Column::number("share_limit", |r| r.share_limit),
        Column::number("share_profile", |r| r.share_profile),
        Column::number("share_clamp", |r| r.share_clamp),
        Column::count("clamped_steps", |r| r.clamped_steps),
        Column::number("lead_limited", |r| r.lead_limited),
        Column::number("curvature_limited", |r| r.curvature_limited),
        Column::number("odometer_gap", |r| r.odometer_gap),
        Column::count("collisions", |r| r.collisions),
        Column::text("reason", |r| Some(r.reason.as_str())),
        Column::flag("complete", |r| r.reason == Reason::Arrived),
    ],
};

/// `trace.csv`.
pub static TRACE: Layout<TraceRow> = Layout {
    table: "trace",
    row: "vehicle",
    by_time: true,
    columns: &[
        Column::number("time", |r| Some(r.time)),
        Column::text("id", |r| Some(&r.id)),
        Column::number("target", |r| Some(r.target)),
        Column::number("reference", |r| Some(r.reference)),
        Column::number("speed", |r| Some(r.speed)),
        Column::number("measured_speed", |r| Some(r.measured_speed)),
        Column::number("lateral_speed", |r| Some(r.lateral_speed)),
        Column::number("yaw_rate", |r| Some(r.yaw_rate)),
        Column::number("slip_front", |r| Some(r.slip_front)),
        Column::number("slip_rear", |r| Some(r.slip_rear)),
        Column::number("torque", |r| Some(r.torque)),
        Column::number("alpha_hat", |r| Some(r.alpha_hat)),
        Column::number("f_hat", |r| Some(r.f_hat)),
        Column::number("distance", |r| Some(r.distance)),
    ],
};

/// `sample.csv`.
pub static SAMPLE: Layout<SampleRow> = Layout {
    table: "sample",
    row: "vehicle",
    by_time: true,
    columns: &[
        Column::number("time", |r| Some(r.time)),
        Column::text("id", |r| Some(&r.id)),
        Column::number("speed", |r| Some(r.speed)),
        Column::number("target", |r| Some(r.target)),
        Column::number("distance", |r| Some(r.distance)),
        Column::number("torque", |r| Some(r.torque)),
    ],
};

/// `edges.csv`.
pub static EDGES: Layout<EdgeRow> = Layout {
    table: "edges",
    row: "edge",
    by_time: false,
    columns: &[
        Column::text("edge", |r| Some(&r.edge)),
        Column::count("samples", |r| r.samples),
        Column::number("error_mean", |r| r.error_mean),
        Column::number("error_rms", |r| r.error_rms),
        Column::number("speed_mean", |r| r.speed_mean),
    ],
};

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A row with a value in every column.
    pub(crate) fn vehicle(id: &str, depart: f64) -> VehicleRow {
        VehicleRow {
            id: id.into(),
            vehicle_type: "pkw".into(),
            controller: "adaptive".into(),
            target: "traffic".into(),
            depart,
            arrival: Some(depart + 60.0),
            duration: Some(60.0),
            timeloss: Some(12.5),
            distance: Some(512.25),
            samples: 6000,
            error_mean: Some(-0.01),
            error_std: Some(0.1),
            error_rms: Some(0.125),
            error_max_abs: Some(0.5),
            overshoot_max: Some(0.25),
            speed_gap_rms: Some(0.2),
            jerk_rms: Some(0.75),
            accel_max: Some(2.5),
            decel_max: Some(3.5),
            torque_rms: Some(250.0),
            share_traffic: Some(1.0),
            share_limit: Some(0.0),
            share_profile: Some(0.0),
            share_clamp: Some(0.0),
            clamped_steps: 0,
            lead_limited: Some(0.0),
            curvature_limited: Some(0.005),
            odometer_gap: Some(-0.03),
            collisions: 0,
            reason: Reason::Arrived,
        }
    }

    #[test]
    fn vehicles_have_the_columns_that_were_promised() {
        let names: Vec<_> = VEHICLES.columns.iter().map(|c| c.name).collect();
        assert_eq!(
            names.join(","),
            "id,type,controller,target,depart,arrival,duration,timeloss,distance,samples,error_mean,error_std,\
             error_rms,error_max_abs,overshoot_max,speed_gap_rms,jerk_rms,accel_max,decel_max,torque_rms,\
             share_traffic,share_limit,share_profile,share_clamp,clamped_steps,lead_limited,curvature_limited,\
             odometer_gap,collisions,reason,complete"
        );
    }

    #[test]
    fn other_tables_have_the_columns_that_were_promised() {
        let trace: Vec<_> = TRACE.columns.iter().map(|c| c.name).collect();
        assert_eq!(
            trace.join(","),
            "time,id,target,reference,speed,measured_speed,lateral_speed,yaw_rate,slip_front,slip_rear,torque,\
             alpha_hat,f_hat,distance"
        );
        let edges: Vec<_> = EDGES.columns.iter().map(|c| c.name).collect();
        assert_eq!(edges.join(","), "edge,samples,error_mean,error_rms,speed_mean");
    }

    #[test]
    fn rows_are_ordered_by_departure_then_id() {
        let mut rows = vec![vehicle("b", 2.0), vehicle("c", 1.0), vehicle("a", 2.0), vehicle("d", 10.0)];
        sort_vehicles(&mut rows);
        assert_eq!(rows.iter().map(|r| r.id.as_str()).collect::<String>(), "cabd");
    }
}
