//! The 7-DoF model of Polack et al. 2017, §4.1: V_x, V_y, ψ̇ and four wheel speeds, Magic Formula tyres both ways.
//!
//! # Frames and signs
//! ISO 8855: x forward, y left, z up; ψ̇ and the steer angle δ positive to the left. Wheels: front left, front right,
//! rear left, rear right. Wheel i sits at (x_i, y_i), x = l_f or −l_r, y = ±w/2. A front wheel's plane is turned by δ, so
//! that with e = (cos δ, sin δ) along it and n = (−sin δ, cos δ) to its left
//! ```text
//! hub speed along the wheel   V_i = e·(V_x − y_i ψ̇, V_y + x_i ψ̇)
//! slip ratio                  τ_i = (r ω_i − V_i)/max(|r ω_i|, |V_i|), within ±1
//! slip angle of an axle       α   = atan(−n·v/|e·v|), v = (V_x, V_y + x ψ̇): δ − atan2(V_y + x ψ̇, V_x) for V_x > 0
//! tyre forces                 F_xp,i = D_i·shape(τ_i),  F_yp,i = g·D_i·shape(α),  D_i = μ_i F_z,i,  g = 1 unless the body says so
//! M (V̇_x − ψ̇ V_y) = ΣF_x                                                    (paper, eq. 12)
//! M (V̇_y + ψ̇ V_x) = ΣF_y                                                    (eq. 13)
//! I_z ψ̈ = l_f F_yf − l_r F_yr − Σ y_i F_x,i                                    (eq. 14; the sum is 0 for w = 0)
//! I_r ω̇_i = C_mi − C_fi − r F_xp,i                                             (eq. 15)
//! ```
//! The paper's slip ratio names V_x; it is the hub's speed along the wheel, which only a steered wheel tells apart, and
//! with it no tyre can feed energy into the body. The one formula for τ equals the paper's two: the larger of |rω| and
//! |V| is the denominator of each. Both denominators have the floor [`FLOOR_MPS`], below which a tyre acts like a
//! damper: standstill is an equilibrium, at any steer angle.
//!
//! Everything here is about one vehicle, in pieces between which `loops.rs` can stop: slips, what they make of the
//! tyres ([`Grip`]), forces, rates.

use super::axle::Axle;
use super::body::{Body, GRAVITY_MPS2};
use super::layout::{FourWheels, Layout};
use super::tyre::Tyre;
use crate::lanes::Lanes;
use crate::trig::{Trig, choose};

/// Smallest speed in the denominators of slip ratio and slip angle [m/s].
pub const FLOOR_MPS: f64 = 0.3;

/// V_x [m/s], V_y [m/s], ψ̇ [rad/s], ω of the four wheels [rad/s].
pub type Vector = [f64; 7];

/// The constants of one vehicle as the equations use them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Car {
    /// M \[kg\].
    pub mass: f64,
    /// I_z [kg·m²].
    pub yaw_inertia: f64,
    /// 1/M.
    pub per_mass: f64,
    /// 1/I_z.
    pub per_yaw_inertia: f64,
    /// 1/I_r.
    pub per_wheel_inertia: f64,
    /// l_f, −l_r: x of the axles \[m\].
    pub axle_x: [f64; 2],
    /// w/2 \[m\].
    pub half_track: f64,
    /// r \[m\].
    pub radius: f64,
    /// Longitudinal shape of front and rear tyres.
    pub longitudinal: [Tyre; 2],
    /// Lateral shape of front and rear tyres.
    pub lateral: [Tyre; 2],
    /// μ of the wheels.
    pub friction: [f64; 4],
    /// Static F_z of one front and one rear wheel \[N\].
    pub load: [f64; 2],
    /// Load that moves from each front to each rear wheel per a_x [N per m/s²].
    pub pitch_transfer: f64,
    /// Load that moves from left to right per a_y, front and rear axle [N per m/s²].
    pub roll_transfer: [f64; 2],
    /// Share of driving torque on one front, one rear wheel.
    pub drive_share: [f64; 2],
    /// Share of braking torque on one front, one rear wheel.
    pub brake_share: [f64; 2],
    /// ρ C_d A/2 [N per (m/s)²].
    pub drag: f64,
    /// Rolling resistance f_R·M·g \[N\].
    pub rolling: f64,
    /// 1 with the friction ellipse, 0 without.
    pub ellipse: f64,
    /// Lateral peak over longitudinal peak.
    pub lateral_grip: f64,
}

