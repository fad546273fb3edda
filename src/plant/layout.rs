//! What the vehicles of a block have in common. Where it is known when a loop is compiled, the loop does once what would come
//! out the same twice, and not at all what is known to be nothing. None of it changes a bit of the result.

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
