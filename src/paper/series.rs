//! The series behind the figures, as CSV.

use super::library::Preset;
use crate::offline::Moment;
use std::fmt::Write;

/// A series has about this many rows at most; longer ones are thinned evenly.
const ROWS: usize = 5000;

/// One file.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// The file's stem.
    pub name: String,
    /// Its content.
    pub csv: String,
}

impl Series {
    /// One file per controller.
    pub fn all(test: &str, preset: &Preset, drives: &[(&'static str, Vec<Moment>)]) -> Vec<Self> {
        let one = |(controller, moments): &(&'static str, Vec<Moment>)| {
            let name = format!("{}_{test}_{controller}", preset.name);
            let mut csv =
                String::from("time_s,distance_m,reference_mps,speed_mps,error_mps,front_wheel_nm,alpha_ratio\n");
            for m in moments.iter().step_by(moments.len().div_ceil(ROWS).max(1)) {
                let error = m.speed_mps - m.reference_mps;
                let _ = writeln!(
                    csv,
                    "{},{},{},{},{error},{},{}",
                    m.time_s, m.distance_m, m.reference_mps, m.speed_mps, m.front_wheel_nm, m.alpha_ratio
                );
            }
            Self { name, csv }
        };
        drives.iter().map(one).collect()
    }
}
