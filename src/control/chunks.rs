//! Long windows by chunks: what sixteen samples in a row add to F̂, whatever their place in the window.
//!
//! The weights of the estimator are polynomials of a sample's place. With x the place from the middle of the window, in periods,
//! sample x = p + j of a chunk around p adds w(p + j), and the whole chunk a polynomial of p:
//! ```text
//! w(x) = −2c x y + d (n²/4 − x²) v        c, d from the window; the halves at its two ends apart
//! Σ w(p + j) = c₀ + c₁p + c₂p²            c₀ = Σ −2c j y + d (n²/4 − j²) v,   c₁ = Σ −2c y − 2d j v,   c₂ = Σ −d v
//! ```
//! The three sums are taken once, when the chunk's newest sample comes in, over the samples themselves and always in the same
//! order: in pairs j and −j, from the outermost one inwards. They stay beside that sample and serve at every place that the
//! chunk takes while it is in the window. So an estimate remains a function of the window's content, to the bit, and reads
//! a fifth of it; the room that a window takes is two and a half times as much.

use crate::lanes::{LANES, Lanes, vectorised};

/// One sample of a block: the measured speed [m/s] and the input that led to it [m/s²].
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Sample {
    pub y: Lanes,
    pub v: Lanes,
}

/// Samples of a chunk.
pub(super) const LENGTH: usize = 16;

/// What a chunk adds to F̂: the coefficients of 1, p and p².
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Chunk([Lanes; 3]);

/// The coefficients of a pair of samples, j and −j.
#[derive(Debug, Clone, Copy)]
struct Pair {
    /// −2c j, of the difference of y in c₀.
    y: f64,
    /// d (n²/4 − j²), of the sum of v in c₀.
    v: f64,
    /// −2d j, of the difference of v in c₁.
    slope: f64,
}

/// The coefficients of a chunk's samples.
#[derive(Debug, Clone, Copy)]
struct Shares {
    pairs: [Pair; LENGTH / 2],
    /// −2c, of y in c₁.
    y: f64,
    /// −d, of v in c₂.
    v: f64,
}

/// The chunks of a window: one for every sample, of which it is the newest.
#[derive(Debug, Clone)]
pub(super) struct Chunks {
    shares: Shares,
    /// Places p of the chunks that make up the window, oldest first.
    places: Vec<f64>,
    /// A ring like that of the samples.
    ring: Vec<Chunk>,
}

impl Chunks {
    /// For a window of `intervals`, the first `singles` and the last one of its samples being counted one by one; `c` and `d`
    /// as in the head of this file.
    pub(super) fn new(intervals: usize, singles: usize, c: f64, d: f64) -> Self {
        let half = 0.5 * intervals as f64;
        let middle = 0.5 * (LENGTH - 1) as f64;
        let pair = |k: usize| {
            let j = middle - k as f64;
            Pair { y: -2.0 * c * j, v: d * (half * half - j * j), slope: -2.0 * d * j }
        };
        let shares = Shares { pairs: std::array::from_fn(pair), y: -2.0 * c, v: -d };
        let firsts = (singles..intervals).step_by(LENGTH);
        let places = firsts.map(|first| first as f64 + middle - half).collect();
        Self { shares, places, ring: vec![Chunk([[0.0; LANES]; 3]); intervals + 1] }
    }

    /// Takes the chunk of the newest sample, `samples[newest]`, from the samples.
    pub(super) fn take(&mut self, samples: &[Sample], newest: usize) {
        gather(&self.shares, samples, newest, &mut self.ring[newest]);
    }

    /// Adds all chunks to `sum`, oldest first, where `newest` is the place of the newest sample in the ring.
    pub(super) fn add(&self, newest: usize, sum: &mut Lanes) {
        combine(&self.places, &self.ring, newest, sum);
    }

    /// Fills a slot with chunks of a constant speed and zero input.
    pub(super) fn fill(&mut self, slot: usize, y_mps: f64) {
        let constant = [Sample { y: [y_mps; LANES], v: [0.0; LANES] }; LENGTH];
        let mut chunk = Chunk([[0.0; LANES]; 3]);
        gather(&self.shares, &constant, LENGTH - 1, &mut chunk);
        for Chunk(known) in &mut self.ring {
            for (known, c) in known.iter_mut().zip(&chunk.0) {
                known[slot] = c[slot];
            }
        }
    }
}

vectorised! {
    /// Sums up the last samples of a ring to a chunk.
    fn gather(shares: &Shares, ring: &[Sample], newest: usize, chunk: &mut Chunk) {
        let [mut c_0, mut y_sum, mut v_slope, mut v_sum] = [[0.0; LANES]; 4];
        let back = |k: usize| if newest >= k { &ring[newest - k] } else { &ring[newest + ring.len() - k] };
        for (k, pair) in shares.pairs.iter().enumerate() {
            let (newer, older) = (back(k), back(LENGTH - 1 - k));
            for i in 0..LANES {
                let v = newer.v[i] + older.v[i];
                c_0[i] += pair.y * (newer.y[i] - older.y[i]) + pair.v * v;
                y_sum[i] += newer.y[i] + older.y[i];
                v_slope[i] += pair.slope * (newer.v[i] - older.v[i]);
                v_sum[i] += v;
            }
        }
        chunk.0[0] = c_0;
        for i in 0..LANES {
            chunk.0[1][i] = shares.y * y_sum[i] + v_slope[i];
            chunk.0[2][i] = shares.v * v_sum[i];
        }
    }
}

vectorised! {
    /// Adds the chunks that end 1, 1 + 16, 1 + 32, ... samples before the newest, the oldest of them first.
    fn combine(places: &[f64], ring: &[Chunk], newest: usize, sum: &mut Lanes) {
        let mut total = *sum;
        let mut at = newest + ring.len() - 1 - LENGTH * (places.len() - 1);
        for &p in places {
            let Chunk([c_0, c_1, c_2]) = &ring[if at >= ring.len() { at - ring.len() } else { at }];
            for i in 0..LANES {
                total[i] += c_0[i] + p * (c_1[i] + p * c_2[i]);
            }
            at += LENGTH;
        }
        *sum = total;
    }
}
