//! Pacejka's Magic Formula in its easiest form and the identification of its constants (Polack et al. 2017, §4.1.2).

use std::f64::consts::PI;

use crate::trig::{Libm, Trig};

/// Shape of a tyre characteristic; the peak D = μ F_z belongs to the wheel, not to the shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tyre {
    /// Stiffness factor B [-].
    pub b: f64,
    /// Shape factor C [-].
    pub c: f64,
    /// Curvature factor E [-].
    pub e: f64,
}

impl Tyre {
    /// F/D = sin(C·atan(Bτ − E(Bτ − atan(Bτ)))) for slip ratio τ [-] or slip angle \[rad\].
    #[inline(always)]
    pub fn shape<T: Trig>(&self, slip: f64) -> f64 {
        let bt = self.b * slip;
        T::sin(self.c * T::atan(Self::bend(self.e, bt, T::atan(bt))))
    }

    /// Bτ − E(Bτ − atan(Bτ)) of E, Bτ and atan(Bτ).
    #[inline(always)]
    pub fn bend(e: f64, bt: f64, atan_bt: f64) -> f64 {
        bt - e * (bt - atan_bt)
    }

    /// F/D, by the `libm` crate.
    pub fn force_per_peak(&self, slip: f64) -> f64 {
        self.shape::<Libm>(slip)
    }

    /// Initial slope per peak, BC.
    pub fn slope_per_peak(&self) -> f64 {
        self.b * self.c
    }
}

/// What a measured curve says about a tyre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identified {
    /// Shape constants.
    pub tyre: Tyre,
    /// Peak force D \[N\].
    pub peak_n: f64,
}

/// Why a measured curve cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TyreError {
    /// A line of the file is not `slip,force_n`.
    #[error("tyre curve, line {line}: expected \"slip,force_n\" as two numbers, found \"{found}\"")]
    Line {
        /// Line number, from 1.
        line: usize,
        /// The text of the line.
        found: String,
    },
    /// The curve does not show what the identification needs.
    #[error("tyre curve: {0}")]
    Curve(&'static str),
}

/// Reads a measured curve: a header `slip,force_n`, then one pair per line, slip in \[-\] or rad, force in N.
///
/// # Errors
/// [`TyreError::Line`] with the first line that is not a pair of finite numbers.
pub fn read_curve(text: &str) -> Result<Vec<(f64, f64)>, TyreError> {
    let data = |line: &str| {
        let (slip, force) = line.split_once(',')?;
        let pair = (slip.trim().parse::<f64>().ok()?, force.trim().parse::<f64>().ok()?);
        (pair.0.is_finite() && pair.1.is_finite()).then_some(pair)
    };
    let is_header = |line: &str| line.split(',').map(str::trim).eq(["slip", "force_n"]);
    text.lines()
        .enumerate()
        .filter(|(k, line)| !(line.trim().is_empty() || *k == 0 && is_header(line)))
        .map(|(k, line)| data(line).ok_or_else(|| TyreError::Line { line: k + 1, found: line.to_owned() }))
        .collect()
}

