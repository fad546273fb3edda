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
//! loses momentum the body gains it, in A as in f.

use super::seven_dof::{Car, Drive, Forces, Vector, across_axis, along_axis, peaks, rates, road_forces, tyre_forces};
use super::trig::{Trig, choose};

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
#[inline(always)]
pub fn substep<T: Trig>(car: &Car, drive: &Drive, now: &Moment, h: f64) -> Moment {
    let x = &now.x;
    let peak = peaks(car, drive, now.acceleration);
    let forces = tyre_forces::<T>(car, drive, &peak, x);
    let (torque, free) = wheel_torques(car, drive, x, &forces);
    let k = System::new(car, drive, x, &forces, &free, h).solve(&rates(car, drive, x, &forces, &torque, &free));
    let mut middle = [0.0; 7];
    for i in 0..7 {
        middle[i] = x[i] + 0.5 * h * k[i];
    }
    let forces = tyre_forces::<T>(car, drive, &peak, &middle);
    let mut right = rates(car, drive, &middle, &forces, &torque, &free);
    for i in 0..7 {
        right[i] -= k[i];
    }
    let d = System::new(car, drive, &middle, &forces, &free, h).solve(&right);
    let mut next = [0.0; 7];
    for i in 0..7 {
        next[i] = x[i] + h * (k[i] + d[i]);
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
    Moment {
        x: next,
        acceleration: [(next[0] - x[0]) / h - next[2] * next[1], (next[1] - x[1]) / h + next[2] * next[0]],
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
        let pull = motor - car.radius * forces.along[wheel].force;
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
    let mut quiet = (next[1].abs() <= HOLD_OTHERWISE) & (next[2].abs() <= HOLD_OTHERWISE);
    for speed in &next[3..] {
        quiet &= (car.radius * speed).abs() <= HOLD_OTHERWISE;
    }
    let mut still = next;
    still[0] = 0.0;
    let pull = road_forces(car, drive, &still)[0].abs() * car.radius;
    let held = crossed & quiet & (brake > 0.0) & (pull <= brake);
    for value in &mut next {
        *value = choose(held, 0.0, *value);
    }
    next
}

/// The matrix 1 − γhA with the wheels eliminated and the rest factorised.
struct System {
    mass: [f64; 3],
    /// 1/q of the wheels.
    relief: [f64; 4],
    /// What the speed of the hub adds to a wheel, and a wheel to the body.
    coupling: [f64; 4],
    lift: [f64; 4],
    axis: [[f64; 3]; 4],
    /// LU factors of the 3×3 body matrix, reciprocal pivots on the diagonal.
    lu: [[f64; 3]; 3],
}

impl System {
    #[inline(always)]
    fn new(car: &Car, drive: &Drive, x: &Vector, forces: &Forces, free: &[f64; 4], h: f64) -> Self {
        let gh = GAMMA * h;
        let mass = [car.mass, car.mass, car.yaw_inertia];
        let mut s = [[0.0; 3]; 3];
        let (mut relief, mut coupling, mut lift, mut axis) = ([0.0; 4], [0.0; 4], [0.0; 4], [[0.0; 3]; 4]);
        let per_inertia = car.radius / car.wheel_inertia;
        for wheel in 0..4 {
            let slope = h * forces.along[wheel].slope;
            // γ of this wheel, (q − 1)/x; a wheel that its brake holds leaves the stiffness to the body.
            let stiff = slope * per_inertia * car.radius;
            let gamma = choose(free[wheel] > 0.0, fitted_gamma(stiff), GAMMA);
            let c = gamma * slope;
            let turn = free[wheel] * per_inertia * c;
            relief[wheel] = 1.0 / (1.0 + turn * car.radius);
            coupling[wheel] = turn * relief[wheel];
            lift[wheel] = c * car.radius * relief[wheel];
            axis[wheel] = along_axis(car, drive, wheel);
            rank_one(&mut s, axis[wheel], c * relief[wheel]);
        }
        for axle in 0..2 {
            rank_one(&mut s, across_axis(car, drive, axle), gh * forces.across[axle].slope);
        }
        // Inertia: V̇_x = ψ̇ V_y, V̇_y = −ψ̇ V_x.
        let m = gh * car.mass;
        s[0][0] += mass[0];
        s[0][1] -= m * x[2];
        s[0][2] -= m * x[1];
        s[1][0] += m * x[2];
        s[1][1] += mass[1];
        s[1][2] += m * x[0];
        s[2][2] += mass[2];
        Self { mass, coupling, relief, lift, axis, lu: factorise(s) }
    }

    #[inline(always)]
    fn solve(&self, right: &Vector) -> Vector {
        let mut b = [0.0; 3];
        for k in 0..3 {
            b[k] = self.mass[k] * right[k];
            for wheel in 0..4 {
                b[k] += self.axis[wheel][k] * self.lift[wheel] * right[3 + wheel];
            }
        }
        let lu = &self.lu;
        b[1] -= lu[1][0] * b[0];
        b[2] -= lu[2][0] * b[0] + lu[2][1] * b[1];
        b[2] *= lu[2][2];
        b[1] = (b[1] - lu[1][2] * b[2]) * lu[1][1];
        b[0] = (b[0] - lu[0][1] * b[1] - lu[0][2] * b[2]) * lu[0][0];
        let mut out = [b[0], b[1], b[2], 0.0, 0.0, 0.0, 0.0];
        for wheel in 0..4 {
            let axis = self.axis[wheel];
            let hub = axis[0] * b[0] + axis[1] * b[1] + axis[2] * b[2];
            out[3 + wheel] = self.relief[wheel] * right[3 + wheel] + self.coupling[wheel] * hub;
        }
        out
    }
}

/// (q − 1)/x of the head of this file.
#[inline(always)]
fn fitted_gamma(x: f64) -> f64 {
    let root = (2.0 * x * x + 4.0 * x + 12.0).sqrt();
    (0.5 * root - 1.0) / (root + x)
}

#[inline(always)]
fn rank_one(s: &mut [[f64; 3]; 3], axis: [f64; 3], weight: f64) {
    for i in 0..3 {
        for j in 0..3 {
            s[i][j] += weight * axis[i] * axis[j];
        }
    }
}

/// LU without pivoting: the symmetric part of the matrix is positive definite, so that no pivot vanishes.
#[inline(always)]
fn factorise(mut s: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    s[0][0] = 1.0 / s[0][0];
    s[1][0] *= s[0][0];
    s[2][0] *= s[0][0];
    s[1][1] -= s[1][0] * s[0][1];
    s[1][2] -= s[1][0] * s[0][2];
    s[1][1] = 1.0 / s[1][1];
    s[2][1] = (s[2][1] - s[2][0] * s[0][1]) * s[1][1];
    s[2][2] -= s[2][0] * s[0][2] + s[2][1] * s[1][2];
    s[2][2] = 1.0 / s[2][2];
    s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_slip_dies_out_as_it_should() {
        for k in 1..100_000 {
            let x = 0.005 * f64::from(k);
            let q = 1.0 + x * fitted_gamma(x);
            let factor = 1.0 - 2.0 * x / q + (0.5 * x * x + x) / (q * q);
            assert!((factor - libm::exp(-x)).abs() < 0.0082, "{x}: {factor}");
        }
    }

    #[test]
    fn law_the_factors_solve_the_system() {
        let s = [[5.0, -1.0, 0.5], [2.0, 7.0, 3.0], [0.5, -3.0, 9.0]];
        let system = System {
            mass: [1.0; 3],
            relief: [1.0; 4],
            coupling: [0.0; 4],
            lift: [0.0; 4],
            axis: [[0.0; 3]; 4],
            lu: factorise(s),
        };
        let right = [1.0, -2.0, 3.0];
        let b = system.solve(&[right[0], right[1], right[2], 0.0, 0.0, 0.0, 0.0]);
        for (row, want) in s.iter().zip(right) {
            let got = row[0] * b[0] + row[1] * b[1] + row[2] * b[2];
            assert!((got - want).abs() < 1e-14, "{got} against {want}");
        }
    }
}
