//! The vehicle that the laws with a model reckon with, to hold their closed loops to what they promise.

use super::controller::Controller;
use super::signals::{Actuation, Command, Observation};
use crate::lanes::LANES;
use std::collections::VecDeque;

pub const PERIOD_S: f64 = 0.01;

/// ẏ = F + a behind a dead time of whole periods, a lag, and limits.
pub struct Plant {
    on_its_way: VecDeque<f64>,
    decay: f64,
    acts_mps2: f64,
    pub force_mps2: f64,
    pub error_mps: f64,
    pub limits_mps2: [f64; 2],
    /// What was asked for last [m/s²].
    pub asked_mps2: f64,
}

impl Plant {
    pub fn new(delay_s: f64, lag_s: f64, force_mps2: f64, error_mps: f64) -> Self {
        let decay = if lag_s > 0.0 { libm::exp(-PERIOD_S / lag_s) } else { 0.0 };
        let on_its_way = vec![0.0; (delay_s / PERIOD_S).round() as usize].into();
        let limits_mps2 = [f64::NEG_INFINITY, f64::INFINITY];
        Self { on_its_way, decay, acts_mps2: 0.0, force_mps2, error_mps, limits_mps2, asked_mps2: 0.0 }
    }

    /// One period at a reference of this rate, that starts at `reference_mps`; returns the error at its beginning.
    pub fn period(&mut self, law: &mut dyn Controller, reference_mps: f64, rate_mps2: f64) -> f64 {
        let e = self.error_mps;
        let observation = Observation {
            measured_mps: [reference_mps + e; LANES],
            reference_mps: [reference_mps; LANES],
            reference_rate_mps2: [rate_mps2; LANES],
            nominal_nm_per_mps2: [500.0; LANES],
        };
        let mut command = Command::default();
        law.command(&observation, &mut command);
        self.asked_mps2 = command.torque_nm[0] / 500.0;
        let sent = self.asked_mps2.clamp(self.limits_mps2[0], self.limits_mps2[1]);
        self.on_its_way.push_back(sent);
        let delayed = self.on_its_way.pop_front().expect("one was pushed");
        self.acts_mps2 = delayed + self.decay * (self.acts_mps2 - delayed);
        law.feedback(&Actuation {
            commanded_mps2: [self.asked_mps2; LANES],
            saturated_mps2: [sent; LANES],
            applied_mps2: [self.acts_mps2; LANES],
        });
        self.error_mps += PERIOD_S * (self.force_mps2 + self.acts_mps2 - rate_mps2);
        e
    }
}