/// Number of columns that hold a [`Car`].
pub const CAR_COLUMNS: usize = 38;

/// Where among them some of them are, or begin.
const TYRES: usize = 23;
const ELLIPSE: usize = 8;
const HALF_TRACK: usize = 2;
const FRICTION: usize = 19;

impl Car {
    /// What the equations need of a body.
    pub fn new(body: &Body) -> Self {
        let load = body.static_load_n();
        let weight = body.mass_kg * GRAVITY_MPS2;
        let per_track = if body.track_width_m > 0.0 { body.cg_height_m / body.track_width_m } else { 0.0 };
        Self {
            mass: body.mass_kg,
            yaw_inertia: body.yaw_inertia_kgm2,
            per_mass: 1.0 / body.mass_kg,
            per_yaw_inertia: 1.0 / body.yaw_inertia_kgm2,
            per_wheel_inertia: 1.0 / body.wheel_inertia_kgm2,
            axle_x: [body.front_axle_m, -body.rear_axle_m],
            half_track: 0.5 * body.track_width_m,
            radius: body.wheel_radius_m,
            longitudinal: body.longitudinal,
            lateral: body.lateral,
            friction: body.friction,
            load: [load[0], load[2]],
            pitch_transfer: 0.5 * body.mass_kg * body.cg_height_m / body.wheelbase_m(),
            roll_transfer: [load[0], load[2]].map(|f| 2.0 * f / GRAVITY_MPS2 * per_track),
            drive_share: [0.5 * body.drive_front_share, 0.5 * (1.0 - body.drive_front_share)],
            brake_share: [0.5 * body.brake_front_share, 0.5 * (1.0 - body.brake_front_share)],
            drag: body.drag_ns2pm2(),
            rolling: body.rolling_resistance * weight,
            ellipse: if body.combined_slip { 1.0 } else { 0.0 },
            lateral_grip: body.lateral_grip,
        }
    }

    /// Writes this car into its lane of the columns.
    pub fn put(&self, columns: &mut [Lanes; CAR_COLUMNS], lane: usize) {
        let tyres = self.longitudinal.iter().chain(&self.lateral).flat_map(|t| [t.b, t.c, t.e]);
        let values = [self.mass, self.yaw_inertia, self.half_track, self.radius, self.per_wheel_inertia]
            .into_iter()
            .chain([self.pitch_transfer, self.drag, self.rolling, self.ellipse])
            .chain(self.axle_x)
            .chain(self.load)
            .chain(self.roll_transfer)
            .chain(self.drive_share)
            .chain(self.brake_share)
            .chain(self.friction)
            .chain(tyres)
            .chain([self.lateral_grip, self.per_mass, self.per_yaw_inertia]);
        for (column, value) in columns.iter_mut().zip(values) {
            column[lane] = value;
        }
    }

    /// The tyre of a wheel, or of an axle across, in the order of [`slips`].
    #[inline(always)]
    pub fn tyre(&self, i: usize) -> &Tyre {
        if i < 4 { &self.longitudinal[i / 2] } else { &self.lateral[i - 4] }
    }

    /// B, C and E of [`Car::tyre`] among the columns.
    #[inline(always)]
    pub fn tyre_columns(columns: &[Lanes; CAR_COLUMNS], i: usize) -> [&Lanes; 3] {
        let first = TYRES + 3 * if i < 4 { i / 2 } else { i - 2 };
        [&columns[first], &columns[first + 1], &columns[first + 2]]
    }

    /// The column of [`Car::ellipse`].
    #[inline(always)]
    pub fn ellipse_column(columns: &[Lanes; CAR_COLUMNS]) -> &Lanes {
        &columns[ELLIPSE]
    }

    /// The columns of [`Car::half_track`] and [`Car::friction`].
    #[inline(always)]
    pub fn sides(columns: &[Lanes; CAR_COLUMNS]) -> (&Lanes, [&Lanes; 4]) {
        (&columns[HALF_TRACK], std::array::from_fn(|wheel| &columns[FRICTION + wheel]))
    }

