//! What to run: a TOML file, a `.sumocfg` or a bare network with routes, together with what the command line overrides,
//! becomes one [`Scenario`] of checked SI values.
//!
//! Every key lives in a table ([`crate::keys`]): the fixed sections in `catalog.rs`, the rest in the registries. Reading,
//! range checks, suggestions, `check` and `check --template` all come from these tables, so a new key is one line.

mod catalog;
mod document;
mod error;
mod load;
mod print;
mod section;
mod selector;
mod spread;

use std::path::PathBuf;

pub use catalog::{Catalog, Named, Options};
pub use document::Override;
pub use error::ScenarioError;
pub use load::Request;
pub use print::template;
pub use selector::{EgoInfo, Selector};
pub use spread::{Distribution, Quantity};

use crate::{
    keys::Values,
    sumo_files::{Equipped, SumoFileError, SumoSetup},
};

/// A checked scenario in SI units.
#[derive(Debug, Clone)]
pub struct Scenario {
    /// Names the output folder.
    pub name: String,
    /// How SUMO is started.
    pub sumo: SumoSetup,
    /// Which vehicles get a body and a controller.
    pub egos: Selector,
    /// What they get: the first group that matches. The last one takes all that are left.
    pub groups: Vec<Group>,
    /// The vehicle model.
    pub plant: Choice,
    /// Control period \[s\].
    pub control_period_s: f64,
    /// Between SUMO and the fleet.
    pub coupling: Coupling,
    /// Changes to the traffic.
    pub traffic: Traffic,
    /// What is written.
    pub output: Output,
    /// Every input file, absolute, in the order in which it was named.
    pub inputs: Vec<PathBuf>,
    /// What the user should be told: overridden settings of the configuration, keys left unused.
    pub notes: Vec<String>,
}

/// A name of a registry with the values of its keys.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The name.
    pub name: &'static str,
    /// Its values, complete with defaults.
    pub values: Values,
}

/// What a group of egos gets.
#[derive(Debug, Clone)]
pub struct Group {
    /// Who belongs to it.
    pub select: Selector,
    /// The speed controller.
    pub controller: Choice,
    /// Where the target speed comes from.
    pub target: Choice,
    /// The body.
    pub vehicle: Vehicle,
    /// What lies between command and torque.
    pub actuator: Actuator,
    /// Power of the white noise on the measured speed [dB re 1 (m/s)²]; `None` = no noise.
    pub noise_power_db: Option<f64>,
}

/// A body.
#[derive(Debug, Clone, PartialEq)]
pub struct Vehicle {
    /// The preset; `None` = by the vehicle class.
    pub preset: Option<String>,
    /// Keys of the body that differ from the preset.
    pub values: Values,
    /// Keys of the body that are drawn per vehicle.
    pub spread: Vec<(&'static str, Distribution)>,
}

/// What lies between command and torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Actuator {
    /// Dead time \[s\].
    pub delay_s: Quantity,
    /// Time constant of the lag behind it \[s\].
    pub lag_s: Quantity,
}

/// Between SUMO and the fleet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling {
    /// How far the reference may keep away from the vehicle's speed [m/s].
    pub lead_mps: f64,
    /// Bodies feel the slope of SUMO's road.
    pub grade: bool,
}

/// Changes to the traffic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traffic {
    /// Driver imperfection of the egos' car-following model; `None` = the vType's.
    pub sigma: Option<f64>,
}

/// What is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// The table of vehicles; its suffix chooses the format.
    pub vehicles: String,
    /// Whose trajectories are traced.
    pub trace: Trace,
    /// Time between two rows of the trace \[s\]; `None` = SUMO's step.
    pub trace_period_s: Option<f64>,
    /// The trace; its suffix chooses the format.
    pub trace_file: String,
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

impl Group {
    /// Which of the groups an ego belongs to: the first that matches.
    pub fn of(groups: &[Self], ego: &EgoInfo<'_>, seed: u64) -> Option<usize> {
        groups.iter().position(|group| group.select.matches(ego, seed))
    }
}

impl Scenario {
    /// Reads and checks a scenario.
    ///
    /// # Errors
    /// What is wrong, with file, line, key, what was found and what was wanted.
    pub fn load(request: &Request, catalog: &Catalog) -> Result<Self, ScenarioError> {
        load::load(request, catalog, false)
    }

    /// The same for vehicles that drive without SUMO: a scenario that names nothing for SUMO to load is whole.
    ///
    /// # Errors
    /// As [`Scenario::load`].
    pub fn load_offline(request: &Request, catalog: &Catalog) -> Result<Self, ScenarioError> {
        load::load(request, catalog, true)
    }

    /// What the demand says of `has.mfc.device`, read only if a selector asks for it.
    ///
    /// # Errors
    /// A file of the demand that cannot be read.
    pub fn equipped(&self) -> Result<Equipped, SumoFileError> {
        let selectors = self.groups.iter().map(|g| &g.select).chain([&self.egos]);
        if selectors.into_iter().any(|s| matches!(s, Selector::Param)) {
            Equipped::read(&self.inputs)
        } else {
            Ok(Equipped::default())
        }
    }

    /// The scenario as TOML in SI units. Reading it gives the same scenario.
    pub fn to_toml(&self) -> String {
        print::scenario(self)
    }

    /// Where the results go if the user does not say: `out/<scenario>-<controller>-<seed>`, with the controller of the
    /// vehicles that no `[[group]]` takes.
    pub fn default_folder(&self) -> PathBuf {
        let controller = self.groups.last().map_or("none", |g| g.controller.name);
        PathBuf::from("out").join(format!("{}-{controller}-{}", self.name, self.sumo.seed))
    }
}

#[cfg(test)]
mod tests;
