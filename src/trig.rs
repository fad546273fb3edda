//! The functions of tyre model and noise, twice: as branch-free polynomials that turn into vector code and give the same
//! bits on every machine, and from the `libm` crate as the oracle of the first.

use crate::lanes::{LANES, Lanes};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// `yes` if `condition`, else `no`, by masks: the compiler never makes a branch of it, which would keep a loop over lanes
/// from becoming vector code.
#[inline(always)]
pub fn choose(condition: bool, yes: f64, no: f64) -> f64 {
    let mask = 0_u64.wrapping_sub(u64::from(condition));
    f64::from_bits((yes.to_bits() & mask) | (no.to_bits() & !mask))
}

/// Where the equations take their trigonometry from.
pub trait Trig {
    /// arctan(x).
    fn atan(x: f64) -> f64;
    /// sin(x), |x| ≤ 3π/2.
    fn sin(x: f64) -> f64;
    /// ln(x), x positive and not subnormal.
    fn ln(x: f64) -> f64;
}

/// Polynomials without branches, error below 1e-14 absolute for `atan`, below 1e-15 for `sin`, 1e-15 relative for `ln`.
pub struct Polynomial;

/// The crate `libm`.
pub struct Libm;

impl Trig for Libm {
    fn atan(x: f64) -> f64 {
        libm::atan(x)
    }

    fn sin(x: f64) -> f64 {
        libm::sin(x)
    }

    fn ln(x: f64) -> f64 {
        libm::log(x)
    }
}

/// Chebyshev fit of atan(√u)/√u on 0 ≤ u ≤ tan²(π/8), relative error 1e-15.
const ATAN: [f64; 10] = [
    1.0,
    -0.3333333333322143,
    0.1999999997839263,
    -0.14285712661682742,
    0.11111048853684977,
    -0.09089529955364099,
    0.07673535415525248,
    -0.06505982889552167,
    0.05024761863196013,
    -0.025316476073953053,
];

/// Chebyshev fit of sin(√u)/√u on 0 ≤ u ≤ (π/2)², relative error 1e-16.
const SIN: [f64; 8] = [
    1.0,
    -0.16666666666666072,
    0.008333333333282756,
    -0.00019841269824861878,
    2.75573166090716e-06,
    -2.5051881946577877e-08,
    1.6048168313864852e-10,
    -7.374387450238072e-13,
];

const TAN_PI_8: f64 = 0.41421356237309503;
const TAN_3PI_8: f64 = 2.414213562373095;

impl Trig for Polynomial {
    /// Three ranges, chosen by selection: atan(a) itself, π/4 + atan((a−1)/(a+1)), π/2 − atan(1/a).
    #[inline(always)]
    fn atan(x: f64) -> f64 {
        let a = x.abs();
        let (near, far) = (a < TAN_PI_8, a > TAN_3PI_8);
        let numerator = choose(far, -1.0, choose(near, a, a - 1.0));
        let denominator = choose(far, a, choose(near, 1.0, a + 1.0));
        let offset = choose(far, FRAC_PI_2, choose(near, 0.0, FRAC_PI_4));
        signed(offset + atan_near(numerator / denominator), x)
    }

    /// sin|x| = sin(π − |x|) folds the argument into 0..π/2.
    #[inline(always)]
    fn sin(x: f64) -> f64 {
        let a = x.abs();
        let folded = choose(a < PI - a, a, PI - a);
        let u = folded * folded;
        let u2 = u * u;
        signed(folded * (quad(&SIN, 0, u, u2) + quad(&SIN, 4, u, u2) * (u2 * u2)), x)
    }

    /// x = m 2^e with √½ ≤ m < √2; ln m = 2 atanh t, t = (m − 1)/(m + 1), by its series.
    #[inline(always)]
    fn ln(x: f64) -> f64 {
        const ROOT_HALF: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();
        const MANTISSA: u64 = (1 << 52) - 1;
        const TWO_52: f64 = 4_503_599_627_370_496.0;
        let shifted = x.to_bits() + (1_f64.to_bits() - ROOT_HALF);
        let m = f64::from_bits((shifted & MANTISSA) + ROOT_HALF);
        let e = f64::from_bits((shifted >> 52) | TWO_52.to_bits()) - (TWO_52 + 1023.0);
        let t = (m - 1.0) / (m + 1.0);
        let u = t * t;
        let mut sum = 1.0 / 21.0;
        for odd in [19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
            sum = sum * u + 1.0 / odd;
        }
        2.0 * t * sum + e * std::f64::consts::LN_2
    }
}