    /// Reads a car back from its lane of the columns.
    #[inline(always)]
    pub fn pick(columns: &[Lanes; CAR_COLUMNS], lane: usize) -> Self {
        let pair = |k: usize| [columns[k][lane], columns[k + 1][lane]];
        let tyre = |k: usize| Tyre { b: columns[k][lane], c: columns[k + 1][lane], e: columns[k + 2][lane] };
        Self {
            mass: columns[0][lane],
            yaw_inertia: columns[1][lane],
            half_track: columns[HALF_TRACK][lane],
            radius: columns[3][lane],
            per_wheel_inertia: columns[4][lane],
            pitch_transfer: columns[5][lane],
            drag: columns[6][lane],
            rolling: columns[7][lane],
            ellipse: columns[ELLIPSE][lane],
            axle_x: pair(9),
            load: pair(11),
            roll_transfer: pair(13),
            drive_share: pair(15),
            brake_share: pair(17),
            friction: std::array::from_fn(|wheel| columns[FRICTION + wheel][lane]),
            longitudinal: [tyre(TYRES), tyre(TYRES + 3)],
            lateral: [tyre(TYRES + 6), tyre(TYRES + 9)],
            lateral_grip: columns[35][lane],
            per_mass: columns[36][lane],
            per_yaw_inertia: columns[37][lane],
        }
    }
}

/// Sine and cosine of an angle within ±π/2. By the square root, cos 0 is exactly 1.
#[inline(always)]
pub fn sine_and_cosine<T: Trig>(angle: f64) -> [f64; 2] {
    let sine = T::sin(angle);
    [sine, (1.0 - sine * sine).sqrt()]
}

/// What acts on one vehicle, constant over a control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// cos δ, sin δ.
    pub steer: [f64; 2],
    /// Driving torque on one front, one rear wheel, ≥ 0 [N·m].
    pub motor: [f64; 2],
    /// Braking torque on one front, one rear wheel, ≥ 0 [N·m].
    pub brake: [f64; 2],
    /// Gravity along x and y on grade and bank [m/s²].
    pub gravity: [f64; 2],
    /// Gravity's share across the road, cos(grade)·cos(bank).
    pub load_scale: f64,
    /// Wind from ahead [m/s].
    pub headwind: f64,
}

impl Drive {
    /// Splits the torque C_T over the axles and turns the angles of the road, given as sine and cosine, into forces.
    ///
    /// Grade is positive uphill; bank is positive where the road rises to the left. All angles within ±π/2.
    #[inline(always)]
    pub fn new(car: &Car, torque: f64, headwind: f64, [steer, grade, bank]: [[f64; 2]; 3]) -> Self {
        let motor = larger(torque, 0.0);
        let brake = larger(-torque, 0.0);
        Self {
            steer: [steer[1], steer[0]],
            motor: car.drive_share.map(|share| share * motor),
            brake: car.brake_share.map(|share| share * brake),
            gravity: [-GRAVITY_MPS2 * grade[0], -GRAVITY_MPS2 * bank[0] * grade[1]],
            load_scale: grade[1] * bank[1],
            headwind,
        }
    }

    /// The axles of a car that steers so.
    #[inline(always)]
    pub fn axles<L: Layout>(&self, car: &Car) -> [Axle; 2] {
        let steer = if L::AHEAD { None } else { Some(self.steer) };
        [Axle::new(car.axle_x[0], car.half_track, steer), Axle::new(car.axle_x[1], car.half_track, None)]
    }
}

/// Peak force D_i = μ_i F_z,i of the wheels \[N\] with the load transfer of the accelerations (a_x, a_y) and of gravity
/// on grade and bank [m/s²].
#[inline(always)]
pub fn peaks<L: Layout>(car: &Car, drive: &Drive, acceleration: [f64; 2]) -> [f64; 4] {
    let static_load = car.load.map(|load| load * drive.load_scale);
    // A wheel that has lifted gives no more: neither axle nor side bears more than all the weight there is.
    let pitch = car.pitch_transfer * (acceleration[0] - drive.gravity[0]);
    let pitch = larger(-static_load[1], smaller(static_load[0], pitch));
    let axle_load = [static_load[0] - pitch, static_load[1] + pitch];
    L::wheels(|wheel| {
        let load = axle_load[wheel / 2];
        let roll = within(car.roll_transfer[wheel / 2] * (acceleration[1] - drive.gravity[1]), load);
        car.friction[wheel] * if wheel.is_multiple_of(2) { load - roll } else { load + roll }
    })
}

