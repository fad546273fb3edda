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
mod target;

pub use error::ReferenceError;
pub use point::Axis;
pub use profile::{Profile, ProfileKeys};
pub use recording::{RecordingOptions, Track};
pub use spacing::{Ahead, Own, Spacing};
pub use target::{Build, Target, target};

use crate::keys::NoKeys;
use crate::registry::Entry;
use std::path::Path;
use std::sync::{Arc, LazyLock};

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
