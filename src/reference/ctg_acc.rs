//! Adaptive cruise control with a constant time gap: a = 0.23 e + 0.07 (v_l − v), identified on four production cars (Milanés and Shladover
//! 2014, Transportation Research Part C 48, 285-300; the cruising gain of 0.4/s from Xiao, Wang and van Arem 2017, Transportation Research Record
//! 2623, 1-9). SUMO's car-following model ACC has the same gains. The time gap of 1.1 s is the shortest of those that were driven
//! (1.1, 1.6, 2.2 s).

use super::spacing::{ComfortKeys, Spacing};
use super::target::{Build, Target, target};
use crate::keys;
use crate::registry::Entry;
use std::path::Path;

keys! {
    /// Keys of the target.
    struct AccKeys {
        /// h, the time gap that is kept
        time_gap_s: f64 = 1.1, "s", 0.1..=10.0;
        /// c_e, acceleration per error of the gap
        gap_per_s2: f64 = 0.23, "1/s2", 0.0..=100.0;
        /// c_v, acceleration per difference of speeds
        speed_per_s: f64 = 0.07, "1/s", 0.0..=100.0;
        and ..comfort: ComfortKeys,
    }
}

pub(super) fn entry() -> Entry<Build> {
    target(
        "ctg_acc",
        "a constant time gap to the vehicle ahead, as production ACC keeps it",
        |keys: AccKeys, _: &Path| {
            let gains = [keys.gap_per_s2, keys.speed_per_s, 0.0];
            Ok(Target::Spacing(Spacing::new(keys.time_gap_s, gains, &keys.comfort)))
        },
    )
}
