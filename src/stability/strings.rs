//! A leader and ten followers: by how much its speed grows on the way to the last of them.
//!
//! The leader's speed is given. Every follower has body, actuators and lower law, and in every step its upper law (a target that keeps a gap) says which speed it is to have at
//! the step's end, as in traffic. The gain of a pair is the ratio of two amplitudes at the leader's frequency, taken over whole periods once
//! the beginning has faded; the amplitude is so small that nothing is limited. All pairs are alike, so the pair is that of the first two
//! followers: far behind, what is left of the beginning is larger than what is left of a swing that fades from pair to pair.
//! A string is stable if no frequency grows.

use super::closed_loop::SPEED_MPS;
use super::error::StabilityError;
use crate::fleet::follow::{Bound, Follow};
use crate::fleet::{Fleet, Slot};
use crate::offline::{End, Road};
use crate::reference::{Ahead, Axis, Own, Profile, Spacing, Target};
use crate::scenario::Scenario;

/// Followers.
pub const FOLLOWERS: usize = 10;
/// Length of a step, SUMO's in our scenarios \[s\].
const STEP_S: f64 = 0.1;
/// Periods of the leader's sinusoids \[s\].
const PERIODS_S: [f64; 10] = [100.0, 60.0, 40.0, 30.0, 20.0, 15.0, 12.0, 8.0, 6.0, 4.0];
/// Their amplitude [m/s].
const AMPLITUDE_MPS: f64 = 0.01;
/// After this time a sinusoid is taken to be all that is left \[s\].
const FADED_S: f64 = 200.0;
/// It is watched for at least this long \[s\].
const WATCHED_S: f64 = 60.0;
/// The step: the leader gains so much, at this rate, and keeps it.
const RISE_MPS: f64 = 1.0;
const RISE_MPS2: f64 = 1.0;
const RISE_AT_S: f64 = 30.0;
const RISE_SEEN_S: f64 = 180.0;
/// The first follower has settled if it is this near to the leader in the end [m/s].
const SETTLED_MPS: f64 = 0.02;

/// Gains at one period of the leader.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// The period \[s\].
    pub period_s: f64,
    /// The gain of the second follower over the first.
    pub pair: f64,
    /// The gain of the last follower over the leader.
    pub tail: f64,
}

/// What a string did.
#[derive(Debug, Clone, PartialEq)]
pub struct StringFound {
    /// False if even the first follower does not settle: its own loop is unstable.
    pub settles: bool,
    /// By the leader's period; none if it does not settle.
    pub gains: Vec<Gain>,
    /// Largest speed of the last follower above the leader's after the step, relative to the step [%].
    pub overshoot: f64,
    /// Least gap of any follower during the step \[m\].
    pub gap_min_m: f64,
}

/// Speeds of all vehicles after a step, the leader's first [m/s], and the least gap \[m\].
type Seen = ([f64; FOLLOWERS + 1], f64);

/// Examines the string of a scenario whose target keeps a gap.
pub fn string(scenario: &Scenario, upper: &str) -> Result<StringFound, StabilityError> {
    let Target::Spacing(spacing) = scenario.groups[0].load_target()? else {
        return Err(StabilityError::NoGap(upper.to_owned()));
    };
    let risen = |t: f64| SPEED_MPS + (RISE_MPS2 * (t - RISE_AT_S)).clamp(0.0, RISE_MPS);
    let (mut overshoot, mut gap_min_m, mut settles) = (0.0_f64, f64::INFINITY, true);
    drive(scenario, &spacing, risen, RISE_SEEN_S, |t, (speeds_mps, gap_m)| {
        let off_mps = |follower: usize| speeds_mps[follower] - SPEED_MPS - RISE_MPS;
        overshoot = overshoot.max(100.0 * off_mps(FOLLOWERS) / RISE_MPS);
        gap_min_m = gap_min_m.min(gap_m);
        settles &= t < RISE_SEEN_S - PERIODS_S[5] || off_mps(1).abs() < SETTLED_MPS;
    })?;
    let periods_s = if settles { &PERIODS_S[..] } else { &[] };
    let gains = periods_s.iter().map(|period_s| gain(scenario, &spacing, *period_s)).collect::<Result<_, _>>()?;
    Ok(StringFound { settles, gains, overshoot, gap_min_m })
}

fn gain(scenario: &Scenario, spacing: &Spacing, period_s: f64) -> Result<Gain, StabilityError> {
    let radps = std::f64::consts::TAU / period_s;
    let watched_s = period_s * (WATCHED_S / period_s).ceil();
    let mut sums = [[0.0; 2]; FOLLOWERS + 1];
    let swing = |t: f64| SPEED_MPS + AMPLITUDE_MPS * libm::sin(radps * t);
    drive(scenario, spacing, swing, FADED_S + watched_s, |t, (speeds_mps, _)| {
        if t > FADED_S + 0.5 * STEP_S {
            for (sum, speed_mps) in sums.iter_mut().zip(speeds_mps) {
                sum[0] += (speed_mps - SPEED_MPS) * libm::cos(radps * t);
                sum[1] += (speed_mps - SPEED_MPS) * libm::sin(radps * t);
            }
        }
    })?;
    let size = sums.map(|[re, im]| libm::sqrt(re * re + im * im));
    Ok(Gain { period_s, pair: size[2] / size[1], tail: size[FOLLOWERS] / size[0] })
}

