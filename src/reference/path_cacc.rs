//! PATH's cooperative adaptive cruise control: in every step of control v ← v + k_p e + k_d ė, ė = v_l − v − h a, with k_p = 0.45, k_d = 0.0125 (Milanés and
//! Shladover 2014, Transportation Research Part C 48, 285-300; the gains as in Xiao, Wang and van Arem 2017, Transportation Research Record 2623, 1-9,
//! and in SUMO's car-following model CACC). The gains are per step; the length of the step, 0.1 s, is ours, so that the law does not depend
//! on SUMO's. The time gap of 0.6 s is the shortest of those that were driven (0.6, 0.7, 0.9, 1.1 s).
//!
//! What is cooperative in it is that the speed ahead is known without a radar's lag.

use super::spacing::{ComfortKeys, Spacing};
use super::target::{Build, Target, target};
use crate::keys;
use crate::registry::Entry;
use std::path::Path;

keys! {
    /// Keys of the target.
    struct CaccKeys {
        /// h, the time gap that is kept
        time_gap_s: f64 = 0.6, "s", 0.1..=10.0;
        /// k_p, change of speed per error of the gap in a step of control
        k_p: f64 = 0.45, "1/s", 0.0..=100.0;
        /// k_d, change of speed per rate of that error in a step of control
        k_d: f64 = 0.0125, "-", 0.0..=100.0;
        /// step of control that k_p and k_d are for
        update_s: f64 = 0.1, "s", 0.001..=10.0;
        and ..comfort: ComfortKeys,
    }
}

pub(super) fn entry() -> Entry<Build> {
    let summary = "a short time gap to the vehicle ahead, as PATH's cooperative ACC keeps it";
    target("path_cacc", summary, |keys: CaccKeys, _: &Path| {
        let gains = [keys.k_p, keys.k_d, keys.k_d * keys.time_gap_s].map(|gain| gain / keys.update_s);
        Ok(Target::Spacing(Spacing::new(keys.time_gap_s, gains, &keys.comfort)))
    })
}
