//! The warm-up of a study: the traffic before its cases begin, simulated once per seed by SUMO without us, and loaded by
//! every case of that seed.
//!
//! A saved state is named after the hash of what makes it, so that a case that names it has an identity of its own.

use crate::sumo_files::SumoSetup;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// One warm-up.
#[derive(Debug, Clone)]
pub struct WarmUp {
    /// SUMO without us, with its seed.
    pub setup: SumoSetup,
    /// When it ends \[s\].
    pub until_s: f64,
    /// Where its state is.
    pub state: PathBuf,
}

impl WarmUp {
    /// The warm-up of a seed; `made_of` tells versions and inputs.
    pub fn new(dir: &Path, (setup, until_s): &(SumoSetup, f64), seed: u64, made_of: &str) -> Self {
        let setup = SumoSetup { seed, ..setup.clone() };
        let hash = Sha256::digest(format!("{setup:?} {until_s} {made_of}"));
        let name: String = hash[..8].iter().map(|byte| format!("{byte:02x}")).collect();
        Self { setup, until_s: *until_s, state: dir.join("warm_up").join(format!("{name}.xml.gz")) }
    }
}
