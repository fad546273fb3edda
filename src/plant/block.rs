//! The vehicles of a block: their constants, states and inputs in columns.

use super::body::Body;
use super::integrator::Moment;
use super::layout::{FourWheels, Layout};
use super::seven_dof::{CAR_COLUMNS, Car, Drive, sine_and_cosine, slips};
use crate::columns::{Slots, columns};
use crate::lanes::{Flags, LANES, Lanes};
use crate::trig::{self, Libm};

/// Faster than any road vehicle: a body that drives so has diverged [m/s].
pub const FASTEST_MPS: f64 = 200.0;

/// State of motion of one vehicle.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct State {
    /// Longitudinal speed V_x [m/s].
    pub vx_mps: f64,
    /// Lateral speed V_y, positive to the left [m/s].
    pub vy_mps: f64,
    /// Yaw rate ψ̇, positive to the left [rad/s].
    pub yaw_rate_radps: f64,
    /// Wheel speeds: front left, front right, rear left, rear right [rad/s].
    pub wheel_speed_radps: [f64; 4],
}

impl State {
    /// Straight ahead at `vx_mps` with wheels that roll without slip.
    pub fn rolling(body: &Body, vx_mps: f64) -> Self {
        Self { vx_mps, wheel_speed_radps: [vx_mps / body.wheel_radius_m; 4], ..Self::default() }
    }
}

impl Inputs {
    /// The same with more torque [N·m].
    pub fn with_torque(&self, more_nm: &Lanes) -> Self {
        Self { torque_nm: std::array::from_fn(|slot| self.torque_nm[slot] + more_nm[slot]), ..*self }
    }
}

columns! {
    /// What acts on the vehicles of a block during one control period.
    #[derive(Debug, Clone, Copy)]
    #[repr(align(64))]
    pub struct Inputs {
        columns {
            /// Torque C_T on the wheels, sum over the wheels: positive drives, negative brakes [N·m].
            pub torque_nm: f64 = 0.0,
            /// Steer angle δ of the front wheels, positive to the left, within ±π/2 \[rad\].
            pub steer_rad: f64 = 0.0,
            /// Grade, positive uphill, within ±π/2 \[rad\].
            pub grade_rad: f64 = 0.0,
            /// Bank, positive where the road rises to the left, within ±π/2 \[rad\].
            pub bank_rad: f64 = 0.0,
            /// Wind from ahead [m/s].
            pub headwind_mps: f64 = 0.0,
        }
    }
}

/// The constants of the vehicles of a block, which are default cars at first.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
struct Constants {
    cars: [Lanes; CAR_COLUMNS],
    bodies: [Body; LANES],
}

impl Constants {
    fn new() -> Self {
        let bodies = std::array::from_fn(|_| Body::default());
        let mut constants = Self { cars: [[0.0; LANES]; CAR_COLUMNS], bodies };
        (0..LANES).for_each(|slot| constants.clear(slot));
        constants
    }

    fn set(&mut self, slot: usize, body: &Body) {
        Car::new(body).put(&mut self.cars, slot);
        self.bodies[slot] = body.clone();
    }
}

impl Slots for Constants {
    fn clear(&mut self, slot: usize) {
        self.set(slot, &Body::default());
    }
}

columns! {
    /// Constants and states of [`LANES`] vehicles, at first default cars at rest. Columns begin where vectors do.
    #[derive(Debug, Clone)]
    #[repr(C, align(64))]
    pub struct PlantBlock {
        parts {
            constants: Constants = Constants::new(),
            /// Wheel speeds ω, one column per wheel [rad/s].
            pub wheel_speed_radps: [Lanes; 4] = [[0.0; LANES]; 4],
            /// Mean accelerations a_x, a_y of the body over the last substep, which shift the wheel loads [m/s²].
            pub acceleration_mps2: [Lanes; 2] = [[0.0; LANES]; 2],
        }
        columns {
            /// Longitudinal speed V_x [m/s].
            pub vx_mps: f64 = 0.0,
            /// Lateral speed V_y [m/s].
            pub vy_mps: f64 = 0.0,
            /// Yaw rate ψ̇ [rad/s].
            pub yaw_rate_radps: f64 = 0.0,
            /// ∫V_x dt since the vehicle entered \[m\].
            pub distance_m: f64 = 0.0,
        }
    }
}

impl PlantBlock {
    /// Makes a slot another vehicle; its state stays.
    pub fn set_body(&mut self, slot: usize, body: &Body) {
        self.constants.set(slot, body);
    }

