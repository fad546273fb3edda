//! One case of the map, its line in `map.csv`, and all of them.

use super::grid::{Grid, LAWS};
use std::fmt::Write;

/// One controller with its gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Job {
    pub controller: &'static str,
    pub period_s: f64,
    pub k_p: f64,
}

/// One case of a job, and what came out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// The law.
    pub controller: &'static str,
    /// Δt \[s\].
    pub period_s: f64,
    /// K_P [1/s].
    pub k_p: f64,
    /// b [m/s² per u].
    pub scale: f64,
    /// Torque limit [m/s²].
    pub limit_mps2: f64,
    /// Delay \[s\].
    pub delay_s: f64,
    /// RMS error on the recording with noise [m/s]; none if it diverged.
    pub error_rms: Option<f64>,
    /// Overshoot of the first step without noise [%].
    pub overshoot: Option<f64>,
}

/// The finished map.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Its axes.
    pub grid: Grid,
    /// Its cells.
    pub cells: Vec<Cell>,
}

impl Map {
    /// The cell of a law at a place of the grid.
    pub fn at(&self, law: &str, place: [f64; 5]) -> Option<&Cell> {
        self.cells.iter().find(|cell| cell.controller == law && cell.place().1 == place)
    }
}

impl Job {
    pub fn name(&self) -> String {
        format!("{},{},{}", self.controller, self.period_s, self.k_p)
    }
}

impl Cell {
    pub fn job(&self) -> String {
        let Self { controller, period_s, k_p, .. } = *self;
        Job { controller, period_s, k_p }.name()
    }

    pub fn place(&self) -> (&'static str, [f64; 5]) {
        (self.controller, [self.period_s, self.k_p, self.scale, self.limit_mps2, self.delay_s])
    }

    pub fn line(&self) -> String {
        let mut line = self.job();
        let number = |x: Option<f64>| x.map(|x| x.to_string()).unwrap_or_default();
        let (rms, overshoot) = (number(self.error_rms), number(self.overshoot));
        let _ = writeln!(line, ",{},{},{},{rms},{overshoot}", self.scale, self.limit_mps2, self.delay_s);
        line
    }

    pub fn read(line: &str) -> Option<Self> {
        let fields: Vec<&str> = line.split(',').collect();
        let [name, numbers @ .., rms, overshoot] = fields.as_slice() else { return None };
        let controller = LAWS.into_iter().find(|law| law == name)?;
        let numbers: Vec<f64> = numbers.iter().map(|n| n.parse().ok()).collect::<Option<_>>()?;
        let [period_s, k_p, scale, limit_mps2, delay_s] = numbers.try_into().ok()?;
        let optional = |text: &str| if text.is_empty() { Some(None) } else { text.parse().ok().map(Some) };
        let (error_rms, overshoot) = (optional(rms)?, optional(overshoot)?);
        Some(Self { controller, period_s, k_p, scale, limit_mps2, delay_s, error_rms, overshoot })
    }
}
