//! Not a check but a tool: the search for one preset that meets the most of the published numbers on our lap, the search of `tune`.

use rayon::prelude::*;
use std::sync::Arc;
use sumo_mfc::offline::{End, Road, Trip, Vehicle};
use sumo_mfc::paper::library::Library;
use sumo_mfc::paper::step::Response;
use sumo_mfc::paper::{CONTROLLERS, Lab, step};
use sumo_mfc::scenario::{Override, Scenario};
use sumo_mfc::tune::{Gain, search};

/// The paper's overshoots of the steps [%], and its RMS errors on the recording without and with delay [m/s], classic before
/// adaptive, with the tolerances of the verdicts.
const STEPS: [(f64, f64); 4] = [(19.5, 1.0), (9.5, 0.7), (8.0, 0.7), (3.9, 0.5)];
const ERRORS: [(f64, f64); 4] = [(0.78, 0.117), (0.35, 0.0525), (2.27, 0.34), (0.68, 0.102)];
/// Noise that each candidate drives under.
const SEEDS: usize = 3;
/// What a candidate that is far from the first numbers costs.
const FAR: f64 = 100.0;

/// From known choices of what the paper leaves open, `tune`'s search looks for better numbers, against the ten facts of the paper at once,
/// its words on the sinusoid, and those on oscillation, on the lap of `scenarios/paper/data/handling_lap.csv` alone. With `LITERAL=1` only
/// Algorithm 1 as it is printed: ε = 0.01, no variant; with `LITERAL=2` the window is 200 ms as well, and there is no lag.
/// `TRIALS=300 cargo test --release --test paper_search -- --ignored --nocapture`.
#[test]
#[ignore = "a search, not a check"]
fn search_for_one_preset_that_matches_the_most() {
    let number = |name: &str, default: usize| std::env::var(name).map_or(default, |n| n.parse().unwrap());
    let (trials, literal) = (number("TRIALS", 300), number("LITERAL", 0));
    let dir = tempfile::tempdir().unwrap();
    let lab = Lab { library: Library::open(dir.path(), &[]).unwrap(), driver: None };
    let found = Choice::KNOWN.par_iter().map(|known| {
        let begin = if literal > 0 { known.to_the_letter(literal) } else { *known };
        let gains = begin.free(literal);
        let cost = |values: &[f64]| Ok(begin.with(values).score(&lab).map_or(FAR, |(score, _)| score));
        let best = begin.with(&search(&gains, trials, cost).unwrap().best);
        best.score(&lab).map(|(score, text)| (score, best, text))
    });
    let mut found: Vec<_> = found.collect::<Vec<_>>().into_iter().flatten().collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (score, choice, text) in &found {
        println!("{score:.2} {choice:?} {text}");
    }
    assert!(!found.is_empty(), "nothing near the first published number was found");
}

/// What the paper leaves open.
#[derive(Debug, Clone, Copy)]
struct Choice {
    /// b [m/s2 per u], K_P [1/s], limits [m/s2] of drive and brakes, lag [s], window [s], epsilon [u].
    values: [f64; 7],
    period_s: f64,
    estimate: &'static str,
    rate: bool,
    window_alpha: &'static str,
    recompute: bool,
}

/// The names of the values; those of Algorithm 1 and the lag come last.
const VALUES: [&str; 7] = ["b", "k_p", "drive", "brakes", "lag", "window", "epsilon"];
/// How many of them are free, by how literal the algorithm is.
const FREE: [usize; 3] = [7, 6, 4];

impl Choice {
    const LOW: [f64; 7] = [0.003, 5.0, 2.5, 2.5, 0.01, 0.1, 0.005];
    const HIGH: [f64; 7] = [0.1, 80.0, 7.0, 9.8, 0.15, 0.3, 0.3];
    const VARIANT: Self = Self {
        values: [0.01, 20.0, 3.1, 5.0, 0.05, 0.2, 0.1],
        period_s: 0.005,
        estimate: "saturated",
        rate: false,
        window_alpha: "used",
        recompute: true,
    };

