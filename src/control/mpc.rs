//! Model predictive control over a short horizon, with torque limits: a baseline that knows dead time and lag.
//!
//! In N moves of h, w the input above that which keeps the error (w = v − ẏ_r + F̂) and ã the acceleration that acts likewise, from the state to
//! be at the end of the dead time:
//! ```text
//! e_{j+1} = e_j + τ(1 − μ) ã_j + (h − τ(1 − μ)) w_j,   ã_{j+1} = μ ã_j + (1 − μ) w_j,   μ = exp(−h/τ)
//! least Σ e_j² + (T_e w_j)² + xᵀ_N P x_N   with   v_min ≤ ẏ_r − F̂ + w_j ≤ v_max
//! ```
//! P is the cost to go of the regulator without limits (`riccati.rs`), so that without active limits the moves are that regulator's, whatever N. The first
//! move is sent; in the next period all is solved again. F̂ comes from the observer of `calibrating.rs`, y and the modelled acceleration put in,
//! and so a constant force leaves no error. The limits are heard: where the actuators cut a torque off, what is left of it
//! is one. Until then there is none.
//!
//! **The quadratic program** in w alone, ½ wᵀHw + gᵀw in a box, has one Hessian for all vehicles and times. Its start is the regulator with its moves clipped
//! one after the other; if nothing is clipped, that is the solution. Otherwise [`ITERATIONS`] steps of the accelerated projected gradient follow
//! (Nesterov 2004, Introductory Lectures on Convex Optimization, 2.2.4), with L ≥ λ_max(H) by row sums and m ≤ λ_min(H): after i steps the
//! cost is within (1 − √(m/L))ⁱ (L + m)/2 ‖w₀ − w*‖² of the least. Nothing is allocated, and every vehicle takes the same steps.
//!
//! # Default tuning
//! T_e = 1 s: without lag the regulator's gain is about 1/s, as the other laws have it. T = 0.5 s as in `calibrating`. A horizon of 1 s in ten moves is
//! longer than most dead times and lags; what is beyond it P knows but for the limits.

use super::actuator_model::{ActuatorModel, Lateness, ModelKeys};
use super::bounds::{INPUT_MAX_MPS2, RateKeys};
use super::controller::Controller;
use super::law::{Build, law};
use super::observer::Observer;
use super::riccati::{Matrix, Regulator, Vector, apply, dot, regulator};
use super::signals::{Actuation, Command, Observation};
use crate::columns::{Slots, columns};
use crate::keys;
use crate::lanes::{LANES, Lanes, vectorised};
use crate::registry::Entry;

/// N.
const MOVES: usize = 10;
/// Steps of the accelerated gradient.
const ITERATIONS: usize = 20;

keys! {
    /// Keys of the law.
    #[derive(Copy)]
    struct MpcKeys {
        ..model: ModelKeys,
        /// T_e, weight of acceleration against that of the speed error: less is faster
        error_time_s: f64 = 1.0, "s", 1e-2..=1e3;
        /// T, the observer's estimate of the unknown force is late by T/2
        window_s: f64 = 0.5, "s", 0.001..=50.0;
        /// length of the horizon, ten moves
        horizon_s: f64 = 1.0, "s", 0.1..=20.0;
        and ..rate: RateKeys,
    }
}

pub(super) fn entry() -> Entry<Build> {
    let summary =
        "model predictive control over a short horizon, with dead time, lag and the torque limits that it hears of";
    law("mpc", summary, |keys: MpcKeys, period_s| {
        let late = Lateness::of(&keys.model, period_s);
        Mpc::new(Law::new(&keys, period_s), ActuatorModel::new(late))
    })
}

/// What is the same for all vehicles and times.
#[derive(Debug, Clone)]
struct Law {
    rate: RateKeys,
    period_s: f64,
    observer: Observer,
    /// A and B over one move.
    step: Matrix<2>,
    input: Vector<2>,
    regulator: Regulator<2>,
    /// H, and g for the two states.
    hessian: [[f64; MOVES]; MOVES],
    slope: [Vector<2>; MOVES],
    /// 1/L and the momentum (√L − √m)/(√L + √m).
    length: f64,
    momentum: f64,
}

