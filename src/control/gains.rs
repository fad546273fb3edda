//! Which keys of a law are gains: declared once, for whatever tunes laws.

use crate::keys::Key;

/// What counts as a gain, the most usual first. What a law believes about the vehicle (`accel_per_unit_mps2`, `model_delay_s`), and bounds,
/// are none: they are part of the condition under which it is tuned.
const GAINS: [&str; 8] = ["k_p", "window_s", "k_i", "epsilon", "memory_s", "k_d", "error_time_s", "integral_time_s"];

/// The gains among the keys of a law, the most usual first.
pub fn gains(keys: &'static [Key]) -> Vec<&'static Key> {
    GAINS.iter().filter_map(|name| keys.iter().find(|key| key.name == *name)).collect()
}
