//! Steps of position (Section 5.1): overshoot and undershoot of each step, where it settles, and how long α̂ stays nominal.

use super::compared::CONTROLLERS;
use super::error::PaperError;
use super::lab::{Finding, Lab, SEEDS};
use super::library::Preset;
use super::published::published;
use super::row::{Row, Rows};
use super::series::Series;
use crate::figure::{Chart, Curve, Figure, hue};
use crate::offline::{End, Moment, Outcome, Road};

/// Length of the test \[m\].
pub const LENGTH_M: f64 = 600.0;
/// The band in which a step has settled, relative to its height.
pub const BAND: f64 = 0.02;

/// The torque has settled when it stays below this share of its largest value.
const TORQUE_BAND: f64 = 0.05;

/// Up to here alpha / alpha nominal is drawn as nominal.
const NEARLY_NOMINAL: f64 = 1.05;
/// Where the strip of the nominal gain is on the axis of alpha / alpha nominal.
const STRIP_AT: f64 = 0.6;

/// A constant target on a stretch of road.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plateau {
    /// Where it begins \[m\].
    pub from_m: f64,
    /// Where the next one does \[m\].
    pub to_m: f64,
    /// The target [m/s].
    pub target_mps: f64,
}

/// How a vehicle took a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Largest speed above the target [% of the target]; 0 if it never got there.
    pub overshoot: f64,
    /// Largest speed below the target after it was first reached [%].
    pub undershoot: f64,
    /// Metres from the step to where it entered the band for good; none if it never did.
    pub settling_m: Option<f64>,
}

/// The response of a vehicle, given its places \[m\] and speeds [m/s], to a step upwards.
pub fn response(path: &[(f64, f64)], plateau: &Plateau) -> Response {
    let on = path.iter().filter(|(s, _)| (plateau.from_m..plateau.to_m).contains(s));
    let (mut over, mut under, mut reached, mut settled) = (0.0_f64, 0.0_f64, false, None);
    for (s, v) in on {
        let relative = v / plateau.target_mps - 1.0;
        reached |= relative >= 0.0;
        if reached {
            over = over.max(relative);
            under = under.max(-relative);
        }
        match (relative.abs() <= BAND, settled) {
            (true, None) => settled = Some(s - plateau.from_m),
            (false, Some(_)) => settled = None,
            _ => {}
        }
    }
    Response { overshoot: 100.0 * over, undershoot: 100.0 * under, settling_m: settled }
}

/// Metres from a step to where the torque is below [`TORQUE_BAND`] of its largest value for good, given places \[m\] and
/// torques; none if it never is.
fn torque_settling(torques: &[(f64, f64)], plateau: &Plateau) -> Option<f64> {
    let on = || torques.iter().filter(|(s, _)| (plateau.from_m..plateau.to_m).contains(s));
    let largest = on().map(|(_, torque)| torque.abs()).fold(0.0, f64::max);
    let mut settled = None;
    for (s, torque) in on() {
        match (torque.abs() <= TORQUE_BAND * largest, settled) {
            (true, None) => settled = Some(s - plateau.from_m),
            (false, Some(_)) => settled = None,
            _ => {}
        }
    }
    settled
}

/// Everything that the test shows about one controller.
pub struct Drive {
    /// The two steps.
    pub steps: [Plateau; 2],
    /// The vehicle without noise, every period.
    pub exact: Vec<Moment>,
    /// Responses to both steps, of the vehicle without noise and then of each with.
    pub responses: Vec<[Response; 2]>,
    /// The same of the torque \[m\].
    torque_settling_m: Vec<[Option<f64>; 2]>,
    /// Share of the time with α̂ nominal.
    nominal: Vec<f64>,
    /// Largest α̂/α_nominal while the speed is above the target.
    alpha_max: Vec<f64>,
    /// Their statistics.
    outcomes: Vec<Outcome>,
}

/// The two steps of the test.
pub fn plateaus(road: &Road) -> [Plateau; 2] {
    let at = |s: f64| road.profile.at(s, 0.0, 0.0).0;
    // The second step is where the profile changes.
    let places = (0..LENGTH_M as u32).map(f64::from);
    let second_m = places.into_iter().find(|s| at(*s) != at(0.0)).unwrap_or(LENGTH_M);
    [
        Plateau { from_m: 0.0, to_m: second_m, target_mps: at(0.0) },
        Plateau { from_m: second_m, to_m: LENGTH_M, target_mps: at(second_m) },
    ]
}