    /// The body of a slot.
    pub fn body(&self, slot: usize) -> &Body {
        &self.constants.bodies[slot]
    }

    /// The state of a slot.
    pub fn state(&self, slot: usize) -> State {
        State {
            vx_mps: self.vx_mps[slot],
            vy_mps: self.vy_mps[slot],
            yaw_rate_radps: self.yaw_rate_radps[slot],
            wheel_speed_radps: self.wheel_speed_radps.map(|column| column[slot]),
        }
    }

    /// Puts a slot into `state`, unaccelerated; its distance stays.
    pub fn set_state(&mut self, slot: usize, state: &State) {
        self.vx_mps[slot] = state.vx_mps;
        self.vy_mps[slot] = state.vy_mps;
        self.yaw_rate_radps[slot] = state.yaw_rate_radps;
        for (column, speed) in self.wheel_speed_radps.iter_mut().zip(state.wheel_speed_radps) {
            column[slot] = speed;
        }
        for column in &mut self.acceleration_mps2 {
            column[slot] = 0.0;
        }
    }

    /// All seven states of a slot exactly 0.
    pub fn rest(&mut self, slot: usize) {
        self.set_state(slot, &State::default());
    }

    /// True while every state of the slot is a finite number, and its vehicle not faster than [`FASTEST_MPS`].
    pub fn is_sensible(&self, slot: usize) -> bool {
        let state = self.state(slot);
        let is_slow_enough = state.vx_mps.abs() <= FASTEST_MPS;
        let others = [state.vx_mps, state.vy_mps, state.yaw_rate_radps, self.distance_m[slot]];
        let mut states = others.iter().chain(&state.wheel_speed_radps);
        is_slow_enough && states.all(|value| value.is_finite())
    }

    /// Slip ratios τ of front and rear axle of a slot, mean of left and right, at the steer angle `steer_rad`.
    pub fn slip(&self, slot: usize, steer_rad: f64) -> [f64; 2] {
        let car = self.car(slot);
        let drive = Drive::new(&car, 0.0, 0.0, [steer_rad, 0.0, 0.0].map(sine_and_cosine::<Libm>));
        let slip = slips::<FourWheels>(&car, &drive, &self.moment::<FourWheels>(slot).x).map(|tyre| tyre.slip);
        [0.5 * (slip[0] + slip[1]), 0.5 * (slip[2] + slip[3])]
    }

    /// The constants of a slot as the equations use them.
    #[inline(always)]
    pub(super) fn car(&self, slot: usize) -> Car {
        Car::pick(&self.constants.cars, slot)
    }

    /// The constants of all slots, one column each.
    #[inline(always)]
    pub(super) fn cars(&self) -> &[Lanes; CAR_COLUMNS] {
        &self.constants.cars
    }

    /// The state of a slot as the integrator uses it.
    #[inline(always)]
    pub(super) fn moment<L: Layout>(&self, slot: usize) -> Moment {
        Moment {
            x: L::states(|i| match i {
                0 => self.vx_mps[slot],
                1 => self.vy_mps[slot],
                2 => self.yaw_rate_radps[slot],
                _ => self.wheel_speed_radps[i - 3][slot],
            }),
            acceleration: [self.acceleration_mps2[0][slot], self.acceleration_mps2[1][slot]],
            distance: self.distance_m[slot],
        }
    }

    /// Writes `next` where `moving` is 1; a slot that does not move keeps its bits.
    #[inline(always)]
    pub(super) fn put(&mut self, slot: usize, next: &Moment, moving: f64) {
        let choose = |new: f64, old: f64| trig::choose(moving > 0.0, new, old);
        self.vx_mps[slot] = choose(next.x[0], self.vx_mps[slot]);
        self.vy_mps[slot] = choose(next.x[1], self.vy_mps[slot]);
        self.yaw_rate_radps[slot] = choose(next.x[2], self.yaw_rate_radps[slot]);
        for wheel in 0..4 {
            self.wheel_speed_radps[wheel][slot] = choose(next.x[3 + wheel], self.wheel_speed_radps[wheel][slot]);
        }
        for k in 0..2 {
            self.acceleration_mps2[k][slot] = choose(next.acceleration[k], self.acceleration_mps2[k][slot]);
        }
        self.distance_m[slot] = choose(next.distance, self.distance_m[slot]);
    }
}

/// A model of the vehicles of a block.
pub trait Plant: Send + Sync {
    /// Advances the slots with `moving` = 1 by one control period of `period_s` seconds; the others stay untouched.
    fn advance(&self, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, period_s: f64);
}
