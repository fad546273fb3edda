//! One random stream per vehicle and purpose, independent of the order in which vehicles appear and of the number of
//! threads. Only `libm` (pure Rust) is used, so that the bits do not depend on the platform's maths library.

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
