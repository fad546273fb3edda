//! The 7-DoF model over a block of vehicles, as vector code for whatever the machine has.
//!
//! The loops over lanes (`loops.rs`) have a constant trip count and no branch between lanes, read and write columns,
//! and call nothing that is not inlined: the compiler makes vector code of them. They are compiled for every instruction
//! set and chosen at run time; without fused products and with polynomials in place of the platform's trigonometry all
//! give the same bits.

use std::cell::RefCell;

use super::block::{Inputs, Plant, PlantBlock};
use super::integrator::substep;
use super::layout::FourWheels;
use super::loops::{Workspace, advance_lanes};
use super::seven_dof::{Car, Drive, sine_and_cosine};
use crate::lanes::{Flags, LANES, vectorised};
use crate::trig::Libm;

/// The 7-DoF model of [`super::seven_dof`], integrated by [`super::integrator`].
///
/// # Accuracy of the default substep of 10 ms
/// Against [`super::oracle`], worst error of V_x: 8e-4 m/s in 60 s of stop and go with bends and jumps of the torque by
/// 7 m/s² (5 ms: 8e-5). With white noise of 1 000 N·m on the torque 2e-3 m/s RMS, 0.04 m/s where the noise decides when the car
/// stops; 8 000 N·m from standstill, several times what the tyres bear, leave 0.12 m/s (5 ms: 0.05). `tests/plant.rs` prints them.
#[derive(Debug, Clone, Copy)]
pub struct SevenDof {
    substep_s: f64,
}

impl SevenDof {
    /// With substeps of at most `substep_s`.
    pub fn new(substep_s: f64) -> Self {
        Self { substep_s }
    }

    /// The same by the `libm` crate, one slot at a time: the oracle of the vector code.
    pub fn advance_scalar(&self, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, period_s: f64) {
        let (count, h) = self.substeps(period_s);
        for lane in (0..LANES).filter(|&lane| moving[lane] > 0.0) {
            let (car, drive) = acting(block, inputs, lane);
            let mut moment = block.moment::<FourWheels>(lane);
            for _ in 0..count {
                moment = substep::<Libm>(&car, &drive, &moment, h);
            }
            block.put(lane, &moment, 1.0);
        }
    }

    /// Number and length of the substeps of one period. A period that is a multiple up to rounding counts as one.
    fn substeps(&self, period_s: f64) -> (usize, f64) {
        let count = (period_s / self.substep_s - 1e-9).ceil().max(1.0);
        (count as usize, period_s / count)
    }
}

thread_local! {
    /// One for all blocks that a thread advances: it stays in the nearest cache, and nobody has to fill it with zeros.
    static WORKSPACE: RefCell<Workspace> = const { RefCell::new(Workspace::NEW) };
}

impl Plant for SevenDof {
    fn advance(&self, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, period_s: f64) {
        let (count, h) = self.substeps(period_s);
        if moving.iter().all(|moving| *moving == 0.0) {
            return;
        }
        let work = |work: &mut Workspace| {
            for _ in 0..count {
                advance(work, block, inputs, moving, h);
            }
        };
        WORKSPACE.with_borrow_mut(work);
    }
}

/// The vehicle in a lane and what acts on it.
pub fn acting(block: &PlantBlock, inputs: &Inputs, lane: usize) -> (Car, Drive) {
    let car = block.car(lane);
    let angles = [inputs.steer_rad[lane], inputs.grade_rad[lane], inputs.bank_rad[lane]];
    let angles = angles.map(sine_and_cosine::<Libm>);
    (car, Drive::new(&car, inputs.torque_nm[lane], inputs.headwind_mps[lane], angles))
}

vectorised! {
    fn advance(work: &mut Workspace, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, h: f64) {
        advance_lanes(work, block, inputs, moving, h);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Even parts of a period, none of them longer than asked for, and no more than that takes: 0.07/0.01 is 7.
    #[test]
    fn law_a_period_is_divided_into_as_few_substeps_as_allowed() {
        for (substep_s, period_s, wanted) in
            [(0.01, 0.01, 1), (0.01, 0.07, 7), (0.01, 0.005, 1), (0.003, 0.01, 4), (0.001, 0.01, 10), (0.01, 0.0101, 2)]
        {
            let (count, h) = SevenDof::new(substep_s).substeps(period_s);
            assert_eq!(count, wanted, "{period_s} s by {substep_s} s");
            assert!((h * count as f64 - period_s).abs() < 1e-15);
        }
    }
}
