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
//! itself. With x = h c r²/I_r and q in place of 1 + γx, the method multiplies slip by R = 1 − 2x/q + (x²/2 + x)/q². As A is
//! free, the wheels take q = (1 + ax + γcx²)/(1 + cx), of which a and c make the largest difference of R to e^{−x} as small as
//! they can: 0.0065, where the constant γ leaves up to 0.2. For large x it is the γ of L-stability again.
//!
//! # The linear systems
//! The wheels do not see each other, so that A is diagonal in them; eliminating them leaves three unknowns. Where a wheel
//! loses momentum the body gains it, in A as in f. Of q only 1/q and (1 − 1/q)/x are needed: one division for both.

use super::layout::{FourWheels, Layout};
use super::seven_dof::{Car, Drive, Forces, Vector, larger, peaks, rates, road_forces, tyre_forces};
use crate::trig::{Trig, choose};

/// γ = 1 − 1/√2: of the two values that make the method L-stable the one with the smaller error.
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// a, c and γc of the wheels' q.
const FIT_A: f64 = 0.5311;
const FIT_C: f64 = 0.3511;
const FIT_B: f64 = GAMMA * FIT_C;

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

/// Advances any vehicle by one substep of `h` seconds.
pub fn substep<T: Trig>(car: &Car, drive: &Drive, now: &Moment, h: f64) -> Moment {
    let peak = peaks::<FourWheels>(car, drive, now.acceleration);
    let half = first_stage::<FourWheels>(car, drive, now, &tyre_forces::<T>(car, drive, &peak, &now.x), h);
    let middle = half.middle::<FourWheels>(now, h);
    second_stage::<FourWheels>(car, drive, now, &half, &tyre_forces::<T>(car, drive, &peak, &middle), h)
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
    pub fn middle<L: Layout>(&self, now: &Moment, h: f64) -> Vector {
        L::states(|i| now.x[i] + 0.5 * h * self.k[i])
    }
}

/// The first stage, with the tyre forces at the beginning of the substep.
#[inline(always)]
pub fn first_stage<L: Layout>(car: &Car, drive: &Drive, now: &Moment, forces: &Forces, h: f64) -> Half {
    let (torque, free) = wheel_torques::<L>(car, drive, &now.x, forces);
    let right = rates::<L>(car, drive, &now.x, forces, &torque, &free);
    Half { k: solve::<L>(car, drive, &now.x, forces, &free, &right, h), torque, free }
}

/// The second stage, with the tyre forces in the middle of the substep; gives its end.
#[inline(always)]
pub fn second_stage<L: Layout>(car: &Car, drive: &Drive, now: &Moment, half: &Half, forces: &Forces, h: f64) -> Moment {
    let middle = half.middle::<L>(now, h);
    let rates = rates::<L>(car, drive, &middle, forces, &half.torque, &half.free);
    let right = L::states(|i| rates[i] - half.k[i]);
    let d = solve::<L>(car, drive, &middle, forces, &half.free, &right, h);
    finish::<L>(car, drive, now, L::states(|i| now.x[i] + h * (half.k[i] + d[i])), h)
}

