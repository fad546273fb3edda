//! The rows of the tables of a run. Each field is declared once, with column, unit and meaning.

use crate::cosim::{Place, Reason, Roads, StringGain};
use crate::stats::{DriveQuality, Sums, VehicleStats};
use crate::table::{Cell, Column, Columns, Field, Kind, Layout, record};
use std::sync::{Arc, LazyLock};

record! {
    /// One ego that departed. e = V_x − y_ref on the true speed at every control period; `None` = no value.
    #[derive(Debug, Clone, PartialEq)]
    pub struct VehicleRow {
        id: String = "SUMO's id of the vehicle";
        vehicle_type as "type": Arc<str> = "Its vType";
        controller: &'static str = "The controller that drove it";
        target: &'static str = "The target that it followed";
        depart: f64 = "Time of departure, as in SUMO's tripinfo" ["s"] not_in_summary;
        arrival: Option<f64> = "Time of arrival, as in SUMO's tripinfo" ["s"] not_in_summary;
        duration: Option<f64> = "From departure to arrival, or to the end of the run" ["s"];
        timeloss: Option<f64> = "SUMO's time loss" ["s"];
        distance: Option<f64> = "Distance that the body has driven: the integral of V_x over time" ["m"];
        /// Its statistics.
        stats: VehicleStats;
        odometer_gap: Option<f64> = "SUMO's distance − that of the body, at the end" ["m"];
        collisions: u64 = "Pairs of colliding vehicles that it was in";
        /// How the row ended.
        reason: Reason;
    }
}

/// An ending has two columns.
impl Field for Reason {
    fn columns<R: 'static>(_: Column, find: impl Fn(&R) -> &Self + Clone + Send + Sync + 'static) -> Columns<R> {
        let reasons = format!("How the row ended: {}", Self::ALL.map(Self::as_str).join(", "));
        let reason = Column::new("reason", Kind::Text, None, reasons);
        let complete = Column::new("complete", Kind::Flag, None, "True if the vehicle arrived");
        let find_again = find.clone();
        vec![
            (reason, Box::new(move |row| Cell::Text(Some(find(row).as_str())))),
            (complete, Box::new(move |row| Cell::Flag(*find_again(row) == Self::Arrived))),
        ]
    }
}

record! {
    /// The drive quality of one ego, in the order of `vehicles.csv`.
    #[derive(Debug, Clone, PartialEq)]
    pub struct QualityRow {
        id: String = "SUMO's id of the vehicle";
        depart: f64 = "Time of departure, as in SUMO's tripinfo" ["s"] not_in_summary;
        /// Its ratings.
        quality: DriveQuality;
        /// How it follows.
        string_gain: StringGain;
    }
}

/// SUMO's times are whole milliseconds; sums of steps are that but for rounding.
pub fn milliseconds(time_s: f64) -> f64 {
    (time_s * 1000.0).round() / 1000.0
}

record! {
    /// One vehicle at one time.
    #[derive(Debug, Clone, PartialEq)]
    pub struct TraceRow {
        time: f64 = "Simulation time" ["s"];
        id: Arc<str> = "SUMO's id of the vehicle";
        target: f64 = "Target speed: v*, the limit or the profile" ["m/s"];
        reference: f64 = "Reference speed y_ref" ["m/s"];
        speed: f64 = "True speed V_x" ["m/s"];
        measured_speed: f64 = "Measured speed, with the noise of the sensor" ["m/s"];
        lateral_speed: f64 = "Lateral speed V_y, positive to the left" ["m/s"];
        yaw_rate: f64 = "Yaw rate, positive to the left" ["rad/s"];
        slip_front: f64 = "Longitudinal slip of the front axle";
        slip_rear: f64 = "Longitudinal slip of the rear axle";
        torque: f64 = "Applied torque, sum over the wheels" ["N·m"];
        alpha_hat: f64 = "Estimate of α over its nominal value";
        f_hat: f64 = "Estimate of F" ["m/s²"];
        distance: f64 = "Distance that the body has driven" ["m"];
        /// Where SUMO shows it.
        place: PlaceColumns;
    }
}

