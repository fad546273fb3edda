//! Gain and delay margin of a loop: computed from the response of the linear loop, and found again in the full model.
//!
//! The speed that is measured is disturbed by d. With L the transfer function around the loop, the measured speed is then S d, S = 1/(1 + L), and
//! the response to an impulse of d, which fades where the loop is stable, gives
//! ```text
//! S(ω) = Σ y_k exp(−jωkΔt)/d,   L = 1/S − 1
//! gain margin   least 1/|L| > 1 where L is negative
//! delay margin  least (π + arg L)/ω where |L| = 1
//! ```
//! That takes the law as it runs, with its filters, its sampling and what it hears of its actuators, and needs no equation of it. The kick is
//! so small that nothing but the linear loop answers: the gain of `adaptive` stays nominal, `calibrating` learns nothing. In the full model
//! `calibrating` learns the delay from the torque that holds the speed, and is another loop: its margins need not be found again.

use super::closed_loop::{AS_IT_IS, Change, ClosedLoop, Vehicle};
use super::error::StabilityError;
use crate::lanes::{LANES, Lanes};

/// Length of a response \[s\].
const RESPONSE_S: f64 = 120.0;
/// The disturbance [m/s].
const KICK_MPS: f64 = 1e-6;
/// A response has faded below this share of the kick.
const FADED: f64 = 1e-4;
/// Frequencies that are looked at, on a logarithmic axis from the least to that of two samples.
const FREQUENCIES: usize = 3_000;
const LEAST_RADPS: f64 = 0.02;
/// Gains beyond this, and delays \[s\], are none that anybody reckons with.
const GAIN_MAX: f64 = 100.0;
const DELAY_MAX_S: f64 = 10.0;
/// The variants that are tried in the full model are this far apart.
const STEP: f64 = 0.04;
/// The disturbance in the full model [m/s].
const FULL_KICK_MPS: f64 = 0.05;

/// The margins of a loop.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Margins {
    /// False if the loop is not stable as it is.
    pub stable: bool,
    /// Where |L| first falls below 1 [rad/s].
    pub crossover_radps: Option<f64>,
    /// By how much the vehicle may answer more than it should.
    pub gain: Option<f64>,
    /// The same in the full model.
    pub gain_simulated: Option<f64>,
    /// How much later the speed may be measured \[s\].
    pub delay_s: Option<f64>,
    /// The same in the full model.
    pub delay_simulated_s: Option<f64>,
}

/// Computes the margins, and finds them again.
pub fn margins(loops: &ClosedLoop) -> Result<Margins, StabilityError> {
    let response = loops.run(Vehicle::Linear, &[AS_IT_IS; LANES], RESPONSE_S, KICK_MPS)?;
    let response: Vec<f64> = response.iter().map(|lanes| lanes[0] / KICK_MPS).collect();
    let last = &response[response.len() * 9 / 10..];
    if last.iter().any(|y| !y.is_finite() || y.abs() > FADED) {
        return Ok(Margins::default());
    }
    let mut found = computed(&response, loops.period_s());
    if let Some(gain) = found.gain {
        let gains: [f64; LANES] = std::array::from_fn(|i| gain * (1.0 + STEP * (i as f64 - 0.5 * (LANES - 1) as f64)));
        let changes = gains.map(|gain| Change { gain, late: 0 });
        found.gain_simulated = first_unstable(loops, &changes)?.map(|i| 0.5 * (gains[i - 1] + gains[i]));
    }
    if let Some(delay_s) = found.delay_s {
        let late = delay_s / loops.period_s();
        let step = (STEP * late).ceil().max(1.0) as usize;
        let first = (late as usize).saturating_sub(step * LANES / 2);
        let lates: [usize; LANES] = std::array::from_fn(|i| first + i * step);
        let changes = lates.map(|late| Change { gain: 1.0, late });
        let between = |i: usize| 0.5 * loops.period_s() * (lates[i - 1] + lates[i]) as f64;
        found.delay_simulated_s = first_unstable(loops, &changes)?.map(between);
    }
    Ok(found)
}

/// The margins of the loop with this response to an impulse.
fn computed(response: &[f64], period_s: f64) -> Margins {
    let highest = std::f64::consts::PI / period_s;
    let ratio = libm::log(highest / LEAST_RADPS) / (FREQUENCIES - 1) as f64;
    let mut found = Margins { stable: true, ..Margins::default() };
    let mut before: Option<(f64, [f64; 2])> = None;
    for i in 0..FREQUENCIES {
        let radps = LEAST_RADPS * libm::exp(ratio * i as f64);
        let open = open_loop(response, radps * period_s);
        if let Some((radps_before, open_before)) = before {
            cross(&mut found, [radps_before, radps], [open_before, open]);
        }
        before = Some((radps, open));
    }
    found
}

