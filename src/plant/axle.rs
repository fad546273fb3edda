//! What an axle makes of the body's motion, and the body of an axle's forces: one geometry read in three ways.
//!
//! With v = (V_x, V_y, ψ̇) and the matrix A whose rows are the directions of the left wheel, the right wheel and the axle's
//! side force, the speeds of the hubs are A·v, the forces on the body Aᵀ·F, and dampers d at the hubs weigh on it as
//! Aᵀ·diag(d)·A. For an axle at x = a with wheels at y = ±w/2 turned by δ
//! ```text
//!     ⎡  cos δ   sin δ   a sin δ − (w/2) cos δ ⎤
//! A = ⎢  cos δ   sin δ   a sin δ + (w/2) cos δ ⎥
//!     ⎣ −sin δ   cos δ   a cos δ               ⎦
//! ```

/// Place and direction of an axle.
#[derive(Debug, Clone, Copy)]
pub struct Axle {
    /// Its x, a \[m\].
    place: f64,
    /// Lever of what left and right differ in, (w/2) cos δ \[m\].
    lever: f64,
    /// cos δ and sin δ of an axle that steers.
    steer: Option<[f64; 2]>,
}

impl Axle {
    /// An axle at `place_m` with wheels `half_track_m` to the left and to the right. `steer` is known when this is compiled:
    /// an axle that does not steer costs no product with 0 and 1.
    #[inline(always)]
    pub fn new(place_m: f64, half_track_m: f64, steer: Option<[f64; 2]>) -> Self {
        let lever = match steer {
            Some([cos, _]) => half_track_m * cos,
            None => half_track_m,
        };
        Self { place: place_m, lever, steer }
    }

    /// From body axes to those of the wheels.
    #[inline(always)]
    fn to_wheels(self, [x, y]: [f64; 2]) -> [f64; 2] {
        match self.steer {
            Some([cos, sin]) => [cos * x + sin * y, cos * y - sin * x],
            None => [x, y],
        }
    }

    /// And back.
    #[inline(always)]
    fn to_body(self, [along, across]: [f64; 2]) -> [f64; 2] {
        match self.steer {
            Some([cos, sin]) => [cos * along - sin * across, sin * along + cos * across],
            None => [along, across],
        }
    }

    /// A·v: speeds of the left hub, the right hub and across the axle; and along its middle.
    #[inline(always)]
    pub fn speeds(self, v: [f64; 3]) -> ([f64; 3], f64) {
        let [along, across] = self.to_wheels([v[0], v[1] + self.place * v[2]]);
        let apart = self.lever * v[2];
        ([along - apart, along + apart, across], along)
    }

    /// Aᵀ·F: force along x and y and moment about z of the forces along the wheels and across the axle.
    #[inline(always)]
    pub fn forces(self, [left, right, across]: [f64; 3]) -> [f64; 3] {
        let [x, y] = self.to_body([left + right, across]);
        [x, y, self.place * y + self.lever * (right - left)]
    }

    /// Aᵀ·diag(d)·A, its upper triangle: xx, xy, yy, xψ, yψ, ψψ.
    #[inline(always)]
    pub fn dampers(self, [left, right, across]: [f64; 3]) -> [f64; 6] {
        let (both, apart) = (left + right, self.lever * (right - left));
        let (a, b, spread) = (self.place, self.lever * self.lever * both, 2.0 * apart);
        match self.steer {
            Some([cos, sin]) => {
                let (cc, ss, cs) = (cos * cos, sin * sin, cos * sin);
                let (xx, xy, yy) = (both * cc + across * ss, (both - across) * cs, both * ss + across * cc);
                let (x_yaw, y_yaw) = (a * xy + apart * cos, a * yy + apart * sin);
                [xx, xy, yy, x_yaw, y_yaw, a * (a * yy + spread * sin) + b]
            }
            None => [both, 0.0, across, apart, a * across, a * a * across + b],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_speeds_forces_and_dampers_are_one_matrix() {
        let (place, half_track, delta) = (1.3, 0.8, 0.4_f64);
        for steer in [None, Some([libm::cos(delta), libm::sin(delta)])] {
            let axle = Axle::new(place, half_track, steer);
            let [cos, sin] = steer.unwrap_or([1.0, 0.0]);
            let rows = [
                [cos, sin, place * sin - half_track * cos],
                [cos, sin, place * sin + half_track * cos],
                [-sin, cos, place * cos],
            ];
            let d = [3.0, 7.0, 5.0];
            let square = axle.dampers(d);
            for (i, j, k) in [(0, 0, 0), (0, 1, 1), (1, 1, 2), (0, 2, 3), (1, 2, 4), (2, 2, 5)] {
                let expected: f64 = (0..3).map(|r| d[r] * rows[r][i] * rows[r][j]).sum();
                assert!((square[k] - expected).abs() < 1e-12, "({i}, {j}): {} for {expected}", square[k]);
            }
            for i in 0..3 {
                let unit = std::array::from_fn(|k| if k == i { 1.0 } else { 0.0 });
                let (speeds, forces) = (axle.speeds(unit).0, axle.forces(unit));
                for k in 0..3 {
                    assert!((speeds[k] - rows[k][i]).abs() < 1e-15 && (forces[k] - rows[i][k]).abs() < 1e-15);
                }
            }
        }
    }
}
