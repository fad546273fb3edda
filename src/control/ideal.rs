//! No controller: the vehicle takes the reference speed as it is. This shows what the coupling alone does.

use super::law::{Build, Law};
use crate::keys::{Keys, NoKeys};
use crate::registry::Entry;
use std::sync::Arc;

pub(super) fn entry() -> Entry<Build> {
    let summary = "the vehicle takes the reference speed exactly: no body, no torque";
    Entry { name: "ideal", summary, keys: NoKeys::keys(), build: Arc::new(|_, _| Law::Nothing) }
}
