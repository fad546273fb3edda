//! The axes of the map.

/// The laws on the map.
pub const LAWS: [&str; 4] = ["classic", "adaptive", "calibrating", "pid"];

/// The key of a law's second value; none where it is the torque scale itself. The torque scale of a law with two keys is
/// right, but for the factors.
pub fn second_key(law: &str) -> Option<&'static str> {
    match law {
        "pid" => Some("k_i"),
        "calibrating" => Some("window_s"),
        _ => None,
    }
}

/// The axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Control periods Δt \[s\].
    pub periods_s: Vec<f64>,
    /// K_P of the model-free laws, k_p of the PID [1/s].
    pub gains: Vec<f64>,
    /// k_i of the PID [1/s²].
    pub integral_gains: Vec<f64>,
    /// T of the calibrating law \[s\].
    pub windows_s: Vec<f64>,
    /// Torque scales b of the paper's laws [m/s² per u].
    pub scales: Vec<f64>,
    /// Factors by which the torque scale of the others is wrong.
    pub factors: Vec<f64>,
    /// Torque limits as accelerations [m/s²].
    pub limits_mps2: Vec<f64>,
    /// Delays \[s\].
    pub delays_s: Vec<f64>,
}

impl Grid {
    /// A minute or two on two cores.
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

    /// The second values of a law.
    pub fn second_gains(&self, law: &str) -> &[f64] {
        match second_key(law) {
            Some("k_i") => &self.integral_gains,
            Some(_) => &self.windows_s,
            None => &[0.0],
        }
    }

    /// The torque scales that one job of a law tries.
    pub fn scales_of(&self, law: &str) -> &[f64] {
        if second_key(law).is_some() { &self.factors } else { &self.scales }
    }
}

/// `count` powers of two times `first`.
fn powers(first: f64, count: u32) -> Vec<f64> {
    (0..count).map(|k| first * f64::from(1_u32 << k)).collect()
}