impl Law {
    fn new(keys: &MpcKeys, period_s: f64) -> Self {
        let h = keys.horizon_s / MOVES as f64;
        let lag_s = keys.model.model_lag_s.unwrap_or(0.0);
        let rest = if lag_s > 0.0 { libm::exp(-h / lag_s) } else { 0.0 };
        let late_s = lag_s * (1.0 - rest);
        let (step, input) = ([[1.0, late_s], [0.0, rest]], [h - late_s, 1.0 - rest]);
        let effort = keys.error_time_s * keys.error_time_s;
        let regulator = regulator(&step, &input, &[1.0, 0.0], effort);
        let (hessian, slope) = condense(&step, &input, &regulator.cost, effort);
        let row_sum = |row: &[f64; MOVES]| row.iter().map(|x| x.abs()).sum::<f64>();
        let most = hessian.iter().map(row_sum).fold(0.0, f64::max);
        Self {
            rate: keys.rate,
            period_s,
            observer: Observer::new(keys.window_s, period_s),
            step,
            input,
            regulator,
            hessian,
            slope,
            length: 1.0 / most,
            momentum: (most.sqrt() - effort.sqrt()) / (most.sqrt() + effort.sqrt()),
        }
    }
}

/// H and g: with x_j = Aʲx₀ + Σ A^(j−1−i) B w_i, half of the second derivative and of the first at w = 0.
fn condense(
    step: &Matrix<2>,
    input: &Vector<2>,
    terminal: &Matrix<2>,
    effort: f64,
) -> ([[f64; MOVES]; MOVES], [Vector<2>; MOVES]) {
    // By columns: what a move, or a state at the beginning, makes of all states to come.
    let run = |mut x: Vector<2>, moved: Option<usize>| -> Vec<Vector<2>> {
        let next = |j: usize| {
            let (free, w) = (apply(step, &x), if moved == Some(j) { 1.0 } else { 0.0 });
            x = std::array::from_fn(|i| free[i] + input[i] * w);
            x
        };
        (0..MOVES).map(next).collect()
    };
    let cost = |x: &[Vector<2>], y: &[Vector<2>]| -> f64 {
        let stages: f64 = (0..MOVES - 1).map(|j| x[j][0] * y[j][0]).sum();
        stages + dot(&x[MOVES - 1], &apply(terminal, &y[MOVES - 1]))
    };
    let moves: Vec<_> = (0..MOVES).map(|j| run([0.0; 2], Some(j))).collect();
    let states = [run([1.0, 0.0], None), run([0.0, 1.0], None)];
    let own = |i: usize, j: usize| if i == j { effort } else { 0.0 };
    let hessian = std::array::from_fn(|i| std::array::from_fn(|j| own(i, j) + cost(&moves[i], &moves[j])));
    (hessian, std::array::from_fn(|i| std::array::from_fn(|state| cost(&moves[i], &states[state]))))
}

columns! {
    /// What a vehicle's motion leaves to the next period.
    #[derive(Debug, Clone)]
    struct Motion {
        columns {
            /// ŷ.
            y_mps: f64 = 0.0,
            f_hat_mps2: f64 = 0.0,
        }
    }
}

columns! {
    /// What the actuators have shown of their limits: v_min and v_max [m/s²].
    #[derive(Debug, Clone)]
    struct Limits {
        columns {
            lowest: f64 = -INPUT_MAX_MPS2,
            highest: f64 = INPUT_MAX_MPS2,
        }
    }
}

columns! {
    struct Mpc(law: Law, model: ActuatorModel) {
        shared {
            law: Law = law,
        }
        parts {
            model: ActuatorModel = model,
            motion: Motion = Motion::default(),
            limits: Limits = Limits::default(),
        }
    }
}

/// A quadratic program for each slot: the state at the beginning, and the box of its moves.
struct Program {
    state: [Lanes; 2],
    lowest: Lanes,
    highest: Lanes,
}

impl Controller for Mpc {
    fn command(&mut self, observation: &Observation, command: &mut Command) {
        let mut keep = [0.0; LANES];
        let mut program = Program { state: [[0.0; LANES]; 2], lowest: [0.0; LANES], highest: [0.0; LANES] };
        set_up(self, observation, &mut keep, &mut program);
        let (mut first, mut clipped) = ([0.0; LANES], [[0.0; LANES]; MOVES]);
        let mut is_clipped = [0.0; LANES];
        roll_out(&self.law, &program, &mut first, &mut clipped, &mut is_clipped);
        if is_clipped.iter().any(|flag| *flag > 0.0) {
            descend(&self.law, &program, &mut clipped);
        }
        for i in 0..LANES {
            let w = if is_clipped[i] > 0.0 { clipped[0][i] } else { first[i] };
            command.ask(i, keep[i] + w, observation.nominal_nm_per_mps2[i], 1.0);
        }
    }

