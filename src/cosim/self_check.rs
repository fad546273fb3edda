//! Is the coupling what it should be? Two egos (`classic`, `adaptive`) and a car of SUMO's own (`plain`) drive the same
//! road side by side: from rest to 20 m/s, to a red light, and on when it is green. The contract is right if SUMO
//! takes the bodies' speeds for the cars', if the egos gain speed like `plain` before and after the light, and if they
//! stand exactly still in between. `tests/self_check.rs` shows that each way to get it wrong fails at least one check.

use super::error::CosimError;
use super::question::{Gets, NoAnswer, Object, Question};
use super::setup::WorldSetup;
use super::sumo::Sumo;
use super::world::World;
use crate::traci::vehicle;

/// The files of the check's scenario, by name; the last one is the scenario itself.
pub const FILES: [(&str, &str); 3] = [
    ("self_check.net.xml", include_str!("../../sumo_nets/self_check/self_check.net.xml")),
    ("self_check.rou.xml", include_str!("../../sumo_nets/self_check/self_check.rou.xml")),
    ("self_check.toml", include_str!("../../sumo_nets/self_check/self_check.toml")),
];

const EGOS: [&str; 2] = ["classic", "adaptive"];
const PLAIN: &str = "plain";
/// The scenario's numbers: time at which the lights turn green and the end \[s\], place of the light \[m\].
const GREEN_S: f64 = 30.0;
const END_S: f64 = 45.0;
const LIGHT_M: f64 = 300.0;
/// What SUMO's driver may gain in a second [m/s²], below this speed for sure [m/s].
const ACCEL_MPS2: f64 = 2.6;
const FREE_MPS: f64 = 15.0;
/// Speed at which the egos are compared with `plain` [m/s], and how much later they may reach it \[s\].
const COMPARED_MPS: f64 = 18.0;
const LATER_S: f64 = 0.3;
/// How long before green the cars have to stand \[s\].
const STANDING_S: f64 = 2.0;
/// Largest difference between SUMO's odometer and the body's \[m\].
const GAP_M: f64 = 0.1;
/// How exactly SUMO's next speed has to follow from the body's: rounding, nothing more [m/s].
const EXACT_MPS: f64 = 1e-6;

/// One thing that was looked at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Check {
    /// What should hold.
    pub name: String,
    /// Whether it does.
    pub passed: bool,
    /// What was measured.
    pub figures: String,
}

/// One car at the end of one SUMO step.
#[derive(Debug, Clone, Copy, Default)]
struct Moment {
    time_s: f64,
    /// The body's speed before the step, and what SUMO took the car's to be once it was told.
    before_mps: f64,
    believed_mps: f64,
    /// SUMO's choice v*.
    sumo_mps: f64,
    /// The body's speed after the step.
    speed_mps: f64,
    /// Metres driven, by the body.
    distance_m: f64,
}

/// Drives the check's scenario ([`FILES`]), which `sumo` has loaded and `setup` describes, and judges it.
///
/// # Errors
/// If SUMO ends or answers nonsense.
pub async fn examine(sumo: impl Sumo, setup: WorldSetup) -> Result<Vec<Check>, CosimError> {
    let mut world = World::over(sumo, setup).await?;
    let objects: Vec<Object> = EGOS.into_iter().chain([PLAIN]).map(Object::new).collect::<Result<_, _>>()?;
    let mut egos: [Vec<Moment>; EGOS.len()] = Default::default();
    let mut plain = Vec::new();
    while world.time_s() < END_S - 0.5 * world.step_s() {
        let believed_mps = sumo_speeds_mps(&mut world, &objects).await?;
        let before = EGOS.map(|id| body(&world, id));
        world.step().await?;
        let time_s = world.time_s();
        for (i, id) in EGOS.into_iter().enumerate() {
            let (Some(before), Some(after), Some(believed_mps)) = (&before[i], body(&world, id), believed_mps[i])
            else {
                continue;
            };
            egos[i].push(Moment { time_s, before_mps: before.speed_mps, believed_mps, ..after });
        }
        // Not there before its departure: then it has no speed.
        if let [Some(speed_mps)] = sumo_speeds_mps(&mut world, &objects[EGOS.len()..]).await?[..] {
            plain.push((time_s, speed_mps));
        }
    }
    world.hand_back().await?;
    let step_s = world.step_s();
    let (records, left) = world.close().await;
    left?;
    let gap_m = |id: &str| records.finished.iter().find(|f| &*f.id == id).and_then(|f| f.odometer_gap_m);
    Ok(EGOS.iter().zip(&egos).flat_map(|(id, drive)| judge(id, drive, &plain, gap_m(id), step_s)).collect())
}

