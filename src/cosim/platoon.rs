//! String stability: by how much a follower's speed varies more than that of the vehicle ahead.
//!
//! While an ego follows another, both speeds are taken at the end of every step. With v̄ the mean of each over an episode, the
//! gains are ‖v − v̄‖₂ / ‖v_ahead − v̄_ahead‖₂ and the same with half the range, (max − min)/2, for the largest deviation
//! (Ploeg, van de Wouw and Nijmeijer 2014, IEEE Trans. Control Syst. Technol. 22(2)). Episodes that are shorter than
//! [`SHORTEST_S`] say nothing; longer ones are added up under the root. A gain above 1 says that disturbances grow from
//! vehicle to vehicle.

use crate::fleet::Slot;
use crate::table::record;
use std::sync::Arc;

/// How far ahead a vehicle is followed \[m\].
pub const AHEAD_M: f64 = 100.0;
/// Shorter than this nobody is said to follow \[s\].
pub const SHORTEST_S: f64 = 20.0;

record! {
    /// How a vehicle passes on what the egos ahead of it do.
    #[derive(Debug, Clone, Copy, Default, PartialEq)]
    pub struct StringGain {
        following_time: Option<f64> = "Time for which it followed another ego, in episodes of at least 20 s; empty unless output.platoons" ["s"];
        string_gain_l2: Option<f64> = "String stability: L2 norm of its speed's deviation over that of the vehicle ahead";
        string_gain_linf: Option<f64> = "String stability: the same with the largest deviation, half the range";
    }
}

/// A speed over an episode, less the first value for the sake of digits.
#[derive(Debug, Clone, Copy)]
struct Swing {
    first: f64,
    sum: f64,
    squares: f64,
    lowest: f64,
    highest: f64,
}

impl Swing {
    fn new(speed_mps: f64) -> Self {
        Self { first: speed_mps, sum: 0.0, squares: 0.0, lowest: speed_mps, highest: speed_mps }
    }

    fn note(&mut self, speed_mps: f64) {
        let from_first = speed_mps - self.first;
        self.sum += from_first;
        self.squares += from_first * from_first;
        self.lowest = self.lowest.min(speed_mps);
        self.highest = self.highest.max(speed_mps);
    }

    /// Sum of the squared deviations from the mean of n values.
    fn deviation(&self, n: f64) -> f64 {
        (self.squares - self.sum * self.sum / n).max(0.0)
    }
}

/// Follower and vehicle ahead.
#[derive(Debug, Clone)]
struct Episode {
    ahead: Arc<str>,
    slot: Slot,
    steps: f64,
    time_s: f64,
    swings: [Swing; 2],
}

/// What one ego has followed so far.
#[derive(Debug, Clone, Default)]
pub struct Follower {
    episode: Option<Episode>,
    time_s: f64,
    /// Squared deviations, its own and those ahead.
    squares: [f64; 2],
    /// Half ranges, its own and those ahead.
    ranges: [f64; 2],
}

impl Follower {
    /// This ego is ahead now, or none.
    pub fn see(&mut self, ahead: Option<(&Arc<str>, Slot)>) {
        let same = |episode: &Episode| ahead.is_some_and(|(id, slot)| episode.slot == slot && episode.ahead == *id);
        if self.episode.as_ref().map_or(ahead.is_none(), same) {
            return;
        }
        self.close();
        self.episode = ahead.map(|(id, slot)| {
            let nothing = [Swing::new(0.0); 2];
            Episode { ahead: id.clone(), slot, steps: 0.0, time_s: 0.0, swings: nothing }
        });
    }

    /// Who is ahead, if anybody.
    pub fn ahead(&self) -> Option<(&Arc<str>, Slot)> {
        self.episode.as_ref().map(|episode| (&episode.ahead, episode.slot))
    }

    /// Both speeds at the end of a step, its own and that of the vehicle ahead.
    pub fn note(&mut self, speeds_mps: [f64; 2], step_s: f64) {
        let Some(episode) = &mut self.episode else { return };
        if episode.steps == 0.0 {
            episode.swings = speeds_mps.map(Swing::new);
        }
        episode.steps += 1.0;
        episode.time_s += step_s;
        episode.swings.iter_mut().zip(speeds_mps).for_each(|(swing, speed_mps)| swing.note(speed_mps));
    }

    fn close(&mut self) {
        let Some(Episode { steps, time_s, swings, .. }) = self.episode.take() else { return };
        // Sums of steps are rounded.
        if time_s < SHORTEST_S - 1e-6 {
            return;
        }
        self.time_s += time_s;
        for (k, swing) in swings.iter().enumerate() {
            self.squares[k] += swing.deviation(steps);
            self.ranges[k] += 0.5 * (swing.highest - swing.lowest);
        }
    }

