//! Not a check but a tool: the search for one preset that matches the most of the published numbers.

use rayon::prelude::*;
use std::sync::Arc;
use sumo_mfc::offline::{End, Road, Trip, Vehicle};
use sumo_mfc::paper::library::Library;
use sumo_mfc::paper::{CONTROLLERS, Lab, step};
use sumo_mfc::random::Stream;
use sumo_mfc::scenario::{Override, Scenario};

const RECORDINGS: [&str; 3] = ["racing_lap", "udds", "hwfet"];

/// The paper's overshoots of the steps [%], and its RMS errors on the recording without and with delay [m/s], classic before
/// adaptive, with the tolerances of the verdicts.
const STEPS: [(f64, f64); 4] = [(19.5, 1.0), (9.5, 0.7), (8.0, 0.7), (3.9, 0.5)];
const ERRORS: [(f64, f64); 4] = [(0.78, 0.117), (0.35, 0.0525), (2.27, 0.34), (0.68, 0.102)];

/// The search behind the preset `best`: the presets that are there and random choices of what the paper leaves open, then small
/// steps from the best, against all published overshoots and RMS errors on all recordings and the first oscillation of the sine at
/// once. `ROUNDS=180 SEED=3 cargo test --release --test paper_search -- --ignored --nocapture`.
#[test]
#[ignore = "a search, not a check"]
fn search_for_one_preset_that_matches_the_most() {
    let rounds = std::env::var("ROUNDS").map_or(300, |n| n.parse().unwrap());
    let seed = std::env::var("SEED").map_or(1, |n| n.parse().unwrap());
    let dir = tempfile::tempdir().unwrap();
    let lab = Lab { library: Library::open(dir.path(), &[]).unwrap(), driver: None };
    let mut random = Stream::new(seed, "search", "paper");
    let mut best: Vec<(f64, Choice, String)> = Vec::new();
    for round in 0..rounds {
        let explore = round % 3 == 0 || best.is_empty();
        let batch: Vec<Choice> = (0..16)
            .map(|i| match (round, explore) {
                (0, _) if i < Choice::KNOWN.len() => Choice::KNOWN[i],
                (_, true) => Choice::random(&mut random),
                _ => {
                    let parent = (random.uniform() * best.len().min(12) as f64) as usize;
                    best[parent].1.near(&mut random)
                }
            })
            .collect();
        let scored: Vec<_> = batch.par_iter().map(|c| (c, c.score(&lab))).collect();
        best.extend(scored.into_iter().filter_map(|(c, s)| s.map(|(score, text)| (score, *c, text))));
        best.sort_by(|a, b| a.0.total_cmp(&b.0));
        best.truncate(30);
        if round % 5 == 0 {
            for (score, choice, text) in best.iter().take(3) {
                println!("{round}: {score:.2} {choice:?} {text}");
            }
        }
    }
}

/// What the paper leaves open.
#[derive(Debug, Clone, Copy)]
struct Choice {
    /// b [m/s2 per u], K_P [1/s], limits [m/s2] of drive and brakes, lag [s], epsilon [u].
    values: [f64; 6],
    period_s: f64,
    estimate: &'static str,
    rate: bool,
    window_alpha: &'static str,
    recompute: bool,
}

const PERIODS_S: [f64; 3] = [0.005, 0.008, 0.01];
const ESTIMATES: [&str; 3] = ["commanded", "saturated", "applied"];
const WINDOW_ALPHAS: [&str; 2] = ["updated", "used"];

impl Choice {
    const LOW: [f64; 6] = [0.004, 1.0, 2.0, 2.0, 0.01, 0.003];
    const HIGH: [f64; 6] = [0.6, 80.0, 7.0, 9.8, 0.15, 0.3];

    /// The presets `best`, `delay_a`, `delay_d` and `default`.
    const KNOWN: [Self; 4] = [
        Self {
            values: [0.011594, 18.01, 2.88, 4.648, 0.046, 0.1036],
            period_s: 0.01,
            estimate: "saturated",
            rate: true,
            window_alpha: "used",
            recompute: true,
        },
        Self {
            values: [0.0136, 15.66, 3.208, 9.18, 0.01, 0.01],
            period_s: 0.005,
            estimate: "saturated",
            rate: false,
            window_alpha: "updated",
            recompute: false,
        },
        Self {
            values: [0.01125, 16.74, 3.09, 7.47, 0.05, 0.1],
            period_s: 0.005,
            estimate: "saturated",
            rate: true,
            window_alpha: "used",
            recompute: true,
        },
        Self {
            values: [0.072, 4.0, 5.3, 5.3, 0.01, 0.01],
            period_s: 0.005,
            estimate: "applied",
            rate: true,
            window_alpha: "updated",
            recompute: false,
        },
    ];

