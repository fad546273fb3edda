//! The reference of one step, control period by control period.

use super::follow::Follow;
use crate::lanes::{Flags, LANES, Lanes};

/// The reference of one control period.
pub(super) struct Demand {
    pub start_mps: Lanes,
    pub end_mps: Lanes,
    pub rate_mps2: Lanes,
    /// 1 = standing still is what is wanted.
    pub rest: Flags,
    /// Middle of the period as a share of the step.
    pub share: f64,
}

/// The vehicles as they are when a control period begins.
pub(super) struct Here<'b> {
    pub present: &'b Flags,
    pub target_mps: &'b Lanes,
    /// 1 = the target alone counts.
    pub ordered: &'b Flags,
    pub speed_mps: &'b Lanes,
    pub distance_m: &'b Lanes,
    pub clock_s: &'b Lanes,
}

/// A step under way.
pub(super) struct Course<'a> {
    pub follow: Follow<'a>,
    /// Speeds at its beginning [m/s].
    pub before_mps: Lanes,
    /// In traffic: straight from this speed [m/s], at this rate, to rest where that is wanted.
    pub start_mps: Lanes,
    pub rate_mps2: Lanes,
    pub rest: Flags,
}

impl<'a> Course<'a> {
    /// The target, or a profile below it, at each control period's own place and time.
    pub fn of_targets(follow: Follow<'a>, before_mps: Lanes) -> Self {
        let zero = [0.0; LANES];
        Self { follow, before_mps, start_mps: zero, rate_mps2: zero, rest: zero }
    }

    /// The control period `k` (from 0) of `periods` of `period_s`.
    #[inline(always)]
    pub fn demand(&self, k: u32, periods: u32, period_s: f64, here: &Here<'_>) -> Demand {
        let share = (f64::from(k) + 0.5) / f64::from(periods);
        if let Follow::Traffic = self.follow {
            let at = |tau_s: f64| std::array::from_fn(|i| (self.start_mps[i] + self.rate_mps2[i] * tau_s).max(0.0));
            let tau_s = f64::from(k) * period_s;
            let (start_mps, end_mps) = (at(tau_s), at(tau_s + period_s));
            return Demand { start_mps, end_mps, rate_mps2: self.rate_mps2, rest: self.rest, share };
        }
        let (start_mps, rate_mps2) = targets(self.follow, here, 0.0);
        let (end_mps, _) = targets(self.follow, here, period_s);
        let rest = std::array::from_fn(|i| if start_mps[i] == 0.0 && end_mps[i] == 0.0 { 1.0 } else { 0.0 });
        Demand { start_mps, end_mps, rate_mps2, rest, share }
    }
}

/// Target speeds and rates `ahead_s` from now, the vehicles rolling on at their present speed.
fn targets(follow: Follow<'_>, here: &Here<'_>, ahead_s: f64) -> (Lanes, Lanes) {
    let mut speed = *here.target_mps;
    let mut rate = [0.0; LANES];
    let profiles = match follow {
        Follow::Profile(profile) => &[profile; LANES],
        Follow::Profiles(profiles) => profiles,
        Follow::Traffic | Follow::Target => return (speed, rate),
    };
    for i in (0..LANES).filter(|i| here.present[*i] > 0.0 && here.ordered[*i] == 0.0) {
        let rolling_mps = here.speed_mps[i];
        let place_m = here.distance_m[i] + rolling_mps * ahead_s;
        let (wanted, wanted_rate) = profiles[i].at(place_m, here.clock_s[i] + ahead_s, rolling_mps);
        if wanted <= speed[i] {
            (speed[i], rate[i]) = (wanted, wanted_rate);
        }
    }
    (speed, rate)
}
