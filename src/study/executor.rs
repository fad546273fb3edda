//! The executors by name.

use super::local;
use super::work::Execute;
use crate::registry::Entry;

/// The executors, the default first.
pub static EXECUTORS: &[Entry<Execute>] = &[Entry {
    name: "local",
    summary: "on this machine, each case a process of its own",
    keys: &[],
    build: local::execute,
}];
