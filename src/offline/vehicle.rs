//! One vehicle under way: what it does, and how it is disturbed.

use crate::fleet::block::Block;
use crate::plant::Body;

/// A vehicle at the end of a control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Time since the start (s).
    pub time_s: f64,
    /// Driven distance (m).
    pub distance_m: f64,
    /// Reference speed y_r [m/s].
    pub reference_mps: f64,
    /// True speed V_x [m/s].
    pub speed_mps: f64,
    /// Measured speed, with noise [m/s].
    pub measured_mps: f64,
    /// Applied torque, sum over the wheels [N·m].
    pub torque_nm: f64,
    /// Applied torque on one front wheel [N·m].
    pub front_wheel_nm: f64,
    /// α̂/α_nominal; 1 for laws without adaptation.
    pub alpha_ratio: f64,
    /// F̂ of the ultra-local model [m/s²]; 0 for laws without an estimate.
    pub f_hat_mps2: f64,
}

impl Moment {
    /// Speed error e = V_x − y_r [m/s].
    pub fn error_mps(&self) -> f64 {
        self.speed_mps - self.reference_mps
    }
}

/// A vehicle under way, at the end of a control period.
pub struct Vehicle<'a> {
    /// Index of its trip.
    pub trip: usize,
    /// Time since its start (s).
    pub time_s: f64,
    pub(super) block: &'a mut Block,
    pub(super) slot: usize,
}

impl Vehicle<'_> {
    /// What the vehicle does now.
    pub fn moment(&self) -> Moment {
        let (block, slot) = (&*self.block, self.slot);
        let body = block.plant().body(slot);
        let torque_nm = block.torque_nm(slot);
        let front_share = if torque_nm < 0.0 { body.brake_front_share } else { body.drive_front_share };
        Moment {
            time_s: self.time_s,
            distance_m: block.distance_m(slot),
            reference_mps: block.reference_mps(slot),
            speed_mps: block.speed_mps(slot),
            measured_mps: block.measured_mps(slot),
            torque_nm,
            front_wheel_nm: 0.5 * front_share * torque_nm,
            alpha_ratio: block.alpha_ratio(slot),
            f_hat_mps2: block.f_hat_mps2(slot),
        }
    }

    /// Driven distance (m).
    pub fn distance_m(&self) -> f64 {
        self.block.distance_m(self.slot)
    }

    /// True speed V_x [m/s].
    pub fn speed_mps(&self) -> f64 {
        self.block.speed_mps(self.slot)
    }

    /// Changes the body, of which the law is not told: a load, other tyres, another friction.
    pub fn change_body(&mut self, change: impl FnOnce(&mut Body)) {
        let mut body = self.block.plant().body(self.slot).clone();
        change(&mut body);
        self.block.plant_mut().set_body(self.slot, &body);
    }

    /// Sets the slope of the road (radians, uphill positive).
    pub fn set_grade(&mut self, grade_rad: f64) {
        self.block.inputs_mut().grade_rad[self.slot] = grade_rad;
    }

    /// Sets the bank of the road (radians).
    pub fn set_bank(&mut self, bank_rad: f64) {
        self.block.inputs_mut().bank_rad[self.slot] = bank_rad;
    }

    /// Sets the wind against the vehicle [m/s].
    pub fn set_headwind(&mut self, headwind_mps: f64) {
        self.block.inputs_mut().headwind_mps[self.slot] = headwind_mps;
    }
}
