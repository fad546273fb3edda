//! The fixed sections of a scenario file. What is chosen by name brings its own keys; see the catalog.

use super::{headway::HeadwayMargin, selector::Selector, trace::Trace};
use crate::{
    keys,
    keys::{Kind, Setting, Value},
};

keys! {
    /// The key outside of all sections.
    pub(super) struct Named {
        /// names the folder of the results; default: this file's name
        name: Option<String>, form folder_name;
    }
}

fn folder_name(name: &str) -> Result<(), String> {
    let shape = !name.is_empty() && !name.starts_with('.') && !name.contains(['/', '\\']);
    fits(name, shape, "a name without slashes that does not start with a dot")
}

/// The longest name \[bytes\]: file systems take 255, and `.part` or a controller and a seed come behind it.
const NAME_MAX: usize = 200;

/// Refuses what cannot be the name of a file.
fn fits(name: &str, shape: bool, wanted: &str) -> Result<(), String> {
    if shape && name.len() <= NAME_MAX && !name.contains(char::is_control) {
        return Ok(());
    }
    Err(format!("{wanted}, without control characters, of at most {NAME_MAX} bytes"))
}

keys! {
    /// Which vehicles get a body and a controller.
    pub(super) struct Egos {
        /// vehicles with a body and a controller
        select: Selector = Selector::All;
    }
}

keys! {
    /// The key of `[vehicle]` that chooses a body.
    pub(super) struct PresetKeys {
        /// body; not set = by the vehicle class
        preset: Option<String>;
    }
}

keys! {
    /// Changes to the traffic.
    #[derive(Copy)]
    pub struct Traffic {
        /// driver imperfection of the egos' car-following; not set = the vType's
        sigma: Option<f64>, "-", 0.0..=1.0;
        /// added to the time headway tau of egos with a body; auto = dead time + lag + 1/k_p (error_time_s of laws without k_p); not set = nothing
        headway_margin_s: Option<HeadwayMargin>, "s", 0.0..=10.0;
    }
}

keys! {
    /// Between SUMO and the fleet.
    #[derive(Copy)]
    pub struct Coupling {
        /// control period
        control_period_s: f64 = 0.01, "s", 0.0001..=1.0;
        /// how far the reference may keep away from the vehicle's speed
        lead_mps: f64 = 1.0, "m/s", 0.01..=100.0;
        /// bodies feel the slope of SUMO's road
        grade: bool = false;
        /// the friction of SUMO's lanes multiplies that of the tyres
        friction: bool = false;
    }
}

keys! {
    /// What is written.
    pub struct Output {
        /// table of vehicles: .csv, .parquet or .xml
        vehicles: String = "vehicles.csv", form table_name;
        /// drive quality, comfort and work of every vehicle, in quality.csv
        quality: bool = true;
        /// string stability of egos that follow each other, in quality.csv
        platoons: bool = false;
        /// none, all or vehicle ids separated by commas
        trace: Trace = Trace::None;
        /// time between rows of the trace, whole steps or control periods; not set = SUMO's step
        trace_period_s: Option<f64>, "s", 0.0001..=3600.0;
        /// file of the trace: .csv, .parquet or .xml
        trace_file: String = "trace.csv", form table_name;
    }
}

fn table_name(name: &str) -> Result<(), String> {
    let stem = [".csv", ".parquet", ".xml"].iter().find_map(|ending| name.strip_suffix(ending));
    let shape = stem.is_some_and(|stem| !stem.is_empty()) && !name.contains(['/', '\\']);
    fits(name, shape, "a file name without folder that ends in .csv, .parquet or .xml")
}

impl Setting for Selector {
    type Literal = Self;
    const KIND: Kind = Kind::Form(|text| Self::parse(text).map(drop));

    fn from_value(value: &Value) -> Option<Self> {
        if let Value::Text(text) = value { Self::parse(text).ok() } else { None }
    }

    fn to_value(&self) -> Option<Value> {
        Some(Value::Text(self.to_string()))
    }
}
