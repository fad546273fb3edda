//! Actuators between a controller's torque and the wheels: limits, dead time, first-order lag.

use crate::columns::{Slots, columns};
use crate::keys;
use crate::lanes::{LANES, Lanes};

/// Largest dead time that can be asked for \[s\].
pub const DEAD_TIME_MAX_S: f64 = 5.0;

keys! {
    /// Keys of a vehicle's actuators.
    pub struct ActuatorKeys {
        /// dead time between command and torque
        delay_s: f64 = 0.0, "s", 0.0..=DEAD_TIME_MAX_S;
        /// time constant of the torque behind the dead time
        lag_s: f64 = 0.0, "s", 0.0..=5.0;
    }
}

/// What became of the torques of one control period.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Actuated {
    /// Torque on the wheels in this period [N·m].
    pub torque_nm: Lanes,
    /// gain × torque asked for.
    pub commanded: Lanes,
    /// gain × torque within the limits, neither delayed nor lagged.
    pub saturated: Lanes,
    /// gain × torque carried as one product through limits, dead time and lag.
    pub applied: Lanes,
}

columns! {
    /// The actuators of one block of vehicles, without dead time, lag or limits until [`Actuators::set`] says otherwise, for
    /// control periods of `period_s` and dead times up to `dead_time_max_s`.
    ///
    /// In each period: limit, then dead time, then lag. The dead time is a ring buffer of periods; a dead time between two
    /// multiples of the period interpolates linearly between the two samples. The lag is the exact answer of
    /// τ ẋ = in − x over one period to an input that is constant in it, y_k = x at the period's end:
    /// x ← in + (x − in)·exp(−Δt/τ).
    #[derive(Debug, Clone)]
    pub struct Actuators(period_s: f64, dead_time_max_s: f64) {
        shared {
            period_s: f64 = period_s,
        }
        parts {
            past: Past = Past::new((dead_time_max_s / period_s).ceil().max(0.0) as usize + 2),
        }
        columns {
            /// Whole periods of dead time, and the weight of the sample one period older.
            whole: usize = 0,
            older: f64 = 0.0,
            /// exp(−Δt/τ), 0 without lag.
            decay: f64 = 0.0,
            drive_max_nm: f64 = f64::INFINITY,
            brake_max_nm: f64 = f64::INFINITY,
        }
    }
}

columns! {
    /// Past limited torques and their products with the gain.
    #[derive(Debug, Clone)]
    struct Past(rows: usize) {
        shared {
            /// The newest row of the rings, which have one row per period.
            head: usize = 0,
        }
        parts {
            torque_ring: Vec<Lanes> = vec![[0.0; LANES]; rows],
            product_ring: Vec<Lanes> = vec![[0.0; LANES]; rows],
        }
        columns {
            /// What left the lag in the last period.
            torque: f64 = 0.0,
            product: f64 = 0.0,
        }
    }
}

impl Past {
    /// Room for so many rows; new ones are older than all, and like the oldest.
    fn grow(&mut self, rows: usize) {
        let (head, before) = (self.head, self.torque_ring.len());
        if rows <= before {
            return;
        }
        for ring in [&mut self.torque_ring, &mut self.product_ring] {
            // The oldest comes first now, and the newest last.
            ring.rotate_left((head + 1) % before);
            let oldest = ring[0];
            ring.splice(0..0, std::iter::repeat_n(oldest, rows - before));
        }
        self.head = rows - 1;
    }
}

impl Actuators {
    /// Sets dead time \[s\], lag time constant \[s\] and torque limits (sums over the wheels, both positive) [N·m] of a slot
    /// and forgets its past. A dead time beyond the capacity is shortened to it.
    pub fn set(&mut self, slot: usize, dead_time_s: f64, lag_s: f64, drive_max_nm: f64, brake_max_nm: f64) {
        self.tune(slot, dead_time_s, lag_s, drive_max_nm, brake_max_nm);
        self.reset(slot);
    }

    /// The same for a vehicle under way: what is on its way to the wheels stays there. A longer dead time lets torques act once more,
    /// and holds the oldest that is known, until the first newer one has come through.
    pub fn change(&mut self, slot: usize, dead_time_s: f64, lag_s: f64, drive_max_nm: f64, brake_max_nm: f64) {
        let rows = (dead_time_s / self.period_s).ceil().max(0.0) as usize + 2;
        self.past.grow(rows);
        self.tune(slot, dead_time_s, lag_s, drive_max_nm, brake_max_nm);
    }