/// arctan(t), |t| < tan(π/8).
#[inline(always)]
fn atan_near(t: f64) -> f64 {
    let u = t * t;
    let u2 = u * u;
    let u4 = u2 * u2;
    t * (quad(&ATAN, 0, u, u2) + (quad(&ATAN, 4, u, u2) + pair(&ATAN, 8, u) * u4) * u4)
}

/// Puts `then(lane, x, arctan x)` in place of x in all lanes, to the bit as by [`Polynomial::atan`] and in half the time where
/// all of them are small.
#[inline(always)]
pub fn with_atan(x: &mut Lanes, then: impl Fn(usize, f64, f64) -> f64) {
    if x.iter().fold(true, |all, x| all & (x.abs() < TAN_PI_8)) {
        for lane in 0..LANES {
            x[lane] = then(lane, x[lane], atan_near(x[lane]));
        }
    } else {
        for lane in 0..LANES {
            x[lane] = then(lane, x[lane], Polynomial::atan(x[lane]));
        }
    }
}

/// a with its sign turned round where x has one.
#[inline(always)]
fn signed(a: f64, x: f64) -> f64 {
    f64::from_bits(a.to_bits() ^ (x.to_bits() & SIGN))
}

/// The bit of a number's sign.
const SIGN: u64 = 1 << 63;

/// Two and four terms of a polynomial by Estrin's scheme: a chain of products and sums half as long as Horner's.
#[inline(always)]
fn pair(c: &[f64], k: usize, u: f64) -> f64 {
    c[k] + c[k + 1] * u
}

#[inline(always)]
fn quad(c: &[f64], k: usize, u: f64, u2: f64) -> f64 {
    pair(c, k, u) + pair(c, k + 2, u) * u2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_polynomials_agree_with_libm() {
        let steps = 200_000;
        for k in -steps..=steps {
            let t = f64::from(k) / f64::from(steps);
            for x in [t, 3.0 * t, 100.0 * t, 1e9 * t] {
                assert!((Polynomial::atan(x) - Libm::atan(x)).abs() < 1e-14, "atan({x})");
            }
            let x = 1.5 * PI * t;
            assert!((Polynomial::sin(x) - Libm::sin(x)).abs() < 1e-14, "sin({x})");
        }
    }

    #[test]
    fn val_logarithms_agree_with_libm() {
        let step = 0x0009_1234_5678_9abc_u64;
        for bits in (1e-300_f64.to_bits()..1e300_f64.to_bits()).step_by(step as usize) {
            let x = f64::from_bits(bits);
            assert!((Polynomial::ln(x) / Libm::ln(x) - 1.0).abs() < 1e-15, "ln({x})");
        }
        for k in 1..100_000 {
            // As far below 1 as a uniform number's step, where the logarithm is nearly 0.
            let x = 1.0 - f64::from(k) * f64::EPSILON;
            assert!((Polynomial::ln(x) / Libm::ln(x) - 1.0).abs() < 1e-15, "ln({x})");
        }
        assert_eq!(Polynomial::ln(1.0), 0.0);
    }

    #[test]
    fn law_polynomials_are_odd_and_exact_at_zero() {
        for x in [0.0, 1e-300, 0.3, 0.41421356237309503, 1.0, 2.5, 4.0] {
            assert_eq!(Polynomial::atan(-x).to_bits(), (-Polynomial::atan(x)).to_bits());
            assert_eq!(Polynomial::sin(-x), -Polynomial::sin(x));
        }
        assert_eq!(Polynomial::atan(0.0), 0.0);
        assert_eq!(Polynomial::sin(0.0), 0.0);
    }

    #[test]
    fn law_the_way_of_small_angles_gives_the_bits_of_the_other() {
        let small: Lanes = std::array::from_fn(|i| (i as f64 - 7.5) * 0.05);
        let (mut alone, mut among) = (small, small);
        alone[0] = -0.0;
        among[0] = 3.0;
        with_atan(&mut alone, |_, _, angle| angle);
        with_atan(&mut among, |_, _, angle| angle);
        assert_eq!(alone[0].to_bits(), (-0.0_f64).to_bits());
        assert_eq!(among[0].to_bits(), Polynomial::atan(3.0).to_bits());
        for i in 1..LANES {
            assert_eq!(alone[i].to_bits(), among[i].to_bits());
            assert_eq!(alone[i].to_bits(), Polynomial::atan(small[i]).to_bits());
        }
    }
}