    fn random(random: &mut Stream) -> Self {
        let values = std::array::from_fn(|i| Self::LOW[i] * (Self::HIGH[i] / Self::LOW[i]).powf(random.uniform()));
        Self { values, ..Self::KNOWN[0] }.with_options(random, 1.0)
    }

    fn near(self, random: &mut Stream) -> Self {
        let size = if random.uniform() < 0.5 { 0.05 } else { 0.2 };
        let values = std::array::from_fn(|i| {
            (self.values[i] * (size * random.normal()).exp()).clamp(Self::LOW[i], Self::HIGH[i])
        });
        Self { values, ..self }.with_options(random, 0.08)
    }

    /// Draws each option anew with this probability.
    fn with_options(mut self, random: &mut Stream, probability: f64) -> Self {
        let mut pick = |n: usize| {
            let (draws, which) = (random.uniform() < probability, (random.uniform() * n as f64) as usize);
            draws.then_some(which)
        };
        self.period_s = pick(3).map_or(self.period_s, |i| PERIODS_S[i]);
        self.estimate = pick(3).map_or(self.estimate, |i| ESTIMATES[i]);
        self.rate = pick(2).map_or(self.rate, |i| i == 0);
        self.window_alpha = pick(2).map_or(self.window_alpha, |i| WINDOW_ALPHAS[i]);
        self.recompute = pick(2).map_or(self.recompute, |i| i == 0);
        self
    }

    fn settings(&self) -> Vec<Override> {
        let [b, k_p, drive, brake, lag, epsilon] = self.values;
        let nm = 1719.0 * 0.3;
        let lag = if lag < 0.02 { 0.0 } else { lag };
        [
            ("controller.accel_per_unit_mps2", b.to_string()),
            ("controller.k_p", k_p.to_string()),
            ("controller.epsilon", epsilon.to_string()),
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

    /// How far from the published numbers, each counted as in [`miss`]; none if far from the first one.
    fn score(&self, lab: &Lab) -> Option<(f64, String)> {
        let (mut overshoots, mut errors, mut sines) = (Vec::new(), Vec::new(), Vec::new());
        for controller in CONTROLLERS {
            let scenario = self.scenario(lab, "step", controller, &[])?;
            let drive = step::drive(&Road::new(&scenario).ok()?, 0).ok()?;
            overshoots.extend(drive.responses[0].map(|r| r.overshoot));
            if (overshoots[0] - 19.5).abs() > 5.0 {
                return None;
            }
        }
        if overshoots[2] > 14.0 {
            return None;
        }
        for controller in CONTROLLERS {
            sines.push(self.sine_overshoot(lab, controller)?);
            errors.push(self.errors(lab, controller)?);
        }
        let mut score: f64 = overshoots.iter().zip(STEPS).map(|(ours, published)| 2.0 * miss(*ours, published)).sum();
        for recording in 0..RECORDINGS.len() {
            for (k, published) in ERRORS.iter().enumerate() {
                score += miss(errors[k % 2][recording][k / 2], *published);
            }
        }
        // Hardly any overshoot on the sine: within 2 %, or half of the classic one's.
        score += if sines[1] <= 2.0 { 0.0 } else { (sines[1] / sines[0].max(2.0)).min(1.0) };
        Some((score, format!("{overshoots:.1?} {errors:.2?} sine {sines:.1?}")))
    }

    /// RMS errors on each recording, with noise: without and with delay.
    fn errors(&self, lab: &Lab, controller: &str) -> Option<Vec<[f64; 2]>> {
        let mut trips: Vec<Trip> = Vec::new();
        let scenarios: Vec<Scenario> = RECORDINGS
            .iter()
            .map(|recording| {
                let file = lab.library.folder().join(format!("data/{recording}.csv"));
                let file = Override::text("search", "target.file", &file.to_string_lossy());
                self.scenario(lab, "delay", controller, &[file])
            })
            .collect::<Option<_>>()?;
        for scenario in &scenarios {
            let delayed = Road::new(scenario).ok()?.whole_trips(1).ok()?.pop()?;
            let mut prompt = Trip { profile: Arc::clone(&delayed.profile), ..delayed.clone() };
            prompt.vehicle.actuator.dead_time_s = 0.0;
            trips.extend([prompt, delayed]);
        }
        let outcomes = Road::new(&scenarios[0]).ok()?.drive(&trips, |_| {}).ok()?;
        let rms: Vec<f64> = outcomes.iter().map(|o| o.stats.error_rms).collect::<Option<_>>()?;
        Some(rms.chunks(2).map(|pair| [pair[0], pair[1]]).collect())
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