/// The paper's four steps: D is the peak, C = 2 − (2/π) asin(y_s/D) with y_s the asymptotic force, B follows from the
/// initial slope BCD, E = (Bτ_m − tan(π/2C))/(Bτ_m − atan(Bτ_m)) with τ_m the slip of the peak.
///
/// `curve` holds (slip, force \[N\]) of the driving branch in any order, also several for one slip. The peak is refined by
/// a parabola through its neighbours, the slope is a least-squares fit. A measured curve ends before its asymptote (a slip
/// ratio at 1); y_s is the one whose tyre lies nearest to all measured points (least squares).
///
/// # Errors
/// [`TyreError::Curve`] if there is no interior peak, no slope, or no constants that fit.
pub fn identify(curve: &[(f64, f64)]) -> Result<Identified, TyreError> {
    let points = driving_branch(curve);
    if points.len() < 5 {
        return Err(TyreError::Curve("at least five points with positive slip are needed"));
    }
    let top = (0..points.len()).max_by(|&p, &q| points[p].1.total_cmp(&points[q].1)).unwrap_or(0);
    if top == 0 || top + 1 == points.len() || points[top].1 <= 0.0 {
        return Err(TyreError::Curve("no peak of positive force between the smallest and the largest slip"));
    }
    let (slip_m, peak_n) = parabola_top(points[top - 1], points[top], points[top + 1]);
    let slope = initial_slope(&points, peak_n)?;
    let candidate = |ratio: f64| four_steps(slip_m, peak_n, ratio, slope);
    let miss = |ratio: f64| {
        let tyre = candidate(ratio);
        points.iter().map(|p| p.1 / peak_n - tyre.force_per_peak(p.0)).map(|e| e * e).sum::<f64>()
    };
    let tyre = candidate(lowest(&miss, -0.95, 0.995));
    if [tyre.b, tyre.c, tyre.e].iter().all(|x| x.is_finite()) {
        Ok(Identified { tyre, peak_n })
    } else {
        Err(TyreError::Curve("no Magic Formula constants fit"))
    }
}

/// The points with positive slip, by slip. Of a slip that was measured several times it has the mean force: two points above
/// each other have no slope, which the peak needs.
fn driving_branch(curve: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut points: Vec<_> = curve.iter().copied().filter(|p| p.0 > 0.0).collect();
    points.sort_by(|p, q| p.0.total_cmp(&q.0));
    let mean = |same: &[(f64, f64)]| (same[0].0, same.iter().map(|p| p.1).sum::<f64>() / same.len() as f64);
    points.chunk_by(|p, q| p.0 == q.0).map(mean).collect()
}

/// Steps 2 to 4 for a peak D at slip τ_m, y_s/D and an initial slope.
fn four_steps(slip_m: f64, peak_n: f64, asymptote_per_peak: f64, slope: f64) -> Tyre {
    let c = 2.0 - 2.0 / PI * libm::asin(asymptote_per_peak);
    let b = slope / (c * peak_n);
    let bt = b * slip_m;
    Tyre { b, c, e: (bt - libm::tan(PI / (2.0 * c))) / (bt - libm::atan(bt)) }
}

/// Where `f` is lowest between `low` and `high`: the best of 200 places, then thirds of what lies around it.
fn lowest(f: &dyn Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let width = (high - low) / 200.0;
    let places = (0..=200).map(|k| low + width * f64::from(k));
    let best = places.min_by(|p, q| f(*p).total_cmp(&f(*q))).unwrap_or(low);
    let (mut a, mut b) = ((best - width).max(low), (best + width).min(high));
    for _ in 0..60 {
        let (p, q) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
        (a, b) = if f(p) < f(q) { (a, q) } else { (p, b) };
    }
    0.5 * (a + b)
}

/// Slope at zero: least squares of F = k₁τ + k₂τ³ through the origin, over the points below a quarter of the peak (at
/// least the first two).
fn initial_slope(points: &[(f64, f64)], peak_n: f64) -> Result<f64, TyreError> {
    let low = points.iter().take_while(|p| p.1 < 0.25 * peak_n).count().max(2);
    let (mut s2, mut s4, mut s6, mut f1, mut f3) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for &(t, f) in &points[..low] {
        let t2 = t * t;
        s2 += t2;
        s4 += t2 * t2;
        s6 += t2 * t2 * t2;
        f1 += t * f;
        f3 += t * t2 * f;
    }
    let determinant = s2 * s6 - s4 * s4;
    let slope = if determinant > 1e-12 * s2 * s6 { (f1 * s6 - f3 * s4) / determinant } else { f1 / s2 };
    if slope > 0.0 { Ok(slope) } else { Err(TyreError::Curve("the force does not rise from zero slip")) }
}

