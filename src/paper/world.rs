//! Vehicles on a road without SUMO: the fleet of a scenario, its target profile, nothing else. The closed loop is the
//! one that `run` uses, period by period.

use super::PaperError;
use crate::cosim::bodies::{TypeFacts, vehicle};
use crate::fleet::block::Block;
use crate::fleet::follow::{Bound, Follow};
use crate::fleet::{Fleet, Slot, VehicleSetup};
use crate::lanes::LANES;
use crate::reference::{Profile, Target};
use crate::run::setup;
use crate::scenario::Scenario;
use crate::stats::VehicleStats;
use std::path::Path;
use std::sync::Arc;

/// Nobody drives longer than this \[s\].
const PATIENCE_S: f64 = 7200.0;

/// Whether somebody is lost, on the road or in a state that is no number, is looked at once in so many periods.
const LOOK_EVERY: u32 = 128;

/// When a vehicle is done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// After so many metres.
    Distance(f64),
    /// After so many seconds.
    Time(f64),
}

/// A vehicle at the end of a control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Since its start \[s\].
    pub time_s: f64,
    /// Driven \[m\].
    pub distance_m: f64,
    /// y_r [m/s].
    pub reference_mps: f64,
    /// V_x [m/s].
    pub speed_mps: f64,
    /// Torque on one front wheel [N·m].
    pub front_wheel_nm: f64,
    /// α̂/α_nominal.
    pub alpha_ratio: f64,
}

impl Moment {
    /// The vehicle of a lane, `time_s` after its start.
    pub fn of(block: &Block, lane: usize, time_s: f64) -> Self {
        let body = block.plant().body(lane);
        let torque_nm = block.torque_nm(lane);
        let front_share = if torque_nm < 0.0 { body.brake_front_share } else { body.drive_front_share };
        Self {
            time_s,
            distance_m: block.distance_m(lane),
            reference_mps: block.reference_mps(lane),
            speed_mps: block.speed_mps(lane),
            front_wheel_nm: 0.5 * front_share * torque_nm,
            alpha_ratio: block.controller().alpha_ratio(lane),
        }
    }
}

/// What became of a vehicle.
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    /// Its statistics, as `run` has them.
    pub stats: VehicleStats,
    /// False if it never came to the end, or its state is not a number.
    pub finished: bool,
}

/// One vehicle's drive.
#[derive(Debug, Clone)]
pub struct Trip {
    /// What drives.
    pub vehicle: VehicleSetup,
    /// What it follows.
    pub profile: Arc<Profile>,
    /// When it is done.
    pub end: End,
}

/// A trip under way.
struct Ride {
    trip: usize,
    end: End,
    slot: Slot,
    periods: u32,
}

/// Everything that is needed to let vehicles of a scenario drive.
pub struct World<'a> {
    scenario: &'a Scenario,
    /// What they follow.
    pub profile: Arc<Profile>,
    /// Whether they steer along the profile's recorded track.
    pub along_track: bool,
}

impl<'a> World<'a> {
    /// The world of a scenario whose target is a profile.
    ///
    /// # Errors
    /// [`PaperError`] if the profile cannot be had, or the target is none.
    pub fn new(scenario: &'a Scenario) -> Result<Self, PaperError> {
        let target = &scenario.groups[0].target;
        let target = (target.entry.build)(&target.values, Path::new(""))?;
        let Target::Profile(profile) = target else { return Err(PaperError::NoProfile) };
        Ok(Self { scenario, profile, along_track: false })
    }

    /// The trips of one vehicle that measures without noise and of `seeds` that do not, each with a stream of its own.
    ///
    /// # Errors
    /// [`PaperError`] if the scenario's body is none.
    pub fn trips(&self, seeds: usize, speed_mps: f64, end: End) -> Result<Vec<Trip>, PaperError> {
        let group = &self.scenario.groups[0];
        let make = |k: usize| {
            let seed = self.scenario.sumo.seed + k as u64;
            let setup = vehicle("ego", &TypeFacts::default(), &[], group, None, seed, speed_mps)?;
            let setup = if k == 0 { VehicleSetup { noise: None, ..setup } } else { setup };
            Ok(Trip { vehicle: setup, profile: Arc::clone(&self.profile), end })
        };
        (0..=seeds).map(make).collect()
    }