    /// `delay_d`, with a rate of the reference and without; `delay_a` and `default`; where the search from `delay_a` with an ε of its own ended.
    const KNOWN: [Self; 5] = [
        Self { values: [0.01125, 16.74, 3.09, 7.47, 0.05, 0.2, 0.1], rate: true, ..Self::VARIANT },
        Self { values: [0.01125, 16.74, 3.09, 7.47, 0.05, 0.2, 0.1], ..Self::VARIANT },
        Self {
            values: [0.0136, 15.66, 3.208, 9.18, 0.01, 0.2, 0.01],
            window_alpha: "updated",
            recompute: false,
            ..Self::VARIANT
        },
        Self {
            values: [0.072, 4.0, 5.3, 5.3, 0.01, 0.2, 0.01],
            estimate: "applied",
            rate: true,
            window_alpha: "updated",
            recompute: false,
            ..Self::VARIANT
        },
        Self {
            values: [0.00752, 39.25, 3.466, 4.49, 0.0645, 0.1916, 0.0581],
            window_alpha: "updated",
            recompute: false,
            ..Self::VARIANT
        },
    ];

    /// What is searched, from here.
    fn free(&self, literal: usize) -> Vec<Gain> {
        let gain = |i: usize| Gain { key: VALUES[i], begin: self.values[i], range: [Self::LOW[i], Self::HIGH[i]] };
        (0..FREE[literal]).map(gain).collect()
    }

    fn with(mut self, values: &[f64]) -> Self {
        self.values[..values.len()].copy_from_slice(values);
        self
    }

    fn to_the_letter(mut self, literal: usize) -> Self {
        self.values[6] = 0.01;
        if literal == 2 {
            (self.values[4], self.values[5]) = (0.0, 0.2);
        }
        Self { window_alpha: "updated", recompute: false, ..self }
    }

    fn settings(&self) -> Vec<Override> {
        let [b, k_p, drive, brake, lag, window, epsilon] = self.values;
        let nm = 1719.0 * 0.3;
        let lag = if lag < 0.02 { 0.0 } else { lag };
        [
            ("controller.accel_per_unit_mps2", b.to_string()),
            ("controller.k_p", k_p.to_string()),
            ("controller.epsilon", epsilon.to_string()),
            ("controller.window_s", window.to_string()),
            ("controller.input_estimate", self.estimate.to_owned()),
            ("controller.reference_rate_max_mps2", if self.rate { "20.0" } else { "0.0" }.to_owned()),
            ("controller.window_alpha", self.window_alpha.to_owned()),
            ("controller.recompute_u", self.recompute.to_string()),
            ("vehicle.drive_torque_max_nm", (drive * nm).to_string()),
            ("vehicle.brake_torque_max_nm", (brake * nm).to_string()),
            ("actuator.lag_s", lag.to_string()),
            ("coupling.control_period_s", self.period_s.to_string()),
        ]
        .iter()
        .map(|(path, value)| Override::set(&format!("{path}={value}")).unwrap())
        .collect()
    }

