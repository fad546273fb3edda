//! What a law is to those who choose it by name: an entry with a constructor.

use super::controller::Controller;
use super::group::GroupController;
use crate::keys::{Keys, Values};
use crate::registry::Entry;
use std::sync::Arc;

/// Builds what drives vehicles from its checked keys and the control period Δt (s).
pub type Build = Arc<dyn Fn(&Values, f64) -> Law + Send + Sync>;

/// What drives vehicles.
pub enum Law {
    /// Nothing: they take the reference speed as it is.
    Nothing,
    /// A controller for each block of them.
    Block(Box<dyn Controller>),
    /// A controller for all of a group.
    Group(Box<dyn GroupController>),
}

impl Law {
    /// The controller of a block, if that is what it is.
    pub fn block(self) -> Option<Box<dyn Controller>> {
        if let Self::Block(controller) = self { Some(controller) } else { None }
    }
}

/// The entry of a law: its name, one line about it, and its constructor from the law's keys and the control period Δt (s).
pub fn law<K: Keys, C: Controller + 'static>(
    name: &'static str,
    summary: &'static str,
    build: impl Fn(K, f64) -> C + Send + Sync + 'static,
) -> Entry<Build> {
    let build: Build = Arc::new(move |values, period_s| Law::Block(Box::new(build(K::from_values(values), period_s))));
    Entry { name, summary, keys: K::keys(), build }
}

/// The entry of a law that commands all vehicles of a group at once.
pub fn group_law<K: Keys, C: GroupController + 'static>(
    name: &'static str,
    summary: &'static str,
    build: impl Fn(K, f64) -> C + Send + Sync + 'static,
) -> Entry<Build> {
    let build: Build = Arc::new(move |values, period_s| Law::Group(Box::new(build(K::from_values(values), period_s))));
    Entry { name, summary, keys: K::keys(), build }
}