/// Lets brakes stop what they have turned round, and closes the books of a step of `h` seconds to `next`.
#[inline(always)]
pub fn finish<L: Layout>(car: &Car, drive: &Drive, now: &Moment, next: Vector, h: f64) -> Moment {
    let x = &now.x;
    let next = L::states(|i| {
        let stops = (i >= 3) && (drive.brake[(i - 3) / 2] > 0.0) & (next[i] * x[i] < 0.0);
        choose(stops, 0.0, next[i])
    });
    let next = hold::<L>(car, drive, x, next);
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
pub fn wheel_torques<L: Layout>(car: &Car, drive: &Drive, x: &Vector, forces: &Forces) -> ([f64; 4], [f64; 4]) {
    let wheels = L::wheels(|wheel| {
        let (motor, brake, speed) = (drive.motor[wheel / 2], drive.brake[wheel / 2], x[3 + wheel]);
        let pull = motor - car.radius * forces.force[wheel];
        let direction = choose(speed == 0.0, pull, speed);
        let held = (brake > 0.0) & (speed == 0.0) & (pull.abs() <= brake);
        [motor - brake.copysign(direction), choose(held, 0.0, 1.0)]
    });
    (wheels.map(|w| w[0]), wheels.map(|w| w[1]))
}

/// A brake that has stopped the vehicle keeps it: V_x comes to exactly 0, all other states with it, unless gravity and
/// wind pull harder than the brakes hold.
#[inline(always)]
fn hold<L: Layout>(car: &Car, drive: &Drive, x: &Vector, next: Vector) -> Vector {
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
    L::states(|i| choose(held, 0.0, next[i]))
}

/// Solves (1 − γhA) out = right: eliminates the wheels, solves for the body, and gives the wheels what the hubs add.
#[inline(always)]
fn solve<L: Layout>(
    car: &Car,
    drive: &Drive,
    x: &Vector,
    forces: &Forces,
    free: &[f64; 4],
    right: &Vector,
    h: f64,
) -> Vector {
    let per_inertia = car.radius * car.per_wheel_inertia;
    let wheels = L::wheels(|wheel| {
        let slope = h * forces.slope[wheel];
        let [relief, share] = fitted(slope * per_inertia * car.radius);
        // A wheel that its brake holds leaves the stiffness to the body.
        let damper = slope * choose(free[wheel] > 0.0, share, GAMMA);
        [relief, damper, car.radius * damper * right[3 + wheel]]
    });
    let (relief, damper, push) = (wheels.map(|w| w[0]), wheels.map(|w| w[1]), wheels.map(|w| w[2]));
    let gh = GAMMA * h;
    let axles = drive.axles::<L>(car);
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
    let forces = std::array::from_fn(|k| mass[k] * right[k] + (front[k] + rear[k]));
    let body = if L::AHEAD { [forces[0] * (1.0 / columns[0][0]), 0.0, 0.0] } else { solve_three(&columns, forces) };
    let [front, rear] = axles.map(|axle| axle.speeds(body).0);
    let hub = [front[0], front[1], rear[0], rear[1]];
    L::states(|i| match i.checked_sub(3) {
        None => body[i],
        Some(wheel) => relief[wheel] * right[i] + free[wheel] * per_inertia * damper[wheel] * hub[wheel],
    })
}

/// 1/q and γ/q with γ = (q − 1)/x, of the head of this file.
#[inline(always)]
fn fitted(x: f64) -> [f64; 2] {
    let scale = 1.0 / (1.0 + x * (FIT_A + FIT_B * x));
    [(1.0 + FIT_C * x) * scale, ((FIT_A - FIT_C) + FIT_B * x) * scale]
}

/// Eliminates the first unknown, then Cramer's rule: what hangs together with nothing else (V_x, straight ahead) is only divided. The
/// symmetric part of the matrix is positive definite, so that neither the first pivot nor the determinant vanishes.
#[inline(always)]
fn solve_three([a, b, c]: &[[f64; 3]; 3], right: [f64; 3]) -> [f64; 3] {
    let per_pivot = 1.0 / a[0];
    let (second, third) = (a[1] * per_pivot, a[2] * per_pivot);
    let (b1, c1, right1) = (b[1] - second * b[0], c[1] - second * c[0], right[1] - second * right[0]);
    let (b2, c2, right2) = (b[2] - third * b[0], c[2] - third * c[0], right[2] - third * right[0]);
    let scale = 1.0 / (b1 * c2 - c1 * b2);
    let (y, z) = ((right1 * c2 - c1 * right2) * scale, (b1 * right2 - b2 * right1) * scale);
    [(right[0] - (b[0] * y + c[0] * z)) * per_pivot, y, z]
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
            assert!((factor - libm::exp(-x)).abs() < 0.0065, "{x}: {factor}");
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

    /// Without tyres a body's rates are those of the frame that turns with it, and A is exactly their derivative.
    #[test]
    fn law_the_turning_frame_is_in_the_system_with_its_whole_derivative() {
        let car = Car::new(&crate::plant::Body::default());
        let drive = Drive::new(&car, 0.0, 0.0, [[0.0, 1.0]; 3]);
        let (none, still) = (Forces { force: [0.0; 6], slope: [0.0; 6] }, [0.0; 4]);
        let rate = |x: &Vector| rates::<FourWheels>(&car, &drive, x, &none, &still, &still);
        let (x, h) = ([30.0, -2.0, 0.5, 0.0, 0.0, 0.0, 0.0], 0.01);
        let right = [1.0, -2.0, 0.3, 0.0, 0.0, 0.0, 0.0];
        let out = solve::<FourWheels>(&car, &drive, &x, &none, &still, &right, h);
        let [ahead, behind] = [0.5, -0.5].map(|s| rate(&std::array::from_fn(|i| x[i] + s * out[i])));
        for i in 0..3 {
            let left = out[i] - GAMMA * h * (ahead[i] - behind[i]);
            assert!((left - right[i]).abs() < 1e-12, "equation {i}: {left} instead of {}", right[i]);
        }
    }
}
