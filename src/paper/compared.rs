//! The laws that are compared.

use crate::control;

/// Those that the paper compares; a preset's `[controller]` is for them.
pub const CONTROLLERS: [&str; 2] = ["classic", "adaptive"];

/// Every law that drives a body, those that are not the paper's included.
pub fn every_law() -> impl Iterator<Item = &'static str> {
    control::CONTROLLERS.iter().map(|entry| entry.name).filter(|name| *name != "ideal")
}