    fn feedback(&mut self, actuation: &Actuation) {
        self.model.take(actuation);
        hear(self, actuation);
    }

    fn reset(&mut self, slot: usize, speed_mps: f64) {
        self.clear(slot);
        self.motion.y_mps[slot] = speed_mps;
    }

    fn rest(&mut self, slot: usize) {
        self.model.clear(slot);
        self.motion.clear(slot);
    }

    fn f_hat_mps2(&self, slot: usize) -> f64 {
        self.motion.f_hat_mps2[slot]
    }
}

vectorised! {
    /// The observer's correction, the state to be at the end of the dead time, and the box.
    fn set_up(mpc: &mut Mpc, observed: &Observation, keep: &mut Lanes, program: &mut Program) {
        let delay_s = mpc.model.late.delay_s();
        for i in 0..LANES {
            let motion = &mut mpc.motion;
            mpc.law.observer.correct(observed.measured_mps[i], &mut motion.y_mps[i], &mut motion.f_hat_mps2[i]);
            let (y_hat, f_hat) = (motion.y_mps[i], motion.f_hat_mps2[i]);
            keep[i] = mpc.law.rate.bound(observed.reference_rate_mps2[i]) - f_hat;
            let e = y_hat - observed.reference_mps[i];
            program.state[0][i] = e + mpc.model.pending_mps[i] - delay_s * keep[i];
            program.state[1][i] = mpc.model.ahead_mps2[i] - keep[i];
            program.lowest[i] = mpc.limits.lowest[i] - keep[i];
            program.highest[i] = mpc.limits.highest[i] - keep[i];
        }
    }
}

vectorised! {
    /// The regulator's moves, each clipped before the next.
    fn roll_out(law: &Law, program: &Program, first: &mut Lanes, moves: &mut [Lanes; MOVES], is_clipped: &mut Lanes) {
        let [mut e, mut a] = program.state;
        let [k_e, k_a] = law.regulator.gains;
        for (j, moves) in moves.iter_mut().enumerate() {
            for i in 0..LANES {
                let free = -k_e * e[i] - k_a * a[i];
                let w = free.max(program.lowest[i]).min(program.highest[i]);
                first[i] = if j == 0 { free } else { first[i] };
                is_clipped[i] = if w == free { is_clipped[i] } else { 1.0 };
                moves[i] = w;
                e[i] = e[i] + law.step[0][1] * a[i] + law.input[0] * w;
                a[i] = law.step[1][1] * a[i] + law.input[1] * w;
            }
        }
    }
}

vectorised! {
    /// The accelerated projected gradient.
    fn descend(law: &Law, program: &Program, moves: &mut [Lanes; MOVES]) {
        let mut ahead = *moves;
        for _ in 0..ITERATIONS {
            let mut next = [[0.0; LANES]; MOVES];
            for (row, next) in next.iter_mut().enumerate() {
                let [of_e, of_a] = law.slope[row];
                let mut slope = [0.0; LANES];
                for i in 0..LANES {
                    slope[i] = of_e * program.state[0][i] + of_a * program.state[1][i];
                }
                for (column, ahead) in ahead.iter().enumerate() {
                    let h = law.hessian[row][column];
                    for i in 0..LANES {
                        slope[i] += h * ahead[i];
                    }
                }
                for i in 0..LANES {
                    let to = ahead[row][i] - law.length * slope[i];
                    next[i] = to.max(program.lowest[i]).min(program.highest[i]);
                }
            }
            for j in 0..MOVES {
                for i in 0..LANES {
                    ahead[j][i] = next[j][i] + law.momentum * (next[j][i] - moves[j][i]);
                    moves[j][i] = next[j][i];
                }
            }
        }
    }
}

