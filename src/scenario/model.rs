//! A checked scenario and its parts, in SI units.

use std::{fmt, path::PathBuf};

use super::{
    sections::{Coupling, Output, Traffic},
    selector::{EgoInfo, Selector},
    spread::PerVehicle,
};
use crate::{
    control,
    keys::Values,
    measurement::NoiseKeys,
    plant::{BuildBody, BuildPlant},
    reference,
    registry::Entry,
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
    pub plant: Choice<BuildPlant>,
    /// Between SUMO and the fleet.
    pub coupling: Coupling,
    /// Changes to the traffic.
    pub traffic: Traffic,
    /// What is written.
    pub output: Output,
    /// The largest dead time that a parameter of the demand gives a vehicle \[s\].
    pub dead_time_max_s: f64,
    /// Every input file, absolute, in the order in which it was named.
    pub inputs: Vec<PathBuf>,
    /// What the user should be told: overridden settings of the configuration, keys left unused.
    pub notes: Vec<String>,
}

/// What was chosen by name, with the values of its keys.
#[derive(Clone)]
pub struct Choice<B> {
    /// What was chosen.
    pub entry: Entry<B>,
    /// Its values, complete with defaults.
    pub values: Values,
}

impl<B> Choice<B> {
    /// The name.
    pub fn name(&self) -> &'static str {
        self.entry.name
    }
}

impl<B> fmt::Debug for Choice<B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Choice").field("entry", &self.entry).field("values", &self.values).finish()
    }
}

/// What a group of egos gets.
#[derive(Debug, Clone)]
pub struct Group {
    /// Who belongs to it.
    pub select: Selector,
    /// The speed controller.
    pub controller: Choice<control::Build>,
    /// Where the target speed comes from.
    pub target: Choice<reference::Build>,
    /// The body.
    pub vehicle: Vehicle,
    /// What lies between command and torque.
    pub actuator: PerVehicle,
    /// The noise on the measured speed.
    pub noise: NoiseKeys,
}

/// A preset of a body.
#[derive(Debug, Clone)]
pub enum Preset {
    /// The one that was named.
    Named(Entry<BuildBody>),
    /// One of these, by the vehicle class.
    ByClass(Vec<Entry<BuildBody>>),
}

/// A body.
#[derive(Debug, Clone)]
pub struct Vehicle {
    /// The preset.
    pub preset: Preset,
    /// Keys of the body that differ from the preset.
    pub body: PerVehicle,
}

impl Group {
    /// Which of the groups an ego belongs to: the first that matches.
    pub fn of(groups: &[Self], ego: &EgoInfo<'_>, seed: u64) -> Option<usize> {
        groups.iter().position(|group| group.select.matches(ego, seed))
    }

    /// Whether its egos drive a body: whether they have a controller.
    pub fn has_body(&self) -> bool {
        const ANY_PERIOD_S: f64 = 0.01;
        !matches!((self.controller.entry.build)(&self.controller.values, ANY_PERIOD_S), control::Law::Nothing)
    }
}

impl Scenario {
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

    /// Where the results go if the user does not say: `out/<scenario>-<controller>-<seed>`, with the controller of the
    /// vehicles that no `[[group]]` takes.
    pub fn default_folder(&self) -> PathBuf {
        let controller = self.groups.last().map_or("none", |g| g.controller.name());
        PathBuf::from("out").join(format!("{}-{controller}-{}", self.name, self.sumo.seed))
    }
}
