//! Laws that command all vehicles of their group in one call: cooperative ones, and those written in a language in which
//! one call for every vehicle would cost too much.

use super::controller::Controller;
use super::port::Port;
use super::signals::{Actuation, Command, Observation};
use crate::lanes::{Flags, LANES, Lanes};

/// A speed controller for all vehicles of a group.
pub trait GroupController: Send {
    /// Computes the torques of this control period from the columns of `group`, into its column `torque_nm`.
    ///
    /// # Errors
    /// What went wrong, in words. It ends the run.
    fn command(&mut self, group: &mut GroupPeriod) -> Result<(), String>;
}

/// One control period of a group. Every column has one value per slot; a vehicle keeps its slot as long as it drives, and
/// the columns grow when all slots are taken.
#[derive(Debug, Clone, Default)]
pub struct GroupPeriod {
    /// Control period Δt \[s\].
    pub period_s: f64,
    /// A vehicle drives here; where none does, all numbers are 0 and the torque is not used.
    pub drives: Vec<bool>,
    /// Since the last period a vehicle came here, was carried elsewhere, or came to rest and is held: what the law
    /// remembers of the slot is void.
    pub starts: Vec<bool>,
    /// Measured speed y (with noise, if any) [m/s].
    pub measured_mps: Vec<f64>,
    /// Reference speed y_r at the same instant [m/s].
    pub reference_mps: Vec<f64>,
    /// Its rate ẏ_r [m/s²].
    pub reference_rate_mps2: Vec<f64>,
    /// Torque that accelerates the nominal vehicle at 1 m/s² [N·m per m/s²].
    pub nominal_nm_per_mps2: Vec<f64>,
    /// What the torque of the last period would give the nominal vehicle [m/s²].
    pub commanded_mps2: Vec<f64>,
    /// The same within the actuator's limits [m/s²].
    pub saturated_mps2: Vec<f64>,
    /// The same for the torque that acts on the wheels now: limited, delayed, lagged [m/s²].
    pub applied_mps2: Vec<f64>,
    /// The law's answer: sum of wheel torques, positive drives, negative brakes [N·m].
    pub torque_nm: Vec<f64>,
}

impl GroupPeriod {
    /// Number of slots.
    pub fn len(&self) -> usize {
        self.drives.len()
    }

    /// True if there is no slot.
    pub fn is_empty(&self) -> bool {
        self.drives.is_empty()
    }

    /// Room for so many blocks.
    pub(crate) fn resize(&mut self, blocks: usize) {
        let slots = blocks * LANES;
        self.drives.resize(slots, false);
        self.starts.resize(slots, false);
        for column in self.columns() {
            column.resize(slots, 0.0);
        }
    }

    fn columns(&mut self) -> [&mut Vec<f64>; 8] {
        [
            &mut self.measured_mps,
            &mut self.reference_mps,
            &mut self.reference_rate_mps2,
            &mut self.nominal_nm_per_mps2,
            &mut self.commanded_mps2,
            &mut self.saturated_mps2,
            &mut self.applied_mps2,
            &mut self.torque_nm,
        ]
    }

    /// A period begins: nothing is seen yet.
    pub(crate) fn clear(&mut self) {
        self.drives.fill(false);
        self.starts.fill(false);
        self.columns().into_iter().for_each(|column| column.fill(0.0));
    }

    /// Writes what the block at `place` shows.
    pub(crate) fn see(&mut self, place: usize, moving: &Flags, seen: &Observation, port: &mut Port) {
        let slots = place * LANES..(place + 1) * LANES;
        let starts = std::mem::take(&mut port.starts);
        self.starts[slots.clone()].copy_from_slice(&starts);
        for (drives, moves) in self.drives[slots.clone()].iter_mut().zip(moving) {
            *drives = *moves > 0.0;
        }
        let told = |x: &Lanes| -> Lanes { std::array::from_fn(|i| if starts[i] { 0.0 } else { x[i] * moving[i] }) };
        let columns: [Lanes; 7] = [
            seen.measured_mps,
            seen.reference_mps,
            seen.reference_rate_mps2,
            std::array::from_fn(|i| seen.nominal_nm_per_mps2[i] * moving[i]),
            told(&port.actuation.commanded_mps2),
            told(&port.actuation.saturated_mps2),
            told(&port.actuation.applied_mps2),
        ];
        for (column, values) in self.columns().into_iter().zip(columns) {
            column[slots.clone()].copy_from_slice(&values);
        }
    }

    /// Hands the torques of the block at `place` over.
    pub(crate) fn tell(&self, place: usize, port: &mut Port) {
        port.torque_nm.copy_from_slice(&self.torque_nm[place * LANES..(place + 1) * LANES]);
    }
}

/// The controller of a block whose group has a law of its own: it passes on what that law says.
#[derive(Default)]
pub struct Delegate(Port);

impl Controller for Delegate {
    fn command(&mut self, observation: &Observation, command: &mut Command) {
        for i in 0..LANES {
            let nominal_nm_per_mps2 = observation.nominal_nm_per_mps2[i];
            command.torque_nm[i] = self.0.torque_nm[i];
            command.gain_mps2_per_nm[i] = if nominal_nm_per_mps2 > 0.0 { 1.0 / nominal_nm_per_mps2 } else { 0.0 };
        }
    }

    fn feedback(&mut self, actuation: &Actuation) {
        self.0.actuation = *actuation;
    }

    fn reset(&mut self, slot: usize, _: f64) {
        self.0.starts[slot] = true;
        self.0.torque_nm[slot] = 0.0;
    }

    fn port(&mut self) -> Option<&mut Port> {
        Some(&mut self.0)
    }
}
