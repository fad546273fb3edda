//! The finished map, and the best gains of each law on it.

use super::cell::Cell;
use super::grid::Grid;

/// The finished map.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Its axes.
    pub grid: Grid,
    /// Its cells.
    pub cells: Vec<Cell>,
}

/// The best choice of a law's two gains under one condition, with the right torque scale, and what it is worth when the torque scale is wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct Tuned {
    /// The law.
    pub law: &'static str,
    /// The case with the least error.
    pub best: Cell,
    /// The same gains by factor.
    pub wrong: Vec<Option<Cell>>,
}

impl Map {
    /// The cell of a law at a place of the grid.
    pub fn at(&self, law: &str, place: [f64; 6]) -> Option<&Cell> {
        self.cells.iter().find(|c| {
            c.controller == law && [c.period_s, c.gain_1, c.gain_2, c.scale, c.limit_mps2, c.delay_s] == place
        })
    }

    /// The best choice of every law under every condition.
    pub fn tuned(&self) -> Vec<(String, Vec<Tuned>)> {
        let mut all = Vec::new();
        for &period_s in &self.grid.periods_s {
            for &limit_mps2 in &self.grid.limits_mps2 {
                for &delay_s in &self.grid.delays_s {
                    let name = format!("dt {} ms, limit {limit_mps2}, delay {delay_s}", 1000.0 * period_s);
                    let laws =
                        self.grid.laws().into_iter().filter_map(|law| self.tune(law, period_s, limit_mps2, delay_s));
                    all.push((name, laws.collect()));
                }
            }
        }
        all
    }

    fn tune(&self, law: &'static str, period_s: f64, limit_mps2: f64, delay_s: f64) -> Option<Tuned> {
        let here = |c: &&Cell| {
            (c.controller, c.period_s, c.limit_mps2, c.delay_s, c.scale) == (law, period_s, limit_mps2, delay_s, 1.0)
        };
        let finished = self.cells.iter().filter(here).filter(|c| c.error_rms.is_some());
        let best = *finished.min_by(|a, b| a.error_rms.partial_cmp(&b.error_rms).expect("errors are numbers"))?;
        let wrong =
            |factor: &f64| self.at(law, [period_s, best.gain_1, best.gain_2, *factor, limit_mps2, delay_s]).copied();
        Some(Tuned { law, best, wrong: self.grid.factors.iter().map(wrong).collect() })
    }
}
