//! What SAE J2951 (2014) adds up along a trace of speeds: distance, cycle energy, speed change and inertial work.

use crate::columns::columns;
use crate::lanes::{LANES, Lanes};

columns! {
    /// Sums along the traces of a block of vehicles.
    #[derive(Debug, Clone)]
    pub(super) struct Trace {
        columns {
            previous_mps: f64 = 0.0,
            pub distance_m: f64 = 0.0,
            /// Work of the driving force wherever it is positive \[J\].
            pub cycle_energy_j: f64 = 0.0,
            /// Σ|Δv| [m/s].
            pub speed_change_mps: f64 = 0.0,
            /// Work of the inertial force wherever it is positive \[J\].
            pub inertial_work_j: f64 = 0.0,
        }
    }
}

impl Trace {
    /// Goes on at `speed_mps`: the jump to it is no driving.
    pub fn rejoin(&mut self, slot: usize, speed_mps: f64) {
        self.previous_mps[slot] = speed_mps;
    }

    /// Takes the speed at the end of a step of `step_s` \[s\].
    #[inline(always)]
    pub fn step(&mut self, speed_mps: &Lanes, load: [&Lanes; 3], step_s: f64, active: &Lanes) {
        let [mass_kg, rolling_n, drag_ns2pm2] = load;
        for i in 0..LANES {
            let on = active[i] > 0.0;
            let before_mps = self.previous_mps[i];
            let speed_mps = if on { speed_mps[i] } else { before_mps };
            let mean_mps = 0.5 * (before_mps + speed_mps);
            let distance_m = if on { mean_mps * step_s } else { 0.0 };
            let inertial_n = mass_kg[i] * (speed_mps - before_mps) / step_s;
            let force_n = inertial_n + rolling_n[i] + drag_ns2pm2[i] * mean_mps * mean_mps;
            self.distance_m[i] += distance_m;
            self.cycle_energy_j[i] += force_n.max(0.0) * distance_m;
            self.inertial_work_j[i] += inertial_n.max(0.0) * distance_m;
            self.speed_change_mps[i] += (speed_mps - before_mps).abs();
            self.previous_mps[i] = speed_mps;
        }
    }
}
