//! A controller that is given v* as a step, as it would be in a wrong coupling.

use sumo_mfc::control::{Actuation, Command, Controller, Observation};
use sumo_mfc::lanes::Lanes;

/// Control periods in a step of the check's scenario, and the control period [s].
const PERIODS: u32 = 10;
const PERIOD_S: f64 = 0.01;

/// Hides the ramp from a law: all through a step the reference is the speed that SUMO wants at its end.
pub struct StepReference {
    law: Box<dyn Controller>,
    period: u32,
    target_mps: Lanes,
}

impl StepReference {
    /// Around a law.
    pub fn around(law: Box<dyn Controller>) -> Self {
        Self { law, period: 0, target_mps: Lanes::default() }
    }
}

impl Controller for StepReference {
    fn command(&mut self, seen: &Observation, command: &mut Command) {
        if self.period == 0 {
            let step_s = f64::from(PERIODS) * PERIOD_S;
            self.target_mps =
                std::array::from_fn(|i| (seen.measured_mps[i] + seen.reference_rate_mps2[i] * step_s).max(0.0));
        }
        self.period = (self.period + 1) % PERIODS;
        let step = Observation { reference_mps: self.target_mps, reference_rate_mps2: Lanes::default(), ..*seen };
        self.law.command(&step, command);
    }

    fn feedback(&mut self, actuation: &Actuation) {
        self.law.feedback(actuation);
    }

    fn reset(&mut self, slot: usize, speed_mps: f64) {
        self.law.reset(slot, speed_mps);
    }

    fn rest(&mut self, slot: usize) {
        self.law.rest(slot);
    }
}