/// The question about a vehicle's speed [m/s].
struct SpeedQuestion;

impl Question for SpeedQuestion {
    type Answer<'a> = Option<f64>;

    fn answer<'a>(&self, gets: &mut impl Gets<'a>) -> Option<f64> {
        gets.number(vehicle::SPEED)
    }
}

/// What SUMO takes for the speeds of these vehicles [m/s], now that it has been told those of the bodies.
async fn sumo_speeds_mps<S: Sumo>(world: &mut World<S>, vehicles: &[Object]) -> Result<Vec<Option<f64>>, CosimError> {
    let sumo = world.sumo_mut();
    // They would go with the next step.
    sumo.hand_over().await?;
    let asked = sumo.ask(vehicles.iter().map(|vehicle| (vehicle, SpeedQuestion)))?;
    let mut speeds_mps = Vec::new();
    let note = |_: SpeedQuestion, speed: Result<Option<f64>, NoAnswer>| speeds_mps.push(speed.ok().flatten());
    sumo.answers(asked, note).await?;
    Ok(speeds_mps)
}

/// A body as it is now; what it was before the step is not known here.
fn body<S: Sumo>(world: &World<S>, id: &str) -> Option<Moment> {
    let (ego, block) = world.driving().find(|(ego, _)| &**ego.id() == id)?;
    let lane = ego.slot.lane();
    let (speed_mps, sumo_mps, distance_m) = (block.speed_mps(lane), block.sumo_mps(lane), block.distance_m(lane));
    Some(Moment { speed_mps, sumo_mps, distance_m, ..Moment::default() })
}

/// The first time after `from_s` at which the compared speed is reached \[s\].
fn time_of(mut speeds: impl Iterator<Item = (f64, f64)>, from_s: f64) -> Option<f64> {
    speeds.find(|(time_s, speed_mps)| *time_s > from_s && *speed_mps >= COMPARED_MPS).map(|(time_s, _)| time_s)
}