/// The slip of one tyre.
#[derive(Debug, Clone, Copy, Default)]
pub struct Slip {
    /// Slip ratio of a wheel, tangent of the slip angle of an axle.
    pub slip: f64,
    /// 1/slip speed [s/m], or 0 where hardly anything slips.
    pub per_speed: f64,
    /// Where hardly anything slips the chord of the tyre's shape, BC/scale [s/m], else 0.
    pub limit: f64,
}

/// Forces of all tyres, in tyre axes: of the wheels along, then of the axles across.
#[derive(Debug, Clone, Copy)]
pub struct Forces {
    /// The forces \[N\].
    pub force: [f64; 6],
    /// Their chords over the slip speeds that cause them, ≥ 0 [N per m/s].
    pub slope: [f64; 6],
}

/// The larger of two numbers, in one instruction.
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    choose(a > b, a, b)
}

/// The smaller of two numbers.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    choose(a < b, a, b)
}

/// The number, or the limit (≥ 0) on its side of zero.
#[inline(always)]
fn within(a: f64, limit: f64) -> f64 {
    choose(a.abs() > limit, limit.copysign(a), a)
}

/// Slip of the tyres in state `x`: of the wheels along, then of the axles across. A tyre that does not slip at all has +0.
#[inline(always)]
pub fn slips<L: Layout>(car: &Car, drive: &Drive, x: &Vector) -> [Slip; 6] {
    let [front, rear] = drive.axles::<L>(car);
    let v = [x[0], x[1], x[2]];
    let ([fl, fr, f], ahead) = front.speeds(v);
    let ([rl, rr, r], back) = rear.speeds(v);
    let hub = [fl, fr, rl, rr, ahead, back];
    let rim = [car.radius * x[3], car.radius * x[4], car.radius * x[5], car.radius * x[6], 0.0, 0.0];
    let speed = [rim[0] - hub[0], rim[1] - hub[1], rim[2] - hub[2], rim[3] - hub[3], 0.0 - f, 0.0 - r];
    L::tyres(|i| {
        let scale = larger(larger(rim[i].abs(), hub[i].abs()), FLOOR_MPS);
        let slides = speed[i].abs() > 1e-7;
        // One division for both reciprocals.
        let safe = choose(slides, speed[i], 1.0);
        let both = 1.0 / (scale * safe);
        let per_scale = both * safe;
        let slip = speed[i] * per_scale;
        Slip {
            slip: if i < 4 { within(slip, 1.0) } else { slip },
            per_speed: choose(slides, both * scale, 0.0),
            limit: choose(slides, 0.0, car.tyre(i).slope_per_peak() * per_scale),
        }
    })
}

/// What slip makes of the tyres.
#[derive(Debug, Clone, Copy)]
pub struct Grip {
    /// Force over peak.
    pub shape: [f64; 6],
    /// Share of its peak that a wheel has left across: with the friction ellipse, it lacks what is spent along.
    pub left: [f64; 4],
}

impl Grip {
    /// Of the tyres with these slips.
    #[inline(always)]
    pub fn new<T: Trig>(car: &Car, slips: &[Slip; 6]) -> Self {
        let shape: [f64; 6] = std::array::from_fn(|i| {
            let slip = if i < 4 { slips[i].slip } else { T::atan(slips[i].slip) };
            car.tyre(i).shape::<T>(slip)
        });
        Self { shape, left: std::array::from_fn(|wheel| left_across(car.ellipse, shape[wheel])) }
    }
}

/// [`Grip::left`] of a wheel.
#[inline(always)]
pub fn left_across(ellipse: f64, shape: f64) -> f64 {
    (1.0 - ellipse * shape * shape).sqrt()
}

