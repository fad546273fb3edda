//! What a target is, and how it is made.

use super::error::ReferenceError;
use super::profile::Profile;
use super::spacing::Spacing;
use crate::keys::{Keys, Values};
use crate::registry::Entry;
use std::path::Path;
use std::sync::Arc;

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