/// Drives the test.
///
/// # Errors
/// [`PaperError`] if the scenario has no profile.
pub fn drive(road: &Road, seeds: usize) -> Result<Drive, PaperError> {
    let steps = plateaus(road);
    let mut exact = Vec::new();
    let mut paths = vec![Vec::new(); seeds + 1];
    let mut torques = vec![Vec::new(); seeds + 1];
    let mut nominal = vec![0_u32; seeds + 1];
    let mut alpha_max = vec![1.0_f64; seeds + 1];
    let outcomes = road.drive(&road.trips(seeds, 0.0, End::Distance(LENGTH_M))?, |vehicle| {
        let (moment, i) = (vehicle.moment(), vehicle.trip);
        paths[i].push((moment.distance_m, moment.speed_mps));
        torques[i].push((moment.distance_m, moment.front_wheel_nm));
        nominal[i] += u32::from(moment.alpha_ratio == 1.0);
        if moment.speed_mps > moment.reference_mps {
            alpha_max[i] = alpha_max[i].max(moment.alpha_ratio);
        }
        if i == 0 {
            exact.push(moment);
        }
    })?;
    let nominal = nominal.iter().zip(&paths).map(|(n, path)| f64::from(*n) / path.len() as f64).collect();
    let responses = paths.iter().map(|path| steps.map(|step| response(path, &step))).collect();
    let torque_settling_m = torques.iter().map(|path| steps.map(|step| torque_settling(path, &step))).collect();
    Ok(Drive { steps, exact, responses, torque_settling_m, nominal, alpha_max, outcomes })
}

/// The test under one preset.
///
/// # Errors
/// [`PaperError`] if the scenario cannot be read.
pub fn run(lab: &Lab, preset: &Preset) -> Result<Finding, PaperError> {
    let mut drives = Vec::new();
    let (mut rows, mut steps) = (Vec::new(), Vec::new());
    for controller in CONTROLLERS {
        let scenario = lab.library.scenario("step", preset, controller, &[])?;
        let drive = drive(&Road::new(&scenario)?, SEEDS)?;
        rows.extend(numbers(&Rows { test: "step", preset: &preset.name, controller }, &drive));
        drives.push((controller, drive.exact));
        steps.push(drive.steps);
    }
    Ok(Finding {
        rows,
        figures: figures(preset, &steps[0], &drives),
        series: Series::all("step", preset, &drives),
        ..Finding::default()
    })
}

fn numbers(rows: &Rows, drive: &Drive) -> Vec<Row> {
    let column = |of: &dyn Fn(&[Response; 2]) -> Option<f64>| drive.responses.iter().map(of).collect::<Vec<_>>();
    let torque = |step: usize| drive.torque_settling_m.iter().map(|settling| settling[step]).collect::<Vec<_>>();
    let known = |values: &[f64]| values.iter().copied().map(Some).collect::<Vec<_>>();
    [
        rows.of("overshoot_1", "%", &column(&|r| Some(r[0].overshoot))),
        rows.of("overshoot_2", "%", &column(&|r| Some(r[1].overshoot))),
        rows.of("undershoot_1", "%", &column(&|r| Some(r[0].undershoot))),
        rows.of("undershoot_2", "%", &column(&|r| Some(r[1].undershoot))),
        rows.of("settling_1", "m", &column(&|r| r[0].settling_m)),
        rows.of("settling_2", "m", &column(&|r| r[1].settling_m)),
        rows.of("torque_settling_1", "m", &torque(0)),
        rows.of("torque_settling_2", "m", &torque(1)),
        rows.of("alpha_nominal_share", "1", &known(&drive.nominal)),
        rows.of("alpha_ratio_max", "1", &known(&drive.alpha_max)),
        rows.of("jerk_rms", "m/s3", &drive.outcomes.iter().map(|o| o.stats.jerk_rms).collect::<Vec<_>>()),
    ]
    .concat()
}