    /// What it has been; the episode under way ends.
    pub fn gain(mut self) -> StringGain {
        self.close();
        let ratio = |[own, ahead]: [f64; 2]| (ahead > 0.0).then(|| own / ahead);
        StringGain {
            following_time: (self.time_s > 0.0).then_some(self.time_s),
            string_gain_l2: ratio(self.squares).map(f64::sqrt),
            string_gain_linf: ratio(self.ranges),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.1;

    /// Follows `ahead` for so many steps in which both speeds are swings about 10 m/s.
    fn follow(follower: &mut Follower, ahead: &str, steps: u32, amplitudes_mps: [f64; 2]) {
        let ahead: Arc<str> = ahead.into();
        for k in 0..steps {
            follower.see(Some((&ahead, Slot::default())));
            let phase = f64::from(k) * STEP_S * std::f64::consts::TAU / 10.0;
            follower.note(amplitudes_mps.map(|amplitude_mps| 10.0 + amplitude_mps * phase.sin()), STEP_S);
        }
    }

    #[test]
    fn law_the_gain_is_the_ratio_of_the_swings() {
        let mut follower = Follower::default();
        follow(&mut follower, "a", 300, [0.6, 0.5]);
        let gain = follower.gain();
        assert!((gain.following_time.unwrap() - 30.0).abs() < 1e-9);
        assert!(
            (gain.string_gain_l2.unwrap() - 1.2).abs() < 1e-9 && (gain.string_gain_linf.unwrap() - 1.2).abs() < 1e-9
        );
    }

    /// The vehicle ahead speeds up by 0.5 m/s and back; the follower slows down by 0.6 m/s and back.
    #[test]
    fn law_the_largest_deviation_is_half_the_range_wherever_it_began() {
        let (mut follower, ahead): (Follower, Arc<str>) = (Follower::default(), "a".into());
        for k in 0..300 {
            follower.see(Some((&ahead, Slot::default())));
            let there = if (100..200).contains(&k) { 1.0 } else { 0.0 };
            follower.note([10.0 - 0.6 * there, 10.0 + 0.5 * there], STEP_S);
        }
        let gain = follower.gain().string_gain_linf.unwrap();
        assert!((gain - 1.2).abs() < 1e-9, "{gain}");
    }

    /// By hand: 30 s with 0.6 after 0.5, 20 s with 0.1 after 0.2: squares 0.36·3 + 0.01·2 over 0.25·3 + 0.04·2.
    #[test]
    fn law_episodes_are_added_up_and_short_ones_left_out() {
        let mut follower = Follower::default();
        follow(&mut follower, "a", 300, [0.6, 0.5]);
        follow(&mut follower, "b", 190, [5.0, 0.1]);
        follow(&mut follower, "c", 200, [0.1, 0.2]);
        let gain = follower.gain();
        assert!((gain.following_time.unwrap() - 50.0).abs() < 1e-9);
        let wanted = ((0.36 * 3.0 + 0.01 * 2.0) / (0.25 * 3.0 + 0.04 * 2.0_f64)).sqrt();
        assert!((gain.string_gain_l2.unwrap() - wanted).abs() < 1e-9, "{gain:?}");
        assert!((gain.string_gain_linf.unwrap() - 1.0).abs() < 1e-9, "0.7 over 0.7: {gain:?}");
    }

    /// Follows for 30 s in which both swing about 30 m/s, the follower from its highest speed, the vehicle ahead from the middle.
    fn gain_of(amplitudes_mps: [f64; 2]) -> f64 {
        let (mut follower, ahead): (Follower, Arc<str>) = (Follower::default(), "a".into());
        follower.see(Some((&ahead, Slot::default())));
        for k in 0..300 {
            let phase = f64::from(k) * STEP_S * std::f64::consts::TAU / 10.0;
            let swings = [phase.cos(), phase.sin()];
            follower.note([0, 1].map(|i| 30.0 + amplitudes_mps[i] * swings[i]), STEP_S);
        }
        follower.gain().string_gain_l2.unwrap()
    }

    #[test]
    fn law_the_gain_is_that_about_the_means_wherever_an_episode_begins() {
        assert!((gain_of([0.6, 0.5]) - 1.2).abs() < 1e-9, "{}", gain_of([0.6, 0.5]));
    }

    /// Sums of squares of whole speeds would have no digits left for it.
    #[test]
    fn law_the_gain_of_small_swings_at_a_high_speed_has_its_digits() {
        assert!((gain_of([6e-7, 5e-7]) - 1.2).abs() < 1e-6, "{}", gain_of([6e-7, 5e-7]));
    }

    /// A step that is as long as the shortest episode, less what rounding takes.
    #[test]
    fn an_episode_of_the_shortest_length_counts() {
        let followed = |step_s: f64| {
            let mut follower = Follower::default();
            follower.see(Some((&"a".into(), Slot::default())));
            follower.note([10.0, 10.0], step_s);
            follower.gain().following_time
        };
        let shortest_s = SHORTEST_S - 1e-6;
        assert_eq!((followed(shortest_s), followed(shortest_s - 1e-9)), (Some(shortest_s), None));
    }

    #[test]
    fn who_follows_nobody_or_somebody_steady_has_no_gain() {
        assert_eq!(Follower::default().gain(), StringGain::default());
        let mut follower = Follower::default();
        follow(&mut follower, "a", 300, [0.6, 0.0]);
        let gain = follower.gain();
        assert!(gain.following_time.is_some() && gain.string_gain_l2.is_none() && gain.string_gain_linf.is_none());
    }
}
