//! Vehicle bodies in motion. One file per model in `plant/`, one line each in [`PLANTS`].
//!
//! A [`PlantBlock`] holds constants and states of [`LANES`] vehicles in columns. In every control period the fleet
//! calls [`Plant::advance`] with the torques that the actuators let through and the steering of the road.
//! Frames and signs: see [`seven_dof`].

pub mod actuator;
mod axle;
pub mod body;
pub mod integrator;
mod kernel;
mod layout;
mod loops;
pub mod oracle;
mod point_mass;
pub mod seven_dof;
pub mod tyre;

use crate::keys::{Key, Kind, Values};
use crate::lanes::{Flags, LANES, Lanes};
use crate::registry::Entry;
use crate::trig::{self, Libm};
pub use actuator::{Actuated, Actuators};
pub use body::{BODIES, BODY_KEYS, Body};
use integrator::Moment;
pub use kernel::SevenDof;
use layout::{FourWheels, Layout};
use seven_dof::{CAR_COLUMNS, Car, Drive, sine_and_cosine, slips};

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

/// What acts on the vehicles of a block during one control period.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(64))]
pub struct Inputs {
    /// Torque C_T on the wheels, sum over the wheels: positive drives, negative brakes [N·m].
    pub torque_nm: Lanes,
    /// Steer angle δ of the front wheels, positive to the left, within ±π/2 \[rad\].
    pub steer_rad: Lanes,
    /// Grade, positive uphill, within ±π/2 \[rad\].
    pub grade_rad: Lanes,
    /// Bank, positive where the road rises to the left, within ±π/2 \[rad\].
    pub bank_rad: Lanes,
    /// Wind from ahead [m/s].
    pub headwind_mps: Lanes,
}

/// Constants and states of [`LANES`] vehicles; the columns come first and begin where vectors do.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub struct PlantBlock {
    cars: [Lanes; CAR_COLUMNS],
    /// Longitudinal speed V_x [m/s].
    pub vx_mps: Lanes,
    /// Lateral speed V_y [m/s].
    pub vy_mps: Lanes,
    /// Yaw rate ψ̇ [rad/s].
    pub yaw_rate_radps: Lanes,
    /// Wheel speeds ω, one column per wheel [rad/s].
    pub wheel_speed_radps: [Lanes; 4],
    /// ∫V_x dt since [`PlantBlock::reset_distance`] \[m\].
    pub distance_m: Lanes,
    /// Mean accelerations a_x, a_y of the body over the last substep, which shift the wheel loads [m/s²].
    pub acceleration_mps2: [Lanes; 2],
    bodies: [Body; LANES],
}

impl Default for PlantBlock {
    fn default() -> Self {
        Self::new()
    }
}

impl PlantBlock {
    /// Every slot a default car at rest.
    pub fn new() -> Self {
        let body = (BODIES[0].build)();
        let mut block = Self {
            bodies: std::array::from_fn(|_| body.clone()),
            cars: [[0.0; LANES]; CAR_COLUMNS],
            vx_mps: [0.0; LANES],
            vy_mps: [0.0; LANES],
            yaw_rate_radps: [0.0; LANES],
            wheel_speed_radps: [[0.0; LANES]; 4],
            distance_m: [0.0; LANES],
            acceleration_mps2: [[0.0; LANES]; 2],
        };
        for slot in 0..LANES {
            block.set_body(slot, &body);
        }
        block
    }

    /// Makes a slot another vehicle; its state stays.
    pub fn set_body(&mut self, slot: usize, body: &Body) {
        Car::new(body).put(&mut self.cars, slot);
        self.bodies[slot] = body.clone();
    }

