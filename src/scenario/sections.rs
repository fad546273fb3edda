//! The fixed sections of a scenario file. What is chosen by name brings its own keys; see the catalog.

use std::path::PathBuf;

use crate::keys;
use crate::keys::{Kind, Setting, Value};

keys! {
    /// `[sumo]`
    pub(super) struct SumoKeys {
        /// SUMO configuration (.sumocfg); or net and routes
        config: Option<PathBuf>;
        /// SUMO network (.net.xml), instead of config
        net: Option<PathBuf>;
        /// SUMO's step, a whole number of control periods and of 1 ms
        step_length_s: f64 = 0.1, "s", 0.001..=10.0;
        /// simulation time at which the run ends; not set = the configuration's
        end_s: Option<f64>, "s", 0.001..=1e9;
        /// seed of SUMO and of everything drawn here
        seed: u32 = 23423, "-", 0..=i32::MAX;
        /// SUMO moves vehicles by the mean of old and new speed, as the body does
        ballistic: bool = true;
        /// start sumo-gui instead of sumo
        gui: bool = false;
        /// TraCI port; not set = a free one
        port: Option<u16>, "-", 1..=65535;
        /// TraCI clients that SUMO waits for, this one included
        num_clients: u32 = 1, "-", 1..=1000;
        /// HOST:PORT of a SUMO that already runs
        connect: Option<String>;
        /// route files of net
        routes: Vec<PathBuf>;
        /// additional files of net
        additional: Vec<PathBuf>;
        /// further options of SUMO
        options: Vec<String>;
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
    }
}

keys! {
    /// What is written.
    pub struct Output {
        /// table of vehicles: .csv, .parquet or .xml
        vehicles: String = "vehicles.csv";
        /// none, all or vehicle ids separated by commas
        trace: Trace = Trace::None;
        /// time between rows of the trace; not set = SUMO's step
        trace_period_s: Option<f64>, "s", 0.0001..=3600.0;
        /// file of the trace: .csv, .parquet or .xml
        trace_file: String = "trace.csv";
    }
}

/// Whose trajectories are traced.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Trace {
    /// Nobody's.
    None,
    /// Every ego's.
    All,
    /// These vehicles'.
    Ids(Vec<String>),
}

impl Setting for Trace {
    type Literal = Self;
    const KIND: Kind = Kind::Text;

    fn from_literal(literal: Self) -> Self {
        literal
    }

    fn from_value(value: &Value) -> Option<Self> {
        let Value::Text(text) = value else { return None };
        Some(match text.as_str() {
            "" | "none" => Self::None,
            "all" => Self::All,
            ids => Self::Ids(ids.split(',').map(|id| id.trim().to_owned()).filter(|id| !id.is_empty()).collect()),
        })
    }

    fn to_value(&self) -> Option<Value> {
        Some(match self {
            Self::None => "none".into(),
            Self::All => "all".into(),
            Self::Ids(ids) => ids.join(",").as_str().into(),
        })
    }
}
