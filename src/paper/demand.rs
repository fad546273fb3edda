//! What a recording asks of a car: the statistics that say whether it is gentle or hard, for ours beside those of human drivers.

use super::human::Sample;
use super::library::carried;
use crate::page::{Cell, Head, TableView};
use crate::table::{Layout, record};

/// Recordings finer than this are averaged over [`AVERAGED_S`], as the driver test does \[s\].
const COARSE_S: f64 = 0.11;
const AVERAGED_S: f64 = 1.0;
/// Accelerations and jerks are differences over this time, or over one sample where that is longer \[s\].
const OVER_S: f64 = 0.5;
/// Braking is a deceleration above this [m/s²].
const BRAKING_MPS2: f64 = 0.1;

record! {
    /// What one recording asks for.
    #[derive(Debug, Clone, PartialEq)]
    pub struct Demand {
        recording: String = "The recording";
        duration: f64 = "Duration" ["s"];
        speed_min: f64 = "Lowest speed" ["m/s"];
        speed_mean: f64 = "Mean speed" ["m/s"];
        speed_max: f64 = "Highest speed" ["m/s"];
        accel_rms: f64 = "RMS of the acceleration, of speeds averaged over 1 s, as differences over 0.5 s" ["m/s2"];
        decel_max: f64 = "Largest deceleration" ["m/s2"];
        accel_max: f64 = "Largest acceleration" ["m/s2"];
        jerk_rms: f64 = "RMS of the jerk, likewise" ["m/s3"];
        braking: f64 = "Share of the time with a deceleration above 0.1 m/s²";
    }
}

/// The columns.
pub fn layout() -> Layout<Demand> {
    Layout::of_record(["demands", "demand"], "One row per recording")
}

/// Recordings of people that others published, by the same formulas; they are not shipped.
fn published() -> [Demand; 2] {
    [
        // A Jaguar I-Pace on the handling course of the ZalaZONE proving ground, driven by hand among ten other cars, 9 October 2019 (JRC
        // OpenACC; Makridis, Mattas, Anesiadou and Ciuffo 2021, Transportation Research Part C 125, 103047).
        Demand {
            recording: "a driver, handling course (OpenACC)".into(),
            duration: 243.5,
            speed_min: 2.0,
            speed_mean: 15.0,
            speed_max: 18.8,
            accel_rms: 0.53,
            decel_max: 1.88,
            accel_max: 1.78,
            jerk_rms: 0.41,
            braking: 0.38,
        },
        // A 1965 Ferrari 250 LM on Palm Beach International Raceway, 22 February 2014 (Kegelman, Harbott and Gerdes 2017, Vehicle System
        // Dynamics 55, 191-207).
        Demand {
            recording: "a racing driver (Kegelman et al. 2017)".into(),
            duration: 550.0,
            speed_min: 16.5,
            speed_mean: 31.7,
            speed_max: 60.8,
            accel_rms: 3.05,
            decel_max: 8.2,
            accel_max: 4.3,
            jerk_rms: 2.19,
            braking: 0.40,
        },
    ]
}

/// Ours, as they are shipped, and the published ones.
pub fn all() -> Vec<Demand> {
    let shipped = [
        ("driver, our lap", "data/handling_lap.csv"),
        ("udds, EPA", "data/udds.csv"),
        ("hwfet, EPA", "data/hwfet.csv"),
        ("racing, SUMO's circuit", "data/racing_lap.csv"),
    ];
    let of_file = |(name, file): &(&str, &str)| of(name, &speeds(carried(file).expect("it is carried")));
    let mut demands: Vec<Demand> = shipped.iter().map(of_file).collect();
    demands.extend(published());
    demands
}

/// What the lap of a seed asks for.
pub fn of_lap(name: &str, samples: &[Sample]) -> Demand {
    of(name, &samples.iter().map(|sample| (sample.t_s, sample.speed_mps)).collect::<Vec<_>>())
}

/// Times and speeds of a recording of ours: the first two columns.
fn speeds(csv: &str) -> Vec<(f64, f64)> {
    let number = |text: Option<&str>| text.and_then(|text| text.parse().ok()).unwrap_or(f64::NAN);
    let row = |line: &str| {
        let mut cells = line.split(',');
        (number(cells.next()), number(cells.next()))
    };
    csv.lines().skip(1).map(row).collect()
}

