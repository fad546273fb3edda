//! What is asked for.

use super::error::StabilityError;
use crate::registry::find;
use crate::scenario::{self, Catalog};

/// Which laws are examined, and behind what.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Body and gains. Its controller, target and actuators are replaced.
    pub scenario: scenario::Request,
    /// The laws; empty = all that drive a body.
    pub controllers: Vec<String>,
    /// Time constants of the actuators \[s\].
    pub lags_s: Vec<f64>,
    /// Dead times of the actuators \[s\].
    pub delays_s: Vec<f64>,
    /// The targets that keep the gaps.
    pub uppers: Vec<String>,
    /// Show a progress bar.
    pub progress: bool,
}

impl Request {
    /// The names of the laws.
    pub(super) fn laws(&self, catalog: &Catalog) -> Result<Vec<String>, StabilityError> {
        let [(kind, laws), (target, targets), ..] = catalog.registries();
        for upper in &self.uppers {
            find(target, &targets, upper)?;
        }
        for name in &self.controllers {
            find(kind, &laws, name)?;
        }
        let all = || laws.iter().map(|law| law.name.to_owned()).filter(|name| name != "ideal").collect();
        Ok(if self.controllers.is_empty() { all() } else { self.controllers.clone() })
    }

    /// The place of an upper law among all.
    pub(super) fn place(&self, upper: &str) -> usize {
        self.uppers.iter().position(|name| name == upper).unwrap_or_default()
    }
}
