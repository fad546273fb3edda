//! One vehicle in body-leads mode: what was changed on it, and the speed that it was told.
//!
//! SUMO would clip the very overshoot that the targets `limit` and `profile` are there to show. So, once per vehicle and
//! in this order (on SUMO 1.28 setting accel or decel after the factor undoes the factor): remember the speed factor; set
//! accel and decel to at least what the body can do; set the factor so high that no lane limit binds; speed mode 27, which
//! keeps safe gaps, right of way and red lights but lets the vehicle brake as hard as it needs. Hand-back restores all of
//! it.

use super::error::CosimError;
use super::question::{Gets, Object};
use super::sumo::{Sumo, Tell};
use crate::fleet::block::Block;
use crate::fleet::follow::Bound;
use crate::reference::{Ahead, Own, Target};
use crate::traci::vehicle;

/// Safe speed, right of way, red lights, accel; not decel: emergency braking stays possible under `setSpeed`.
const SPEED_MODE: i32 = 27;
/// Raises any lane's limit above what a road vehicle drives.
const SPEED_FACTOR: f64 = 100.0;
/// Speed with which a car that SUMO holds at a standstill asks whether it may go [m/s].
const PROBE_MPS: f64 = 0.1;
/// If SUMO's speed is this far below the command, SUMO clamped it [m/s].
const CLAMP_MPS: f64 = 1e-6;

/// What is changed on a vehicle whose body leads, to be restored at hand-back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Before {
    speed_factor: f64,
    accel_mps2: f64,
    decel_mps2: f64,
    speed_mode: i32,
    speed_max_mps: f64,
}

impl Before {
    /// Asks for it; `None` if SUMO does not tell all of it.
    pub fn ask<'a>(gets: &mut impl Gets<'a>) -> Option<Self> {
        let speed_factor = gets.number(vehicle::SPEED_FACTOR);
        let accel_mps2 = gets.number(vehicle::ACCEL);
        let decel_mps2 = gets.number(vehicle::DECEL);
        let speed_mode = gets.integer(vehicle::SPEED_MODE);
        let speed_max_mps = gets.number(vehicle::MAX_SPEED);
        Some(Self {
            speed_factor: speed_factor?,
            accel_mps2: accel_mps2?,
            decel_mps2: decel_mps2?,
            speed_mode: speed_mode?,
            speed_max_mps: speed_max_mps?,
        })
    }
}

/// The state of a vehicle whose body leads.
#[derive(Debug, Clone, PartialEq)]
pub struct Leader {
    before: Before,
    /// The limit of its lane [m/s].
    pub limit_mps: f64,
    /// Whether its target keeps a gap to who is ahead.
    pub keeps_gap: bool,
    /// The speed that a caller orders in place of the target [m/s].
    pub ordered_mps: Option<f64>,
    /// Time lost so far \[s\].
    pub time_loss_s: f64,
    /// The speed that SUMO was told last [m/s].
    command_mps: f64,
    /// The speed that SUMO allowed instead, while it does [m/s].
    clamp_mps: Option<f64>,
    /// Who is ahead, and the gap to it \[m\].
    ahead: Option<(String, f64)>,
    /// Rate of that gap [m/s].
    gap_rate_mps: f64,
}

impl Leader {
    /// A vehicle at `speed_mps` [m/s], which is its limit until that of its lane is known.
    pub fn new(before: Before, speed_mps: f64, target: &Target) -> Self {
        Self {
            before,
            limit_mps: speed_mps,
            keeps_gap: matches!(target, Target::Spacing(_)),
            ordered_mps: None,
            time_loss_s: 0.0,
            command_mps: speed_mps,
            clamp_mps: None,
            ahead: None,
            gap_rate_mps: 0.0,
        }
    }

    /// Changes the vehicle so that its body can lead.
    pub fn take_over(
        &self,
        sumo: &mut impl Sumo,
        vehicle: &Object,
        body_limits_mps2: [f64; 2],
    ) -> Result<(), CosimError> {
        let [drive_mps2, brake_mps2] = body_limits_mps2;
        sumo.tell(vehicle, Tell::Accel(self.before.accel_mps2.max(drive_mps2)))?;
        sumo.tell(vehicle, Tell::Decel(self.before.decel_mps2.max(brake_mps2)))?;
        sumo.tell(vehicle, Tell::SpeedFactor(SPEED_FACTOR))?;
        sumo.tell(vehicle, Tell::SpeedMode(SPEED_MODE))
    }

    /// Gives the vehicle back to SUMO as it was.
    pub fn hand_back(&self, sumo: &mut impl Sumo, vehicle: &Object) -> Result<(), CosimError> {
        sumo.tell(vehicle, Tell::SpeedMode(self.before.speed_mode))?;
        sumo.tell(vehicle, Tell::Accel(self.before.accel_mps2))?;
        sumo.tell(vehicle, Tell::Decel(self.before.decel_mps2))?;
        sumo.tell(vehicle, Tell::SpeedFactor(self.before.speed_factor))?;
        sumo.tell(vehicle, Tell::ReleaseSpeed)
    }

