//! Odometers and roads, read once a second, when bodies and SUMO's cars are at the same instant.

use super::egos::{EgoTable, Presence};
use super::error::CosimError;
use super::platoon::AHEAD_M;
use super::question::{Gets, NoAnswer, Question};
use super::roads::Roads;
use super::sumo::Sumo;
use crate::fleet::{Fleet, Slot};
use crate::traci::vehicle;

/// When they are read.
#[derive(Clone, Copy)]
pub struct Readings {
    every: u64,
    /// Who is ahead of each ego is asked, too.
    platoons: bool,
}

/// The question about an ego's odometer and road, and perhaps about who is ahead.
pub struct ReadingQuestion {
    slot: Slot,
    platoons: bool,
}

/// The answer.
pub struct Reading<'a> {
    odometer_m: Option<f64>,
    road: Option<&'a str>,
    ahead: Option<String>,
}

impl Question for ReadingQuestion {
    type Answer<'a> = Reading<'a>;

    fn answer<'a>(&self, gets: &mut impl Gets<'a>) -> Reading<'a> {
        let (odometer_m, road) = (gets.number(vehicle::DISTANCE), gets.text(vehicle::ROAD));
        let ahead = if self.platoons { gets.leader(AHEAD_M).map(|leader| leader.id) } else { None };
        Reading { odometer_m, road, ahead }
    }
}

impl Readings {
    /// Once a second, or in every step if steps are longer than that.
    pub fn every_second(step_s: f64, platoons: bool) -> Self {
        Self { every: (1.0 / step_s).round().max(1.0) as u64, platoons }
    }

    /// Whether they are due after this step.
    pub fn are_due(&self, step: u64) -> bool {
        step.is_multiple_of(self.every)
    }

    /// Asks about every ego, or only about those that were carried to another place, in the memory of the last questions.
    /// SUMO looks the values up while the bodies drive to the same instant.
    pub fn ask<S: Sumo>(
        self,
        due: bool,
        room: S::Asked<ReadingQuestion>,
        sumo: &mut S,
        egos: &EgoTable,
    ) -> Result<S::Asked<ReadingQuestion>, CosimError> {
        sumo.ask_in(
            room,
            egos.iter()
                .filter(|ego| due || ego.carried)
                .map(|ego| (&ego.object, ReadingQuestion { slot: ego.slot, platoons: self.platoons })),
        )
    }

    /// Takes the answers: odometers are compared, and what a body did since the last reading goes to the road that it is
    /// on now.
    pub async fn hear<S: Sumo>(
        asked: S::Asked<ReadingQuestion>,
        sumo: &mut S,
        egos: &mut EgoTable,
        fleet: &mut Fleet,
        roads: &mut Roads,
    ) -> Result<S::Asked<ReadingQuestion>, CosimError> {
        let note = |ReadingQuestion { slot, platoons }: ReadingQuestion, answer: Result<Reading<'_>, NoAnswer>| {
            let ahead = |id: &str| egos.find(id).map(|ego| (ego.id().clone(), ego.slot));
            let ahead = answer.as_ref().ok().and_then(|reading| reading.ahead.as_deref()).and_then(ahead);
            let (Ok(reading), Some(ego)) = (answer, egos.get_mut(slot)) else { return };
            if platoons {
                ego.follower.see(ahead.as_ref().map(|(id, slot)| (id, *slot)));
            }
            let (block, lane) = (fleet.block_mut(slot), slot.lane());
            if let Some(odometer_m) = reading.odometer_m.filter(|_| ego.presence == Presence::Driving) {
                let gap_m = odometer_m - ego.odometer_offset_m - block.distance_m(lane);
                if std::mem::take(&mut ego.carried) {
                    // What it was carried is no difference between the two ways.
                    ego.odometer_offset_m += gap_m - ego.odometer_gap_m.unwrap_or(0.0);
                } else {
                    ego.odometer_gap_m = Some(gap_m);
                }
            }
            if let Some(road) = reading.road.filter(|road| !road.is_empty()) {
                let sums = block.take_sums(lane);
                let index = roads.index(road);
                ego.road = Some(index);
                roads.add(index, &sums);
            }
        };
        sumo.answers(asked, note).await
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odometers_are_read_once_a_second_or_in_every_longer_step() {
        for (step_s, count) in [(0.1, 10), (0.05, 5), (0.5, 10), (1.0, 10), (2.0, 10), (0.001, 3)] {
            let readings = Readings::every_second(step_s, false);
            let due: Vec<u64> = (1..).filter(|step| readings.are_due(*step)).take(count).collect();
            for (second, step) in (1..).zip(due) {
                let time_s = step as f64 * step_s;
                assert!((time_s - f64::from(second) * step_s.max(1.0)).abs() < 1e-9, "{step_s}: {time_s}");
            }
        }
    }
}