vectorised! {
    /// The observer's prediction with the torque that acts, and the limits.
    fn hear(mpc: &mut Mpc, actuation: &Actuation) {
        for i in 0..LANES {
            mpc.motion.y_mps[i] += mpc.law.period_s * (mpc.motion.f_hat_mps2[i] + mpc.model.acts_mps2[i]);
            let (asked, left) = (actuation.commanded_mps2[i], actuation.saturated_mps2[i]);
            mpc.limits.highest[i] = if asked > left { left } else { mpc.limits.highest[i] };
            mpc.limits.lowest[i] = if asked < left { left } else { mpc.limits.lowest[i] };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::loop_tests::{PERIOD_S, Plant};
    use crate::random::Stream;

    fn keys(delay_s: f64, lag_s: f64) -> MpcKeys {
        MpcKeys { model: ModelKeys { model_delay_s: Some(delay_s), model_lag_s: Some(lag_s) }, ..MpcKeys::default() }
    }

    fn law(keys: &MpcKeys) -> Mpc {
        Mpc::new(Law::new(keys, PERIOD_S), ActuatorModel::new(Lateness::of(&keys.model, PERIOD_S)))
    }

    fn cost(law: &Law, state: Vector<2>, moves: &[f64; MOVES]) -> f64 {
        let quadratic = |i: usize| 0.5 * dot(&law.hessian[i], moves) + dot(&law.slope[i], &state);
        (0..MOVES).map(|i| moves[i] * quadratic(i)).sum()
    }

    fn program(state: Vector<2>, [lowest, highest]: [f64; 2]) -> Program {
        Program { state: state.map(|x| [x; LANES]), lowest: [lowest; LANES], highest: [highest; LANES] }
    }

    /// Where the descent starts.
    fn clipped(law: &Law, state: Vector<2>, limits: [f64; 2]) -> [f64; MOVES] {
        let (mut first, mut moves, mut is_clipped) = ([0.0; LANES], [[0.0; LANES]; MOVES], [0.0; LANES]);
        roll_out(law, &program(state, limits), &mut first, &mut moves, &mut is_clipped);
        moves.map(|lanes| lanes[0])
    }

    /// What the law finds for one program.
    fn solve(law: &Law, state: Vector<2>, limits: [f64; 2]) -> [f64; MOVES] {
        let mut moves = clipped(law, state, limits).map(|w| [w; LANES]);
        descend(law, &program(state, limits), &mut moves);
        moves.map(|lanes| lanes[0])
    }

    /// The exact minimum by coordinate descent, which converges for a strictly convex cost in a box (Luo and Tseng 1992).
    fn exact(law: &Law, state: Vector<2>, [lowest, highest]: [f64; 2]) -> [f64; MOVES] {
        let mut w = [0.0_f64.clamp(lowest, highest); MOVES];
        for _ in 0..20_000 {
            for i in 0..MOVES {
                let slope = dot(&law.hessian[i], &w) + dot(&law.slope[i], &state);
                w[i] = (w[i] - slope / law.hessian[i][i]).clamp(lowest, highest);
            }
        }
        w
    }

    #[test]
    fn law_without_active_limits_the_moves_are_the_regulators() {
        for lag_s in [0.0, 0.1, 0.5] {
            let law = Law::new(&keys(0.0, lag_s), PERIOD_S);
            let state = [2.0, -0.7];
            let best = exact(&law, state, [-1e6, 1e6]);
            let mut x = state;
            for (j, w) in best.iter().enumerate() {
                let wanted = -dot(&law.regulator.gains, &x);
                assert!((w - wanted).abs() < 1e-9, "lag {lag_s} move {j}: {w} for {wanted}");
                let free = apply(&law.step, &x);
                x = std::array::from_fn(|i| free[i] + law.input[i] * w);
            }
            let found = solve(&law, state, [-1e6, 1e6]);
            assert!(found.iter().zip(best).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {best:?}");
        }
    }

    #[test]
    fn law_moves_are_within_the_limits_and_near_the_least_cost() {
        let mut random = Stream::new(7, "programs", "mpc");
        let mut better = 0;
        for lag_s in [0.0, 0.2, 1.0] {
            for error_time_s in [0.1, 1.0, 5.0] {
                let law = Law::new(&MpcKeys { error_time_s, ..keys(0.0, lag_s) }, PERIOD_S);
                let (mut first, mut excess) = (0.0_f64, 0.0_f64);
                for _ in 0..100 {
                    let state = [3.0 * random.normal(), 3.0 * random.normal()];
                    let limits = [-4.0 * random.uniform(), 3.0 * random.uniform()];
                    let (found, best) = (solve(&law, state, limits), exact(&law, state, limits));
                    assert!(found.iter().all(|w| (limits[0]..=limits[1]).contains(w)));
                    let start = clipped(&law, state, limits);
                    let [start, cost, least] = [&start, &found, &best].map(|moves| cost(&law, state, moves));
                    assert!(cost >= least - 1e-9 * least.abs(), "nothing costs less than the least");
                    better += usize::from(start - least > 1e-3 * least.abs() && cost - least < 0.3 * (start - least));
                    first = first.max((found[0] - best[0]).abs());
                    excess = excess.max((cost - least) / least.abs());
                }
                println!(
                    "lag {lag_s} s, T_e {error_time_s} s: first move off by {first:.1e} m/s2, cost by {excess:.1e}"
                );
                assert!(first < 0.05 && excess < 0.01, "lag {lag_s} T_e {error_time_s}: {first} m/s2, {excess}");
            }
        }
        assert!(better > 5, "the descent makes the clipped regulator better where it is not the best: {better}");
    }

    /// What is asked for is the descent's first move, for the state that the vehicle is in, wherever a limit acts.
    #[test]
    fn law_the_command_is_what_the_descent_finds() {
        // With a fast law behind a slow actuator the clipped regulator is far from the best.
        let keys = MpcKeys { error_time_s: 0.1, ..keys(0.0, 1.0) };
        let mut random = Stream::new(9, "commands", "mpc");
        let mut better = 0;
        for _ in 0..200 {
            let mut mpc = law(&keys);
            let (y_mps, ahead_mps2) = (20.0 + 3.0 * random.normal(), 3.0 * random.normal());
            let limits = [-4.0 * random.uniform(), 3.0 * random.uniform()];
            (0..LANES).for_each(|slot| mpc.reset(slot, y_mps));
            mpc.model.ahead_mps2 = [ahead_mps2; LANES];
            (mpc.limits.lowest, mpc.limits.highest) = ([limits[0]; LANES], [limits[1]; LANES]);
            let observation = Observation {
                measured_mps: [y_mps; LANES],
                reference_mps: [20.0; LANES],
                nominal_nm_per_mps2: [500.0; LANES],
                ..Observation::default()
            };
            let mut command = Command::default();
            mpc.command(&observation, &mut command);
            let state = [y_mps - 20.0, ahead_mps2];
            let (found, start) = (solve(&mpc.law, state, limits)[0], clipped(&mpc.law, state, limits)[0]);
            let asked_mps2 = command.torque_nm[0] / 500.0;
            assert!((asked_mps2 - found).abs() < 1e-8, "{state:?} {limits:?}: {asked_mps2} for {found}");
            better += usize::from((found - start).abs() > 1e-3);
        }
        assert!(better > 5, "it differs from the clipped regulator: {better}");
    }

    #[test]
    fn law_the_error_to_be_decays_as_the_regulator_says() {
        // Nothing unknown: each period the predicted error falls by the regulator's gain times a period.
        let keys = keys(0.3, 0.0);
        let (mut mpc, mut plant) = (law(&keys), Plant::new(0.3, 0.0, 0.0, 1.0));
        (0..LANES).for_each(|slot| mpc.reset(slot, 21.0));
        let gain = mpc.law.regulator.gains[0];
        let mut wanted = 1.0;
        for k in 0..500 {
            let e = plant.period(&mut mpc, 20.0, 0.0);
            if k >= 30 {
                assert!((e - wanted).abs() < 1e-9, "period {k}: {e} for {wanted}");
                wanted -= PERIOD_S * gain * wanted;
            }
        }
        assert!(wanted < 0.02);
    }

    #[test]
    fn law_a_constant_force_and_a_ramp_leave_no_error() {
        let keys = keys(0.25, 0.1);
        let (mut mpc, mut plant) = (law(&keys), Plant::new(0.25, 0.1, -0.5, 0.0));
        let mut reference = 5.0;
        for _ in 0..3_000 {
            plant.period(&mut mpc, reference, 0.5);
            reference += PERIOD_S * 0.5;
        }
        assert!(plant.error_mps.abs() < 1e-3, "{}", plant.error_mps);
    }

    #[test]
    fn law_the_limits_are_those_that_were_heard_and_outlive_a_halt() {
        let keys = keys(0.0, 0.0);
        let (mut mpc, mut plant) = (law(&keys), Plant::new(0.0, 0.0, 0.0, 20.0));
        plant.limits_mps2 = [-4.0, 2.0];
        for _ in 0..300 {
            plant.period(&mut mpc, 20.0, 0.0);
        }
        assert_eq!((mpc.limits.lowest[0], mpc.limits.highest[0]), (-4.0, INPUT_MAX_MPS2));
        assert!(plant.asked_mps2 >= -4.0, "once a limit is known, no more is asked for: {}", plant.asked_mps2);
        mpc.rest(0);
        assert_eq!((mpc.limits.lowest[0], mpc.f_hat_mps2(0)), (-4.0, 0.0));
        mpc.reset(0, 3.0);
        assert_eq!((mpc.limits.lowest[0], mpc.motion.y_mps[0]), (-INPUT_MAX_MPS2, 3.0));
    }
}
