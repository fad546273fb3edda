//! Targets `limit` and `profile`: the body leads. It runs the coming step first, and SUMO is told `setSpeed` with the
//! speed that the body will have at its end, in every step.
//!
//! SUMO would clip the very overshoot that these targets are there to show. So, once per vehicle and in this order (on
//! SUMO 1.28 setting accel or decel after the factor undoes the factor): remember the speed factor; set accel and decel
//! to at least what the body can do; set the factor so high that no lane limit binds; speed mode 27, which keeps safe
//! gaps, right of way and red lights but lets the vehicle brake as hard as it needs. Hand-back restores all of it.

use super::CosimError;
use super::book::Ego;
use crate::fleet::Fleet;
use crate::traci::{Batch, vehicle};

/// Speed with which a car that SUMO holds at a standstill asks whether it may go [m/s].
pub(super) const PROBE_MPS: f64 = 0.1;

/// Safe speed, right of way, red lights, accel; not decel: emergency braking stays possible under `setSpeed`.
const SPEED_MODE_LEAD: i32 = 27;
/// Raises any lane's limit above what a road vehicle drives.
const FACTOR_LEAD: f64 = 100.0;

/// Prepares a newcomer: its driver imperfection, and what a leading body needs.
pub(super) fn take_over(batch: &mut Batch, ego: &Ego, fleet: &Fleet, sigma: Option<f64>) -> Result<(), CosimError> {
    if let (Some(sigma), Some(_)) = (sigma, ego.sigma_before) {
        batch.set(vehicle::IMPERFECTION, &ego.id, sigma)?;
    }
    if let Some(lead) = &ego.lead {
        let [drive_mps2, brake_mps2] = fleet.block(ego.slot).acceleration_limits_mps2(ego.slot.lane());
        batch.set(vehicle::ACCEL, &ego.id, lead.before.accel_mps2.max(drive_mps2))?;
        batch.set(vehicle::DECEL, &ego.id, lead.before.decel_mps2.max(brake_mps2))?;
        batch.set(vehicle::SPEED_FACTOR, &ego.id, FACTOR_LEAD)?;
        batch.set(vehicle::SPEED_MODE, &ego.id, SPEED_MODE_LEAD)?;
    }
    Ok(())
}

/// Gives a vehicle back to SUMO as it was.
pub(super) fn hand_back(batch: &mut Batch, ego: &Ego) -> Result<(), CosimError> {
    if let Some(sigma) = ego.sigma_before {
        batch.set(vehicle::IMPERFECTION, &ego.id, sigma)?;
    }
    if let Some(lead) = &ego.lead {
        batch.set(vehicle::SPEED_MODE, &ego.id, lead.before.speed_mode)?;
        batch.set(vehicle::ACCEL, &ego.id, lead.before.accel_mps2)?;
        batch.set(vehicle::DECEL, &ego.id, lead.before.decel_mps2)?;
        batch.set(vehicle::SPEED_FACTOR, &ego.id, lead.before.speed_factor)?;
        batch.release_speed(&ego.prefix)?;
    }
    Ok(())
}
