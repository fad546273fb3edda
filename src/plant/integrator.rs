//! One substep of the 7-DoF model: a linearly implicit two-stage method of order 2, and what brakes do at standstill.
//!
//! # The method
//! With any A₁ ≈ A₂ ≈ ∂f/∂x
//! ```text
//! (1 − γhA₁) k = f(x),   (1 − γhA₂) d = f(x + h/2·k) − k,   x⁺ = x + h (k + d)
//! ```
//! is a Rosenbrock W-method of order 2 (k = f + γhA₁f and d = h/2·f′f − γhA₁f up to h²: A drops out of the sum). For an
//! exact A and γ = 1 − 1/√2 it is L-stable. A₁ and A₂ hold the tyres' chords at x and at the middle: a tyre is stiffest
//! at rest, and a chord, unlike the tangent beyond the peak, is never negative.
//!
//! # Wheels
//! A wheel's slip dies out at the rate c r²/I_r, up to 20 000 1/s, and a step has to answer a jump of the torque within
//! itself. With x = h c r²/I_r and q in place of 1 + γx, the method multiplies slip by R = 1 − 2x/q + (x²/2 + x)/q²;
//! R = e^{−x} for q = (1 + x/2)/(1 + √(1 − (1 − e^{−x})(1/2 + 1/x))). As A is free, the wheels take that q, with
//! x/√(2x² + 4x + 12) for the root: then |R − e^{−x}| < 0.0082 for every x, where the constant γ leaves up to 0.2.
//!
//! # The linear systems
//! The wheels do not see each other, so that A is diagonal in them; eliminating them leaves three unknowns. Where a wheel
//! loses momentum the body gains it, in A as in f. Of q only 1/q = (√ + x)/(√ (1 + x/2)) and (1 − 1/q)/x are needed, √ the
//! root of 2x² + 4x + 12: one division for both.

use super::seven_dof::{Car, Drive, Forces, Vector, larger, peaks, rates, road_forces, tyre_forces};
use crate::trig::{Trig, choose};

/// γ = 1 − 1/√2: of the two values that make the method L-stable the one with the smaller error.
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// Below this speed a braked vehicle that moves no other way is held at exact rest [m/s].
pub const HOLD_MPS: f64 = 0.001;

/// Fastest sideways speed and wheel rim [m/s] and yaw rate [rad/s] that count as not moving any other way.
const HOLD_OTHERWISE: f64 = 0.1;

/// What a substep hands on to the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// State of motion.
    pub x: Vector,
    /// Accelerations a_x, a_y of the body for the load transfer of the next substep [m/s²].
    pub acceleration: [f64; 2],
    /// ∫V_x dt \[m\].
    pub distance: f64,
}

/// Advances by one substep of `h` seconds.
pub fn substep<T: Trig>(car: &Car, drive: &Drive, now: &Moment, h: f64) -> Moment {
    let peak = peaks(car, drive, now.acceleration);
    let half = first_stage(car, drive, now, &tyre_forces::<T>(car, drive, &peak, &now.x), h);
    let forces = tyre_forces::<T>(car, drive, &peak, &half.middle(now, h));
    second_stage(car, drive, now, &half, &forces, h)
}

/// What the first stage hands on to the second.
#[derive(Debug, Clone, Copy)]
pub struct Half {
    /// The rates k.
    pub k: Vector,
    /// Torques C_mi − C_fi of the wheels [N·m].
    pub torque: [f64; 4],
    /// 1 for a wheel that turns, 0 for one that its brake holds.
    pub free: [f64; 4],
}

impl Half {
    /// The state x + h/2·k.
    #[inline(always)]
    pub fn middle(&self, now: &Moment, h: f64) -> Vector {
        let mut middle = [0.0; 7];
        for i in 0..7 {
            middle[i] = now.x[i] + 0.5 * h * self.k[i];
        }
        middle
    }
}

/// The first stage, with the tyre forces at the beginning of the substep.
#[inline(always)]
pub fn first_stage(car: &Car, drive: &Drive, now: &Moment, forces: &Forces, h: f64) -> Half {
    let (torque, free) = wheel_torques(car, drive, &now.x, forces);
    let right = rates(car, drive, &now.x, forces, &torque, &free);
    Half { k: solve(car, drive, &now.x, forces, &free, &right, h), torque, free }
}

