//! The axes of the map.

/// The laws on the map.
pub const LAWS: [&str; 2] = ["classic", "adaptive"];

/// Their window T \[s\], that of the paper.
pub const WINDOW_S: f64 = 0.2;

/// The axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Control periods Δt \[s\].
    pub periods_s: Vec<f64>,
    /// K_P [1/s].
    pub gains: Vec<f64>,
    /// Torque scales b [m/s² per u].
    pub scales: Vec<f64>,
    /// Torque limits as accelerations [m/s²].
    pub limits_mps2: Vec<f64>,
    /// Delays \[s\].
    pub delays_s: Vec<f64>,
}

impl Grid {
    /// Half a minute on two cores.
    pub fn whole() -> Self {
        Self {
            periods_s: vec![0.001, 0.002, 0.005, 0.01, 0.02],
            gains: powers(0.25, 9),
            scales: powers(0.0125, 9),
            limits_mps2: vec![3.0, 5.3],
            delays_s: vec![0.0, 0.25],
        }
    }

    /// Seconds, to see that it works.
    pub fn coarse() -> Self {
        Self {
            periods_s: vec![0.01, 0.02],
            gains: vec![1.0, 4.0],
            scales: vec![0.1, 0.4],
            limits_mps2: vec![5.3],
            delays_s: vec![0.0, 0.25],
        }
    }
}

/// `count` powers of two times `first`.
fn powers(first: f64, count: u32) -> Vec<f64> {
    (0..count).map(|k| first * f64::from(1_u32 << k)).collect()
}
