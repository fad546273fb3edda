//! What the speed sensor makes of the true speed: white Gaussian noise on V_x (Polack et al. 2017, Section 4.1, "Adding
//! Noise"), one draw per vehicle and control period.

use crate::columns::columns;
use crate::keys;
use crate::lanes::{Flags, LANES, Lanes};
use crate::random::{Stream, normals};

keys! {
    /// Keys of the noise on the measured speed.
    pub struct NoiseKeys {
        /// power of the white noise on the measured speed, re 1 (m/s)²; not set = none
        power_db: Option<f64>, "dB", -200.0..=60.0;
    }
}

/// Standard deviation [m/s] of white noise with a power of `power_db` (dB) relative to 1 m²/s²: −6 dB is 0.501 m/s.
pub fn sigma_mps(power_db: f64) -> f64 {
    libm::pow(10.0, power_db / 20.0)
}

columns! {
    /// The speed sensors of one block of vehicles, noiseless until [`Measurement::set`] says otherwise.
    #[derive(Debug, Clone)]
    pub struct Measurement {
        columns {
            streams: Option<Stream> = None,
            sigma_mps: f64 = 0.0,
        }
    }
}

impl Measurement {
    /// Gives a slot the noise of a new vehicle, or none.
    pub fn set(&mut self, slot: usize, stream: Option<Stream>, sigma_mps: f64) {
        self.streams[slot] = stream;
        self.sigma_mps[slot] = if self.streams[slot].is_some() { sigma_mps } else { 0.0 };
    }

    /// The measured speeds of this control period [m/s]. Where `noisy` is 0, for a vehicle that stands, the true speed is
    /// returned, but the draw is made all the same: the n-th draw then belongs to the n-th period of the vehicle's
    /// life whatever the controller, and runs with different controllers meet the same noise.
    pub fn measure(&mut self, true_mps: &Lanes, noisy: &Flags) -> Lanes {
        let (mut first, mut second, mut normal) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let mut measured = *true_mps;
        if self.streams.iter().all(Option::is_none) {
            return measured;
        }
        for (i, stream) in self.streams.iter_mut().enumerate() {
            if let Some(stream) = stream {
                (first[i], second[i]) = (stream.uniform(), stream.uniform());
            }
        }
        normals(&first, &second, &mut normal);
        for i in 0..LANES {
            measured[i] += self.sigma_mps[i] * noisy[i] * normal[i];
        }
        measured
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noisy_block() -> Measurement {
        let mut block = Measurement::default();
        for slot in 0..LANES - 1 {
            block.set(slot, Some(Stream::new(7, "noise", &slot.to_string())), sigma_mps(-6.0));
        }
        block
    }

    #[test]
    fn minus_six_decibels_are_half_a_metre_per_second() {
        assert!((sigma_mps(-6.0) - 0.501_187).abs() < 1e-6);
        assert_eq!(sigma_mps(0.0), 1.0);
    }

    #[test]
    fn noise_is_white_with_the_power_asked_for() {
        let mut block = noisy_block();
        let (mut sum, mut squares, mut neighbours, mut last) = (0.0, 0.0, 0.0, [0.0; LANES]);
        let periods = 20_000;
        for _ in 0..periods {
            let noise = block.measure(&[0.0; LANES], &[1.0; LANES]);
            assert_eq!(noise[LANES - 1], 0.0, "a slot without a stream is exact");
            for i in 0..LANES - 1 {
                sum += noise[i];
                squares += noise[i] * noise[i];
                neighbours += noise[i] * last[i];
            }
            last = noise;
        }
        let samples = f64::from(periods) * (LANES - 1) as f64;
        let power = squares / samples;
        assert!((power / libm::pow(10.0, -0.6) - 1.0).abs() < 0.02, "{power}");
        assert!((sum / samples).abs() < 0.005 && (neighbours / samples / power).abs() < 0.01);
    }

    #[test]
    fn a_standing_vehicle_is_measured_exactly_and_its_noise_goes_on_in_step() {
        let (mut stops, mut drives) = (noisy_block(), noisy_block());
        let mut standing = [1.0; LANES];
        standing[4] = 0.0;
        for k in 0..10 {
            let flags = if (3..6).contains(&k) { &standing } else { &[1.0; LANES] };
            let (a, b) = (stops.measure(&[2.0; LANES], flags), drives.measure(&[2.0; LANES], &[1.0; LANES]));
            if flags[4] == 0.0 {
                assert_eq!(a[4], 2.0);
                assert!(b[4] != 2.0);
            } else {
                assert_eq!(a, b);
            }
        }
    }
}