/// Forces of tyres with these slips.
#[inline(always)]
pub fn forces<L: Layout>(car: &Car, peak: &[f64; 4], slips: &[Slip; 6], grip: &Grip) -> Forces {
    let [fl, fr, rl, rr] = L::wheels(|wheel| peak[wheel] * grip.left[wheel]);
    let peak = [peak[0], peak[1], peak[2], peak[3], car.lateral_grip * (fl + fr), car.lateral_grip * (rl + rr)];
    let slope = |i: usize| larger(grip.shape[i] * slips[i].per_speed + slips[i].limit, 0.0);
    Forces { force: L::tyres(|i| peak[i] * grip.shape[i]), slope: L::tyres(|i| peak[i] * slope(i)) }
}

/// Tyre forces in state `x`, of any vehicle.
pub fn tyre_forces<T: Trig>(car: &Car, drive: &Drive, peak: &[f64; 4], x: &Vector) -> Forces {
    let slips = slips::<FourWheels>(car, drive, x);
    forces::<FourWheels>(car, peak, &slips, &Grip::new::<T>(car, &slips))
}

/// Forces on the body that come from neither tyres nor inertia: gravity, drag, rolling resistance; along x and y \[N\].
#[inline(always)]
pub fn road_forces(car: &Car, drive: &Drive, x: &Vector) -> [f64; 2] {
    let wind = x[0] + drive.headwind;
    let rolling = car.rolling * within(x[0] * (1.0 / FLOOR_MPS), 1.0);
    [car.mass * drive.gravity[0] - car.drag * wind * wind.abs() - rolling, car.mass * drive.gravity[1]]
}

/// Sums the right-hand sides of the four equations in the head of this file; `torque` is C_mi − C_fi of the wheels and
/// `free` is 1 for a wheel that turns, 0 for one that its brake holds.
#[inline(always)]
pub fn rates<L: Layout>(
    car: &Car,
    drive: &Drive,
    x: &Vector,
    forces: &Forces,
    torque: &[f64; 4],
    free: &[f64; 4],
) -> Vector {
    let [front, rear] = drive.axles::<L>(car);
    let f = &forces.force;
    let front = front.forces([f[0], f[1], f[4]]);
    let rear = rear.forces([f[2], f[3], f[5]]);
    let road = road_forces(car, drive, x);
    L::states(|i| match i {
        0 => x[2] * x[1] + (front[0] + rear[0] + road[0]) * car.per_mass,
        1 => -x[2] * x[0] + (front[1] + rear[1] + road[1]) * car.per_mass,
        2 => (front[2] + rear[2]) * car.per_yaw_inertia,
        _ => free[i - 3] * (torque[i - 3] - car.radius * f[i - 3]) * car.per_wheel_inertia,
    })
}

#[cfg(test)]
mod tests {
    use super::super::body::BODIES;
    use super::*;
    use crate::lanes::LANES;
    use crate::trig::Libm;

    fn every_car() -> impl Iterator<Item = Car> {
        BODIES.iter().map(|entry| {
            let mut body = (entry.build)();
            (body.track_width_m, body.cg_height_m) = (1.5, 0.5);
            (body.drag_area_m2, body.rolling_resistance) = (0.7, 0.01);
            body.friction = [0.1, 0.2, 0.3, 0.4];
            body.combined_slip = true;
            Car::new(&body)
        })
    }

    #[test]
    fn law_a_car_survives_its_columns() {
        for (lane, car) in every_car().enumerate() {
            let mut columns = [[f64::NAN; LANES]; CAR_COLUMNS];
            car.put(&mut columns, lane);
            assert_eq!(Car::pick(&columns, lane), car);
            assert!(columns.iter().flatten().filter(|value| !value.is_nan()).count() == CAR_COLUMNS);
        }
    }

    #[test]
    fn law_slip_is_the_papers_two_formulas() {
        let car = Car::new(&(BODIES[0].build)());
        let drive = Drive::new(&car, 0.0, 0.0, [[0.0, 1.0]; 3]);
        for (v, rim) in [(10.0, 11.0), (10.0, 9.0), (10.0, 0.0), (0.5, 30.0), (10.0, -1.0), (-5.0, 4.0), (-5.0, -6.0)] {
            let w = rim / car.radius;
            let x = [v, 0.0, 0.0, w, w, w, w];
            let got = slips::<FourWheels>(&car, &drive, &x)[2].slip;
            let propulsion = rim.abs() > f64::abs(v);
            let expected: f64 = (rim - v) / if propulsion { rim.abs() } else { f64::abs(v) };
            assert!((got - expected.clamp(-1.0, 1.0)).abs() < 1e-12, "{v} m/s, rim {rim} m/s: {got}, not {expected}");
        }
    }

