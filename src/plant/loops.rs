//! One substep of [`super::integrator`] for all lanes of a block, in several loops over them.
//!
//! A tyre curve is a chain of some hundred operations that wait for each other, and a processor looks ahead only so far:
//! in one long loop the curves of a vehicle would be computed one after the other. So each loop does one thing for all
//! lanes and leaves its results in columns for the next one; the short loops over the curves keep the processor busy with
//! many vehicles and tyres at once.
//!
//! The loops are compiled for each [`Layout`]; a block takes the simplest one that holds for its vehicles.

use super::block::{Inputs, PlantBlock};
use super::integrator::{Half, Moment, first_stage, second_stage};
use super::layout::{FourWheels, Layout, StraightAhead, TwoAxles};
use super::seven_dof::{Car, Drive, Forces, Grip, Slip, forces, left_across, peaks, sine_and_cosine, slips};
use super::tyre::Tyre;

use crate::lanes::{Flags, LANES, Lanes};
use crate::trig::{Polynomial, Trig, with_atan};

/// Which of the layouts hold for a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Common {
    /// [`TwoAxles`] holds.
    pub even: bool,
    /// [`StraightAhead`] holds.
    pub ahead: bool,
}

impl Common {
    /// What the moving vehicles of a block have in common.
    #[inline(always)]
    pub fn of(block: &PlantBlock, inputs: &Inputs, moving: &Flags) -> Self {
        let (half_track, friction) = Car::sides(block.cars());
        let [fl, fr, rl, rr] = &block.wheel_speed_radps;
        let pairs = [(fl, fr), (rl, rr), (friction[0], friction[1]), (friction[2], friction[3])];
        let across =
            [&block.vy_mps, &block.yaw_rate_radps, &block.acceleration_mps2[1], &inputs.steer_rad, &inputs.bank_rad];
        let (mut uneven, mut wide, mut sideways) = (0, 0, 0);
        for lane in 0..LANES {
            let bits = |column: &Lanes| column[lane].to_bits();
            let counts = 0_u64.wrapping_sub(u64::from(moving[lane] > 0.0));
            uneven |= counts & pairs.iter().fold(0, |all, (left, right)| all | (bits(left) ^ bits(right)));
            wide |= counts & bits(half_track);
            sideways |= counts & across.iter().fold(0, |all, column| all | bits(column));
        }
        Self { even: uneven == 0 && wide == 0, ahead: uneven == 0 && sideways == 0 }
    }
}

/// Numbers that one loop over the lanes leaves to the next.
#[repr(align(64))]
struct Columns<const K: usize>([Lanes; K]);

impl<const K: usize> Columns<K> {
    const NEW: Self = Self([[0.0; LANES]; K]);
}

/// True if every lane is +0.
#[inline(always)]
fn is_zero(column: &Lanes) -> bool {
    column.iter().fold(0, |bits, x| bits | x.to_bits()) == 0
}

/// Sines and cosines of the angles in a column; straight and level roads cost next to nothing.
#[inline(always)]
fn sines_and_cosines(angle: &Lanes, out: &mut Columns<2>) {
    if is_zero(angle) {
        *out = Columns([[0.0; LANES], [1.0; LANES]]);
        return;
    }
    for lane in 0..LANES {
        [out.0[0][lane], out.0[1][lane]] = sine_and_cosine::<Polynomial>(angle[lane]);
    }
}

/// The tyres of a block in one state: slips, and what they make of the tyres.
struct Tyres {
    peak: Columns<4>,
    slip: Columns<6>,
    per_speed: Columns<6>,
    limit: Columns<6>,
    shape: Columns<6>,
    left: Columns<4>,
}

impl Tyres {
    #[inline(always)]
    fn put<L: Layout>(&mut self, lane: usize, slips: &[Slip; 6]) {
        L::tyres(|i| {
            self.slip.0[i][lane] = slips[i].slip;
            self.per_speed.0[i][lane] = slips[i].per_speed;
            self.limit.0[i][lane] = slips[i].limit;
        });
    }

    /// What the slips make of the tyres.
    #[inline(always)]
    fn shape<L: Layout>(&mut self, block: &PlantBlock) {
        for i in L::TYRES.iter().filter(|i| **i >= 4) {
            with_atan(&mut self.slip.0[*i], |_, _, angle| angle);
        }
        for i in L::TYRES {
            let [b, _, e] = Car::tyre_columns(block.cars(), *i);
            let x = &mut self.shape.0[*i];
            for lane in 0..LANES {
                x[lane] = b[lane] * self.slip.0[*i][lane];
            }
            with_atan(x, |lane, bt, angle| Tyre::bend(e[lane], bt, angle));
        }
        for i in L::TYRES {
            let [_, c, _] = Car::tyre_columns(block.cars(), *i);
            with_atan(&mut self.shape.0[*i], |lane, _, angle| c[lane] * angle);
        }
        for i in L::TYRES {
            for x in &mut self.shape.0[*i] {
                *x = Polynomial::sin(*x);
            }
        }
        let ellipse = Car::ellipse_column(block.cars());
        if L::AHEAD || is_zero(ellipse) {
            self.left.0 = [[1.0; LANES]; 4];
            return;
        }
        for wheel in L::TYRES.iter().filter(|i| **i < 4) {
            let (shape, left) = (&self.shape.0[*wheel], &mut self.left.0[*wheel]);
            for lane in 0..LANES {
                left[lane] = left_across(ellipse[lane], shape[lane]);
            }
        }
    }

