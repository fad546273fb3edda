//! What the map says: heat maps of ratios, and in how many cells adaptation helps.

use super::cell::{Cell, Map};
use super::heat::{Heat, Panel, heat_map};
use crate::paper::Finding;
use crate::paper::row::{Row, Rows};

/// A value of a cell, by name.
type Value = (&'static str, &'static str, fn(&Cell) -> Option<f64>);

const VALUES: [Value; 2] = [
    ("rms", "RMS error on a noisy recording", |c| c.error_rms),
    // A point of overshoot is added to both, so that two small ones do not make a large ratio.
    ("overshoot", "overshoot of the first step (+1 %)", |c| c.overshoot.map(|o| o + 1.0)),
];

/// Everything that is shown of it. `mark` is the paper's point: Δt, K_P and b of a preset.
pub fn finding(map: &Map, preset: &str, mark: [f64; 3]) -> Finding {
    let rows = shares(map, preset);
    let mut finding = Finding { text: words(&rows), rows, ..Finding::default() };
    for (value, title, of) in VALUES {
        for &delay_s in &map.grid.delays_s {
            for &limit_mps2 in &map.grid.limits_mps2 {
                let heat = plane(map, title, of, (delay_s, limit_mps2), mark);
                let name = format!("map_{value}_delay{delay_s}_limit{limit_mps2}");
                finding.figures.push(heat_map(&name, &heat));
            }
        }
    }
    finding
}

/// Adaptive over classic with the same K_P, b and T, one panel per control period.
fn plane(map: &Map, title: &str, of: fn(&Cell) -> Option<f64>, condition: (f64, f64), mark: [f64; 3]) -> Heat<'static> {
    let (delay_s, limit_mps2) = condition;
    let (grid, gains) = (&map.grid, &map.grid.gains);
    let names = |axis: &[f64]| axis.iter().map(|x| format!("{x}")).collect::<Vec<_>>();
    let panels = grid.periods_s.iter().map(|&period_s| {
        let ratio = |gain: f64, scale: f64| {
            let place = [period_s, gain, scale, limit_mps2, delay_s];
            Some(of(map.at("adaptive", place)?)? / of(map.at("classic", place)?)?)
        };
        let here = delay_s == 0.0 && period_s == mark[0];
        Panel {
            title: format!("dt {} ms", 1000.0 * period_s),
            columns: names(&grid.scales),
            rows: names(gains),
            ratios: gains.iter().map(|gain| grid.scales.iter().map(|scale| ratio(*gain, *scale)).collect()).collect(),
            mark: if here { on(&grid.scales, mark[2]).zip(on(gains, mark[1])) } else { None },
        }
    });
    Heat {
        title: format!("{title}, adaptive/classic; delay {delay_s} s, limit {limit_mps2} m/s2"),
        x: "torque scale b [m/s2 per u], alpha = 1",
        y: "K_P [1/s]",
        panels: panels.collect(),
    }
}

/// In how many cells the adaptive law is better with the same gains.
fn shares(map: &Map, preset: &str) -> Vec<Row> {
    let rows = Rows { test: "map", preset, controller: "adaptive" };
    let share = |of: fn(&Cell) -> Option<f64>, factor: f64| {
        let pairs = map
            .cells
            .iter()
            .filter(|c| c.controller == "adaptive")
            .filter_map(|c| Some(of(c)? / of(map.at("classic", c.place().1)?)?));
        let ratios: Vec<f64> = pairs.collect();
        let better = ratios.iter().filter(|r| **r * factor < 1.0).count() as f64;
        (!ratios.is_empty()).then(|| better / ratios.len() as f64)
    };
    let worse = |of| share(of, 1.0 / 1.05).map(|not_worse| 1.0 - not_worse);
    vec![
        noisy(&rows, "rms_better_by_5_percent_share", "1", share(|c| c.error_rms, 1.05)),
        noisy(&rows, "rms_worse_by_5_percent_share", "1", worse(|c| c.error_rms)),
        noisy(&rows, "overshoot_better_by_5_percent_share", "1", share(|c| c.overshoot.map(|o| o + 1.0), 1.05)),
        noisy(&rows, "overshoot_worse_by_5_percent_share", "1", worse(|c| c.overshoot.map(|o| o + 1.0))),
    ]
}

/// The shares, for the terminal.
fn words(rows: &[Row]) -> String {
    let line = |row: &Row| {
        let quantity = row.quantity.trim_end_matches("_share").replace('_', " ");
        row.value.map(|share| {
            format!("adaptive, with the gains of classic: {quantity} in {:.0} % of the cases\n", 100.0 * share)
        })
    };
    rows.iter().filter_map(line).collect()
}

/// Where a value is on a logarithmic axis, in cells.
fn on(axis: &[f64], value: f64) -> Option<f64> {
    let next = axis.iter().position(|x| *x >= value)?;
    let Some(before) = next.checked_sub(1) else { return (axis[0] == value).then_some(0.0) };
    let (low, high) = (axis[before], axis[next]);
    Some(before as f64 + libm::log(value / low) / libm::log(high / low))
}

/// One row of a number found with noise.
fn noisy(rows: &Rows, quantity: &'static str, unit: &'static str, value: Option<f64>) -> Row {
    Row {
        test: rows.test.to_owned(),
        preset: rows.preset.to_owned(),
        noise: true,
        controller: rows.controller,
        quantity,
        value,
        spread: None,
        unit,
    }
}
