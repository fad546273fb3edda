//! Many vehicles of one scenario on a level road in calm air.

use super::error::OfflineError;
use super::vehicle::Vehicle;
use crate::cosim::bodies::{TypeFacts, vehicle};
use crate::fleet::follow::{Bound, Follow};
use crate::fleet::{Fleet, Slot, VehicleSetup};
use crate::lanes::LANES;
use crate::reference::{Profile, Target};
use crate::scenario::Scenario;
use crate::stats::VehicleStats;
use std::sync::Arc;

/// No vehicle drives longer than this (s).
const TIME_MAX_S: f64 = 7200.0;

/// One in so many control periods checks whether a vehicle has driven too long or its state is not a number.
const CHECK_PERIODS: u32 = 128;

/// Where a trip ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// After so many metres.
    Distance(f64),
    /// After so many seconds.
    Time(f64),
}

/// How a trip ended.
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    /// The statistics, as `run` has them.
    pub stats: VehicleStats,
    /// False if the vehicle did not reach the end, or its state is not a number.
    pub finished: bool,
}

/// The trip of one vehicle.
#[derive(Debug, Clone)]
pub struct Trip {
    /// The vehicle.
    pub vehicle: VehicleSetup,
    /// The reference.
    pub profile: Arc<Profile>,
    /// The end.
    pub end: End,
}

/// A trip under way.
struct Ride {
    trip: usize,
    slot: Slot,
    periods: u32,
}

/// The vehicles of a scenario's first group, on the profile that its target names.
pub struct Road<'a> {
    scenario: &'a Scenario,
    tyre_curve: Option<String>,
    /// The reference.
    pub profile: Arc<Profile>,
    /// Whether the vehicles steer along the profile's recorded track.
    pub along_track: bool,
}

impl<'a> Road<'a> {
    /// The road of a scenario whose target is a profile.
    ///
    /// # Errors
    /// [`OfflineError`] if the target is not a profile, or a file of profile or tyre cannot be read.
    pub fn new(scenario: &'a Scenario) -> Result<Self, OfflineError> {
        let Target::Profile(profile) = scenario.groups[0].load_target()? else { return Err(OfflineError::NoProfile) };
        Self::with_profile(scenario, profile)
    }

    /// The road of a scenario with a reference of its own, whatever the scenario's target is.
    ///
    /// # Errors
    /// [`OfflineError::Scenario`] if the file of the tyres cannot be read.
    pub fn with_profile(scenario: &'a Scenario, profile: Arc<Profile>) -> Result<Self, OfflineError> {
        Ok(Self { scenario, tyre_curve: scenario.groups[0].load_tyre_curve()?, profile, along_track: false })
    }

    /// The trip of the vehicle number `index`, whose noise (if the scenario has noise) comes from a stream of its own.
    ///
    /// # Errors
    /// [`OfflineError::Vehicle`] if the scenario's body cannot be built.
    pub fn trip(&self, index: usize, speed_mps: f64, end: End) -> Result<Trip, OfflineError> {
        let seed = self.scenario.sumo.seed + index as u64;
        let (group, tyres) = (&self.scenario.groups[0], self.tyre_curve.as_deref());
        let (vehicle, _) = vehicle("ego", &TypeFacts::default(), &[], group, tyres, seed, speed_mps)?;
        Ok(Trip { vehicle, profile: Arc::clone(&self.profile), end })
    }

    /// The trips of one vehicle that measures without noise and of `seeds` vehicles with noise.
    ///
    /// # Errors
    /// As [`Road::trip`].
    pub fn trips(&self, seeds: usize, speed_mps: f64, end: End) -> Result<Vec<Trip>, OfflineError> {
        let mut trips: Vec<Trip> =
            (0..=seeds).map(|index| self.trip(index, speed_mps, end)).collect::<Result<_, _>>()?;
        trips[0].vehicle.noise = None;
        Ok(trips)
    }

    /// The same along the whole profile, from its own first speed to its end.
    ///
    /// # Errors
    /// [`OfflineError::NoProfile`] if the profile has no end; as [`Road::trip`].
    pub fn whole_trips(&self, seeds: usize) -> Result<Vec<Trip>, OfflineError> {
        self.trips(seeds, self.first_speed_mps(), self.end().ok_or(OfflineError::NoProfile)?)
    }

    /// The profile's speed at its start [m/s].
    pub fn first_speed_mps(&self) -> f64 {
        self.profile.at(0.0, 0.0, 0.0).0
    }

    /// The profile's end; none if it goes on for ever.
    pub fn end(&self) -> Option<End> {
        let end = if self.profile.is_by_time() { End::Time } else { End::Distance };
        self.profile.length().map(end)
    }

    /// Lets the vehicles drive until each is at its end, and returns their outcomes in the order of the trips. `watch` sees
    /// every vehicle under way at the end of every control period.
    ///
    /// The vehicles share one block. When one is at its end, the next takes its slot, so that all slots are busy until the
    /// last vehicles drive (the longest trips should come first).
    ///
    /// # Errors
    /// [`OfflineError::Law`] if the law gives up.
    pub fn drive(&self, trips: &[Trip], mut watch: impl FnMut(&mut Vehicle)) -> Result<Vec<Outcome>, OfflineError> {
        let group = &self.scenario.groups[0];
        let mut fleet = Fleet::new(self.scenario.loop_config(), vec![self.scenario.blocks(group)]);
        let period_s = fleet.period_s();
        let mut profiles: [&Profile; LANES] = [&self.profile; LANES];
        let mut waiting = trips.iter().enumerate();
        let mut rides: Vec<Ride> = Vec::with_capacity(LANES);
        let mut outcomes = vec![None; trips.len()];
        loop {
            while rides.len() < LANES
                && let Some((trip, Trip { vehicle, profile, .. })) = waiting.next()
            {
                let slot = fleet.admit(0, vehicle.clone());
                fleet.block_mut(slot).set_target(slot.lane(), f64::INFINITY, Bound::Profile);
                profiles[slot.lane()] = profile;
                rides.push(Ride { trip, slot, periods: 0 });
            }
            if rides.is_empty() {
                break;
            }
            if self.along_track {
                for Ride { slot, .. } in &rides {
                    let (block, lane) = (fleet.block_mut(*slot), slot.lane());
                    block.steering.set_curvature(lane, profiles[lane].curvature_at(block.distance_m(lane)));
                }
            }
            fleet.advance(1, |_| true, Follow::Profiles(&profiles));
            fleet.soundness()?;
            rides.retain_mut(|ride| {
                ride.periods += 1;
                let (slot, time_s) = (ride.slot.lane(), f64::from(ride.periods) * period_s);
                let block = fleet.block_mut(ride.slot);
                watch(&mut Vehicle { trip: ride.trip, time_s, block, slot });
                let at_end = match trips[ride.trip].end {
                    End::Distance(metres) => block.distance_m(slot) >= metres,
                    End::Time(seconds) => time_s >= seconds - 0.5 * period_s,
                };
                let is_checked = ride.periods % CHECK_PERIODS == 0;
                let ends = at_end || is_checked && (time_s >= TIME_MAX_S || !block.is_sound(slot));
                if ends {
                    let finished = at_end && block.is_sound(slot);
                    outcomes[ride.trip] = Some(Outcome { stats: fleet.release(ride.slot), finished });
                }
                !ends
            });
        }
        Ok(outcomes.into_iter().map(|outcome| outcome.expect("every vehicle ended")).collect())
    }
}