fn of(name: &str, samples: &[(f64, f64)]) -> Demand {
    let raw: Vec<f64> = samples.iter().map(|(_, speed)| *speed).collect();
    let duration = samples[samples.len() - 1].0 - samples[0].0;
    let period_s = duration / (samples.len() - 1) as f64;
    let averaged =
        if period_s < COARSE_S { averaged(&raw, (AVERAGED_S / period_s).round() as usize) } else { raw.clone() };
    let over = ((OVER_S / period_s).round() as usize).max(1);
    let rate = |values: &[f64]| -> Vec<f64> {
        values.windows(over + 1).map(|w| (w[over] - w[0]) / (over as f64 * period_s)).collect()
    };
    let (accels, raw_of) = (rate(&averaged), |f: fn(f64, f64) -> f64, from: f64| raw.iter().copied().fold(from, f));
    let rms = |values: &[f64]| (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt();
    Demand {
        recording: name.to_owned(),
        duration,
        speed_min: raw_of(f64::min, f64::INFINITY),
        speed_mean: raw.iter().sum::<f64>() / raw.len() as f64,
        speed_max: raw_of(f64::max, 0.0),
        accel_rms: rms(&accels),
        decel_max: -accels.iter().copied().fold(f64::INFINITY, f64::min),
        accel_max: accels.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        jerk_rms: rms(&rate(&accels)),
        braking: accels.iter().filter(|a| **a < -BRAKING_MPS2).count() as f64 / accels.len() as f64,
    }
}

/// Mean over so many samples around each one.
fn averaged(values: &[f64], samples: usize) -> Vec<f64> {
    let mean = |window: &[f64]| window.iter().sum::<f64>() / window.len() as f64;
    let around = |i: usize| mean(&values[i.saturating_sub(samples / 2)..(i + samples.div_ceil(2)).min(values.len())]);
    (0..values.len()).map(around).collect()
}

/// As a table of the page.
pub fn table(demands: &[Demand]) -> TableView {
    let heads = [
        ("duration", "s"),
        ("speed, lowest", "m/s"),
        ("mean", "m/s"),
        ("highest", "m/s"),
        ("acceleration, RMS", "m/s², of speeds averaged over 1 s, as differences over 0.5 s"),
        ("largest deceleration", "m/s²"),
        ("largest acceleration", "m/s²"),
        ("jerk, RMS", "m/s³"),
        ("braking", "share of the time with a deceleration above 0.1 m/s²"),
    ];
    let head = std::iter::once(Head::text("recording", "")).chain(heads.map(|(name, about)| Head::number(name, about)));
    let row = |d: &Demand| {
        let speeds = [d.speed_min, d.speed_mean, d.speed_max].map(|x| format!("{x:.1}"));
        let rates = [d.accel_rms, d.decel_max, d.accel_max, d.jerk_rms, d.braking].map(|x| format!("{x:.2}"));
        let numbers = std::iter::once(format!("{:.0}", d.duration)).chain(speeds).chain(rates).map(Cell::number);
        std::iter::once(Cell::text(&d.recording)).chain(numbers).collect()
    };
    TableView {
        id: "demands".into(),
        head: head.collect(),
        rows: demands.iter().map(row).collect(),
        ..TableView::default()
    }
}

/// As lines of the terminal.
pub fn lines(demands: &[Demand]) -> String {
    let line = |d: &Demand| {
        format!(
            "{:<40}{:>6.0} s {:>6.1} to {:>4.1} m/s, acceleration RMS {:.2} m/s² ({:+.2} to {:+.2}), jerk {:.2} m/s³, braking {:.0} %\n",
            d.recording,
            d.duration,
            d.speed_min,
            d.speed_max,
            d.accel_rms,
            -d.decel_max,
            d.accel_max,
            d.jerk_rms,
            100.0 * d.braking
        )
    };
    demands.iter().map(line).collect()
}

/// A lap as a file.
pub fn to_csv(samples: &[Sample]) -> String {
    let line = |s: &Sample| format!("{:.1},{:.4},0,{:.5}\n", s.t_s, s.speed_mps, s.yaw_rate_radps + 0.0);
    std::iter::once("t_s,vx_mps,vy_mps,yaw_rate_radps\n".to_owned()).chain(samples.iter().map(line)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::human;

    /// Laps of other seeds ask for as much as the one that is shipped.
    #[test]
    fn law_laps_are_brisk_whatever_the_seed() {
        for seed in 1..=20 {
            let demand = of_lap("lap", &human::lap(seed));
            assert!((0.45..0.8).contains(&demand.accel_rms), "{seed}: {demand:?}");
            assert!(demand.speed_min > 5.0 && demand.speed_max < 25.0 && demand.decel_max < 3.0, "{seed}: {demand:?}");
        }
    }

    #[test]
    fn law_a_ramp_has_its_slope_and_no_jerk() {
        let ramp: Vec<(f64, f64)> = (0..=300).map(|k| (0.1 * f64::from(k), 20.0 - 0.05 * f64::from(k))).collect();
        let demand = of("ramp", &ramp);
        assert!((demand.duration - 30.0).abs() < 1e-9 && demand.speed_max == 20.0);
        // The average is shorter at the ends.
        assert!((demand.accel_rms - 0.5).abs() < 0.02 && (demand.decel_max - 0.5).abs() < 1e-9, "{demand:?}");
        assert!(demand.braking == 1.0 && demand.jerk_rms < 0.1, "{demand:?}");
    }
}
