//! One random stream per vehicle and purpose, independent of the order in which vehicles appear and of the number of
//! threads. Only `libm` (pure Rust) is used, so that the bits do not depend on the platform's maths library.

use crate::lanes::{LANES, Lanes, vectorised};
use crate::trig::{Polynomial, Trig};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sha2::{Digest, Sha256};

/// A stream of random numbers owned by one vehicle.
#[derive(Debug, Clone)]
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// The stream of `id` for `purpose` ("noise", "mass", ...) in a run with `seed`.
    pub fn new(seed: u64, purpose: &str, id: &str) -> Self {
        let mut hash = Sha256::new();
        hash.update(seed.to_le_bytes());
        hash.update(purpose.as_bytes());
        hash.update([0]);
        hash.update(id.as_bytes());
        Self(ChaCha8Rng::from_seed(hash.finalize().into()))
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.0.random::<f64>()
    }

    /// Standard normal (Box and Muller 1958, the cosine branch).
    pub fn normal(&mut self) -> f64 {
        let u = 1.0 - self.uniform();
        let phase = std::f64::consts::TAU * self.uniform();
        (-2.0 * libm::log(u)).sqrt() * libm::cos(phase)
    }
}

vectorised! {
    /// Standard normals from two columns of uniforms in [0, 1), to rounding what [`Stream::normal`] makes of the same two
    /// draws.
    pub fn normals(first: &Lanes, second: &Lanes, out: &mut Lanes) {
        for i in 0..LANES {
            let radius = (-2.0 * Polynomial::ln(1.0 - first[i])).sqrt();
            // cos φ = sin(π/2 − φ), which stays within the range of the polynomial.
            let phase = std::f64::consts::TAU * second[i];
            out[i] = radius * Polynomial::sin(std::f64::consts::FRAC_PI_2 - phase);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_normals_by_lanes_are_those_of_the_stream() {
        let (mut one, mut other) = (Stream::new(3, "noise", "lanes"), Stream::new(3, "noise", "lanes"));
        for _ in 0..10_000 {
            let expected: Lanes = std::array::from_fn(|_| one.normal());
            let (mut first, mut second, mut normal) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                (first[i], second[i]) = (other.uniform(), other.uniform());
            }
            normals(&first, &second, &mut normal);
            for i in 0..LANES {
                assert!((normal[i] - expected[i]).abs() < 1e-14, "{} for {}", normal[i], expected[i]);
            }
        }
        let mut edge = [f64::NAN; LANES];
        normals(&[0.0; LANES], &[0.25; LANES], &mut edge);
        assert!(edge.iter().all(|x| *x == 0.0));
        normals(&[1.0 - f64::EPSILON / 2.0; LANES], &[0.0; LANES], &mut edge);
        assert!(edge.iter().all(|x| (x - 8.57).abs() < 0.01), "{edge:?}");
    }
}