/// The second stage, with the tyre forces in the middle of the substep; gives its end.
#[inline(always)]
pub fn second_stage(car: &Car, drive: &Drive, now: &Moment, half: &Half, forces: &Forces, h: f64) -> Moment {
    let middle = half.middle(now, h);
    let mut right = rates(car, drive, &middle, forces, &half.torque, &half.free);
    for i in 0..7 {
        right[i] -= half.k[i];
    }
    let d = solve(car, drive, &middle, forces, &half.free, &right, h);
    let mut next = [0.0; 7];
    for i in 0..7 {
        next[i] = now.x[i] + h * (half.k[i] + d[i]);
    }
    finish(car, drive, now, next, h)
}

/// Lets brakes stop what they have turned round, and closes the books of a step of `h` seconds to `next`.
#[inline(always)]
pub fn finish(car: &Car, drive: &Drive, now: &Moment, mut next: Vector, h: f64) -> Moment {
    let x = &now.x;
    for wheel in 0..4 {
        let stops = (drive.brake[wheel / 2] > 0.0) & (next[3 + wheel] * x[3 + wheel] < 0.0);
        next[3 + wheel] = choose(stops, 0.0, next[3 + wheel]);
    }
    let next = hold(car, drive, x, next);
    let per_h = 1.0 / h;
    Moment {
        x: next,
        acceleration: [(next[0] - x[0]) * per_h - next[2] * next[1], (next[1] - x[1]) * per_h + next[2] * next[0]],
        distance: now.distance + 0.5 * h * (x[0] + next[0]),
    }
}

/// Torques C_mi − C_fi of the wheels, and whether they turn. A brake acts against the wheel's turning; a wheel at rest
/// is held as long as the brake outweighs motor and tyre, and otherwise starts against the brake.
#[inline(always)]
pub fn wheel_torques(car: &Car, drive: &Drive, x: &Vector, forces: &Forces) -> ([f64; 4], [f64; 4]) {
    let (mut torque, mut free) = ([0.0; 4], [0.0; 4]);
    for wheel in 0..4 {
        let (motor, brake, speed) = (drive.motor[wheel / 2], drive.brake[wheel / 2], x[3 + wheel]);
        let pull = motor - car.radius * forces.force[wheel];
        let direction = choose(speed == 0.0, pull, speed);
        let held = (brake > 0.0) & (speed == 0.0) & (pull.abs() <= brake);
        torque[wheel] = motor - brake.copysign(direction);
        free[wheel] = choose(held, 0.0, 1.0);
    }
    (torque, free)
}

/// A brake that has stopped the vehicle keeps it: V_x comes to exactly 0, all other states with it, unless gravity and
/// wind pull harder than the brakes hold.
#[inline(always)]
fn hold(car: &Car, drive: &Drive, x: &Vector, mut next: Vector) -> Vector {
    let brake = 2.0 * (drive.brake[0] + drive.brake[1]);
    let crossed = (next[0] * x[0] < 0.0) | (next[0].abs() <= HOLD_MPS);
    let [_, sideways, yaw, fl, fr, rl, rr] = next.map(f64::abs);
    let rim = car.radius * larger(larger(fl, fr), larger(rl, rr));
    let otherwise = larger(larger(sideways, yaw), rim);
    let quiet = otherwise <= HOLD_OTHERWISE;
    let mut still = next;
    still[0] = 0.0;
    let pull = road_forces(car, drive, &still)[0].abs() * car.radius;
    let held = crossed & quiet & (brake > 0.0) & (pull <= brake);
    for value in &mut next {
        *value = choose(held, 0.0, *value);
    }
    next
}

