//! One case of the map, and its line in `map.csv`.

use crate::paper::every_law;
use std::fmt::Write;

/// One controller with its gains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Job {
    pub controller: &'static str,
    pub period_s: f64,
    /// The law's two gains, as `two_gains` has them.
    pub gain_1: f64,
    pub gain_2: f64,
}

/// One case of a job, and what came out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// The law.
    pub controller: &'static str,
    /// Δt \[s\].
    pub period_s: f64,
    /// The first gain.
    pub gain_1: f64,
    /// The second gain.
    pub gain_2: f64,
    /// b, which is also the factor by which the torque scale is wrong.
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

impl Job {
    pub fn name(&self) -> String {
        format!("{},{},{},{}", self.controller, self.period_s, self.gain_1, self.gain_2)
    }
}

impl Cell {
    pub fn job(&self) -> String {
        let Self { controller, period_s, gain_1, gain_2, .. } = *self;
        Job { controller, period_s, gain_1, gain_2 }.name()
    }

    pub fn place(&self) -> (&'static str, [f64; 6]) {
        (self.controller, [self.period_s, self.gain_1, self.gain_2, self.scale, self.limit_mps2, self.delay_s])
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
        let controller = every_law().find(|law| law == name)?;
        let numbers: Vec<f64> = numbers.iter().map(|n| n.parse().ok()).collect::<Option<_>>()?;
        let [period_s, gain_1, gain_2, scale, limit_mps2, delay_s] = numbers.try_into().ok()?;
        let optional = |text: &str| if text.is_empty() { Some(None) } else { text.parse().ok().map(Some) };
        let (error_rms, overshoot) = (optional(rms)?, optional(overshoot)?);
        Some(Self { controller, period_s, gain_1, gain_2, scale, limit_mps2, delay_s, error_rms, overshoot })
    }
}
