//! One substep of [`super::integrator`] for all lanes of a block, in several loops over them.
//!
//! A tyre curve is a chain of some hundred operations that wait for each other, and a processor looks ahead only so far:
//! in one long loop the curves of a vehicle would be computed one after the other. So each loop does one thing for all
//! lanes and leaves its results in columns for the next one; the short loops over the curves keep the processor busy with
//! many vehicles and tyres at once.
//!
//! Work that is known to be nothing is left out, which changes no bit: see [`Tyres::shape`] and [`sines_and_cosines`].

use super::integrator::{Half, Moment, first_stage, second_stage};
use super::seven_dof::{Car, Drive, Forces, Grip, Slips, forces, left_across, peaks, sine_and_cosine, slips};
use super::tyre::Tyre;
use super::{Inputs, PlantBlock};
use crate::lanes::{Flags, LANES, Lanes};
use crate::trig::{Polynomial, Trig};

/// Numbers that one loop over the lanes leaves to the next.
#[repr(align(64))]
struct Columns<const K: usize>([Lanes; K]);

impl<const K: usize> Columns<K> {
    const NEW: Self = Self([[0.0; LANES]; K]);

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

/// True if every lane is +0.
#[inline(always)]
fn is_zero(column: &Lanes) -> bool {
    column.iter().fold(0, |bits, x| bits | x.to_bits()) == 0
}

/// True if the columns hold the same bits.
#[inline(always)]
fn is_same(a: &Lanes, b: &Lanes) -> bool {
    a.iter().zip(b).fold(0, |bits, (a, b)| bits | (a.to_bits() ^ b.to_bits())) == 0
}

/// Sines and cosines of the angles in a column; straight and level roads cost next to nothing.
#[inline(always)]
fn sines_and_cosines(angle: &Lanes, out: &mut Columns<2>) {
    if is_zero(angle) {
        *out = Columns([[0.0; LANES], [1.0; LANES]]);
        return;
    }
    for lane in 0..LANES {
        out.put(lane, &sine_and_cosine::<Polynomial>(angle[lane]));
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
    fn put(&mut self, lane: usize, slips: &Slips) {
        self.slip.put(lane, &slips.slip);
        self.per_speed.put(lane, &slips.per_speed);
        self.limit.put(lane, &slips.limit);
    }

    /// What the slips make of the tyres. A tyre that does not slip in any lane has no force (no vehicle of the block
    /// steers or drifts); a right tyre that slips as the left one does in every lane has its force (no track width, or straight
    /// ahead).
    #[inline(always)]
    fn shape(&mut self, block: &PlantBlock) {
        let (mut todo, mut count, mut twin) = ([0; 6], 0, [false; 6]);
        for i in 0..6 {
            self.shape.0[i] = self.slip.0[i];
            twin[i] = matches!(i, 1 | 3) && is_same(&self.slip.0[i], &self.slip.0[i - 1]);
            if !(twin[i] || is_zero(&self.slip.0[i])) {
                todo[count] = i;
                count += 1;
            }
        }
        let todo = &todo[..count];
        for i in todo.iter().filter(|i| **i >= 4) {
            for x in &mut self.shape.0[*i] {
                *x = Polynomial::atan(*x);
            }
        }
        for i in todo {
            let [b, _, e] = Car::tyre_columns(&block.cars, *i);
            let x = &mut self.shape.0[*i];
            for lane in 0..LANES {
                x[lane] = Tyre::bend::<Polynomial>(b[lane], e[lane], x[lane]);
            }
        }
        for i in todo {
            let [_, c, _] = Car::tyre_columns(&block.cars, *i);
            let x = &mut self.shape.0[*i];
            for lane in 0..LANES {
                x[lane] = c[lane] * Polynomial::atan(x[lane]);
            }
        }
        for i in todo {
            for x in &mut self.shape.0[*i] {
                *x = Polynomial::sin(*x);
            }
        }
        for i in [1, 3] {
            if twin[i] {
                self.shape.0[i] = self.shape.0[i - 1];
            }
        }
        let ellipse = Car::ellipse_column(&block.cars);
        if is_zero(ellipse) {
            self.left.0 = [[1.0; LANES]; 4];
        } else {
            for wheel in 0..4 {
                for lane in 0..LANES {
                    self.left.0[wheel][lane] = left_across(ellipse[lane], self.shape.0[wheel][lane]);
                }
            }
        }
    }

    #[inline(always)]
    fn forces(&self, car: &Car, lane: usize) -> Forces {
        let slips =
            Slips { slip: self.slip.get(lane), per_speed: self.per_speed.get(lane), limit: self.limit.get(lane) };
        let grip = Grip { shape: self.shape.get(lane), left: self.left.get(lane) };
        forces(car, &self.peak.get(lane), &slips, &grip)
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

/// Advances the lanes with `moving` = 1 by one substep of `h` seconds.
#[inline(always)]
pub fn advance_lanes(work: &mut Workspace, block: &mut PlantBlock, inputs: &Inputs, moving: &Flags, h: f64) {
    let Workspace { angles, tyres, k, torque, free } = work;
    sines_and_cosines(&inputs.steer_rad, &mut angles[0]);
    sines_and_cosines(&inputs.grade_rad, &mut angles[1]);
    sines_and_cosines(&inputs.bank_rad, &mut angles[2]);
    let pick = |block: &PlantBlock, lane: usize| -> (Car, Drive, Moment) {
        let car = Car::pick(&block.cars, lane);
        let angles = [angles[0].get(lane), angles[1].get(lane), angles[2].get(lane)];
        let drive = Drive::new(&car, inputs.torque_nm[lane], inputs.headwind_mps[lane], angles);
        (car, drive, block.moment(lane))
    };
    for lane in 0..LANES {
        let (car, drive, now) = pick(block, lane);
        tyres.peak.put(lane, &peaks(&car, &drive, now.acceleration));
        tyres.put(lane, &slips(&car, &drive, &now.x));
    }
    tyres.shape(block);
    for lane in 0..LANES {
        let (car, drive, now) = pick(block, lane);
        let half = first_stage(&car, &drive, &now, &tyres.forces(&car, lane), h);
        k.put(lane, &half.k);
        torque.put(lane, &half.torque);
        free.put(lane, &half.free);
        tyres.put(lane, &slips(&car, &drive, &half.middle(&now, h)));
    }
    tyres.shape(block);
    for lane in 0..LANES {
        let (car, drive, now) = pick(block, lane);
        let half = Half { k: k.get(lane), torque: torque.get(lane), free: free.get(lane) };
        let next = second_stage(&car, &drive, &now, &half, &tyres.forces(&car, lane), h);
        block.put(lane, &next, moving[lane]);
    }
}
