//! What a controller is to follow. `traffic` and `limit` get their speed from SUMO in every step (the coupling knows how);
//! a [`Profile`] is a speed over position or time from a formula or a file; a [`Spacing`] keeps a gap to the vehicle ahead. One entry
//! each in [`TARGETS`].

mod ctg_acc;
mod error;
mod index;
mod path_cacc;
mod point;
mod profile;
mod recording;
mod spacing;
mod table;

pub use error::ReferenceError;
pub use point::Axis;
pub use profile::{Profile, ProfileKeys};
pub use recording::{RecordingOptions, Track};
pub use spacing::{Ahead, Own, Spacing};

use crate::keys::{Keys, NoKeys, Values};
use crate::registry::Entry;
use std::path::Path;
use std::sync::{Arc, LazyLock};

/// A target, ready for the coupling.
#[derive(Debug, Clone)]
pub enum Target {
    /// The speed that SUMO's car-following, lights and right of way choose.
    Traffic,
    /// The lane's speed limit times the vehicle's speed factor.
    Limit,
    /// A speed over position or time, shared by the vehicles that follow it.
    Profile(Arc<Profile>),
    /// A gap to the vehicle ahead, below the lane's limit.
    Spacing(Spacing),
}

impl Target {
    /// How its recording was smoothed, if it is one.
    pub fn note(&self) -> Option<&str> {
        if let Self::Profile(profile) = self { profile.note() } else { None }
    }
}

/// Builds a target from its checked keys; files are relative to the folder.
pub type Build = Arc<dyn Fn(&Values, &Path) -> Result<Target, ReferenceError> + Send + Sync>;

/// The entry of a target: its name, one line about it, and its constructor from the target's keys and the folder to which
/// their files are relative.
pub fn target<K: Keys>(
    name: &'static str,
    summary: &'static str,
    build: impl Fn(K, &Path) -> Result<Target, ReferenceError> + Send + Sync + 'static,
) -> Entry<Build> {
    let build: Build = Arc::new(move |values, folder| build(K::from_values(values), folder));
    Entry { name, summary, keys: K::keys(), build }
}

/// All targets, the default first.
pub static TARGETS: LazyLock<Vec<Entry<Build>>> = LazyLock::new(|| {
    vec![
        target(
            "traffic",
            "the speed that SUMO's car-following, lights and right of way choose",
            |_: NoKeys, _: &Path| Ok(Target::Traffic),
        ),
        target("limit", "the lane's speed limit, for test roads without traffic", |_: NoKeys, _: &Path| {
            Ok(Target::Limit)
        }),
        target(
            "profile",
            "a speed over position or time: steps, a sine, a CSV file, a driver's recording, a SUMO driving cycle",
            |keys: ProfileKeys, folder: &Path| Ok(Target::Profile(Arc::new(profile::build(&keys, folder)?))),
        ),
        ctg_acc::entry(),
        path_cacc::entry(),
    ]
});

#[cfg(test)]
mod tests;
