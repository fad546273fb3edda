//! The discrete algebraic Riccati equation, for loops of a few states and one input.
//!
//! Of all u = −Kx, that which has the least Σ xᵀQx + r u² along x_{k+1} = A x_k + B u_k:
//! ```text
//! P = Q + AᵀPA − AᵀPB (r + BᵀPB)⁻¹ BᵀPA,   K = (r + BᵀPB)⁻¹ BᵀPA
//! ```
//! The doubling algorithm (Anderson 1978, Int. J. Control 28(2), 295-306) goes from the cost of n steps to that of 2n, and so converges quadratically.

/// A square matrix, by rows.
pub(super) type Matrix<const N: usize> = [[f64; N]; N];
/// A column or a row.
pub(super) type Vector<const N: usize> = [f64; N];

/// Doublings at most: costs of 2⁵⁰ steps.
const DOUBLINGS: usize = 50;
/// Relative change of P that counts as none.
const DONE: f64 = 1e-14;

/// P and K.
#[derive(Debug, Clone, Copy)]
pub(super) struct Regulator<const N: usize> {
    /// P, the cost to go.
    pub cost: Matrix<N>,
    /// K.
    pub gains: Vector<N>,
}

/// Solves the equation. The pair (A, B) has to be stabilisable and Q positive semidefinite with every state in it by (A, Q); r > 0.
pub(super) fn regulator<const N: usize>(a: &Matrix<N>, b: &Vector<N>, q: &Vector<N>, r: f64) -> Regulator<N> {
    let mut forward = *a;
    let mut reach: Matrix<N> = matrix(|i, j| b[i] * b[j] / r);
    let mut cost: Matrix<N> = matrix(|i, j| if i == j { q[i] } else { 0.0 });
    for _ in 0..DOUBLINGS {
        // W = (1 + GH)⁻¹; A ← AWA, G ← G + AWGAᵀ, H ← H + AᵀHWA.
        let w = inverse(&add(&identity(), &times(&reach, &cost)));
        let (aw, wa) = (times(&forward, &w), times(&w, &forward));
        let more_cost = times(&transposed(&forward), &times(&cost, &wa));
        reach = symmetric(&add(&reach, &times(&times(&aw, &reach), &transposed(&forward))));
        forward = times(&aw, &forward);
        cost = symmetric(&add(&cost, &more_cost));
        if largest(&more_cost) <= DONE * largest(&cost) {
            break;
        }
    }
    let pb = apply(&cost, b);
    let curvature = r + dot(b, &pb);
    Regulator { cost, gains: std::array::from_fn(|j| (0..N).map(|i| pb[i] * a[i][j]).sum::<f64>() / curvature) }
}

fn matrix<const N: usize>(entry: impl Fn(usize, usize) -> f64) -> Matrix<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

fn identity<const N: usize>() -> Matrix<N> {
    matrix(|i, j| if i == j { 1.0 } else { 0.0 })
}

fn transposed<const N: usize>(a: &Matrix<N>) -> Matrix<N> {
    matrix(|i, j| a[j][i])
}

fn symmetric<const N: usize>(a: &Matrix<N>) -> Matrix<N> {
    matrix(|i, j| 0.5 * (a[i][j] + a[j][i]))
}

fn add<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    matrix(|i, j| a[i][j] + b[i][j])
}

/// A product of matrices.
pub(super) fn times<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    matrix(|i, j| (0..N).map(|k| a[i][k] * b[k][j]).sum())
}

/// A matrix times a column.
pub(super) fn apply<const N: usize>(a: &Matrix<N>, x: &Vector<N>) -> Vector<N> {
    std::array::from_fn(|i| dot(&a[i], x))
}

/// An inner product.
pub(super) fn dot<const N: usize>(x: &Vector<N>, y: &Vector<N>) -> f64 {
    (0..N).map(|i| x[i] * y[i]).sum()
}

fn largest<const N: usize>(a: &Matrix<N>) -> f64 {
    a.iter().flatten().fold(0.0, |most, x| most.max(x.abs()))
}

/// Gauss and Jordan, with the largest entry of a column for its pivot.
fn inverse<const N: usize>(a: &Matrix<N>) -> Matrix<N> {
    let (mut left, mut right) = (*a, identity());
    for column in 0..N {
        let below = column..N;
        let pivot = below.max_by(|i, j| left[*i][column].abs().total_cmp(&left[*j][column].abs())).unwrap_or(column);
        left.swap(column, pivot);
        right.swap(column, pivot);
        let scale = 1.0 / left[column][column];
        left[column] = left[column].map(|x| scale * x);
        right[column] = right[column].map(|x| scale * x);
        for row in (0..N).filter(|row| *row != column) {
            let share = left[row][column];
            for j in 0..N {
                left[row][j] -= share * left[column][j];
                right[row][j] -= share * right[column][j];
            }
        }
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_the_scalar_solution_is_the_known_one() {
        // p = q + p − p²b²/(r + p b²) with a = 1: p² b² − q b² p − q r = 0.
        let (b, q, r) = (0.01, 3.0, 2.0);
        let found = regulator(&[[1.0]], &[b], &[q], r);
        let p = 0.5 * (q + (q * q + 4.0 * q * r / (b * b)).sqrt());
        assert!((found.cost[0][0] / p - 1.0).abs() < 1e-12);
        assert!((found.gains[0] / (p * b / (r + p * b * b)) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn law_the_solution_solves_its_equation_and_no_other_gain_costs_less() {
        let (dt, lag) = (0.01, 0.9);
        for (q, r) in [([1.0, 0.0, 0.04], 1.0), ([1.0, 0.0, 100.0], 1e-4), ([1.0, 0.0, 1e-4], 1e4)] {
            let a = [[1.0, dt * lag, 0.0], [0.0, lag, 0.0], [dt, 0.0, 1.0]];
            let b = [dt * (1.0 - lag), 1.0 - lag, 0.0];
            let found = regulator(&a, &b, &q, r);
            let pa = times(&found.cost, &a);
            let bpa: Vector<3> = std::array::from_fn(|j| (0..3).map(|i| b[i] * pa[i][j]).sum());
            let apa = times(&transposed(&a), &pa);
            for i in 0..3 {
                for j in 0..3 {
                    let own = if i == j { q[i] } else { 0.0 };
                    let again = own + apa[i][j] - bpa[i] * found.gains[j];
                    let gap = (found.cost[i][j] - again).abs();
                    assert!(gap < 1e-9 * largest(&found.cost), "{i} {j}: {gap}");
                }
            }
            let cost = |gains: &Vector<3>| {
                let (mut x, mut sum) = ([1.0, -0.5, 0.3], 0.0);
                for _ in 0..400_000 {
                    let u = -dot(gains, &x);
                    sum += r * u * u + (0..3).map(|i| q[i] * x[i] * x[i]).sum::<f64>();
                    let next = apply(&a, &x);
                    x = std::array::from_fn(|i| next[i] + b[i] * u);
                }
                sum
            };
            let least = cost(&found.gains);
            let x = [1.0, -0.5, 0.3];
            assert!((least / dot(&x, &apply(&found.cost, &x)) - 1.0).abs() < 1e-6, "{least}");
            for (i, factor) in [(0, 0.99), (0, 1.01), (1, 0.9), (1, 1.1), (2, 0.99), (2, 1.01)] {
                let mut gains = found.gains;
                gains[i] *= factor;
                assert!(cost(&gains) > least, "gain {i} times {factor}");
            }
        }
    }
}
