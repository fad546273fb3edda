//! The 7-DoF model over a block of vehicles, as vector code for whatever the machine has.
//!
//! The loop over lanes has a constant trip count and no branch, reads and writes columns of one struct, and calls nothing
//! that is not inlined: the compiler makes vector code of it. It is compiled three times and chosen at run time; without
//! fused products and with polynomials in place of the platform's trigonometry all three give the same bits.

use std::cell::RefCell;

use super::integrator::substep;
use super::loops::{Workspace, advance_lanes};
use super::seven_dof::{Car, Drive, sine_and_cosine};
use super::trig::Libm;
use super::{Inputs, Plant, PlantBlock};
use crate::lanes::{Flags, LANES};

/// Vector instructions that a block can be advanced with. All give the same bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InstructionSet {
    /// What every processor of the architecture has.
    Baseline,
    /// AVX2.
    Avx2,
    /// AVX-512.
    Avx512,
}

impl InstructionSet {
    /// The sets that this machine has, best first.
    pub fn available() -> Vec<Self> {
        let mut sets = vec![Self::Baseline];
        #[cfg(target_arch = "x86_64")]
        {
            if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") {
                sets.push(Self::Avx2);
            }
            let wide = std::is_x86_feature_detected!("avx512f") && std::is_x86_feature_detected!("avx512vl");
            if wide && std::is_x86_feature_detected!("avx512dq") && std::is_x86_feature_detected!("avx512bw") {
                sets.push(Self::Avx512);
            }
        }
        sets.reverse();
        sets
    }
}

/// The 7-DoF model of [`super::seven_dof`], integrated by [`super::integrator`].
///
/// # Accuracy of the default substep of 10 ms
/// Against [`super::oracle`], worst error of V_x: 8e-4 m/s in 60 s of stop and go with bends and jumps of the torque by
/// 7 m/s² (5 ms: 4e-4, at the instant of a stop). A torque with white noise of 1 000 N·m on top: 4e-4 m/s RMS, 2e-3 worst.
/// Errors die out with the slip that they come from. A torque far beyond the grip from standstill, the worst case, leaves
/// 0.07 m/s (5 ms: 0.03).
#[derive(Debug, Clone, Copy)]
pub struct SevenDof {
    substep_s: f64,
    set: InstructionSet,
}

impl SevenDof {
    /// With substeps of at most `substep_s` and the best instruction set of this machine.
    pub fn new(substep_s: f64) -> Self {
        Self { substep_s, set: InstructionSet::available()[0] }
    }

    /// With a chosen instruction set; one that the machine lacks falls back to the baseline.
    pub fn with_instruction_set(substep_s: f64, set: InstructionSet) -> Self {
        Self { substep_s, set }
    }

    /// The same by the `libm` crate, one slot at a time: the oracle of the vector code.
    pub fn advance_scalar(&self, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, period_s: f64) {
        let (count, h) = self.substeps(period_s);
        for lane in (0..LANES).filter(|&lane| moving[lane] > 0.0) {
            let (car, drive) = acting(block, inputs, lane);
            let mut moment = block.moment(lane);
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
        let advance = match self.set {
            InstructionSet::Baseline => advance_baseline,
            InstructionSet::Avx2 => advance_avx2,
            InstructionSet::Avx512 => advance_avx512,
        };
        WORKSPACE.with_borrow_mut(|work| {
            for _ in 0..count {
                advance(work, block, inputs, moving, h);
            }
        });
    }
}

/// The vehicle in a lane and what acts on it.
pub fn acting(block: &PlantBlock, inputs: &Inputs, lane: usize) -> (Car, Drive) {
    let car = Car::pick(&block.cars, lane);
    let angles = [inputs.steer_rad[lane], inputs.grade_rad[lane], inputs.bank_rad[lane]];
    let angles = angles.map(sine_and_cosine::<Libm>);
    (car, Drive::new(&car, inputs.torque_nm[lane], inputs.headwind_mps[lane], angles))
}

fn advance_baseline(work: &mut Workspace, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, h: f64) {
    advance_lanes(work, block, inputs, moving, h);
}

#[multiversion::multiversion(targets("x86_64+avx2+fma"))]
fn advance_avx2(work: &mut Workspace, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, h: f64) {
    advance_lanes(work, block, inputs, moving, h);
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw"))]
fn advance_avx512(work: &mut Workspace, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, h: f64) {
    advance_lanes(work, block, inputs, moving, h);
}