    /// The trips of a profile that ends, from its own first speed to its end.
    ///
    /// # Errors
    /// [`PaperError`] if the profile does not end or the scenario's body is none.
    pub fn whole_trips(&self, seeds: usize) -> Result<Vec<Trip>, PaperError> {
        let length = self.profile.length().ok_or(PaperError::NoProfile)?;
        let end = if self.profile.is_by_time() { End::Time(length) } else { End::Distance(length) };
        self.trips(seeds, self.profile.at(0.0, 0.0, 0.0).0, end)
    }

    /// Lets the vehicles drive until each is at its end. They share one block; when one is done, the next takes its slot, so
    /// that all slots are busy until the last ones drive (the longest trips should come first). In every period `watch`
    /// gets, for each vehicle under way, the number of its trip, its block and lane, and the time since its start.
    ///
    /// # Errors
    /// [`PaperError`] if the scenario's controller or plant is unknown.
    pub fn drive(
        &self,
        trips: &[Trip],
        mut watch: impl FnMut(usize, &mut Block, usize, f64),
    ) -> Result<Vec<Outcome>, PaperError> {
        let period_s = self.scenario.coupling.control_period_s;
        let group = setup::block(&self.scenario.groups[0], period_s);
        let mut fleet = Fleet::new(setup::loop_config(self.scenario), vec![group]);
        let mut profiles: [&Profile; LANES] = [&self.profile; LANES];
        let mut waiting = 0..trips.len();
        let mut rides: Vec<Ride> = Vec::with_capacity(LANES);
        let mut outcomes = vec![None; trips.len()];
        loop {
            while rides.len() < LANES
                && let Some(trip) = waiting.next()
            {
                let slot = start(&mut fleet, &trips[trip]);
                profiles[slot.lane()] = &trips[trip].profile;
                rides.push(Ride { trip, end: trips[trip].end, slot, periods: 0 });
            }
            if rides.is_empty() {
                break;
            }
            if self.along_track {
                for Ride { slot, .. } in &rides {
                    let block = fleet.block_mut(*slot);
                    let curvature = profiles[slot.lane()].curvature_at(block.distance_m(slot.lane()));
                    block.steering.set_curvature(slot.lane(), curvature);
                }
            }
            fleet.advance(1, |_| true, Follow::Profiles(&profiles));
            rides.retain_mut(|ride| {
                ride.periods += 1;
                let (slot, lane) = (ride.slot, ride.slot.lane());
                let time_s = f64::from(ride.periods) * period_s;
                let block = fleet.block_mut(slot);
                watch(ride.trip, block, lane, time_s);
                let there = match ride.end {
                    End::Distance(metres) => block.distance_m(lane) >= metres,
                    End::Time(seconds) => time_s >= seconds - 0.5 * period_s,
                };
                let ends = there || ride.periods % LOOK_EVERY == 0 && (time_s >= PATIENCE_S || !block.is_sound(lane));
                if ends {
                    let finished = there && block.is_sound(lane);
                    outcomes[ride.trip] = Some(Outcome { stats: fleet.release(slot), finished });
                }
                !ends
            });
        }
        Ok(outcomes.into_iter().map(|o| o.expect("every vehicle ended")).collect())
    }
}

/// Puts the vehicle of a trip on a level, calm road.
fn start(fleet: &mut Fleet, trip: &Trip) -> Slot {
    let slot = fleet.admit(0, trip.vehicle.clone());
    let (block, lane) = (fleet.block_mut(slot), slot.lane());
    block.set_target(lane, f64::INFINITY, Bound::Profile);
    let inputs = block.inputs_mut();
    (inputs.grade_rad[lane], inputs.bank_rad[lane], inputs.headwind_mps[lane]) = (0.0, 0.0, 0.0);
    slot
}
