//! A law after its search.

use super::condition::Condition;
use super::drives::{Drives, Trial};
use super::gains::Gain;

/// A law in a condition, tuned.
pub struct Tuned<'a> {
    pub condition: &'a Condition,
    pub controller: &'a str,
    pub gains: Vec<Gain>,
    /// The best values of the gains.
    pub best: Vec<f64>,
    pub trials: usize,
    /// What they cost on the recordings to tune on.
    pub train: Trial,
    pub drives: Drives<'a>,
}
