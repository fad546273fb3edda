//! Everything that a scenario may say, as tables of keys: the fixed sections, and what the registries offer by name.

use crate::{
    control::CONTROLLERS,
    keys::{Key, Kind},
    plant::{BODIES, BODY_KEYS, PLANTS},
    reference::TARGETS,
    registry::{Entry, UnknownName, nearest},
};

/// One name of a registry, without its constructor.
#[derive(Debug, Clone, Copy)]
pub struct Named {
    /// The name.
    pub name: &'static str,
    /// One line about it.
    pub summary: &'static str,
    /// The keys that it takes.
    pub keys: &'static [Key],
}

/// The names of one registry.
#[derive(Debug, Clone)]
pub struct Options {
    /// What is chosen, e.g. "controller".
    pub kind: &'static str,
    /// The names, in the registry's order.
    pub entries: Vec<Named>,
}

impl Options {
    /// The names of a registry.
    pub fn of<B>(kind: &'static str, entries: &'static [Entry<B>]) -> Self {
        let entries = entries.iter().map(|e| Named { name: e.name, summary: e.summary, keys: e.keys }).collect();
        Self { kind, entries }
    }

    /// The entry called `name`.
    ///
    /// # Errors
    /// [`UnknownName`] with the nearest name and all known ones.
    pub fn find(&self, name: &str) -> Result<&Named, UnknownName> {
        self.entries.iter().find(|e| e.name == name).ok_or_else(|| UnknownName {
            kind: self.kind,
            name: name.to_owned(),
            suggestion: nearest(name, self.entries.iter().map(|e| e.name)).map(str::to_owned),
            known: self.entries.iter().map(|e| e.name.to_owned()).collect(),
        })
    }
}

/// What the registries offer.
#[derive(Debug, Clone)]
pub struct Catalog {
    /// Speed controllers, for `[controller]`.
    pub controllers: Options,
    /// Sources of the target speed, for `[target]`.
    pub targets: Options,
    /// Vehicle models, for `[plant]`.
    pub plants: Options,
    /// Presets of bodies, for `vehicle.preset`.
    pub bodies: Options,
    /// The keys of a body, for `[vehicle]`.
    pub body_keys: &'static [Key],
}

impl Catalog {
    /// What this build offers.
    pub fn installed() -> Self {
        Self {
            controllers: Options::of("controller", CONTROLLERS),
            targets: Options::of("target", TARGETS),
            plants: Options::of("plant", PLANTS),
            bodies: Options::of("body", BODIES),
            body_keys: BODY_KEYS,
        }
    }

    /// All registries, in the order of `sumo-mfc list`.
    pub fn registries(&self) -> [&Options; 4] {
        [&self.controllers, &self.targets, &self.plants, &self.bodies]
    }
}

const fn number(
    name: &'static str,
    unit: &'static str,
    range: (f64, f64),
    default: &'static str,
    help: &'static str,
) -> Key {
    Key { name, kind: Kind::Number { unit, min: range.0, max: range.1 }, default, help }
}

/// `[sumo]`, besides the lists of [`SUMO_LISTS`].
pub(crate) const SUMO_KEYS: &[Key] = &[
    Key { name: "config", kind: Kind::File, default: "", help: "SUMO configuration (.sumocfg); or net and routes" },
    Key { name: "net", kind: Kind::File, default: "", help: "SUMO network (.net.xml), instead of config" },
    number("step_length_s", "s", (0.001, 10.0), "0.1", "SUMO's step, a whole number of control periods and of 1 ms"),
    number("end_s", "s", (0.001, 1e9), "", "simulation time at which the run ends; not set = the configuration's"),
    Key {
        name: "seed",
        kind: Kind::Integer { min: 0, max: i32::MAX as i64 },
        default: "23423",
        help: "seed of SUMO and of everything drawn here",
    },
    Key {
        name: "ballistic",
        kind: Kind::Flag,
        default: "true",
        help: "SUMO moves vehicles by the mean of old and new speed, as the body does",
    },
    Key { name: "gui", kind: Kind::Flag, default: "false", help: "start sumo-gui instead of sumo" },
    Key {
        name: "port",
        kind: Kind::Integer { min: 1, max: u16::MAX as i64 },
        default: "",
        help: "TraCI port; not set = a free one",
    },
    Key {
        name: "num_clients",
        kind: Kind::Integer { min: 1, max: 1000 },
        default: "1",
        help: "TraCI clients that SUMO waits for, this one included",
    },
    Key { name: "connect", kind: Kind::Text, default: "", help: "HOST:PORT of a SUMO that already runs" },
];

/// Keys of `[sumo]` that take a list of texts; true = of files.
pub(crate) const SUMO_LISTS: &[(&str, bool, &str)] = &[
    ("routes", true, "route files of net"),
    ("additional", true, "additional files of net"),
    ("options", false, "further options of SUMO"),
];

/// `vehicle.preset`.
pub(crate) const PRESET_KEY: Key =
    Key { name: "preset", kind: Kind::Text, default: "", help: "body; not set = by the vehicle class" };

/// `[actuator]`.
pub(crate) const ACTUATOR_KEYS: &[Key] = &[
    number("delay_s", "s", (0.0, 5.0), "0", "dead time between command and torque"),
    number("lag_s", "s", (0.0, 5.0), "0", "time constant of the torque behind the dead time"),
];

/// `[noise]`.
pub(crate) const NOISE_KEYS: &[Key] = &[number(
    "power_db",
    "dB",
    (-200.0, 60.0),
    "",
    "power of the white noise on the measured speed, re 1 (m/s)²; not set = none",
)];

/// `[traffic]`.
pub(crate) const TRAFFIC_KEYS: &[Key] =
    &[number("sigma", "-", (0.0, 1.0), "", "driver imperfection of the egos' car-following; not set = the vType's")];

/// `[coupling]`.
pub(crate) const COUPLING_KEYS: &[Key] = &[
    number("control_period_s", "s", (0.0001, 1.0), "0.01", "control period"),
    number("lead_mps", "m/s", (0.01, 100.0), "1", "how far the reference may keep away from the vehicle's speed"),
    Key { name: "grade", kind: Kind::Flag, default: "false", help: "bodies feel the slope of SUMO's road" },
];

/// `[output]`.
pub(crate) const OUTPUT_KEYS: &[Key] = &[
    Key {
        name: "vehicles",
        kind: Kind::Text,
        default: "\"vehicles.csv\"",
        help: "table of vehicles: .csv, .parquet or .xml",
    },
    Key { name: "trace", kind: Kind::Text, default: "\"none\"", help: "none, all or vehicle ids separated by commas" },
    number("trace_period_s", "s", (0.0001, 3600.0), "", "time between rows of the trace; not set = SUMO's step"),
    Key {
        name: "trace_file",
        kind: Kind::Text,
        default: "\"trace.csv\"",
        help: "file of the trace: .csv, .parquet or .xml",
    },
];