    #[inline(always)]
    fn forces<L: Layout>(&self, car: &Car, lane: usize) -> Forces {
        let slips = L::tyres(|i| Slip {
            slip: self.slip.0[i][lane],
            per_speed: self.per_speed.0[i][lane],
            limit: self.limit.0[i][lane],
        });
        let left = if L::AHEAD { [1.0; 4] } else { L::wheels(|wheel| self.left.0[wheel][lane]) };
        let grip = Grip { shape: L::tyres(|i| self.shape.0[i][lane]), left };
        forces::<L>(car, &L::wheels(|wheel| self.peak.0[wheel][lane]), &slips, &grip)
    }
}

/// All columns of a substep. What they hold before does not matter.
pub struct Workspace {
    angles: [Columns<2>; 3],
    tyres: Tyres,
    k: Columns<7>,
    torque: Columns<4>,
    free: Columns<4>,
}

impl Workspace {
    /// Columns of zeros.
    pub const NEW: Self = Self {
        angles: [Columns::NEW; 3],
        tyres: Tyres {
            peak: Columns::NEW,
            slip: Columns::NEW,
            per_speed: Columns::NEW,
            limit: Columns::NEW,
            shape: Columns::NEW,
            left: Columns::NEW,
        },
        k: Columns::NEW,
        torque: Columns::NEW,
        free: Columns::NEW,
    };
}

/// The vehicle in a lane, what acts on it, and its state.
#[inline(always)]
fn pick<L: Layout>(block: &PlantBlock, inputs: &Inputs, angles: &[Columns<2>; 3], lane: usize) -> (Car, Drive, Moment) {
    let car = block.car(lane);
    let [steer, grade, bank] = angles;
    let angles = [steer, grade, bank].map(|angle| [angle.0[0][lane], angle.0[1][lane]]);
    (car, Drive::new(&car, inputs.torque_nm[lane], inputs.headwind_mps[lane], angles), block.moment::<L>(lane))
}

/// Advances the lanes with `moving` = 1 by one substep of `h` seconds.
#[inline(always)]
pub fn advance_lanes(work: &mut Workspace, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, h: f64) {
    match Common::of(block, inputs, moving) {
        Common { ahead: true, .. } => advance_alike::<StraightAhead>(work, block, inputs, moving, h),
        Common { even: true, .. } => advance_alike::<TwoAxles>(work, block, inputs, moving, h),
        _ => advance_alike::<FourWheels>(work, block, inputs, moving, h),
    }
}

