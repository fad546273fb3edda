//! What of a vehicle's motion people feel: weighted accelerations and jerk along the lane, from its speed.

use super::weighting::Weighting;
use super::window::Window;
use crate::columns::columns;
use crate::lanes::{LANES, Lanes};

columns! {
    /// The comfort of a block of vehicles whose speed is known every `period_s` \[s\].
    #[derive(Debug, Clone)]
    pub(super) struct Comfort(period_s: f64) {
        shared {
            period_s: f64 = period_s,
        }
        parts {
            window: Window = Window::new(period_s),
            driving: Weighting<2> = Weighting::driving(period_s),
            sickness: Weighting<4> = Weighting::sickness(period_s),
        }
        columns {
            previous_mps: f64 = 0.0,
            samples: f64 = 0.0,
            driving_squared: f64 = 0.0,
            sickness_squared: f64 = 0.0,
        }
    }
}

impl Comfort {
    /// Goes on at `speed_mps`; what was before it is no neighbour.
    pub fn rejoin(&mut self, slot: usize, speed_mps: f64) {
        self.previous_mps[slot] = speed_mps;
        self.window.rejoin(slot, speed_mps);
    }

    /// Takes the speed at the end of a period.
    #[inline(always)]
    pub fn sample(&mut self, speed_mps: &Lanes, active: &Lanes) {
        let on: [bool; LANES] = std::array::from_fn(|i| active[i] > 0.0);
        let rate_hz = 1.0 / self.period_s;
        let mut acceleration_mps2 = [0.0; LANES];
        for i in 0..LANES {
            acceleration_mps2[i] = if on[i] { (speed_mps[i] - self.previous_mps[i]) * rate_hz } else { 0.0 };
            self.previous_mps[i] = if on[i] { speed_mps[i] } else { self.previous_mps[i] };
        }
        // Who is not on the road is not accelerated, and forgets.
        let driving = self.driving.weigh(&acceleration_mps2);
        let sickness = self.sickness.weigh(&acceleration_mps2);
        for i in 0..LANES {
            self.samples[i] += if on[i] { 1.0 } else { 0.0 };
            self.driving_squared[i] += if on[i] { driving[i] * driving[i] } else { 0.0 };
            self.sickness_squared[i] += if on[i] { sickness[i] * sickness[i] } else { 0.0 };
        }
        self.window.sample(speed_mps, active);
    }

    /// Lets memory that has faded be zero.
    #[inline(always)]
    pub fn settle(&mut self) {
        self.driving.settle();
        self.sickness.settle();
    }

    /// RMS of the acceleration weighted by W_d [m/s²].
    pub fn acceleration(&self, slot: usize) -> Option<f64> {
        (self.samples[slot] > 0.0).then(|| (self.driving_squared[slot] / self.samples[slot]).sqrt())
    }

    /// Motion sickness dose value: √∫a² dt of the acceleration weighted by W_f [m/s^1.5].
    pub fn sickness(&self, slot: usize) -> Option<f64> {
        (self.samples[slot] > 0.0).then(|| (self.sickness_squared[slot] * self.period_s).sqrt())
    }

    /// The jerk over windows.
    pub fn window(&self) -> &Window {
        &self.window
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After a push the filters ring for minutes. Then nothing is left, and until then settling costs nothing.
    #[test]
    fn law_a_push_is_forgotten_at_last() {
        let [mut settled, mut plain] = [Comfort::new(0.05), Comfort::new(0.05)];
        for k in 0..20_000 {
            let speed_mps = [if k == 0 { 0.0 } else { 1.0 }; LANES];
            settled.sample(&speed_mps, &[1.0; LANES]);
            settled.settle();
            plain.sample(&speed_mps, &[1.0; LANES]);
        }
        assert!(settled.driving.has_faded() && settled.sickness.has_faded());
        assert!(!plain.sickness.has_faded(), "it needs settling");
        assert_eq!(settled.acceleration(0), plain.acceleration(0));
        assert_eq!(settled.sickness(0), plain.sickness(0));
    }
}
