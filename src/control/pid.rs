//! PI(D) with feed-forward, the baseline: what a practitioner would fit first.
//!
//! ```text
//! a_k = I_k − k_p e_k − k_d (e_k − e_{k−1})/Δt + k_ff ẏ_r,k          I_k = I_{k−1} − k_i Δt e_k
//! ```
//! with a the nominal vehicle's acceleration (torque = a·M·r). As long as the actuator's limits cut something off, the
//! integral takes nothing up that would have more cut off (Åström and Hägglund 1995, Section 3.5); it is the only memory, so
//! what is cut off of the other terms is gone with them. (In velocity form, with the limited torque for its state, half of
//! a spike of the reference stays: its rise is cut off and its fall is not.)
//! With ẏ_r = (y_r,k − y_r,k−1)/Δt, k_d = k_ff = 0, k_p = 1/(αΔt) and k_i = K_P/(αΔt) it is the classic model-free law
//! with the two-point estimator.
//!
//! # Default tuning
//! Chosen on the same drive and disturbances as the model-free laws (see `mfc.rs`), from a grid of the same size: k_p = 1/s
//! and k_i = 1/s² give the least error over wrong mass, lag, dead time up to 250 ms and noise among the gains that stay
//! damped (ζ = 0.5). More k_p tracks a wrong mass better, but noise then drives the torque into its limits.

use super::bounds::{INPUT_MAX_MPS2, RateKeys};
use super::controller::Controller;
use super::law::{Build, law};
use super::signals::{Actuation, Command, Observation};
use crate::columns::{Slots, columns};
use crate::keys;
use crate::lanes::{LANES, vectorised};
use crate::registry::Entry;

keys! {
    /// Keys of the law.
    struct PidKeys {
        /// acceleration per speed error
        k_p: f64 = 1.0, "1/s", 0.0..=1e6;
        /// acceleration per integrated speed error
        k_i: f64 = 1.0, "1/s2", 0.0..=1e6;
        /// acceleration per rate of the speed error
        k_d: f64 = 0.0, "-", 0.0..=1e3;
        /// share of the reference's rate that is fed forward
        k_ff: f64 = 1.0, "-", 0.0..=10.0;
        and ..rate: RateKeys,
    }
}

pub(super) fn entry() -> Entry<Build> {
    law("pid", "PI(D) with feed-forward and anti-windup, the baseline", Pid::new)
}

/// The gains per period [1/s].
struct Law {
    k_p: f64,
    k_i_dt: f64,
    k_d_per_dt: f64,
    k_ff: f64,
    rate: RateKeys,
}

columns! {
    /// What one period leaves to the next.
    struct Memory {
        columns {
            /// The integral I_{k−1} [m/s²].
            integral: f64 = 0.0,
            /// e_{k−1} [m/s].
            error: f64 = 0.0,
            /// What the limits cut off the last torque [m/s²].
            excess: f64 = 0.0,
        }
    }
}

struct Pid {
    law: Law,
    memory: Memory,
}

impl Pid {
    fn new(keys: PidKeys, period_s: f64) -> Self {
        let law = Law {
            k_p: keys.k_p,
            k_i_dt: keys.k_i * period_s,
            k_d_per_dt: keys.k_d / period_s,
            k_ff: keys.k_ff,
            rate: keys.rate,
        };
        Self { law, memory: Memory::default() }
    }
}

impl Controller for Pid {
    fn command(&mut self, observation: &Observation, command: &mut Command) {
        pid(&self.law, observation, &mut self.memory, command);
    }

    fn feedback(&mut self, actuation: &Actuation) {
        self.memory.excess = std::array::from_fn(|i| actuation.commanded_mps2[i] - actuation.saturated_mps2[i]);
    }

    fn reset(&mut self, slot: usize, _speed_mps: f64) {
        self.memory.clear(slot);
    }
}

vectorised! {
    fn pid(law: &Law, observed: &Observation, memory: &mut Memory, command: &mut Command) {
        for i in 0..LANES {
            let rate = law.rate.bound(observed.reference_rate_mps2[i]);
            let e = observed.measured_mps[i] - observed.reference_mps[i];
            let change = e - memory.error[i];
            let step = -law.k_i_dt * e;
            let step = if step * memory.excess[i] > 0.0 { 0.0 } else { step };
            let integral = (memory.integral[i] + step).clamp(-INPUT_MAX_MPS2, INPUT_MAX_MPS2);
            let accel = integral - law.k_p * e - law.k_d_per_dt * change + law.k_ff * rate;
            memory.integral[i] = integral;
            memory.error[i] = e;
            command.ask(i, accel, observed.nominal_nm_per_mps2[i], 1.0);
        }
    }
}