/// The same for vehicles of a layout.
#[inline(always)]
fn advance_alike<L: Layout>(work: &mut Workspace, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, h: f64) {
    let Workspace { angles, tyres, k, torque, free } = work;
    sines_and_cosines(&inputs.steer_rad, &mut angles[0]);
    sines_and_cosines(&inputs.grade_rad, &mut angles[1]);
    sines_and_cosines(&inputs.bank_rad, &mut angles[2]);
    for lane in 0..LANES {
        let (car, drive, now) = pick::<L>(block, inputs, angles, lane);
        let peak = peaks::<L>(&car, &drive, now.acceleration);
        L::wheels(|wheel| tyres.peak.0[wheel][lane] = peak[wheel]);
        tyres.put::<L>(lane, &slips::<L>(&car, &drive, &now.x));
    }
    tyres.shape::<L>(block);
    for lane in 0..LANES {
        let (car, drive, now) = pick::<L>(block, inputs, angles, lane);
        let half = first_stage::<L>(&car, &drive, &now, &tyres.forces::<L>(&car, lane), h);
        L::states(|i| k.0[i][lane] = half.k[i]);
        L::wheels(|wheel| torque.0[wheel][lane] = half.torque[wheel]);
        L::wheels(|wheel| free.0[wheel][lane] = half.free[wheel]);
        tyres.put::<L>(lane, &slips::<L>(&car, &drive, &half.middle::<L>(&now, h)));
    }
    tyres.shape::<L>(block);
    for lane in 0..LANES {
        let (car, drive, now) = pick::<L>(block, inputs, angles, lane);
        let half = Half {
            k: L::states(|i| k.0[i][lane]),
            torque: L::wheels(|wheel| torque.0[wheel][lane]),
            free: L::wheels(|wheel| free.0[wheel][lane]),
        };
        let next = second_stage::<L>(&car, &drive, &now, &half, &tyres.forces::<L>(&car, lane), h);
        block.put(lane, &next, moving[lane]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::block::State;
    use super::super::body::BODIES;
    use super::*;
    use crate::random::Stream;

    /// Sixteen vehicles and what acts on them in one period: roads up and down, wind, torques from full brakes to spinning
    /// wheels; sometimes standing, sometimes rolling backwards. On straight roads some have track width.
    fn scene(random: &mut Stream, steers: bool) -> (PlantBlock, Inputs) {
        let (mut block, mut inputs) = (PlantBlock::default(), Inputs::default());
        for lane in 0..LANES {
            let mut body = (BODIES[lane % BODIES.len()].build)();
            (body.drag_area_m2, body.rolling_resistance) = (0.7, 0.01);
            body.combined_slip = lane % 3 == 0;
            if !steers && lane % 2 == 0 {
                (body.track_width_m, body.cg_height_m) = (1.5, 0.5);
            }
            block.set_body(lane, &body);
            let speed_mps = (8.0 * random.normal() + 6.0).max(-3.0);
            let speed_mps = if lane % 5 == 4 { 0.0 } else { speed_mps };
            block.set_state(lane, &State::rolling(&body, speed_mps));
            inputs.grade_rad[lane] = 0.05 * random.normal();
            inputs.headwind_mps[lane] = 3.0 * random.normal();
            inputs.steer_rad[lane] = if steers && lane % 2 == 0 { 0.05 * random.normal() } else { 0.0 };
        }
        (block, inputs)
    }

    fn bits(block: &PlantBlock) -> Vec<u64> {
        let columns = [&block.vx_mps, &block.vy_mps, &block.yaw_rate_radps, &block.distance_m];
        let columns = columns.into_iter().chain(&block.wheel_speed_radps).chain(&block.acceleration_mps2);
        columns.flatten().map(|x| x.to_bits()).collect()
    }

    /// Drives a scene by two layouts for as many periods and compares every bit after each.
    fn compare<A: Layout, B: Layout>(steers: bool, holds: impl Fn(Common) -> bool) {
        let mut random = Stream::new(3, "layout", if steers { "steering" } else { "straight" });
        let (moving, mut work) = ([1.0; LANES], Workspace::NEW);
        for _ in 0..20 {
            let (mut a, mut inputs) = scene(&mut random, steers);
            let mut b = a.clone();
            for period in 0..200 {
                if period % 20 == 0 {
                    inputs.torque_nm = std::array::from_fn(|_| 2500.0 * random.normal());
                }
                assert!(holds(Common::of(&a, &inputs, &moving)), "period {period}");
                advance_alike::<A>(&mut work, &mut a, &inputs, &moving, 0.01);
                advance_alike::<B>(&mut work, &mut b, &inputs, &moving, 0.01);
                assert_eq!(bits(&a), bits(&b), "period {period}");
            }
            assert!(a.vx_mps.iter().all(|v| v.is_finite()) && a.vx_mps.iter().any(|v| v.abs() > 1.0));
        }
    }

    #[test]
    fn law_what_vehicles_have_in_common_changes_no_bit() {
        compare::<TwoAxles, FourWheels>(true, |common| common == Common { even: true, ahead: false });
        compare::<StraightAhead, FourWheels>(false, |common| common == Common { even: false, ahead: true });
    }

    #[test]
    fn a_wide_car_or_an_uneven_road_needs_all_wheels() {
        let (moving, inputs) = ([1.0; LANES], Inputs::default());
        let mut body = (BODIES[0].build)();
        body.track_width_m = 1.5;
        let mut block = PlantBlock::default();
        block.set_body(3, &body);
        assert_eq!(Common::of(&block, &inputs, &moving), Common { even: false, ahead: true });
        body.friction[1] = 0.3;
        block.set_body(3, &body);
        assert_eq!(Common::of(&block, &inputs, &moving), Common { even: false, ahead: false });
        // A vehicle that does not move takes no part.
        let moving = std::array::from_fn(|lane| if lane == 3 { 0.0 } else { 1.0 });
        assert_eq!(Common::of(&block, &inputs, &moving), Common { even: true, ahead: true });
    }

    #[test]
    fn whatever_pulls_across_is_not_straight_ahead() {
        type Push = fn(&mut PlantBlock, &mut Inputs);
        let pushes: [Push; 5] = [
            |_, inputs| inputs.steer_rad[5] = 0.1,
            |_, inputs| inputs.bank_rad[5] = 0.1,
            |block, _| block.vy_mps[5] = 0.1,
            |block, _| block.yaw_rate_radps[5] = 0.1,
            |block, _| block.acceleration_mps2[1][5] = 0.1,
        ];
        for (k, push) in pushes.iter().enumerate() {
            let (mut block, mut inputs) = (PlantBlock::default(), Inputs::default());
            push(&mut block, &mut inputs);
            let common = Common::of(&block, &inputs, &[1.0; LANES]);
            assert_eq!(common, Common { even: true, ahead: false }, "{k}");
        }
        for wheel in 0..4 {
            let mut block = PlantBlock::default();
            block.wheel_speed_radps[wheel][5] = 0.1;
            let common = Common::of(&block, &Inputs::default(), &[1.0; LANES]);
            assert_eq!(common, Common { even: false, ahead: false }, "wheel {wheel}");
        }
    }
}