    #[test]
    fn law_slip_angles_are_those_of_the_velocity_triangle() {
        let car = Car::new(&(BODIES[0].build)());
        for (vx, vy, yaw, steer) in
            [(10.0, 0.3, 0.2, 0.05), (25.0, -1.0, 0.4, -0.1), (3.0, 0.5, 0.5, 0.3), (1.0, 3.0, 0.2, 0.1)]
        {
            let drive = Drive::new(&car, 0.0, 0.0, [steer, 0.0, 0.0].map(sine_and_cosine::<Libm>));
            let [.., f, r] = slips::<FourWheels>(&car, &drive, &[vx, vy, yaw, 0.0, 0.0, 0.0, 0.0]).map(|s| s.slip);
            let front = steer - libm::atan2(vy + car.axle_x[0] * yaw, vx);
            let rear = -libm::atan2(vy + car.axle_x[1] * yaw, vx);
            assert!((libm::atan(f) - front).abs() < 1e-12 && (libm::atan(r) - rear).abs() < 1e-12);
        }
    }

    #[test]
    fn law_load_transfer_moves_load_and_makes_none() {
        for car in every_car() {
            let mut even = car;
            even.friction = [1.0; 4];
            let drive = Drive::new(&even, 0.0, 0.0, [[0.0, 1.0]; 3]);
            let [fl, fr, rl, rr] = peaks::<FourWheels>(&even, &drive, [2.0, 1.0]);
            assert!(((fl + fr + rl + rr) / (even.mass * GRAVITY_MPS2) - 1.0).abs() < 1e-12);
            // Speeding up and turning left loads the rear and the right.
            assert!(rl + rr > 2.0 * even.load[1] && fr > fl && rr > rl);
            // However hard it is thrown about, what one wheel loses another bears, and none pulls on the road.
            for acceleration in [[500.0, 0.0], [-500.0, 1.0], [0.0, 500.0], [300.0, -400.0], [-1e30, 1e30]] {
                let loads = peaks::<FourWheels>(&even, &drive, acceleration);
                let all: f64 = loads.iter().sum();
                assert!((all / (even.mass * GRAVITY_MPS2) - 1.0).abs() < 1e-12, "{acceleration:?}: {loads:?}");
                assert!(loads.iter().all(|load| *load >= 0.0), "{acceleration:?}: {loads:?}");
            }
        }
    }

    /// By statics: the wheels carry M g cos, and the lower ones more of it.
    #[test]
    fn law_who_stands_on_a_slope_leans_on_the_lower_wheels() {
        let angle = |x: f64| [libm::sin(x), libm::cos(x)];
        for car in every_car() {
            let mut even = car;
            even.friction = [1.0; 4];
            let standing = |grade: f64, bank: f64| {
                let drive = Drive::new(&even, 0.0, 0.0, [angle(0.0), angle(grade), angle(bank)]);
                peaks::<FourWheels>(&even, &drive, [0.0, 0.0])
            };
            let [fl, fr, rl, rr] = standing(0.1, 0.0);
            let carried = even.mass * GRAVITY_MPS2 * libm::cos(0.1);
            assert!(((fl + fr + rl + rr) / carried - 1.0).abs() < 1e-12, "{} of {carried}", fl + fr + rl + rr);
            // Uphill the moment of M g sin about the road is held by the rear wheels, which are lower.
            let moved = even.pitch_transfer * GRAVITY_MPS2 * libm::sin(0.1);
            assert!(
                (rl + rr - 2.0 * even.load[1] * libm::cos(0.1) - 2.0 * moved).abs() < 1e-9 * carried && moved > 0.0
            );
            // Banked down to the right.
            let [fl, fr, rl, rr] = standing(0.0, 0.1);
            assert!(fr > fl && rr > rl, "{fl} {fr} {rl} {rr}");
        }
    }
}