    /// The body of a slot.
    pub fn body(&self, slot: usize) -> &Body {
        &self.bodies[slot]
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

    /// Starts a slot's odometer at 0.
    pub fn reset_distance(&mut self, slot: usize) {
        self.distance_m[slot] = 0.0;
    }

    /// True while every state of the slot is a finite number.
    pub fn is_finite(&self, slot: usize) -> bool {
        let state = self.state(slot);
        [state.vx_mps, state.vy_mps, state.yaw_rate_radps, self.distance_m[slot]]
            .iter()
            .chain(&state.wheel_speed_radps)
            .all(|value| value.is_finite())
    }

    /// Slip ratios τ of front and rear axle of a slot, mean of left and right, at the steer angle `steer_rad`.
    pub fn slip(&self, slot: usize, steer_rad: f64) -> [f64; 2] {
        let car = Car::pick(&self.cars, slot);
        let drive = Drive::new(&car, 0.0, 0.0, [steer_rad, 0.0, 0.0].map(sine_and_cosine::<Libm>));
        let slip = slips::<FourWheels>(&car, &drive, &self.moment::<FourWheels>(slot).x).map(|tyre| tyre.slip);
        [0.5 * (slip[0] + slip[1]), 0.5 * (slip[2] + slip[3])]
    }

    #[inline(always)]
    fn moment<L: Layout>(&self, lane: usize) -> Moment {
        Moment {
            x: L::states(|i| match i {
                0 => self.vx_mps[lane],
                1 => self.vy_mps[lane],
                2 => self.yaw_rate_radps[lane],
                _ => self.wheel_speed_radps[i - 3][lane],
            }),
            acceleration: [self.acceleration_mps2[0][lane], self.acceleration_mps2[1][lane]],
            distance: self.distance_m[lane],
        }
    }

    /// Writes `next` where `moving` is 1; a slot that does not move keeps its bits.
    #[inline(always)]
    fn put(&mut self, lane: usize, next: &Moment, moving: f64) {
        let choose = |new: f64, old: f64| trig::choose(moving > 0.0, new, old);
        self.vx_mps[lane] = choose(next.x[0], self.vx_mps[lane]);
        self.vy_mps[lane] = choose(next.x[1], self.vy_mps[lane]);
        self.yaw_rate_radps[lane] = choose(next.x[2], self.yaw_rate_radps[lane]);
        for wheel in 0..4 {
            self.wheel_speed_radps[wheel][lane] = choose(next.x[3 + wheel], self.wheel_speed_radps[wheel][lane]);
        }
        for k in 0..2 {
            self.acceleration_mps2[k][lane] = choose(next.acceleration[k], self.acceleration_mps2[k][lane]);
        }
        self.distance_m[lane] = choose(next.distance, self.distance_m[lane]);
    }
}

/// A model of the vehicles of a block.
pub trait Plant: Send + Sync {
    /// Advances the slots with `moving` = 1 by one control period of `period_s` seconds; the others stay untouched.
    fn advance(&self, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, period_s: f64);
}

/// Builds a plant from the checked values of its keys.
pub type BuildPlant = fn(&Values) -> Box<dyn Plant>;

/// The plants that can be chosen by name.
pub static PLANTS: &[Entry<BuildPlant>] = &[
    Entry {
        name: "seven_dof",
        summary: "7 degrees of freedom: V_x, V_y, yaw rate and four wheels with Magic Formula tyres",
        keys: &[Key {
            name: "substep_s",
            kind: Kind::Number { unit: "s", min: 1e-5, max: 0.01 },
            default: "0.01",
            help: "largest integration step; a control period is divided evenly",
        }],
        build: |values| Box::new(SevenDof::new(values.number("substep_s"))),
    },
    Entry {
        name: "reference",
        summary: "the 7-DoF model integrated implicitly to a tolerance: slow, to measure the others against",
        keys: &[Key {
            name: "tolerance",
            kind: Kind::Number { unit: "m/s", min: 1e-12, max: 1e-3 },
            default: "1e-8",
            help: "largest error of one integration step",
        }],
        build: |values| Box::new(oracle::Reference::new(values.number("tolerance"))),
    },
    Entry {
        name: "point_mass",
        summary: "a point on a line: mass, torque, slope, drag and brakes, no tyres",
        keys: &[],
        build: |_| Box::new(point_mass::PointMass),
    },
];
