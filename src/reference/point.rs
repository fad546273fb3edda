//! Points of a profile, and what it is a function of.

/// What a profile is a function of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Driven distance (m).
    Position,
    /// Time since the vehicle's start (s).
    Time,
}

/// A speed at a place on the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    pub at: f64,
    pub speed_mps: f64,
}
