//! Laws that keep a gap to the vehicle ahead: what the targets `ctg_acc` and `path_cacc` have in common.
//!
//! With the gap g to the vehicle ahead, its speed v_l, the own speed v and acceleration a:
//! ```text
//! e = g − g₀ − h v                                       h the time gap
//! a_gap = c_e e + c_v (v_l − v) − c_a a,   a_free = c_0 (v_free − v)
//! a_wanted = min(a_gap, a_free) within the bounds of comfort
//! ```
//! With nobody ahead a_free is all there is. The published models switch between the two by range; the smaller of both does the same without a
//! jump. The wanted speed at the end of a step is v + a_wanted Δt.

use crate::keys;

keys! {
    /// What both laws can be told.
    #[derive(Copy)]
    pub(super) struct ComfortKeys {
        /// gap at rest, beyond SUMO's minGap
        standstill_gap_m: f64 = 0.0, "m", 0.0..=100.0;
        /// c_0, acceleration per speed error while nobody is ahead
        cruise_per_s: f64 = 0.4, "1/s", 0.0..=10.0;
        /// largest acceleration that is asked for
        accel_max_mps2: f64 = 2.0, "m/s2", 0.1..=20.0;
        /// largest deceleration that is asked for; SUMO's own safe speed comes on top
        decel_max_mps2: f64 = 4.0, "m/s2", 0.1..=20.0;
    }
}

/// The vehicle ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ahead {
    /// Gap to it, beyond SUMO's minGap \[m\].
    pub gap_m: f64,
    /// Its speed [m/s].
    pub speed_mps: f64,
}

/// How the own vehicle moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Own {
    /// Speed [m/s].
    pub speed_mps: f64,
    /// Acceleration [m/s²].
    pub accel_mps2: f64,
    /// The speed that it would have alone [m/s].
    pub free_mps: f64,
}

/// A law that keeps a gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spacing {
    /// h, the time gap \[s\].
    pub time_gap_s: f64,
    /// c_e [1/s²].
    pub gap_per_s2: f64,
    /// c_v [1/s].
    pub speed_per_s: f64,
    /// c_a.
    pub accel: f64,
    /// g₀ \[m\].
    pub standstill_gap_m: f64,
    /// c_0 [1/s].
    pub cruise_per_s: f64,
    /// Smallest and largest acceleration [m/s²].
    pub bounds_mps2: [f64; 2],
}

impl Spacing {
    pub(super) fn new(time_gap_s: f64, [gap_per_s2, speed_per_s, accel]: [f64; 3], comfort: &ComfortKeys) -> Self {
        Self {
            time_gap_s,
            gap_per_s2,
            speed_per_s,
            accel,
            standstill_gap_m: comfort.standstill_gap_m,
            cruise_per_s: comfort.cruise_per_s,
            bounds_mps2: [-comfort.decel_max_mps2, comfort.accel_max_mps2],
        }
    }

    /// The gap that is kept at a constant speed \[m\].
    pub fn gap_m(&self, speed_mps: f64) -> f64 {
        self.standstill_gap_m + self.time_gap_s * speed_mps
    }

    /// The wanted speed after a step of `step_s` [m/s].
    pub fn next_mps(&self, own: Own, ahead: Option<Ahead>, step_s: f64) -> f64 {
        let free = self.cruise_per_s * (own.free_mps - own.speed_mps);
        let wanted = ahead.map_or(free, |Ahead { gap_m, speed_mps }| {
            let error_m = gap_m - self.gap_m(own.speed_mps);
            let kept = self.gap_per_s2 * error_m + self.speed_per_s * (speed_mps - own.speed_mps);
            free.min(kept - self.accel * own.accel_mps2)
        });
        let [least, most] = self.bounds_mps2;
        (own.speed_mps + step_s * wanted.clamp(least, most)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keys::Values;
    use crate::reference::{TARGETS, Target};
    use crate::registry::find;
    use std::path::Path;

    fn spacing(name: &str) -> Spacing {
        let entry = find("target", &TARGETS, name).unwrap();
        let built = (entry.build)(&Values::defaults(entry.keys), Path::new("")).unwrap();
        let Target::Spacing(spacing) = built else { panic!("{name} keeps a gap") };
        spacing
    }

    #[test]
    fn val_the_gains_are_the_published_ones() {
        // Milanés and Shladover 2014; Xiao, Wang and van Arem 2017, as SUMO's own models ACC and CACC have them.
        let acc = spacing("ctg_acc");
        assert_eq!((acc.gap_per_s2, acc.speed_per_s, acc.accel, acc.cruise_per_s), (0.23, 0.07, 0.0, 0.4));
        let cacc = spacing("path_cacc");
        // v ← v + 0.45 e + 0.0125 ė in each step of 0.1 s.
        let own = Own { speed_mps: 20.0, accel_mps2: 0.3, free_mps: 40.0 };
        let ahead = Ahead { gap_m: cacc.gap_m(20.0) + 0.2, speed_mps: 20.1 };
        let published = 20.0 + 0.45 * 0.2 + 0.0125 * (0.1 - 0.6 * 0.3);
        assert!((cacc.next_mps(own, Some(ahead), 0.1) - published).abs() < 1e-12);
        assert_eq!((acc.time_gap_s, cacc.time_gap_s), (1.1, 0.6));
    }

    #[test]
    fn law_the_wanted_gap_is_kept_and_comfort_bounds_what_is_asked() {
        for name in ["ctg_acc", "path_cacc"] {
            let law = spacing(name);
            let own = Own { speed_mps: 15.0, accel_mps2: 0.0, free_mps: 30.0 };
            let at = |gap_m: f64| law.next_mps(own, Some(Ahead { gap_m, speed_mps: 15.0 }), 0.1);
            assert!((at(law.gap_m(15.0)) - 15.0).abs() < 1e-12, "{name}");
            assert!((at(-10.0) - 14.6).abs() < 1e-12 && (at(1000.0) - 15.2).abs() < 1e-12, "{name}");
            assert_eq!(law.next_mps(Own { free_mps: 15.0, ..own }, None, 0.1), 15.0, "{name}");
            assert_eq!(
                law.next_mps(Own { speed_mps: 0.1, ..own }, Some(Ahead { gap_m: -10.0, speed_mps: 0.0 }), 1.0),
                0.0
            );
        }
    }
}
