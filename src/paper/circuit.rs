//! A circuit of our own for the driver of [`super::human`]: nine corners of 35 m to 130 m radius and straights of up to 500 m,
//! 2.7 km in all, as handling courses have them. Curvature rises and falls linearly over [`TRANSITION_M`] on either side of a
//! corner (a clothoid). Two straights are as long as they are so that the circuit closes.

use std::f64::consts::PI;

/// Length of the transition between straight and arc \[m\].
const TRANSITION_M: f64 = 25.0;

/// A straight, and the corner behind it: length \[m\], radius \[m\], left positive, and angle \[°\].
const PARTS: [(f64, f64, f64); 9] = [
    (150.0, 70.0, 90.0),
    (60.0, -90.0, 60.0),
    (80.0, 60.0, 110.0),
    (120.0, -110.0, 70.0),
    (90.0, 130.0, 60.0),
    (60.0, 45.0, 120.0),
    (120.0, -80.0, 50.0),
    (379.7, 35.0, 100.0),
    (498.7, 120.0, 60.0),
];

/// A piece of the circuit with linear curvature.
#[derive(Debug, Clone, Copy)]
struct Piece {
    from_m: f64,
    length_m: f64,
    /// At its beginning and at its end [1/m].
    curvature_per_m: [f64; 2],
}

/// The circuit.
#[derive(Debug, Clone)]
pub struct Circuit {
    pieces: Vec<Piece>,
    /// Length of a lap \[m\].
    pub length_m: f64,
}

impl Circuit {
    /// The circuit, its beginning at that of the first straight.
    pub fn new() -> Self {
        let (mut pieces, mut from_m) = (Vec::new(), 0.0);
        for (straight_m, radius_m, angle_deg) in PARTS {
            let bend = 1.0 / radius_m;
            // Each transition turns by half of what the arc would turn over its length.
            let arc_m = angle_deg * PI / 180.0 * radius_m.abs() - TRANSITION_M;
            let corner = [(TRANSITION_M, [0.0, bend]), (arc_m, [bend, bend]), (TRANSITION_M, [bend, 0.0])];
            for (length_m, curvature_per_m) in std::iter::once((straight_m, [0.0, 0.0])).chain(corner) {
                pieces.push(Piece { from_m, length_m, curvature_per_m });
                from_m += length_m;
            }
        }
        Self { pieces, length_m: from_m }
    }

    /// Curvature at a place, left positive [1/m]; behind a lap the next one begins.
    pub fn curvature_at(&self, s_m: f64) -> f64 {
        let s = libm::fmod(s_m, self.length_m);
        let piece = &self.pieces[self.pieces.partition_point(|piece| piece.from_m <= s).max(1) - 1];
        let [begin, end] = piece.curvature_per_m;
        begin + (end - begin) * (s - piece.from_m) / piece.length_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_the_circuit_closes() {
        let circuit = Circuit::new();
        let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0_f64);
        let step_m = circuit.length_m / 200_000.0;
        for k in 0..200_000 {
            heading += circuit.curvature_at((f64::from(k) + 0.5) * step_m) * step_m;
            x += step_m * heading.cos();
            y += step_m * heading.sin();
        }
        assert!((heading - 2.0 * PI).abs() < 1e-3, "{heading}");
        assert!(x.hypot(y) < 0.5, "{x} {y}");
    }
}