/// L at a frequency \[rad per sample\], as real and imaginary part.
fn open_loop(response: &[f64], rad: f64) -> [f64; 2] {
    let (turn_re, turn_im) = (libm::cos(rad), -libm::sin(rad));
    let (mut re, mut im, mut s_re, mut s_im) = (1.0, 0.0, 0.0, 0.0);
    for y in response {
        s_re += y * re;
        s_im += y * im;
        (re, im) = (re * turn_re - im * turn_im, re * turn_im + im * turn_re);
    }
    let square = s_re * s_re + s_im * s_im;
    [s_re / square - 1.0, -s_im / square]
}

/// Takes what happens between two frequencies: the imaginary part changes its sign, or the absolute value passes 1.
fn cross(found: &mut Margins, radps: [f64; 2], open: [[f64; 2]; 2]) {
    let least = |known: Option<f64>, new: f64| Some(known.map_or(new, |known| known.min(new)));
    let [[re_0, im_0], [re_1, im_1]] = open;
    if (im_0 > 0.0) != (im_1 > 0.0) {
        let real = re_0 + (re_1 - re_0) * im_0 / (im_0 - im_1);
        let gain = -1.0 / real;
        if gain > 1.0 && gain < GAIN_MAX {
            found.gain = least(found.gain, gain);
        }
    }
    let size = open.map(|[re, im]| libm::sqrt(re * re + im * im));
    if (size[0] > 1.0) != (size[1] > 1.0) {
        let share = (size[0] - 1.0) / (size[0] - size[1]);
        let at = |pair: [f64; 2]| pair[0] + share * (pair[1] - pair[0]);
        let (frequency, re, im) = (at(radps), at([re_0, re_1]), at([im_0, im_1]));
        // From arg L down to −π, however often around.
        let room = (libm::atan2(im, re) + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU);
        found.crossover_radps = found.crossover_radps.or(Some(frequency));
        if room / frequency < DELAY_MAX_S {
            found.delay_s = least(found.delay_s, room / frequency);
        }
    }
}

/// The first variant that swings up in the full model, none if all or none do.
fn first_unstable(loops: &ClosedLoop, changes: &[Change; LANES]) -> Result<Option<usize>, StabilityError> {
    let response = loops.run(Vehicle::Full, changes, RESPONSE_S, FULL_KICK_MPS)?;
    let third = response.len() / 3;
    let range = |part: &[Lanes], slot: usize| {
        let (least, most) = part.iter().fold((f64::MAX, f64::MIN), |(l, m), y| (l.min(y[slot]), m.max(y[slot])));
        most - least
    };
    let swings_up = |slot: usize| {
        let [middle, last] = [range(&response[third..2 * third], slot), range(&response[2 * third..], slot)];
        // What has swung up to its end stays there.
        last > 1e-6 && last > middle || last > 1.0
    };
    Ok((0..LANES).find(|slot| swings_up(*slot)).filter(|first| *first > 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_margins_of_a_delayed_integrator_are_the_known_ones() {
        // y' = −k y(t − θ): unstable from kθ = π/2 on, sampled a little earlier: L = kΔt z^(−d−1)/(1 − z⁻¹) is −1 at 2 sin(π/(2(2d + 1)))/Δt.
        let (k, period_s) = (1.5, 0.01);
        for late in [0, 7, 25] {
            let mut y = vec![0.0; 12_000];
            for i in 0..y.len() {
                let disturbed = |j: usize| if j == 0 { y[0] + 1.0 } else { y[j] };
                let rate = if i >= late { -k * disturbed(i - late) } else { 0.0 };
                if i + 1 < y.len() {
                    y[i + 1] = y[i] + period_s * rate;
                }
            }
            y[0] += 1.0;
            let found = computed(&y, period_s);
            let critical = 2.0 * (std::f64::consts::FRAC_PI_2 / (2.0 * late as f64 + 1.0)).sin() / period_s;
            let gain = critical / k;
            assert!(late == 0 || (found.gain.unwrap() / gain - 1.0).abs() < 0.01, "{late}: {found:?} for {gain}");
            let delay_s = std::f64::consts::FRAC_PI_2 / k - (late as f64 + 0.5) * period_s;
            assert!((found.delay_s.unwrap() - delay_s).abs() < 0.005, "{late}: {found:?} for {delay_s}");
            assert!((found.crossover_radps.unwrap() - k).abs() < 0.01);
        }
    }
}