/// Drives the string for so long, and shows every step.
fn drive(
    scenario: &Scenario,
    spacing: &Spacing,
    leader_mps: impl Fn(f64) -> f64,
    seconds: f64,
    mut see: impl FnMut(f64, Seen),
) -> Result<(), StabilityError> {
    let profile = Profile::step(Axis::Time, &[0.0], &[SPEED_MPS])?;
    let road = Road::with_profile(scenario, profile.into())?;
    let mut fleet = Fleet::new(scenario.loop_config(), vec![scenario.blocks(&scenario.groups[0])]);
    let periods = (STEP_S / fleet.period_s()).round().max(1.0) as u32;
    let step_s = f64::from(periods) * fleet.period_s();
    let mut slots: Vec<Slot> = Vec::with_capacity(FOLLOWERS);
    for index in 0..FOLLOWERS {
        slots.push(fleet.admit(0, road.trip(index, SPEED_MPS, End::Time(seconds))?.vehicle));
    }
    // Every vehicle's way begins where it keeps its gap.
    let gap_m = spacing.gap_m(SPEED_MPS);
    let mut leader_m = 0.0;
    for step in 0..(seconds / step_s).round() as usize {
        let t = step as f64 * step_s;
        let mut ahead = (leader_m, leader_mps(t));
        let mut gap_min_m = f64::INFINITY;
        for slot in &slots {
            let (block, lane) = (fleet.block_mut(*slot), slot.lane());
            let (way_m, speed_mps) = (block.distance_m(lane), block.speed_mps(lane));
            let own = Own { speed_mps, accel_mps2: block.acceleration_mps2(lane), free_mps: 2.0 * SPEED_MPS };
            let gap_m = gap_m + ahead.0 - way_m;
            let next_mps = spacing.next_mps(own, Some(Ahead { gap_m, speed_mps: ahead.1 }), step_s);
            block.set_target(lane, next_mps, Bound::Profile);
            gap_min_m = gap_min_m.min(gap_m);
            ahead = (way_m, speed_mps);
        }
        fleet.advance(periods, |_| true, Follow::Traffic);
        fleet.close_step();
        let end_s = t + step_s;
        leader_m += 0.5 * step_s * (leader_mps(t) + leader_mps(end_s));
        let speed_mps = |i: usize| fleet.block(slots[i]).speed_mps(slots[i].lane());
        let speeds = std::array::from_fn(|i| if i == 0 { leader_mps(end_s) } else { speed_mps(i - 1) });
        see(end_s, (speeds, gap_min_m));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Catalog, Override, Request};

    #[test]
    fn val_pairs_have_the_gain_of_the_upper_laws_transfer_function() {
        // Without a body in between, sampled as here, z = exp(jφ): (z − 1) v/Δt = c_e (g − h v) + c_v (v_l − v) − c_a (1 − 1/z) v/Δt with the
        // gap g = Δt/2 (z + 1)/(z − 1) (v_l − v), whose factor is −jΔt/2 / tan(φ/2).
        for (upper, tolerance) in [("ctg_acc", 0.01), ("path_cacc", 0.02)] {
            let overrides = vec![
                Override::text("test", "target.name", upper),
                Override::text("test", "controller.name", "lqi"),
                Override::literal("test", "controller.error_time_s", "0.05"),
            ];
            let scenario =
                Scenario::load_offline(&Request { scenario: None, overrides }, &Catalog::installed()).unwrap();
            let Target::Spacing(law) = scenario.groups[0].load_target().unwrap() else { panic!("{upper} keeps a gap") };
            for period_s in [60.0, 20.0, 12.0] {
                let phi = std::f64::consts::TAU / period_s * STEP_S;
                let gap = -0.5 * STEP_S / (0.5 * phi).tan();
                let above = [law.speed_per_s, law.gap_per_s2 * gap];
                let below = [
                    (1.0 - law.accel) * (phi.cos() - 1.0) / STEP_S + law.gap_per_s2 * law.time_gap_s + law.speed_per_s,
                    (1.0 + law.accel) * phi.sin() / STEP_S + law.gap_per_s2 * gap,
                ];
                let size = |[re, im]: [f64; 2]| libm::sqrt(re * re + im * im);
                let (wanted, found) = (size(above) / size(below), gain(&scenario, &law, period_s).unwrap());
                assert!((found.pair / wanted - 1.0).abs() < tolerance, "{upper} {period_s}: {found:?} for {wanted}");
                let tail = wanted.powi(FOLLOWERS as i32);
                assert!((found.tail / tail).ln().abs() < 10.0 * tolerance, "{upper} {period_s}: {found:?} for {tail}");
            }
        }
    }
}