/// Vertex of the parabola through three points.
fn parabola_top(p: (f64, f64), q: (f64, f64), r: (f64, f64)) -> (f64, f64) {
    let (left, right) = ((q.1 - p.1) / (q.0 - p.0), (r.1 - q.1) / (r.0 - q.0));
    let bend = (right - left) / (r.0 - p.0);
    if bend >= 0.0 {
        return q;
    }
    let slope = left + bend * (q.0 - p.0);
    let shift = -slope / (2.0 * bend);
    (q.0 + shift, q.1 + 0.5 * slope * shift)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(tyre: &Tyre, peak_n: f64, step: f64, last: f64) -> Vec<(f64, f64)> {
        let count = (last / step).round() as usize;
        (1..=count).map(|k| (k as f64 * step, peak_n * tyre.force_per_peak(k as f64 * step))).collect()
    }

    #[test]
    fn five_points_with_slip_are_enough_and_fewer_are_not() {
        let tyre = Tyre { b: 10.0, c: 1.6, e: 0.5 };
        let at =
            |slips: &[f64]| slips.iter().map(|slip| (*slip, 4000.0 * tyre.force_per_peak(*slip))).collect::<Vec<_>>();
        assert!(identify(&at(&[0.02, 0.06, 0.15, 0.3, 0.6])).is_ok());
        for few in [&[0.02, 0.06, 0.15, 0.3][..], &[0.0, 0.02, 0.06, 0.15, 0.3]] {
            let error = identify(&at(few)).unwrap_err();
            assert!(error.to_string().contains("at least five points"), "{error}");
        }
    }

    #[test]
    fn law_identification_finds_the_constants_of_its_own_curve() {
        for tyre in [
            Tyre { b: 10.0, c: 1.65, e: 0.5 },
            Tyre { b: 11.577, c: 1.6411, e: 0.46403 },
            Tyre { b: 8.0, c: 1.9, e: 0.97 },
            Tyre { b: 14.0, c: 1.4, e: -0.5 },
        ] {
            let found = identify(&curve(&tyre, 4200.0, 0.002, 1.0)).unwrap();
            assert!((found.peak_n / 4200.0 - 1.0).abs() < 1e-4, "{found:?}");
            for (got, want) in [(found.tyre.b, tyre.b), (found.tyre.c, tyre.c), (found.tyre.e, tyre.e)] {
                assert!((got - want).abs() < 0.02 * want.abs().max(0.5), "{tyre:?}: {found:?}");
            }
            for k in 0..=100 {
                let slip = 0.01 * f64::from(k);
                let miss = found.peak_n * found.tyre.force_per_peak(slip) - 4200.0 * tyre.force_per_peak(slip);
                assert!(miss.abs() < 0.005 * 4200.0, "{tyre:?} at {slip}: {miss} N");
            }
        }
    }

    #[test]
    fn curves_are_read_with_and_without_header() {
        let rows = vec![(0.0, 0.0), (0.1, 3000.0)];
        assert_eq!(read_curve("slip,force_n\n0,0\n\n0.1, 3000\n"), Ok(rows.clone()));
        assert_eq!(read_curve("0,0\n0.1,3e3"), Ok(rows));
        let wrong = read_curve("slip,force_n\n0.1;3000").unwrap_err();
        assert_eq!(
            wrong.to_string(),
            "tyre curve, line 2: expected \"slip,force_n\" as two numbers, found \"0.1;3000\""
        );
        assert!(read_curve("0.1,NaN").is_err());
    }

    /// The four steps of the paper, read backwards: the tyre has its peak at τ_m, begins with the slope, and ends at y_s.
    #[test]
    fn law_a_tyre_has_the_peak_the_slope_and_the_asymptote_it_was_made_of() {
        for (asymptote, slope) in [(0.9, 80_000.0), (0.5, 70_000.0), (0.0, 60_000.0)] {
            let tyre = four_steps(0.1, 4000.0, asymptote, slope);
            assert!((tyre.slope_per_peak() * 4000.0 / slope - 1.0).abs() < 1e-12, "{tyre:?}");
            assert!((tyre.force_per_peak(1e9) - asymptote).abs() < 1e-6, "{tyre:?}");
            assert!((tyre.force_per_peak(0.1) - 1.0).abs() < 1e-12, "{tyre:?}");
            assert!(tyre.force_per_peak(0.09) < 1.0 && tyre.force_per_peak(0.11) < 1.0, "{tyre:?}");
        }
    }

    #[test]
    fn law_the_top_of_a_parabola_is_found_between_its_points() {
        let at = |x: f64| (x, 1000.0 - 5.0 * (x - 12.0) * (x - 12.0));
        for [p, q, r] in [[10.0, 11.5, 15.0], [11.0, 12.0, 20.0], [4.0, 12.5, 13.0]] {
            let (x, y) = parabola_top(at(p), at(q), at(r));
            assert!((x - 12.0).abs() < 1e-9 && (y - 1000.0).abs() < 1e-9, "{p}, {q}, {r}: ({x}, {y})");
        }
    }

    /// Readings that are 2 % of the peak too high and too low in turn: the slope is that of all points near zero.
    #[test]
    fn law_the_slope_of_a_rough_curve_is_that_of_many_points() {
        let tyre = Tyre { b: 10.0, c: 1.65, e: 0.5 };
        let mut rough = curve(&tyre, 4200.0, 0.0005, 1.0);
        rough.iter_mut().enumerate().for_each(|(k, p)| p.1 += if k % 2 == 0 { 84.0 } else { -84.0 });
        let found = identify(&rough).unwrap();
        let slope = found.peak_n * found.tyre.slope_per_peak();
        assert!((slope / (4200.0 * 16.5) - 1.0).abs() < 0.05, "{slope} N, {found:?}");
    }

    /// Every slip twice, alike or 100 N too high and too low: the same tyre.
    #[test]
    fn law_measuring_every_slip_twice_changes_nothing() {
        let once = curve(&Tyre { b: 10.0, c: 1.65, e: 0.5 }, 4200.0, 0.01, 1.0);
        let found = identify(&once).unwrap();
        for apart_n in [0.0, 100.0] {
            let twice: Vec<_> = once.iter().flat_map(|p| [(p.0, p.1 - apart_n), (p.0, p.1 + apart_n)]).collect();
            let again = identify(&twice).unwrap();
            assert!((again.peak_n / found.peak_n - 1.0).abs() < 1e-9, "{again:?} instead of {found:?}");
            assert!((again.tyre.b / found.tyre.b - 1.0).abs() < 1e-9, "{again:?} instead of {found:?}");
        }
    }

    /// Below a quarter of the peak there are only two readings at almost one slip: their mean gives the slope.
    #[test]
    fn two_readings_at_almost_one_slip_are_a_slope() {
        let coarse =
            [(0.05, 2000.0), (0.050000001, 1600.0), (0.1, 4000.0), (0.2, 3900.0), (0.5, 3500.0), (1.0, 3300.0)];
        let found = identify(&coarse).unwrap();
        assert!((found.peak_n * found.tyre.slope_per_peak() / 36_000.0 - 1.0).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn curves_without_a_tyre_in_them_are_refused() {
        let line = |f: fn(f64) -> f64| (0..50).map(|k| (0.02 * f64::from(k), f(f64::from(k)))).collect::<Vec<_>>();
        for curve in [vec![], line(|_| 0.0), line(|k| k), line(|k| -k), line(|_| 7.0)] {
            assert!(matches!(identify(&curve), Err(TyreError::Curve(_))), "{curve:?}");
        }
        // Nothing at first, or next to nothing, and then a peak.
        let hump = |first: f64| move |k: f64| if k < 10.0 { first * k } else { 1.0 - 0.001 * (k - 30.0) * (k - 30.0) };
        for (first, why) in [(0.0, "the force does not rise from zero slip"), (1e-15, "no Magic Formula constants fit")]
        {
            let curve: Vec<_> = (0..50).map(|k| (0.02 * f64::from(k), hump(first)(f64::from(k)))).collect();
            assert_eq!(identify(&curve), Err(TyreError::Curve(why)));
        }
    }
}