    /// How far from what the paper says, each counted as in [`miss`]; none if far from the first numbers.
    fn score(&self, lab: &Lab) -> Option<(f64, String)> {
        let mut steps: Vec<[Response; 2]> = Vec::new();
        for (controller, most) in CONTROLLERS.into_iter().zip([25.0, 14.0]) {
            let scenario = self.scenario(lab, "step", controller, &[])?;
            let drive = step::drive(&Road::new(&scenario).ok()?, 0).ok()?;
            steps.push(drive.responses[0]);
            if !(most - 10.0..most).contains(&drive.responses[0][0].overshoot) {
                return None;
            }
        }
        let overshoots = [&steps[0][0], &steps[0][1], &steps[1][0], &steps[1][1]].map(|r| r.overshoot);
        let settled = steps[1].map(|r| r.settling_m.unwrap_or(500.0));
        let undershoots = [0, 1].map(|law| steps[law].map(|r| r.undershoot));
        let (mut errors, mut sines) = (Vec::new(), Vec::new());
        for controller in CONTROLLERS {
            sines.push(self.sine_overshoot(lab, controller)?);
            errors.push(self.errors(lab, controller)?);
        }
        let errors = [errors[0][0], errors[1][0], errors[0][1], errors[1][1]];
        let mut score: f64 = overshoots.iter().zip(STEPS).map(|(ours, published)| miss(*ours, published)).sum();
        score += errors.iter().zip(ERRORS).map(|(ours, published)| miss(*ours, published)).sum::<f64>();
        score += settled.iter().map(|metres| if *metres <= 100.0 { 0.0 } else { 1.0 }).sum::<f64>();
        // The words: an oscillation to be seen, half of it at most with adaptation, hardly any overshoot on the sinusoid.
        let words = [
            undershoots[0].iter().all(|under| *under >= 2.0),
            undershoots[1].iter().zip(&undershoots[0]).all(|(adaptive, classic)| *adaptive <= 0.5 * classic),
            sines[1] <= 2.0,
        ];
        score += words.iter().map(|holds| if *holds { 0.0 } else { 0.5 }).sum::<f64>();
        let text = format!(
            "steps {overshoots:.2?} settled {settled:.0?} undershoots {undershoots:.1?} errors {errors:.3?} sine {sines:.2?}"
        );
        Some((score, text))
    }

    /// RMS errors on the lap, mean over the noise: without and with delay.
    fn errors(&self, lab: &Lab, controller: &str) -> Option<[f64; 2]> {
        let scenario = self.scenario(lab, "delay", controller, &[])?;
        let road = Road::new(&scenario).ok()?;
        let delayed = road.whole_trips(SEEDS).ok()?.split_off(1);
        let prompt = delayed.iter().map(|trip| {
            let mut prompt = Trip { profile: Arc::clone(&trip.profile), ..trip.clone() };
            prompt.vehicle.actuator.dead_time_s = 0.0;
            prompt
        });
        let trips: Vec<Trip> = prompt.chain(delayed.iter().cloned()).collect();
        let outcomes = road.drive(&trips, |_| {}).ok()?;
        let rms: Vec<f64> = outcomes.iter().map(|o| o.stats.error_rms).collect::<Option<_>>()?;
        let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
        Some([mean(&rms[..SEEDS]), mean(&rms[SEEDS..])])
    }

    /// Overshoot in the first oscillation, without noise [%].
    fn sine_overshoot(&self, lab: &Lab, controller: &str) -> Option<f64> {
        let scenario = self.scenario(lab, "sine", controller, &[])?;
        let road = Road::new(&scenario).ok()?;
        let wave_m = scenario.groups[0].target.values.get::<f64>("sine_wavelength_m").unwrap();
        let (mut reached, mut over) = (false, 0.0_f64);
        let trips = road.trips(0, 0.0, End::Distance(wave_m)).ok()?;
        let watch = |vehicle: &mut Vehicle| {
            let moment = vehicle.moment();
            let relative = moment.speed_mps / moment.reference_mps - 1.0;
            reached |= relative >= 0.0;
            over = if reached { over.max(relative) } else { over };
        };
        road.drive(&trips, watch).ok()?;
        Some(100.0 * over)
    }

    fn scenario(&self, lab: &Lab, test: &str, controller: &str, more: &[Override]) -> Option<Scenario> {
        let adaptation = ["controller.epsilon", "controller.window_alpha", "controller.recompute_u"];
        let mut settings = self.settings();
        settings.retain(|s| controller == "adaptive" || !adaptation.contains(&s.path.as_str()));
        settings.extend_from_slice(more);
        lab.library.scenario(test, lab.library.find("default").ok()?, controller, &settings).ok()
    }
}

/// 0 for the published number, less than 0.3 within its tolerance, between 1 and 3 outside.
fn miss(ours: f64, (published, within): (f64, f64)) -> f64 {
    let apart = (ours - published).abs() / within;
    if apart <= 1.0 { 0.3 * apart } else { (1.0 + 0.7 * apart.ln()).min(3.0) }
}
