//! What of a vehicle may become another while it drives: its body, its actuators, a torque that disturbs it, whose speed it is to
//! have.

use super::Block;
use crate::fleet::setup::{ActuatorSetup, VehicleSetup, least, road_load};
use crate::plant::Body;

impl Block {
    /// Makes the vehicle of a slot another one as it drives: its body and its actuators. How it moves, what is on the way through
    /// its actuators, and what its law has learned all stay.
    pub fn change(&mut self, slot: usize, vehicle: &VehicleSetup) {
        let body = &vehicle.body;
        let ActuatorSetup { dead_time_s, lag_s } = vehicle.actuator;
        self.actuators.change(slot, dead_time_s, lag_s, body.drive_torque_max_nm, body.brake_torque_max_nm);
        self.tyre_friction[slot] = body.friction;
        let friction = body.friction.map(|tyre| tyre * self.road_friction[slot]);
        self.steering.refit(slot, body.wheelbase_m(), body.understeer_gradient(), least(friction));
        self.plant.set_body(slot, &Body { friction, ..body.clone() });
        self.quality.iter_mut().for_each(|quality| quality.set_load(slot, &road_load(body)));
        if self.controller.is_some() {
            self.driver.set_limits(slot, self.acceleration_limits_mps2(slot));
        }
    }

    /// From now on this torque acts on the wheels beside that of the actuators, of which neither the law nor the statistics learn;
    /// sum over the wheels, positive drives [N·m]. A vehicle that is held at rest stays there.
    pub fn disturb(&mut self, slot: usize, torque_nm: f64) {
        self.disturbance_nm[slot] = torque_nm;
        self.is_disturbed = self.disturbance_nm.iter().any(|torque_nm| *torque_nm != 0.0);
    }

    /// From now on the target of a slot is the caller's alone, whatever profile its group has; or not any more.
    pub fn set_ordered(&mut self, slot: usize, ordered: bool) {
        self.ordered[slot] = f64::from(u8::from(ordered));
    }

    /// True if the vehicles of the block have bodies that torques move.
    pub fn has_bodies(&self) -> bool {
        self.controller.is_some()
    }
}
