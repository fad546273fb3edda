//! The 7-DoF model again, integrated slowly and as exactly as asked for: the reference that the fast integrator is
//! measured against. Same equations, from the `libm` crate; nothing else is shared with [`super::integrator`] but what
//! brakes do at standstill.
//!
//! Two-stage Radau IIA, order 3, L-stable: with x_j = x + z_j and the nodes 1/3 and 1
//! ```text
//! z = h (A ⊗ 1) f(x + z),   A = [5/12 −1/12; 3/4 1/4],   x⁺ = x + z₂
//! ```
//! by simplified Newton with the full 7×7 Jacobian from central differences. Each step is compared with two of half its
//! length and its length chosen by what that shows; a step in which a brake stops a wheel is shortened until it ends
//! there.

use nalgebra::{SMatrix, SVector};

use super::block::{Inputs, Plant, PlantBlock};
use super::integrator::{HOLD_MPS, Moment, finish, wheel_torques};
use super::kernel::acting;
use super::layout::FourWheels;
use super::seven_dof::{Car, Drive, Vector, peaks, rates, tyre_forces};
use crate::lanes::{Flags, LANES};
use crate::trig::Libm;

/// The shortest step \[s\]; what still disagrees there is a kink of the model, not an error.
const SHORTEST_S: f64 = 1e-7;

type Matrix7 = SMatrix<f64, 7, 7>;
type Stages = SVector<f64, 14>;

/// The implicit reference.
#[derive(Debug, Clone, Copy)]
pub struct Reference {
    /// Largest difference of a step to two half steps [m/s, rad/s·m].
    tolerance: f64,
}

impl Reference {
    /// With steps that err by at most `tolerance` (in m/s, wheel speeds times radius).
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance }
    }

    /// One vehicle over one period, during which nothing that acts on it changes.
    fn period(&self, car: &Car, drive: &Drive, start: Moment, period_s: f64) -> Moment {
        let (mut now, mut left, mut h) = (start, period_s, period_s);
        while left > 0.0 {
            let last = h >= left;
            h = if last { left } else { h };
            let whole = step(car, drive, &now, h);
            let halves = step(car, drive, &now, 0.5 * h).and_then(|half| step(car, drive, &half, 0.5 * h));
            let error = match (&whole, &halves) {
                (Some(a), Some(b)) => distance(car, &a.x, &b.x),
                _ => f64::INFINITY,
            };
            if (error <= self.tolerance || h <= SHORTEST_S)
                && let Some(next) = halves.or(whole)
            {
                now = next;
                left = if last { 0.0 } else { left - h };
                h *= (0.9 * libm::sqrt(libm::sqrt(self.tolerance / error.max(1e-300)))).clamp(0.2, 4.0);
            } else if h <= SHORTEST_S {
                return Moment { x: [f64::NAN; 7], ..now };
            } else {
                h *= 0.3;
            }
        }
        now
    }
}

impl Plant for Reference {
    fn advance(&self, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, period_s: f64) {
        for lane in (0..LANES).filter(|&lane| moving[lane] > 0.0) {
            let (car, drive) = acting(block, inputs, lane);
            let next = self.period(&car, &drive, block.moment::<FourWheels>(lane), period_s);
            block.put(lane, &next, 1.0);
        }
    }
}

/// Largest difference of two states in m/s.
fn distance(car: &Car, a: &Vector, b: &Vector) -> f64 {
    let scale = [1.0, 1.0, 1.0, car.radius, car.radius, car.radius, car.radius];
    (0..7).map(|k| scale[k] * (a[k] - b[k]).abs()).fold(0.0, f64::max)
}

/// One Radau step; `None` if Newton fails or an event lies inside a step that can still be shortened.
fn step(car: &Car, drive: &Drive, now: &Moment, h: f64) -> Option<Moment> {
    let peak = peaks::<FourWheels>(car, drive, now.acceleration);
    let start = tyre_forces::<Libm>(car, drive, &peak, &now.x);
    let (torque, free) = wheel_torques::<FourWheels>(car, drive, &now.x, &start);
    let f = |x: &SVector<f64, 7>| {
        let x = Vector::from(*x);
        SVector::from(rates::<FourWheels>(car, drive, &x, &tyre_forces::<Libm>(car, drive, &peak, &x), &torque, &free))
    };
    let x = SVector::from(now.x);
    let z = newton(&f, &x, h)?;
    let next = Vector::from(x + z.fixed_rows::<7>(7));
    let stops = (0..4).any(|w| drive.brake[w / 2] > 0.0 && next[3 + w] * now.x[3 + w] < 0.0);
    let passes = drive.brake[0] + drive.brake[1] > 0.0 && next[0] < -HOLD_MPS && now.x[0] > 0.0;
    if (stops || passes) && h > SHORTEST_S { None } else { Some(finish::<FourWheels>(car, drive, now, next, h)) }
}

/// Solves for the stages z.
fn newton(f: &dyn Fn(&SVector<f64, 7>) -> SVector<f64, 7>, x: &SVector<f64, 7>, h: f64) -> Option<Stages> {
    const A: [[f64; 2]; 2] = [[5.0 / 12.0, -1.0 / 12.0], [0.75, 0.25]];
    let jacobian = jacobian(f, x);
    let mut system = SMatrix::<f64, 14, 14>::identity();
    for (i, row) in A.iter().enumerate() {
        for (j, a) in row.iter().enumerate() {
            let mut block = system.fixed_view_mut::<7, 7>(7 * i, 7 * j);
            block -= jacobian * (h * a);
        }
    }
    let lu = system.lu();
    let mut z = Stages::zeros();
    for _ in 0..25 {
        let rates = [f(&(x + z.fixed_rows::<7>(0))), f(&(x + z.fixed_rows::<7>(7)))];
        let mut residual = -z;
        for (i, row) in A.iter().enumerate() {
            let mut part = residual.fixed_rows_mut::<7>(7 * i);
            part += (rates[0] * row[0] + rates[1] * row[1]) * h;
        }
        let change = lu.solve(&residual)?;
        z += change;
        if change.amax() < 1e-12 * (1.0 + x.amax()) {
            return Some(z);
        }
    }
    None
}

/// ∂f/∂x by central differences.
fn jacobian(f: &dyn Fn(&SVector<f64, 7>) -> SVector<f64, 7>, x: &SVector<f64, 7>) -> Matrix7 {
    let mut matrix = Matrix7::zeros();
    for k in 0..7 {
        let step = 1e-7 * (1.0 + x[k].abs());
        let (mut up, mut down) = (*x, *x);
        up[k] += step;
        down[k] -= step;
        matrix.set_column(k, &((f(&up) - f(&down)) / (up[k] - down[k])));
    }
    matrix
}
