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

#[cfg(test)]
mod tests {
    use super::*;

    /// 1, 2, 3, ... times `scale`.
    fn rising(scale: f64) -> Lanes {
        std::array::from_fn(|i| scale * (i + 1) as f64)
    }

    #[test]
    fn a_law_sees_who_drives_and_answers_to_its_own_slots() {
        let mut group = GroupPeriod { period_s: 0.01, ..GroupPeriod::default() };
        assert!(group.is_empty());
        group.resize(2);
        assert_eq!((group.len(), group.is_empty()), (2 * LANES, false));
        let seen = Observation {
            measured_mps: rising(1.0),
            reference_mps: rising(2.0),
            reference_rate_mps2: rising(3.0),
            nominal_nm_per_mps2: rising(4.0),
        };
        let mut delegate = Delegate::default();
        delegate.feedback(&Actuation {
            commanded_mps2: rising(5.0),
            saturated_mps2: rising(6.0),
            applied_mps2: rising(7.0),
        });
        // Nobody is in slot 0, and somebody has just come to slot 2.
        let mut moving = [1.0; LANES];
        moving[0] = 0.0;
        delegate.reset(2, 9.0);
        let port = delegate.port().unwrap();
        group.see(1, &moving, &seen, port);

        assert_eq!(group.drives, [[false; LANES], std::array::from_fn(|i| i != 0)].concat());
        assert_eq!(group.starts, [[false; LANES], std::array::from_fn(|i| i == 2)].concat());
        assert_eq!(group.nominal_nm_per_mps2[..=LANES], [0.0; LANES + 1], "another block, and nobody's slot");
        assert_eq!(group.nominal_nm_per_mps2[LANES + 1], 8.0);
        let at = |slot: usize| {
            let columns = [&group.measured_mps, &group.reference_mps, &group.reference_rate_mps2];
            columns.map(|column| column[LANES + slot])
        };
        assert_eq!(at(1), [2.0, 4.0, 6.0]);
        let told = |slot: usize| {
            let columns = [&group.commanded_mps2, &group.saturated_mps2, &group.applied_mps2];
            columns.map(|column| column[LANES + slot])
        };
        assert_eq!(
            (told(0), told(1), told(2)),
            ([0.0; 3], [10.0, 12.0, 14.0], [0.0; 3]),
            "not of who was there before"
        );
        group.see(1, &moving, &seen, port);
        assert!(!group.starts.contains(&true), "a start is told once");

        group.torque_nm[LANES + 3] = 120.0;
        group.tell(1, port);
        let mut command = Command::default();
        let nobody =
            Observation { nominal_nm_per_mps2: std::array::from_fn(|i| if i == 1 { 0.0 } else { 400.0 }), ..seen };
        delegate.command(&nobody, &mut command);
        assert_eq!((command.torque_nm[3], command.torque_nm[2]), (120.0, 0.0));
        assert_eq!((command.gain_mps2_per_nm[3], command.gain_mps2_per_nm[1]), (1.0 / 400.0, 0.0));
        delegate.reset(3, 0.0);
        delegate.command(&nobody, &mut command);
        assert_eq!(command.torque_nm[3], 0.0, "no torque of who was there before");

        group.clear();
        assert!(!group.drives.contains(&true) && group.torque_nm.iter().all(|torque_nm| *torque_nm == 0.0));
    }
}