/// Figures 2 to 5 of the paper. Of the speed and its error there are also the levels that the published overshoots mean for
/// our targets.
fn figures(preset: &Preset, steps: &[Plateau; 2], drives: &[(&'static str, Vec<Moment>)]) -> Vec<Figure> {
    let along = |of: &dyn Fn(&Moment) -> f64| -> Vec<Curve> {
        let curve = |(name, moments): &(&'static str, Vec<Moment>)| {
            Curve::of(name, moments.iter().map(|m| (m.distance_m, of(m))).collect())
        };
        drives.iter().map(curve).collect()
    };
    let chart = |what: &str, title: &str, y: &str, curves: Vec<Curve>| {
        let title = format!("{title}, preset {}", preset.name);
        let logarithmic = what == "alpha";
        let chart = Chart { title, x: "distance s [m]", y, curves, logarithmic, ..Chart::default() };
        Figure::chart(&format!("{}_step_{what}", preset.name), &chart)
    };
    let reference = Curve::of("reference", drives[0].1.iter().map(|m| (m.distance_m, m.reference_mps)).collect());
    let speeds = [vec![reference], levels(steps, 1.0), along(&|m| m.speed_mps)].concat();
    let errors = [levels(steps, 0.0), along(&|m| m.speed_mps - m.reference_mps)].concat();
    let (torques, alphas) = (along(&|m| m.front_wheel_nm), drives.iter().find(|(name, _)| *name == "adaptive"));
    vec![
        chart("speed", "Speed, steps of position", "speed [m/s]", speeds),
        chart("error", "Speed error, steps of position", "error [m/s]", errors),
        chart("torque", "Torque of one front wheel, steps of position", "torque [N m]", torques),
        chart("alpha", "Adapted gain, steps of position", "alpha / alpha nominal", alpha(alphas.map_or(&[], |a| &a.1))),
    ]
}

/// How high the published overshoots reach above `base` times the targets.
fn levels(steps: &[Plateau; 2], base: f64) -> Vec<Curve> {
    let mut curves = Vec::new();
    for (place, controller) in CONTROLLERS.into_iter().enumerate() {
        for (plateau, quantity) in steps.iter().zip(["overshoot_1", "overshoot_2"]) {
            let Some(published) = published("step", controller, quantity) else { continue };
            let level = plateau.target_mps * (base + 0.01 * published.number());
            let name = if quantity == "overshoot_1" { format!("published, {controller}") } else { String::new() };
            let points = vec![(plateau.from_m, level), (plateau.to_m, level)];
            curves.push(Curve::of(&name, points).in_style(&format!("{} level", hue(controller, place))));
        }
    }
    curves
}

/// The adapted gain, with a strip below that is there where it is nominal: a curve that lies on its lowest value cannot be told
/// from one that is close to it.
fn alpha(moments: &[Moment]) -> Vec<Curve> {
    let near = |m: &Moment| m.alpha_ratio <= NEARLY_NOMINAL;
    let share = |is: &dyn Fn(&Moment) -> bool| {
        100.0 * moments.iter().filter(|m| is(m)).count() as f64 / moments.len().max(1) as f64
    };
    let name = format!(
        "nominal {:.0} % of the time, within 5 % of it {:.0} %",
        share(&|m| m.alpha_ratio == 1.0),
        share(&near)
    );
    let style = format!("{} strip", hue("adaptive", 1));
    let strip = |run: &[Moment]| {
        let [first, .., last] = run else { return None };
        let ends = [first, last].map(|m| (m.distance_m, STRIP_AT));
        near(first).then(|| Curve::of("", ends.to_vec()).in_style(&style))
    };
    let mut strips: Vec<Curve> = moments.chunk_by(|a, b| near(a) == near(b)).filter_map(strip).collect();
    if let Some(first) = strips.first_mut() {
        first.name = name;
    }
    let ends = moments.first().zip(moments.last()).map(|(a, b)| vec![(a.distance_m, 1.0), (b.distance_m, 1.0)]);
    let nominal = Curve::of("alpha nominal", ends.unwrap_or_default()).in_style("reference");
    let adapted = Curve::of("adaptive", moments.iter().map(|m| (m.distance_m, m.alpha_ratio)).collect());
    strips.into_iter().chain([nominal, adapted]).collect()
}