    fn tune(&mut self, slot: usize, dead_time_s: f64, lag_s: f64, drive_max_nm: f64, brake_max_nm: f64) {
        let periods = (dead_time_s / self.period_s).clamp(0.0, (self.past.torque_ring.len() - 2) as f64);
        // A dead time typed as a multiple of the period is one: 0.07/0.01 must not become 7.000000000000001.
        let periods = if (periods - periods.round()).abs() < 1e-9 { periods.round() } else { periods };
        self.whole[slot] = periods.floor() as usize;
        self.older[slot] = periods - periods.floor();
        self.decay[slot] = if lag_s > 0.0 { libm::exp(-self.period_s / lag_s) } else { 0.0 };
        self.drive_max_nm[slot] = drive_max_nm;
        self.brake_max_nm[slot] = brake_max_nm;
    }

    /// Forgets the past of a slot: zero torque everywhere.
    pub fn reset(&mut self, slot: usize) {
        self.past.clear(slot);
    }

    /// Takes the torques asked for in this period and gives those that act in it. `gain` turns a torque into the
    /// controller's input v = gain·torque; the product is carried as one, so that a delayed torque is never multiplied
    /// by a later gain.
    pub fn step(&mut self, torque_nm: &Lanes, gain: &Lanes) -> Actuated {
        let past = &mut self.past;
        past.head = if past.head + 1 < past.torque_ring.len() { past.head + 1 } else { 0 };
        let mut out = Actuated::default();
        for lane in 0..LANES {
            let limited = torque_nm[lane].min(self.drive_max_nm[lane]).max(-self.brake_max_nm[lane]);
            out.commanded[lane] = gain[lane] * torque_nm[lane];
            out.saturated[lane] = gain[lane] * limited;
            past.torque_ring[past.head][lane] = limited;
        }
        past.product_ring[past.head] = out.saturated;
        for (state, ring) in [(&mut past.torque, &past.torque_ring), (&mut past.product, &past.product_ring)] {
            let [newer, older] = look_back(ring, past.head, &self.whole);
            for lane in 0..LANES {
                let (share, decay) = (self.older[lane], self.decay[lane]);
                let between = newer[lane] + share * (older[lane] - newer[lane]);
                let delayed = if share > 0.0 { between } else { newer[lane] };
                let lagged = delayed + decay * (state[lane] - delayed);
                state[lane] = if decay > 0.0 { lagged } else { delayed };
            }
        }
        out.torque_nm = past.torque;
        out.applied = past.product;
        out
    }
}

