//! The sections of a scenario file, in order. The template, the schema, the page of keys in the docs and the check for
//! unknown sections come from this list.

use super::{
    catalog::Catalog,
    sections::{Coupling, Egos, Output, PresetKeys, Traffic},
};
use crate::{
    keys::{Key, Keys},
    measurement::NoiseKeys,
    plant::{ActuatorKeys, BodyKeys},
    registry::Entry,
    sumo_files::SumoSetup,
};

/// A section of a scenario file.
pub struct Section {
    /// Its name.
    pub name: &'static str,
    /// Whether a `[[group]]` may have a section of this name, too.
    pub grouped: bool,
    /// What it takes.
    pub form: Form,
}

/// What a section takes.
pub enum Form {
    /// These keys.
    Keys(Vec<Key>),
    /// These keys, of which numbers may be distributions.
    Drawn(Vec<Key>),
    /// The name of one of these entries, and the entry's keys.
    Choice(Vec<Entry<()>>),
}

/// All sections but `[[group]]`.
pub fn sections(catalog: &Catalog) -> Vec<Section> {
    let keys = |name, keys: &[Key]| Section { name, grouped: false, form: Form::Keys(keys.to_vec()) };
    let [controller, target, plant, _] = catalog.registries().map(|(name, entries)| Section {
        name,
        grouped: name != "plant",
        form: Form::Choice(entries),
    });
    let vehicle = Form::Drawn([PresetKeys::keys(), BodyKeys::keys()].concat());
    vec![
        keys("sumo", SumoSetup::keys()),
        keys("egos", Egos::keys()),
        controller,
        target,
        plant,
        Section { name: "vehicle", grouped: true, form: vehicle },
        Section { name: "actuator", grouped: true, form: Form::Drawn(ActuatorKeys::keys().to_vec()) },
        Section { grouped: true, ..keys("noise", NoiseKeys::keys()) },
        keys("traffic", Traffic::keys()),
        keys("coupling", Coupling::keys()),
        keys("output", Output::keys()),
    ]
}