/// Solves (1 − γhA) out = right: eliminates the wheels, solves for the body, and gives the wheels what the hubs add.
#[inline(always)]
fn solve(car: &Car, drive: &Drive, x: &Vector, forces: &Forces, free: &[f64; 4], right: &Vector, h: f64) -> Vector {
    let (mut relief, mut damper, mut push) = ([0.0; 4], [0.0; 4], [0.0; 4]);
    let per_inertia = car.radius * car.per_wheel_inertia;
    for wheel in 0..4 {
        let slope = h * forces.slope[wheel];
        let wheel_answer = fitted(slope * per_inertia * car.radius);
        relief[wheel] = wheel_answer[0];
        // A wheel that its brake holds leaves the stiffness to the body.
        damper[wheel] = slope * choose(free[wheel] > 0.0, wheel_answer[1], GAMMA);
        push[wheel] = car.radius * damper[wheel] * right[3 + wheel];
    }
    let gh = GAMMA * h;
    let axles = drive.axles(car);
    let front = axles[0].dampers([damper[0], damper[1], gh * forces.slope[4]]);
    let rear = axles[1].dampers([damper[2], damper[3], gh * forces.slope[5]]);
    let [xx, xy, yy, x_yaw, y_yaw, yaw_yaw]: [f64; 6] = std::array::from_fn(|k| front[k] + rear[k]);
    // Inertia: V̇_x = ψ̇ V_y, V̇_y = −ψ̇ V_x.
    let m = gh * car.mass;
    let columns = [
        [car.mass + xx, xy + m * x[2], x_yaw],
        [xy - m * x[2], car.mass + yy, y_yaw],
        [x_yaw - m * x[1], y_yaw + m * x[0], car.yaw_inertia + yaw_yaw],
    ];
    let front = axles[0].forces([push[0], push[1], 0.0]);
    let rear = axles[1].forces([push[2], push[3], 0.0]);
    let mass = [car.mass, car.mass, car.yaw_inertia];
    let body = solve_three(&columns, std::array::from_fn(|k| mass[k] * right[k] + (front[k] + rear[k])));
    let [front, rear] = axles.map(|axle| axle.speeds(body).0);
    let hub = [front[0], front[1], rear[0], rear[1]];
    let mut out = [body[0], body[1], body[2], 0.0, 0.0, 0.0, 0.0];
    for wheel in 0..4 {
        out[3 + wheel] = relief[wheel] * right[3 + wheel] + free[wheel] * per_inertia * damper[wheel] * hub[wheel];
    }
    out
}

/// 1/q and γ/q with γ = (q − 1)/x, of the head of this file.
#[inline(always)]
fn fitted(x: f64) -> [f64; 2] {
    let root = (2.0 * x * x + 4.0 * x + 12.0).sqrt();
    let scale = 1.0 / (root * (1.0 + 0.5 * x));
    [(root + x) * scale, (0.5 * root - 1.0) * scale]
}

/// Cramer's rule. The symmetric part of the matrix is positive definite, so that its determinant does not vanish.
#[inline(always)]
fn solve_three([a, b, c]: &[[f64; 3]; 3], right: [f64; 3]) -> [f64; 3] {
    let bc = cross(b, c);
    let scale = 1.0 / dot(a, &bc);
    [dot(&right, &bc) * scale, dot(a, &cross(&right, c)) * scale, dot(a, &cross(b, &right)) * scale]
}

#[inline(always)]
fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_slip_dies_out_as_it_should() {
        for k in 1..100_000 {
            let x = 0.005 * f64::from(k);
            let [relief, share] = fitted(x);
            assert!((relief + x * share - 1.0).abs() < 1e-14, "{x}: q = 1 + xγ");
            let factor = 1.0 - 2.0 * x * relief + (0.5 * x * x + x) * relief * relief;
            assert!((factor - libm::exp(-x)).abs() < 0.0082, "{x}: {factor}");
        }
    }

    #[test]
    fn law_three_equations_are_solved() {
        let columns = [[5.0, 2.0, 0.5], [-1.0, 7.0, -3.0], [0.5, 3.0, 9.0]];
        let right = [1.0, -2.0, 3.0];
        let out = solve_three(&columns, right);
        for (row, want) in right.into_iter().enumerate() {
            let got: f64 = (0..3).map(|k| columns[k][row] * out[k]).sum();
            assert!((got - want).abs() < 1e-14, "{got} against {want}");
        }
    }
}