record! {
    /// Where SUMO shows a vehicle; `None` within SUMO's steps.
    #[derive(Debug, Clone, Default, PartialEq)]
    pub struct PlaceColumns {
        x: Option<f64> = "Middle of the front bumper in the network's coordinates, to the east; empty within SUMO's steps" ["m"];
        y: Option<f64> = "The same, to the north" ["m"];
        angle: Option<f64> = "Heading, clockwise from north" ["degrees"];
        lane: Option<String> = "SUMO's id of the lane";
    }
}

impl From<Place> for PlaceColumns {
    fn from(Place { position_m: [x, y], heading_deg, lane }: Place) -> Self {
        Self { x: Some(x), y: Some(y), angle: Some(heading_deg), lane: Some(lane) }
    }
}

record! {
    /// One of at most 200 vehicles at one second.
    #[derive(Debug, Clone, PartialEq)]
    pub struct SampleRow {
        time: f64 = "Simulation time" ["s"];
        id: Arc<str> = "SUMO's id of the vehicle";
        speed: f64 = "True speed V_x" ["m/s"];
        target: f64 = "Target speed: v*, the limit or the profile" ["m/s"];
        distance: f64 = "Distance that the body has driven" ["m"];
        torque: f64 = "Applied torque, sum over the wheels" ["N·m"];
        /// Where SUMO shows it.
        place: PlaceColumns;
    }
}

record! {
    /// One edge. The road of a vehicle is read once a second, and all its control periods since the last reading count
    /// for it: around a junction up to a second goes to the wrong side.
    #[derive(Debug, Clone, PartialEq)]
    pub struct EdgeRow {
        edge: String = "SUMO's id of the edge";
        samples: u64 = "Control periods of all egos on it";
        error_mean: f64 = "Mean of e" ["m/s"];
        error_rms: f64 = "Root mean square of e" ["m/s"];
        speed_mean: f64 = "Mean of V_x" ["m/s"];
    }
}

/// The edges on which egos were seen, ordered by id.
pub fn edge_rows(roads: &Roads) -> Vec<EdgeRow> {
    let driven = roads.iter().filter(|(_, sums)| sums.samples > 0);
    let row = |(edge, sums): (&str, &Sums)| {
        let n = sums.samples as f64;
        EdgeRow {
            edge: edge.to_owned(),
            samples: sums.samples,
            error_mean: sums.error_mps / n,
            error_rms: (sums.error_squared / n).sqrt(),
            speed_mean: sums.speed_mps / n,
        }
    };
    let mut rows: Vec<EdgeRow> = driven.map(row).collect();
    rows.sort_by(|a, b| a.edge.cmp(&b.edge));
    rows
}

/// `vehicles.csv`.
pub static VEHICLES: LazyLock<Layout<VehicleRow>> = LazyLock::new(|| {
    Layout::of_record(["vehicles", "vehicle"], "One row per ego that departed, ordered by departure, then id")
});

/// `quality.csv`.
pub static QUALITY: LazyLock<Layout<QualityRow>> = LazyLock::new(|| {
    Layout::of_record(["quality", "vehicle"], "The drive quality of the egos, a row for each of vehicles.csv")
});

/// `trace.csv`.
pub static TRACE: LazyLock<Layout<TraceRow>> =
    LazyLock::new(|| Layout::of_record(["trace", "vehicle"], "One row per traced vehicle and time").by_time());

/// `sample.csv`.
pub static SAMPLE: LazyLock<Layout<SampleRow>> = LazyLock::new(|| {
    Layout::of_record(["sample", "vehicle"], "One row per second and vehicle, of at most 200 vehicles drawn from all")
        .by_time()
});

/// `edges.csv`.
pub static EDGES: LazyLock<Layout<EdgeRow>> =
    LazyLock::new(|| Layout::of_record(["edges", "edge"], "One row per edge on which egos were seen, ordered by id"));

#[cfg(test)]
pub(crate) mod tests;
