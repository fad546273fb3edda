//! The axes of the map.

use crate::control::{CONTROLLERS, gains};
use crate::keys::Key;
use crate::paper::every_law;
use crate::registry::find;

/// The laws of the paper, which are also shown over the torque scale that they believe in, with this window \[s\].
pub const SHOWN_OVER_SCALE: ([&str; 2], f64) = (["classic", "adaptive"], 0.2);

/// The two gains of a law that are tuned, those that `tune` takes first; none of a law that has fewer.
pub fn two_gains(law: &str) -> Option<[&'static Key; 2]> {
    let law = find("controller", &CONTROLLERS, law).ok()?;
    gains(law.keys).get(..2)?.try_into().ok()
}

/// The axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Control periods Δt \[s\].
    pub periods_s: Vec<f64>,
    /// What is tried of each gain, by its key.
    pub gains: Vec<(&'static str, Vec<f64>)>,
    /// Torque scales b over which the paper's laws are shown [m/s² per u].
    pub scales: Vec<f64>,
    /// Factors by which the torque scale is wrong where laws are compared at their best gains.
    pub factors: Vec<f64>,
    /// Torque limits as accelerations [m/s²].
    pub limits_mps2: Vec<f64>,
    /// Delays \[s\].
    pub delays_s: Vec<f64>,
}

impl Grid {
    /// Minutes on two cores.
    pub fn whole() -> Self {
        Self {
            periods_s: vec![0.001, 0.002, 0.005, 0.01, 0.02],
            gains: vec![
                ("k_p", powers(0.25, 9)),
                ("k_i", powers(0.0625, 9)),
                ("window_s", vec![0.1, 0.14, 0.2, 0.28, 0.4, 0.56, 0.8, 1.12, 1.6]),
                // As far as the gains that they stand for: k_p is about 1/T_e, k_i about 1/T_i².
                ("error_time_s", powers(1.0 / 64.0, 9)),
                ("integral_time_s", vec![0.25, 0.35, 0.5, 0.71, 1.0, 1.41, 2.0, 2.83, 4.0]),
            ],
            scales: powers(0.0125, 9),
            factors: powers(0.25, 5),
            limits_mps2: vec![3.0, 5.3],
            delays_s: vec![0.0, 0.25],
        }
    }

    /// Seconds, to see that it works.
    pub fn coarse() -> Self {
        Self {
            periods_s: vec![0.01, 0.02],
            gains: vec![
                ("k_p", vec![1.0, 4.0]),
                ("k_i", vec![0.5, 1.0]),
                ("window_s", vec![0.2, 0.5]),
                ("error_time_s", vec![0.25, 1.0]),
                ("integral_time_s", vec![1.0, 2.0]),
            ],
            scales: vec![0.1, 0.4],
            factors: vec![0.5, 1.0],
            limits_mps2: vec![5.3],
            delays_s: vec![0.0, 0.25],
        }
    }

    /// What is tried of a gain; nothing of one that has no axis.
    pub fn axis(&self, gain: &str) -> &[f64] {
        self.gains.iter().find(|(key, _)| *key == gain).map_or(&[], |(_, values)| values)
    }

    /// The laws on the map: all that have two gains with an axis.
    pub fn laws(&self) -> Vec<&'static str> {
        let is_here = |law: &&str| two_gains(law).is_some_and(|two| two.iter().all(|g| !self.axis(g.name).is_empty()));
        every_law().filter(is_here).collect()
    }

    /// The torque scales that one job of a law tries.
    pub fn scales_of(&self, law: &str, gain_2: f64) -> Vec<f64> {
        let (laws, window_s) = SHOWN_OVER_SCALE;
        let mut scales = self.factors.clone();
        if laws.contains(&law) && gain_2 == window_s {
            scales.extend(self.scales.iter().filter(|scale| !self.factors.contains(scale)));
            scales.sort_by(f64::total_cmp);
        }
        scales
    }
}

/// `count` powers of two times `first`.
fn powers(first: f64, count: u32) -> Vec<f64> {
    (0..count).map(|k| first * f64::from(1_u32 << k)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_law_is_on_the_map_with_as_many_choices() {
        for grid in [Grid::whole(), Grid::coarse()] {
            assert_eq!(grid.laws(), every_law().collect::<Vec<_>>());
            let choices = |law: &str| two_gains(law).unwrap().map(|gain| grid.axis(gain.name).len());
            assert!(grid.laws().iter().all(|law| choices(law) == choices("classic")), "equal tuning");
        }
        assert!(two_gains("ideal").is_none());
    }
}