    /// Sets what the body drives towards in the coming step: the limit, or the speed that SUMO clamped it to.
    pub fn set_target(&self, target: &Target, block: &mut Block, lane: usize, step_s: f64) {
        let free_mps = self.before.speed_max_mps.min(self.limit_mps * self.before.speed_factor);
        block.set_ordered(lane, self.ordered_mps.is_some());
        let (limit_mps, bound) = match (self.ordered_mps, target) {
            (Some(ordered_mps), _) => (ordered_mps, Bound::Profile),
            (None, Target::Profile(_)) => (f64::INFINITY, Bound::Profile),
            (None, Target::Spacing(spacing)) => {
                let speed_mps = block.speed_mps(lane);
                let own = Own { speed_mps, accel_mps2: block.acceleration_mps2(lane), free_mps };
                let ahead = self
                    .ahead
                    .as_ref()
                    .map(|(_, gap_m)| Ahead { gap_m: *gap_m, speed_mps: speed_mps + self.gap_rate_mps });
                (spacing.next_mps(own, ahead, step_s), if ahead.is_some() { Bound::Profile } else { Bound::Limit })
            }
            _ => (self.limit_mps * self.before.speed_factor, Bound::Limit),
        };
        match self.clamp_mps {
            Some(clamp_mps) if clamp_mps < limit_mps => block.set_target(lane, clamp_mps, Bound::Clamp),
            _ => block.set_target(lane, limit_mps, bound),
        }
    }

    /// Takes the speed that the body reached for the next command. A car that SUMO holds has to ask whether it may go,
    /// or it would stand for ever.
    pub fn set_command(&mut self, speed_mps: f64) {
        let probe_mps = if self.clamp_mps == Some(0.0) { PROBE_MPS } else { 0.0 };
        self.command_mps = speed_mps.max(probe_mps);
    }

    /// The next command.
    pub fn command(&self) -> Tell {
        Tell::Speed(self.command_mps)
    }

    /// Counts the time that a step at this speed loses against the fastest that the vehicle would drive here by its own
    /// speed factor, as SUMO's `timeLoss` does (which counts against the factor that it has meanwhile). Stops lose none.
    pub fn lose_time(&mut self, sumo_mps: f64, stopped: bool, step_s: f64) {
        let fastest_mps = self.before.speed_max_mps.min(self.limit_mps * self.before.speed_factor);
        if !stopped && fastest_mps > 0.0 {
            self.time_loss_s += step_s * (fastest_mps - sumo_mps) / fastest_mps;
        }
    }

    /// Takes who is ahead at the end of a step, and the gap to it \[m\]. Its speed is known from how the gap changes, as it is to a radar;
    /// of a vehicle that has just come in between it is taken to be the own.
    pub fn see_ahead(&mut self, ahead: Option<(String, f64)>, step_s: f64) {
        self.gap_rate_mps = match (&self.ahead, &ahead) {
            (Some((before, before_m)), Some((now, now_m))) if before == now => (now_m - before_m) / step_s,
            _ => 0.0,
        };
        self.ahead = ahead;
    }

    /// Compares SUMO's speed with the command; true if SUMO clamped it.
    pub fn see_speed(&mut self, sumo_mps: f64) -> bool {
        let clamped = sumo_mps < self.command_mps - CLAMP_MPS;
        self.clamp_mps = clamped.then_some(sumo_mps);
        clamped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.1;

    /// A vehicle that would drive 1.2 times the limit of 15 m/s.
    fn leader(speed_max_mps: f64) -> Leader {
        let (accel_mps2, decel_mps2, speed_mode) = (2.6, 4.5, 31);
        let before = Before { speed_factor: 1.2, accel_mps2, decel_mps2, speed_mode, speed_max_mps };
        Leader::new(before, 15.0, &Target::Limit)
    }

    /// As in SUMO's tripinfo: the time of the way, less the time that the same way takes at the speed of the free road.
    #[test]
    fn law_the_time_lost_is_what_the_way_took_beyond_the_free_road() {
        let speed_mps = |k: u32| f64::from(k % 70) * 0.25;
        for (speed_max_mps, free_mps) in [(60.0, 18.0), (16.0, 16.0)] {
            let mut leader = leader(speed_max_mps);
            (0..300).for_each(|k| leader.lose_time(speed_mps(k), false, STEP_S));
            let way_m: f64 = (0..300).map(|k| speed_mps(k) * STEP_S).sum();
            let wanted_s = 30.0 - way_m / free_mps;
            assert!(
                wanted_s > 10.0 && (leader.time_loss_s - wanted_s).abs() < 1e-9,
                "{} {wanted_s}",
                leader.time_loss_s
            );
        }
    }

    #[test]
    fn who_stops_as_planned_or_may_not_drive_at_all_loses_no_time() {
        let mut leader = leader(60.0);
        leader.lose_time(0.0, true, STEP_S);
        leader.limit_mps = 0.0;
        leader.lose_time(0.0, false, STEP_S);
        assert_eq!(leader.time_loss_s, 0.0);
    }

    #[test]
    fn sumo_has_clamped_what_is_slower_than_told_by_more_than_rounding() {
        let mut leader = leader(60.0);
        leader.command_mps = 10.0;
        assert!(!leader.see_speed(10.0 - CLAMP_MPS) && leader.clamp_mps.is_none());
        assert!(leader.see_speed(10.0 - 1.1 * CLAMP_MPS) && leader.clamp_mps == Some(10.0 - 1.1 * CLAMP_MPS));
    }

    #[test]
    fn the_gap_to_another_vehicle_has_no_rate() {
        let mut leader = leader(60.0);
        let mut rate_mps = |ahead: Option<(&str, f64)>| {
            leader.see_ahead(ahead.map(|(id, gap_m)| (id.to_owned(), gap_m)), STEP_S);
            leader.gap_rate_mps
        };
        assert_eq!(rate_mps(Some(("a", 50.0))), 0.0);
        assert!((rate_mps(Some(("a", 49.5))) + 5.0).abs() < 1e-9, "it comes nearer");
        assert_eq!(rate_mps(Some(("b", 20.0))), 0.0, "it has cut in");
        assert!((rate_mps(Some(("b", 20.2))) - 2.0).abs() < 1e-9);
        assert_eq!(rate_mps(None), 0.0);
        assert_eq!(rate_mps(Some(("b", 60.0))), 0.0, "it is there again");
    }
}
