//! A driver with human imperfection on a circuit: what makes the recording that the driver test follows.
//!
//! - *Corners.* The lateral acceleration that drivers prefer goes with the root of the curvature (Levison, Bittner, Campbell and
//!   Schreiner 2002, Transportation Research Record 1803, 52-58): a_y = c √|κ|, hence a speed of √c |κ|^(−1/4).
//! - *Ahead.* The driver brakes so early, and accelerates so late, that moderate accelerations do.
//! - *Imperfection* (Treiber, Kesting and Helbing 2006, Physica A 360, 71-88): the own speed is known as it was a reaction time
//!   ago, brought up to date with the acceleration (temporal anticipation), and the speed that is wanted is misjudged by a
//!   relative error with a memory of `MEMORY_S`, an Ornstein-Uhlenbeck process.
//! - *Pedals* move to a new place at random moments, not all the time (Wagner 2006, European Physical Journal B 52, 427-431), and
//!   the car follows them with a lag.
//!
//! Constants are usual ones, chosen once so that the acceleration is that of brisk driving (an RMS of 0.5 m/s² to 0.7 m/s²); no recording
//! of anybody was fitted.

use super::circuit::Circuit;
use crate::random::Stream;

/// c of the lateral acceleration [m^(3/2)/s²]: 3.2 m/s² at a radius of 40 m.
const LATERAL: f64 = 20.0;
/// What the driver does not exceed on straights [m/s].
const TOP_MPS: f64 = 18.0;
/// Planned braking and driving [m/s²].
const BRAKES_MPS2: f64 = 1.0;
const DRIVES_MPS2: f64 = 0.65;
/// The driver asks for no more than this [m/s²].
const DRIVES_MAX_MPS2: f64 = 2.0;
const BRAKES_MAX_MPS2: f64 = 2.5;
/// In this time the driver means to have the speed that is wanted \[s\].
const RELAXATION_S: f64 = 1.2;
/// Reaction time \[s\].
const REACTION_S: f64 = 0.7;
/// Lag of car and foot \[s\].
const LAG_S: f64 = 0.3;
/// Mean time between moves of the pedals \[s\].
const MOVES_S: f64 = 0.5;
/// Relative error of the speed that is wanted, and how long it lasts \[s\].
const MISJUDGES: f64 = 0.05;
const MEMORY_S: f64 = 20.0;

/// Step of the simulation \[s\], and steps per sample.
const STEP_S: f64 = 0.01;
const STEPS_PER_SAMPLE: usize = 10;
/// Metres of the plan beyond the end of the lap, for what lies ahead there.
const BEYOND_M: usize = 200;

/// A sample, 10 a second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time (s).
    pub t_s: f64,
    /// Speed [m/s].
    pub speed_mps: f64,
    /// Yaw rate, left positive [rad/s].
    pub yaw_rate_radps: f64,
}

/// A flying lap, driven with this seed.
pub fn lap(seed: u64) -> Vec<Sample> {
    let circuit = Circuit::new();
    let plan = plan(&circuit);
    let mut driver = Driver::new(seed, plan[0]);
    let mut samples = Vec::new();
    for step in 0.. {
        if driver.distance_m >= circuit.length_m {
            break;
        }
        if step % STEPS_PER_SAMPLE == 0 {
            let yaw_rate_radps = circuit.curvature_at(driver.distance_m) * driver.speed_mps;
            samples.push(Sample { t_s: step as f64 * STEP_S, speed_mps: driver.speed_mps, yaw_rate_radps });
        }
        driver.step(step, &plan);
    }
    samples
}

/// The speed that is wanted at every metre [m/s].
fn plan(circuit: &Circuit) -> Vec<f64> {
    let metres = circuit.length_m as usize + BEYOND_M;
    let wanted = |s: usize| {
        let curvature = circuit.curvature_at(s as f64).abs().max(1e-9);
        (LATERAL.sqrt() / curvature.sqrt().sqrt()).min(TOP_MPS)
    };
    let mut plan: Vec<f64> = (0..metres).map(wanted).collect();
    let reach = |speed_mps: f64, accel_mps2: f64| (speed_mps * speed_mps + 2.0 * accel_mps2).sqrt();
    for s in (1..metres).rev() {
        plan[s - 1] = plan[s - 1].min(reach(plan[s], BRAKES_MPS2));
    }
    for s in 1..metres {
        plan[s] = plan[s].min(reach(plan[s - 1], DRIVES_MPS2));
    }
    plan
}

/// The plan at a place, linear between metres.
fn planned(plan: &[f64], s_m: f64) -> f64 {
    let s = (s_m as usize).min(plan.len() - 2);
    plan[s] + (plan[s + 1] - plan[s]) * (s_m - s as f64).min(1.0)
}

struct Driver {
    distance_m: f64,
    speed_mps: f64,
    accel_mps2: f64,
    /// What the pedals ask for [m/s²], and from which step on they may move again.
    asked_mps2: f64,
    next_move: usize,
    /// Of the misjudgement, with a variance of 1.
    error: f64,
    errors: Stream,
    moves: Stream,
    /// Speeds of the last reaction time, a ring [m/s].
    past_mps: Vec<f64>,
}

impl Driver {
    fn new(seed: u64, speed_mps: f64) -> Self {
        let mut errors = Stream::new(seed, "driver", "misjudgement");
        Self {
            distance_m: 0.0,
            speed_mps,
            accel_mps2: 0.0,
            asked_mps2: 0.0,
            next_move: 0,
            error: errors.normal(),
            errors,
            moves: Stream::new(seed, "driver", "pedals"),
            past_mps: vec![speed_mps; (REACTION_S / STEP_S).round() as usize],
        }
    }

    fn step(&mut self, step: usize, plan: &[f64]) {
        let diffusion = (2.0 * STEP_S / MEMORY_S).sqrt();
        self.error += -self.error * STEP_S / MEMORY_S + diffusion * self.errors.normal();
        let place = step % self.past_mps.len();
        let seen_mps = self.past_mps[place] + self.accel_mps2 * REACTION_S;
        self.past_mps[place] = self.speed_mps;
        if step >= self.next_move {
            let ahead_m = self.speed_mps * (RELAXATION_S + LAG_S);
            let wanted_mps = planned(plan, self.distance_m + ahead_m) * libm::exp(MISJUDGES * self.error);
            self.asked_mps2 = ((wanted_mps - seen_mps) / RELAXATION_S).clamp(-BRAKES_MAX_MPS2, DRIVES_MAX_MPS2);
            let wait_s = -MOVES_S * libm::log(1.0 - self.moves.uniform());
            self.next_move = step + (wait_s / STEP_S) as usize;
        }
        self.accel_mps2 += (self.asked_mps2 - self.accel_mps2) * STEP_S / LAG_S;
        self.speed_mps = (self.speed_mps + self.accel_mps2 * STEP_S).max(0.0);
        self.distance_m += self.speed_mps * STEP_S;
    }
}