/// What lies in a ring `whole` periods before the newest row, and one period before that.
fn look_back(ring: &[Lanes], head: usize, whole: &[usize; LANES]) -> [Lanes; 2] {
    let row = |back: usize| if head >= back { head - back } else { head + ring.len() - back };
    if whole.iter().all(|back| *back == whole[0]) {
        return [ring[row(whole[0])], ring[row(whole[0] + 1)]];
    }
    let mut found = [[0.0; LANES]; 2];
    for lane in 0..LANES {
        found[0][lane] = ring[row(whole[lane])][lane];
        found[1][lane] = ring[row(whole[lane] + 1)][lane];
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAIN: Lanes = [2.0; LANES];

    /// Torques and products on slot 0 for a sequence of requests.
    fn respond(actuators: &mut Actuators, torques: &[f64]) -> Vec<(f64, f64)> {
        let act = |&t: &f64| {
            let out = actuators.step(&[t; LANES], &GAIN);
            (out.torque_nm[0], out.applied[0])
        };
        torques.iter().map(act).collect()
    }

    #[test]
    fn without_settings_torque_passes_at_once() {
        let mut actuators = Actuators::new(0.01, 0.0);
        assert_eq!(respond(&mut actuators, &[1.0, -3.0]), [(1.0, 2.0), (-3.0, -6.0)]);
    }

    #[test]
    fn dead_time_of_whole_periods_is_exact() {
        let mut actuators = Actuators::new(0.01, 0.25);
        actuators.set(0, 0.07, 0.0, 1e9, 1e9);
        let answer = respond(&mut actuators, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        assert_eq!(answer.iter().map(|a| a.0).collect::<Vec<_>>(), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0]);
        assert!(answer.iter().all(|a| a.1 == 2.0 * a.0));
        // The largest dead time that was asked for fits, a larger one is shortened to it.
        actuators.set(0, 9.0, 0.0, 1e9, 1e9);
        let late = respond(&mut actuators, &[1.0; 30]);
        assert_eq!(late.iter().filter(|a| a.0 == 0.0).count(), 25);
    }

    #[test]
    fn dead_time_between_periods_interpolates() {
        let mut actuators = Actuators::new(0.01, 0.1);
        actuators.set(0, 0.0125, 0.0, 1e9, 1e9);
        let ramp: Vec<f64> = (1..20).map(f64::from).collect();
        for (asked, (torque, _)) in ramp.iter().zip(respond(&mut actuators, &ramp)).skip(3) {
            assert!((torque - (asked - 1.25)).abs() < 1e-12, "{torque} for {asked}");
        }
    }

    /// Whether its neighbours have the same dead time or none, a slot's torques are the same.
    #[test]
    fn law_the_dead_time_of_a_slot_is_its_own() {
        let ramp: Vec<f64> = (1..20).map(|k| f64::from(k * k)).collect();
        for dead_time_s in [0.0, 0.03, 0.0125] {
            let [mut alone, mut alike] = [Actuators::new(0.01, 0.1), Actuators::new(0.01, 0.1)];
            alone.set(0, dead_time_s, 0.0, 1e9, 1e9);
            (0..LANES).for_each(|slot| alike.set(slot, dead_time_s, 0.0, 1e9, 1e9));
            assert_eq!(respond(&mut alone, &ramp), respond(&mut alike, &ramp), "{dead_time_s} s");
        }
    }

    #[test]
    fn law_lag_is_the_exact_first_order_answer_to_a_step() {
        let mut actuators = Actuators::new(0.01, 0.0);
        actuators.set(0, 0.0, 0.2, 1e9, 1e9);
        for (k, (torque, product)) in respond(&mut actuators, &[100.0; 300]).into_iter().enumerate() {
            let expected = 100.0 * (1.0 - libm::exp(-(k as f64 + 1.0) * 0.01 / 0.2));
            assert!((torque - expected).abs() < 1e-10 && (product - 2.0 * expected).abs() < 1e-10);
        }
    }

    #[test]
    fn limits_come_before_the_dead_time_and_count_as_saturation() {
        let mut actuators = Actuators::new(0.01, 0.0);
        actuators.set(0, 0.0, 0.0, 100.0, 300.0);
        let out = actuators.step(&[500.0; LANES], &GAIN);
        assert_eq!(
            (out.torque_nm[0], out.commanded[0], out.saturated[0], out.applied[0]),
            (100.0, 1000.0, 200.0, 200.0)
        );
        assert_eq!(actuators.step(&[-500.0; LANES], &GAIN).torque_nm[0], -300.0);
        assert_eq!(out.torque_nm[1], 500.0, "another slot has no limits");
    }

    #[test]
    fn a_delayed_product_keeps_the_gain_of_its_own_time() {
        let mut actuators = Actuators::new(0.01, 0.02);
        actuators.set(0, 0.02, 0.0, 1e9, 1e9);
        actuators.step(&[10.0; LANES], &[3.0; LANES]);
        actuators.step(&[20.0; LANES], &[5.0; LANES]);
        let out = actuators.step(&[30.0; LANES], &[7.0; LANES]);
        assert_eq!((out.torque_nm[0], out.applied[0], out.commanded[0]), (10.0, 30.0, 210.0));
    }

    #[test]
    fn a_change_under_way_keeps_what_is_on_its_way() {
        let mut actuators = Actuators::new(0.01, 0.02);
        actuators.set(0, 0.02, 0.0, 1e9, 1e9);
        actuators.set(1, 0.01, 0.0, 1e9, 1e9);
        respond(&mut actuators, &[1.0, 2.0, 3.0, 4.0, 5.0]);
        actuators.change(0, 0.06, 0.0, 1e9, 1e9);
        let mut torques = [6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0].map(|t| actuators.step(&[t; LANES], &GAIN).torque_nm);
        assert_eq!(
            torques.map(|t| t[0]),
            [2.0, 2.0, 2.0, 3.0, 4.0, 5.0, 6.0],
            "the oldest known, then each in its turn"
        );
        assert_eq!(torques.map(|t| t[1]), [5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0], "another slot is as it was");
        actuators.change(0, 0.0, 0.0, 12.0, 1e9);
        torques[0] = actuators.step(&[13.0; LANES], &GAIN).torque_nm;
        assert_eq!(torques[0][..2], [12.0, 12.0], "shorter at once, and within the new limit");
    }

    #[test]
    fn reset_forgets_one_slot_only() {
        let mut actuators = Actuators::new(0.01, 0.03);
        for slot in [0, 1] {
            actuators.set(slot, 0.03, 0.1, 1e9, 1e9);
        }
        respond(&mut actuators, &[50.0; 10]);
        actuators.reset(0);
        let out = actuators.step(&[0.0; LANES], &GAIN);
        assert_eq!(out.torque_nm[0], 0.0);
        assert!(out.torque_nm[1] > 0.0);
    }
}
