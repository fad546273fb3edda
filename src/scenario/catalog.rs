//! What a scenario can choose by name: what this build offers, and what other crates register.

use crate::{
    control::{self, CONTROLLERS},
    plant::{BODIES, BuildBody, BuildPlant, PLANTS},
    reference::{self, TARGETS},
    registry::{Entry, RegistrationError, register},
};

/// The entries that a scenario can choose from. The first controller, target and plant are the defaults.
///
/// A law, a body preset or a target of another crate is registered here, and then serves under its name in `run`,
/// `compare`, `list`, `check` and misspelling hints as the installed ones do.
#[derive(Debug, Clone)]
pub struct Catalog {
    /// Speed controllers, for `[controller]`.
    pub(super) controllers: Vec<Entry<control::Build>>,
    /// Sources of the target speed, for `[target]`.
    pub(super) targets: Vec<Entry<reference::Build>>,
    /// Vehicle models, for `[plant]`.
    pub(super) plants: Vec<Entry<BuildPlant>>,
    /// Presets of bodies, for `vehicle.preset`.
    pub(super) bodies: Vec<Entry<BuildBody>>,
}

impl Catalog {
    /// What this build offers.
    pub fn installed() -> Self {
        Self {
            controllers: CONTROLLERS.clone(),
            targets: TARGETS.clone(),
            plants: PLANTS.clone(),
            bodies: BODIES.clone(),
        }
    }

    /// Adds a speed controller, made with [`control::law`].
    ///
    /// # Errors
    /// [`RegistrationError`] if there is a controller of this name.
    pub fn with_controller(mut self, entry: Entry<control::Build>) -> Result<Self, RegistrationError> {
        register("controller", &mut self.controllers, entry, "name")?;
        Ok(self)
    }

    /// Adds a target, made with [`reference::target`].
    ///
    /// # Errors
    /// [`RegistrationError`] if there is a target of this name.
    pub fn with_target(mut self, entry: Entry<reference::Build>) -> Result<Self, RegistrationError> {
        register("target", &mut self.targets, entry, "name")?;
        Ok(self)
    }

    /// Adds a vehicle model, made with [`crate::plant::model`].
    ///
    /// # Errors
    /// [`RegistrationError`] if there is a plant of this name.
    pub fn with_plant(mut self, entry: Entry<BuildPlant>) -> Result<Self, RegistrationError> {
        register("plant", &mut self.plants, entry, "name")?;
        Ok(self)
    }

    /// Adds a body preset, made with [`crate::plant::preset`].
    ///
    /// # Errors
    /// [`RegistrationError`] if there is a body of this name.
    pub fn with_body(mut self, entry: Entry<BuildBody>) -> Result<Self, RegistrationError> {
        register("body", &mut self.bodies, entry, "preset")?;
        Ok(self)
    }

    /// All entries by kind, in the order of `sumo-mfc list`.
    pub fn registries(&self) -> [(&'static str, Vec<Entry<()>>); 4] {
        [
            ("controller", described(&self.controllers)),
            ("target", described(&self.targets)),
            ("plant", described(&self.plants)),
            ("body", described(&self.bodies)),
        ]
    }

    /// One line `kind<TAB>name<TAB>summary` per entry, as `sumo-mfc list` prints them.
    pub fn lines(&self) -> String {
        let lines = self.registries().into_iter().flat_map(|(kind, entries)| {
            entries.into_iter().map(move |e| format!("{kind}\t{}\t{}\n", e.name, e.summary))
        });
        lines.collect()
    }
}

fn described<B>(entries: &[Entry<B>]) -> Vec<Entry<()>> {
    entries.iter().map(Entry::described).collect()
}
