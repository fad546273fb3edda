//! The tables: margins by law, gains of strings by upper and lower law, and the same by frequency.

use super::job::Job;
use super::margins::Margins;
use super::strings::{Gain, StringFound};
use crate::table::{Layout, record, rounded};

record! {
    /// A law's loop.
    #[derive(Debug, Clone, PartialEq)]
    pub struct MarginRow {
        controller: String = "The law";
        lag: f64 = "Time constant of the actuators" ["s"];
        delay: f64 = "Dead time of the actuators, which laws with a model know" ["s"];
        stable: bool = "Whether the loop is stable as it is";
        crossover: Option<f64> = "Frequency at which the gain around the loop first falls below 1" ["rad/s"];
        gain_margin: Option<f64> = "By how much the vehicle may answer more than its nominal torque says, computed; empty above 100";
        gain_margin_simulated: Option<f64> = "The same, found by raising the gain of the full model in steps of 4 %";
        delay_margin: Option<f64> = "How much later the speed may be measured, computed; empty above 10 s" ["s"];
        delay_margin_simulated: Option<f64> = "The same, found in the full model in steps of 4 %, or of one control period" ["s"];
    }
}

record! {
    /// A string of ten followers.
    #[derive(Debug, Clone, PartialEq)]
    pub struct StringRow {
        upper: String = "The target that keeps the gaps";
        controller: String = "The law below it";
        lag: f64 = "Time constant of the actuators" ["s"];
        delay: f64 = "Dead time of the actuators" ["s"];
        settles: bool = "Whether the first follower settles behind a leader whose speed is constant again";
        pair_gain: Option<f64> = "Largest ratio of the speed amplitudes of two followers, over periods of the leader from 4 to 100 s; empty if it does not settle";
        pair_period: Option<f64> = "The period at which it is that large" ["s"];
        tail_gain: Option<f64> = "Largest ratio of the speed amplitudes of the tenth follower and the leader";
        tail_period: Option<f64> = "The period at which it is that large" ["s"];
        step_overshoot: f64 = "Largest speed of the tenth follower above the leader's after a step of 1 m/s, relative to the step" ["%"];
        gap_min: f64 = "Least gap of any follower during that step; below 0 they would have touched" ["m"];
    }
}

record! {
    /// A string at one frequency.
    #[derive(Debug, Clone, PartialEq)]
    pub struct SweepRow {
        upper: String = "The target that keeps the gaps";
        controller: String = "The law below it";
        lag: f64 = "Time constant of the actuators" ["s"];
        delay: f64 = "Dead time of the actuators" ["s"];
        period: f64 = "Period of the leader's speed" ["s"];
        pair_gain: f64 = "Ratio of the speed amplitudes of the second follower and the first";
        tail_gain: f64 = "Ratio of the speed amplitudes of the tenth follower and the leader";
    }
}

/// The columns of `margins.csv`.
pub fn margin_layout() -> Layout<MarginRow> {
    Layout::of_record(["stability", "loop"], "One row per law, lag and dead time")
}

/// The columns of `strings.csv`.
pub fn string_layout() -> Layout<StringRow> {
    Layout::of_record(
        ["stability", "string"],
        "One row per upper law, law, lag and dead time: a leader and ten followers",
    )
}

/// The columns of `sweep.csv`.
pub fn sweep_layout() -> Layout<SweepRow> {
    Layout::of_record(["stability", "frequency"], "One row per upper law, law, lag, dead time and period of the leader")
}

pub(super) fn margin_row(job: &Job, found: &Margins) -> MarginRow {
    MarginRow {
        controller: job.controller.clone(),
        lag: job.lag_s,
        delay: job.delay_s,
        stable: found.stable,
        crossover: found.crossover_radps.map(rounded),
        gain_margin: found.gain.map(rounded),
        gain_margin_simulated: found.gain_simulated.map(rounded),
        delay_margin: found.delay_s.map(rounded),
        delay_margin_simulated: found.delay_simulated_s.map(rounded),
    }
}

pub(super) fn string_row(job: &Job, upper: &str, found: &StringFound) -> StringRow {
    let largest = |of: fn(&Gain) -> f64| found.gains.iter().max_by(|a, b| of(a).total_cmp(&of(b)));
    let (pair, tail) = (largest(|gain| gain.pair), largest(|gain| gain.tail));
    StringRow {
        upper: upper.to_owned(),
        controller: job.controller.clone(),
        lag: job.lag_s,
        delay: job.delay_s,
        settles: found.settles,
        pair_gain: pair.map(|gain| rounded(gain.pair)),
        pair_period: pair.map(|gain| gain.period_s),
        tail_gain: tail.map(|gain| rounded(gain.tail)),
        tail_period: tail.map(|gain| gain.period_s),
        step_overshoot: rounded(found.overshoot),
        gap_min: rounded(found.gap_min_m),
    }
}

pub(super) fn sweep_rows(job: &Job, upper: &str, found: &StringFound) -> Vec<SweepRow> {
    let row = |gain: &Gain| SweepRow {
        upper: upper.to_owned(),
        controller: job.controller.clone(),
        lag: job.lag_s,
        delay: job.delay_s,
        period: gain.period_s,
        pair_gain: rounded(gain.pair),
        tail_gain: rounded(gain.tail),
    };
    found.gains.iter().map(row).collect()
}
