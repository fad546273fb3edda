//! The 7-DoF model over a block of vehicles, as vector code for whatever the machine has.
//!
//! The loop over lanes has a constant trip count and no branch, reads and writes columns of one struct, and calls nothing
//! that is not inlined: the compiler makes vector code of it. It is compiled three times and chosen at run time; without
//! fused products and with polynomials in place of the platform's trigonometry all three give the same bits.

use super::integrator::{Half, first_stage, second_stage, slips_amid, substep};
use super::seven_dof::{Car, Drive, Slips, angles, peaks, slips};
use super::trig::{Libm, Polynomial, Trig};
use super::{Inputs, Plant, PlantBlock};
use crate::lanes::{Flags, LANES, Lanes};

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
            let (car, drive) = acting::<Libm>(block, inputs, lane);
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

impl Plant for SevenDof {
    fn advance(&self, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, period_s: f64) {
        let (count, h) = self.substeps(period_s);
        for _ in 0..count {
            match self.set {
                InstructionSet::Baseline => advance_baseline(block, inputs, moving, h),
                InstructionSet::Avx2 => advance_avx2(block, inputs, moving, h),
                InstructionSet::Avx512 => advance_avx512(block, inputs, moving, h),
            }
        }
    }
}

/// The vehicle in a lane and what acts on it.
#[inline(always)]
pub fn acting<T: Trig>(block: &PlantBlock, inputs: &Inputs, lane: usize) -> (Car, Drive) {
    let car = Car::pick(&block.cars, lane);
    let angles = angles::<T>(inputs.steer_rad[lane], inputs.grade_rad[lane], inputs.bank_rad[lane]);
    let drive = Drive::new(&car, inputs.torque_nm[lane], inputs.headwind_mps[lane], &angles);
    (car, drive)
}

/// Numbers that one loop over the lanes leaves to the next.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Columns<const K: usize>([Lanes; K]);

impl<const K: usize> Columns<K> {
    fn new() -> Self {
        Self([[0.0; LANES]; K])
    }

    #[inline(always)]
    fn put(&mut self, lane: usize, values: &[f64; K]) {
        for k in 0..K {
            self.0[k][lane] = values[k];
        }
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> [f64; K] {
        let mut values = [0.0; K];
        for k in 0..K {
            values[k] = self.0[k][lane];
        }
        values
    }
}

struct SlipColumns {
    slip: Columns<6>,
    per_speed: Columns<6>,
    limit: Columns<6>,
}

impl SlipColumns {
    #[inline(always)]
    fn put(&mut self, lane: usize, slips: &Slips) {
        self.slip.put(lane, &slips.slip);
        self.per_speed.put(lane, &slips.per_speed);
        self.limit.put(lane, &slips.limit);
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> Slips {
        Slips { slip: self.slip.get(lane), per_speed: self.per_speed.get(lane), limit: self.limit.get(lane) }
    }
}

const TYRE_COLUMN: [usize; 6] = [23, 23, 26, 26, 29, 32];

#[inline(always)]
fn shape_lanes(block: &PlantBlock, slip: &mut Columns<6>) {
    for axle in 4..6 {
        for slip in &mut slip.0[axle] {
            *slip = Polynomial::atan(*slip);
        }
    }
    for (slip, column) in slip.0.iter_mut().zip(TYRE_COLUMN) {
        for lane in 0..LANES {
            let bt = block.cars[column][lane] * slip[lane];
            slip[lane] = bt - block.cars[column + 2][lane] * (bt - Polynomial::atan(bt));
        }
    }
    for (slip, column) in slip.0.iter_mut().zip(TYRE_COLUMN) {
        for lane in 0..LANES {
            slip[lane] = block.cars[column + 1][lane] * Polynomial::atan(slip[lane]);
        }
    }
    for slip in &mut slip.0 {
        for slip in slip {
            *slip = Polynomial::sin(*slip);
        }
    }
}

#[inline(always)]
fn advance_lanes(block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, h: f64) {
    let mut angle = Columns::<5>::new();
    let mut peak = Columns::<4>::new();
    let mut slip = SlipColumns { slip: Columns::new(), per_speed: Columns::new(), limit: Columns::new() };
    let (mut k, mut torque, mut free) = (Columns::<7>::new(), Columns::<4>::new(), Columns::<4>::new());
    for lane in 0..LANES {
        angle.put(lane, &angles::<Polynomial>(inputs.steer_rad[lane], inputs.grade_rad[lane], inputs.bank_rad[lane]));
    }
    for lane in 0..LANES {
        let car = Car::pick(&block.cars, lane);
        let drive = Drive::new(&car, inputs.torque_nm[lane], inputs.headwind_mps[lane], &angle.get(lane));
        let now = block.moment(lane);
        peak.put(lane, &peaks(&car, &drive, now.acceleration));
        slip.put(lane, &slips(&car, &drive, &now.x));
    }
    shape_lanes(block, &mut slip.slip);
    for lane in 0..LANES {
        let car = Car::pick(&block.cars, lane);
        let drive = Drive::new(&car, inputs.torque_nm[lane], inputs.headwind_mps[lane], &angle.get(lane));
        let now = block.moment(lane);
        let slips = slip.get(lane);
        let half = first_stage(&car, &drive, &now.x, &peak.get(lane), &slips, &slips.slip, h);
        k.put(lane, &half.k);
        torque.put(lane, &half.torque);
        free.put(lane, &half.free);
        slip.put(lane, &slips_amid(&car, &drive, &now.x, &half, h));
    }
    shape_lanes(block, &mut slip.slip);
    for lane in 0..LANES {
        let car = Car::pick(&block.cars, lane);
        let drive = Drive::new(&car, inputs.torque_nm[lane], inputs.headwind_mps[lane], &angle.get(lane));
        let now = block.moment(lane);
        let slips = slip.get(lane);
        let half = Half { k: k.get(lane), torque: torque.get(lane), free: free.get(lane) };
        let next = second_stage(&car, &drive, &now, &peak.get(lane), &half, &slips, &slips.slip, h);
        block.put(lane, &next, moving[lane]);
    }
}

fn advance_baseline(block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, h: f64) {
    advance_lanes(block, inputs, moving, h);
}

#[multiversion::multiversion(targets("x86_64+avx2+fma"))]
fn advance_avx2(block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, h: f64) {
    advance_lanes(block, inputs, moving, h);
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw"))]
fn advance_avx512(block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, h: f64) {
    advance_lanes(block, inputs, moving, h);
}