fn judge(id: &str, drive: &[Moment], plain: &[(f64, f64)], gap_m: Option<f64>, step_s: f64) -> Vec<Check> {
    let check = |name: &str, passed: bool, figures: String| Check { name: format!("{id}: {name}"), passed, figures };
    let largest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).reduce(f64::max);

    let told = largest(&mut drive.iter().map(|m| m.believed_mps - m.before_mps));
    let free = |m: &&Moment| m.time_s < 0.5 * GREEN_S && m.before_mps < FREE_MPS && m.speed_mps > m.before_mps;
    let chosen = largest(&mut drive.iter().filter(free).map(|m| m.sumo_mps - m.before_mps - ACCEL_MPS2 * step_s));
    let difference = |what: &str, reply: Option<f64>| {
        reply.map_or("no step to judge by".to_owned(), |v| format!("{what} by at most {v:.1e} m/s"))
    };

    let gain = |name: &str, from_s: f64| {
        let ours = time_of(drive.iter().map(|m| (m.time_s, m.speed_mps)), from_s);
        let theirs = time_of(plain.iter().copied(), from_s);
        let passed = matches!((ours, theirs), (Some(a), Some(b)) if a - b <= LATER_S.max(step_s) + 1e-9);
        let shown = |t: Option<f64>| t.map_or("never".to_owned(), |t| format!("at {t:.1} s"));
        check(name, passed, format!("{COMPARED_MPS} m/s {}, plain SUMO {}", shown(ours), shown(theirs)))
    };

    let waiting = |m: &&Moment| m.time_s > GREEN_S - STANDING_S && m.time_s < GREEN_S;
    let standing = drive.iter().filter(waiting);
    let fastest = largest(&mut standing.clone().map(|m| m.speed_mps.abs().max(m.sumo_mps.abs())));
    let place_m = standing.clone().map(|m| m.distance_m).reduce(f64::max);
    let stands = fastest == Some(0.0) && place_m.is_some_and(|s| s > 0.0 && s < LIGHT_M);
    let place = place_m.map_or("not there".to_owned(), |s| format!("{:.1} m before the light", LIGHT_M - s));
    vec![
        check("SUMO's speed is the body's", told.is_some_and(|v| v <= EXACT_MPS), difference("differs", told)),
        check(
            "SUMO's choice follows from it",
            chosen.is_some_and(|v| v <= EXACT_MPS),
            difference("off V + a·dt", chosen),
        ),
        gain("no creep", 0.0),
        check("stands at the red light", stands, format!("at {} m/s, {place}", fastest.unwrap_or(f64::NAN))),
        gain("no freeze after it", GREEN_S),
        check(
            "odometers agree",
            gap_m.is_some_and(|gap| gap.abs() < GAP_M),
            gap_m.map_or("none read".to_owned(), |gap| format!("gap {gap:.3} m")),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive as it should be: to 20 m/s, a stop 1 m before the light, on at green.
    fn drive() -> Vec<Moment> {
        let step_s = 0.1;
        let speed_mps = |t: f64| match t {
            t if t < 25.0 => (ACCEL_MPS2 * (t - 1.0)).clamp(0.0, 20.0),
            t => (ACCEL_MPS2 * (t - GREEN_S)).clamp(0.0, 20.0),
        };
        let moments = (10..450).map(|k| {
            let time_s = f64::from(k) * step_s;
            let (before_mps, after_mps) = (speed_mps(time_s - step_s), speed_mps(time_s));
            Moment {
                time_s,
                before_mps,
                believed_mps: before_mps,
                sumo_mps: if (1.0..8.0).contains(&time_s) { before_mps + ACCEL_MPS2 * step_s } else { after_mps },
                speed_mps: after_mps,
                distance_m: LIGHT_M - 1.0,
            }
        });
        moments.collect()
    }

    fn failed(drive: &[Moment], gap_m: Option<f64>) -> Vec<usize> {
        let plain: Vec<_> = self::drive().iter().map(|m| (m.time_s, m.speed_mps)).collect();
        let checks = judge("ego", drive, &plain, gap_m, 0.1);
        (0..checks.len()).filter(|i| !checks[*i].passed).collect()
    }

    #[test]
    fn each_deviation_fails_its_own_check() {
        let change = |change: &dyn Fn(&mut Moment)| {
            let mut drive = drive();
            drive.iter_mut().for_each(change);
            failed(&drive, Some(0.01))
        };
        assert_eq!(change(&|_| {}), [0; 0]);
        let held = |m: &mut Moment| m.sumo_mps *= if m.time_s < 1.05 { 0.0 } else { 1.0 };
        assert_eq!(change(&held), [0; 0], "SUMO holds a car that has just departed");
        assert_eq!(change(&|m| m.believed_mps += 1e-3), [0]);
        assert_eq!(change(&|m| m.sumo_mps += if m.sumo_mps > 0.0 { 1e-3 } else { 0.0 }), [1]);
        assert_eq!(change(&|m| m.speed_mps = if m.time_s < 20.0 { m.speed_mps.min(17.0) } else { m.speed_mps }), [2]);
        assert_eq!(change(&|m| m.speed_mps = m.speed_mps.max(1e-9)), [3]);
        assert_eq!(change(&|m| m.speed_mps = if (28.5..29.5).contains(&m.time_s) { 0.01 } else { m.speed_mps }), [3]);
        assert_eq!(change(&|m| m.distance_m += 2.0), [3]);
        assert_eq!(change(&|m| m.distance_m = 0.0), [3], "it has never left");
        assert_eq!(change(&|m| m.distance_m = LIGHT_M), [3], "it is to stand before the light");
        assert_eq!(change(&|m| m.speed_mps = if m.time_s < 30.0 { m.speed_mps } else { 0.0 }), [4]);
        let at_green_only = |m: &mut Moment| {
            m.speed_mps = if m.time_s == GREEN_S {
                COMPARED_MPS
            } else {
                m.speed_mps.min(if m.time_s > GREEN_S { 9.0 } else { 20.0 })
            }
        };
        assert_eq!(change(&at_green_only), [4], "it has to start when it is green, not to pass then");
        assert_eq!(failed(&drive(), Some(-0.2)), [5]);
        assert_eq!(failed(&[], None), [0, 1, 2, 3, 4, 5]);
    }

    /// The light is red up to the step that ends at 30 s; the cars drive freely up to the one that ends at 15 s.
    #[test]
    fn what_happens_at_the_bounds_of_time_and_speed_is_not_judged() {
        let at = |time_s: f64, before_mps: f64, sumo_mps: f64| {
            let mut drive = drive();
            let moment = drive.iter_mut().find(|m| m.time_s == time_s).unwrap();
            let (believed_mps, speed_mps) = (before_mps, before_mps + 0.1);
            *moment = Moment { before_mps, believed_mps, sumo_mps, speed_mps, ..*moment };
            failed(&drive, Some(0.01))
        };
        assert_eq!(at(14.5, 10.0, 99.0), [1], "it is judged here");
        assert_eq!(at(0.5 * GREEN_S, 10.0, 99.0), [0; 0]);
        assert_eq!(at(5.0, FREE_MPS, 99.0), [0; 0]);
        assert_eq!(at(GREEN_S - STANDING_S, 0.0, 0.5), [0; 0]);
        assert_eq!(at(GREEN_S, 0.0, 0.5), [0; 0]);
    }
}
