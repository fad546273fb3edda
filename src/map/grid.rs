//! The axes of the map.

/// The laws on the map.
pub const LAWS: [&str; 4] = ["classic", "adaptive", "calibrating", "pid"];

/// The key of a law's second gain; the first is `k_p`.
pub fn second_key(law: &str) -> &'static str {
    if law == "pid" { "k_i" } else { "window_s" }
}

/// The laws of the paper, which are also shown over the torque scale that they believe in, with this window \[s\].
pub const SHOWN_OVER_SCALE: ([&str; 2], f64) = (["classic", "adaptive"], 0.2);

/// The axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Control periods Δt \[s\].
    pub periods_s: Vec<f64>,
    /// K_P of the model-free laws, k_p of the PID [1/s].
    pub gains: Vec<f64>,
    /// k_i of the PID [1/s²].
    pub integral_gains: Vec<f64>,
    /// T of the model-free laws \[s\].
    pub windows_s: Vec<f64>,
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
            gains: powers(0.25, 9),
            integral_gains: powers(0.0625, 9),
            windows_s: vec![0.1, 0.14, 0.2, 0.28, 0.4, 0.56, 0.8, 1.12, 1.6],
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
            gains: vec![1.0, 4.0],
            integral_gains: vec![0.5, 1.0],
            windows_s: vec![0.2, 0.5],
            scales: vec![0.1, 0.4],
            factors: vec![0.5, 1.0],
            limits_mps2: vec![5.3],
            delays_s: vec![0.0, 0.25],
        }
    }

    /// The second gains of a law.
    pub fn second_gains(&self, law: &str) -> &[f64] {
        if second_key(law) == "k_i" { &self.integral_gains } else { &self.windows_s }
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
