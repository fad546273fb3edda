//! What the vehicles of a block have in common. Where it is known when a loop is compiled, the loop does once what would come
//! out the same twice, and not at all what is known to be nothing. None of it changes a bit of the result.

use super::seven_dof::Car;
use super::{Inputs, PlantBlock};
use crate::lanes::{Flags, LANES, Lanes};

/// What is different from wheel to wheel, from tyre to tyre and from state to state. Wheels: front left, front right, rear
/// left, rear right. Tyres: those of the wheels along, then of the axles across. States: V_x, V_y, ψ̇, the wheels.
pub trait Layout {
    /// Left and right wheels do the same.
    const EVEN: bool;
    /// Nothing moves or pulls across the road, so that left and right wheels do the same as well.
    const AHEAD: bool;
    /// The tyres of which no other one does the same.
    const TYRES: &'static [usize];

    /// One thing for each wheel.
    #[inline(always)]
    fn wheels<T: Copy>(mut of: impl FnMut(usize) -> T) -> [T; 4] {
        let front = of(0);
        let front = [front, if Self::EVEN { front } else { of(1) }];
        let rear = of(2);
        [front[0], front[1], rear, if Self::EVEN { rear } else { of(3) }]
    }

    /// One thing for each tyre; nothing (`T::default()`) for tyres that nothing moves across.
    #[inline(always)]
    fn tyres<T: Copy + Default>(mut of: impl FnMut(usize) -> T) -> [T; 6] {
        let [fl, fr, rl, rr] = Self::wheels(&mut of);
        let [front, rear] = if Self::AHEAD { [T::default(); 2] } else { [of(4), of(5)] };
        [fl, fr, rl, rr, front, rear]
    }

    /// One thing for each state; nothing for those across.
    #[inline(always)]
    fn states<T: Copy + Default>(mut of: impl FnMut(usize) -> T) -> [T; 7] {
        let along = of(0);
        let [across, yaw] = if Self::AHEAD { [T::default(); 2] } else { [of(1), of(2)] };
        let [fl, fr, rl, rr] = Self::wheels(|wheel| of(3 + wheel));
        [along, across, yaw, fl, fr, rl, rr]
    }
}

/// Any vehicles.
pub struct FourWheels;

/// Vehicles without track width whose wheels have the same road left and right.
pub struct TwoAxles;

/// Vehicles that go straight ahead.
pub struct StraightAhead;

impl Layout for FourWheels {
    const EVEN: bool = false;
    const AHEAD: bool = false;
    const TYRES: &'static [usize] = &[0, 1, 2, 3, 4, 5];
}

impl Layout for TwoAxles {
    const EVEN: bool = true;
    const AHEAD: bool = false;
    const TYRES: &'static [usize] = &[0, 2, 4, 5];
}

impl Layout for StraightAhead {
    const EVEN: bool = true;
    const AHEAD: bool = true;
    const TYRES: &'static [usize] = &[0, 2];
}

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
        let (half_track, friction) = Car::sides(&block.cars);
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
