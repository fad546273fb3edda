//! The executors by name.

use super::work::Executor;
use super::{local, slurm};
use crate::registry::Entry;
use std::collections::BTreeMap;

/// The executors, the default first.
pub static EXECUTORS: &[Entry<Executor>] = &[
    Entry {
        name: "local",
        summary: "on this machine, each case a process of its own",
        keys: &[],
        build: Executor { execute: local::execute, standing: |_| Ok(BTreeMap::new()) },
    },
    Entry {
        name: "slurm",
        summary: "job arrays of a Slurm cluster, and a job that writes the tables after them",
        keys: &[],
        build: Executor { execute: slurm::execute, standing: slurm::standing },
    },
];
