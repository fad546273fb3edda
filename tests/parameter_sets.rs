//! Random legal parameter sets: every key of a scenario that has a range is drawn from the whole of it, and the vehicles are
//! driven hard. Every state stays a finite number, whatever is drawn; a vehicle that becomes faster than any ends as diverged.
//!
//! What is drawn comes from the declarations of the keys, so that a new key is drawn by itself. A set is made from its
//! number alone.

use std::collections::BTreeMap;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sumo_mfc::fleet::follow::{Bound, Follow};
use sumo_mfc::fleet::{Fleet, Snapshot};
use sumo_mfc::keys::{Key, Kind};
use sumo_mfc::offline::{End, Road};
use sumo_mfc::reference::{Axis, Profile, Target};
use sumo_mfc::scenario::{Catalog, Form, Override, Request, Scenario, sections};

/// How many sets are driven.
const SETS: u64 = 10_000;

/// More diverged vehicles than this share would be news: a car of 50 kg with 957 740 N·m does diverge.
const DIVERGED_MAX: f64 = 0.01;

/// How long a vehicle drives \[s\], if that does not take more substeps of its body than this.
const DRIVE_S: f64 = 6.0;
const SUBSTEPS_MAX: f64 = 3_000.0;
/// The implicit oracle is there to be compared with, and takes minutes for some of these vehicles.
const ORACLE: &str = "reference";

/// Sections that say nothing about how a vehicle drives.
const OTHER_SECTIONS: [&str; 4] = ["sumo", "egos", "traffic", "output"];

/// Keys without a range, by section: texts and files, drawn by hand or not at all.
const WITHOUT_RANGE: [&str; 5] =
    ["target.file", "target.step_at", "target.step_speeds_mps", "vehicle.preset", "vehicle.tyre_curve"];

/// A number of the range: its ends, what lies near them, and everything between, over the decades if there are many.
fn number(random: &mut ChaCha8Rng, min: f64, max: f64) -> f64 {
    let share: f64 = random.random();
    match random.random_range(0..10) {
        0 => min,
        1 => max,
        2..=5 if max > 0.0 && max > 1e3 * min.max(1e-12) && min >= 0.0 => {
            let least = min.max(1e-9 * max);
            (least * libm::exp(share * libm::log(max / least))).clamp(min, max)
        }
        _ => min + share * (max - min),
    }
}

/// The text of a value, as `--set` takes it; none for a key without a range.
fn value(random: &mut ChaCha8Rng, key: &Key) -> Option<String> {
    Some(match key.kind {
        Kind::NumberOr { word, .. } if random.random_range(0..4) == 0 => format!("\"{word}\""),
        Kind::Number { min, max, .. } | Kind::NumberOr { min, max, .. } => format!("{:?}", number(random, min, max)),
        Kind::Integer { min, max } => (number(random, min as f64, max as f64) as i64).clamp(min, max).to_string(),
        Kind::Flag => random.random::<bool>().to_string(),
        Kind::Choice(words) => format!("\"{}\"", words[random.random_range(0..words.len())]),
        Kind::Text | Kind::Form(_) | Kind::File | Kind::Texts | Kind::Files => return None,
    })
}

/// What is set in a set. `rich` is the chance of each key to be set.
fn overrides(random: &mut ChaCha8Rng, catalog: &Catalog) -> Vec<Override> {
    let mut all = Vec::new();
    let set = |all: &mut Vec<Override>, key: String, value: String| {
        all.push(Override { shown: format!("--set {key}={value}"), path: key, value });
    };
    let rich = [0.05, 0.2, 0.5][random.random_range(0..3)];
    for section in sections(catalog).iter().filter(|section| !OTHER_SECTIONS.contains(&section.name)) {
        let keys = match &section.form {
            Form::Keys(keys) | Form::Drawn(keys) => keys.clone(),
            Form::Choice(entries) => {
                let entries: Vec<_> = entries.iter().filter(|entry| entry.name != ORACLE).collect();
                let entry = &entries[random.random_range(0..entries.len())];
                set(&mut all, format!("{}.name", section.name), format!("\"{}\"", entry.name));
                entry.keys.to_vec()
            }
        };
        for key in keys.iter().filter(|key| key.name != "control_period_s") {
            if let (true, Some(value)) = (random.random_bool(rich), value(random, key)) {
                set(&mut all, format!("{}.{}", section.name, key.name), value);
            }
        }
    }
    let bodies = &catalog.registries()[3].1;
    set(&mut all, "vehicle.preset".to_owned(), format!("\"{}\"", bodies[random.random_range(0..bodies.len())].name));
    // A profile without a file, and a step of whole control periods.
    set(&mut all, "target.shape".to_owned(), format!("\"{}\"", ["step", "sine"][random.random_range(0..2)]));
    let substep_s = all.iter().find(|o| o.path == "plant.substep_s").map_or(0.01, |o| o.value.parse().unwrap());
    let is_short = |ms: &u32| f64::from(*ms) * 1e-3 <= SUBSTEPS_MAX * substep_s;
    let fits = [1, 10, 50, 100, 500, 1000, 10_000].into_iter().filter(is_short).count();
    let step_ms = [1, 10, 50, 100, 500, 1000, 10_000][random.random_range(0..fits.max(1))];
    let parts = [1, 2, 5, 10][random.random_range(0..4)];
    let period_s = (f64::from(step_ms) * 1e-3 / f64::from(parts)).clamp(1e-4, 1.0);
    set(&mut all, "sumo.step_length_s".to_owned(), format!("{:?}", f64::from(step_ms) * 1e-3));
    set(&mut all, "coupling.control_period_s".to_owned(), format!("{period_s:?}"));
    let is_profile = all.iter().any(|o| o.path == "target.name" && o.value == "\"profile\"");
    all.retain(|o| is_profile || !o.path.starts_with("target.") || o.path == "target.name");
    all
}

/// How a set ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Ended {
    /// To the end of the drive.
    Whole,
    /// The vehicle became faster than any: the run ends its record as `diverged`.
    TooFast,
}

/// What a vehicle shows, by name.
fn shown(now: &Snapshot) -> [(&'static str, f64); 12] {
    [
        ("target", now.target_mps),
        ("reference", now.reference_mps),
        ("speed", now.speed_mps),
        ("measured speed", now.measured_mps),
        ("lateral speed", now.lateral_mps),
        ("yaw rate", now.yaw_rate_radps),
        ("front slip", now.slip[0]),
        ("rear slip", now.slip[1]),
        ("torque", now.torque_nm),
        ("alpha", now.alpha_ratio),
        ("F", now.f_hat_mps2),
        ("distance", now.distance_m),
    ]
}

/// Full throttle, full brakes, standstill and crawling, by time.
fn demanding() -> Profile {
    let at = [0.0, 0.5, 1.0, 1.8, 2.2, 3.0, 3.3, 4.0, 5.0];
    Profile::step(Axis::Time, &at, &[5.0, 30.0, 0.0, 0.0, 12.0, 60.0, 0.3, 25.0, 0.0]).unwrap()
}

/// Drives one set; an error names what is not finite although the run would go on.
fn drive(scenario: &Scenario, random: &mut ChaCha8Rng) -> Result<Ended, String> {
    let group = &scenario.groups[0];
    let target = group.load_target().map_err(|error| format!("refused: {error}"))?;
    let demanding = demanding();
    let (profile, is_traffic) = match &target {
        Target::Profile(profile) => (&**profile, false),
        Target::Traffic | Target::Spacing(_) => (&demanding, true),
        Target::Limit => (&demanding, false),
    };
    let road = Road::with_profile(scenario, profile.clone().into()).map_err(|error| format!("refused: {error}"))?;
    let start_mps = [0.0, 5.0, 60.0][random.random_range(0..3)];
    let trip = road.trip(0, start_mps, End::Time(DRIVE_S)).map_err(|error| format!("refused: {error}"))?;
    let (step_s, period_s) = (scenario.sumo.step_length_s, scenario.coupling.control_period_s);
    let periods = (step_s / period_s).round() as u32;
    let substep_s = scenario.plant.values.get("substep_s").unwrap_or(0.01).min(period_s);
    let steps = (DRIVE_S.min(SUBSTEPS_MAX * substep_s) / step_s).ceil() as u32;
    let mut fleet = Fleet::new(scenario.loop_config(), vec![scenario.blocks(group)]).rated(true);
    let slot = fleet.admit(0, trip.vehicle);
    let (lane, mut ended) = (slot.lane(), Ended::Whole);
    for step in 0..steps {
        let begin_s = f64::from(step) * step_s;
        let wanted_mps = profile.at(fleet.block(slot).distance_m(lane), begin_s, fleet.block(slot).speed_mps(lane)).0;
        let block = fleet.block_mut(slot);
        let (grade, headwind, heading) =
            (random.random_range(-0.3..0.3), random.random_range(-40.0..40.0), random.random_range(-3.2..3.2));
        if step % 8 == 7 {
            block.inputs_mut().headwind_mps[lane] = headwind;
            block.set_grade(lane, grade);
            block.set_road_friction(lane, random.random_range(0.05..1.0));
        }
        block.see_heading(lane, Some(heading), step_s);
        let follow = match (is_traffic, &target) {
            (true, _) => {
                // SUMO's own cars brake with at most 9 m/s² and gain at most 2.6.
                let now_mps = block.speed_mps(lane);
                let v = wanted_mps.clamp((now_mps - 9.0 * step_s).max(0.0), now_mps + 2.6 * step_s);
                block.set_target(lane, v, Bound::Traffic);
                block.see_speed(lane, v);
                Follow::Traffic
            }
            (_, Target::Limit) => {
                block.set_target(lane, wanted_mps, Bound::Limit);
                Follow::Target
            }
            _ => {
                block.set_target(lane, f64::INFINITY, Bound::Profile);
                Follow::Profile(profile)
            }
        };
        fleet.advance(periods, |_| true, follow);
        fleet.close_step();
        let (block, now) = (fleet.block(slot), fleet.block(slot).snapshot(lane));
        if !block.is_sound(lane) {
            ended = Ended::TooFast;
        }
        if let Some((name, value)) = shown(&now).into_iter().find(|(_, value)| !value.is_finite()) {
            return Err(format!("{name} is {value} at {begin_s} s"));
        }
        if ended == Ended::TooFast {
            return Ok(ended);
        }
    }
    let stats = fleet.release(slot);
    let rms = [stats.error_rms, stats.torque_rms, stats.jerk_rms, stats.accel_max, stats.speed_gap_rms];
    match rms.into_iter().flatten().find(|value| !value.is_finite()) {
        Some(value) => Err(format!("a statistic is {value}")),
        None => Ok(Ended::Whole),
    }
}

/// Draws sets until one is legal, and drives it.
fn set(number: u64, catalog: &Catalog, refused: &mut BTreeMap<String, u64>) -> Result<(String, Ended), String> {
    let mut random = ChaCha8Rng::seed_from_u64(number);
    loop {
        let overrides = overrides(&mut random, catalog);
        let all = overrides.iter().map(|o| o.shown.clone()).collect::<Vec<_>>().join(" ");
        let driven = match Scenario::load_offline(&Request { scenario: None, overrides }, catalog) {
            Ok(scenario) => drive(&scenario, &mut random).map(|end| (scenario.groups[0].controller.name(), end)),
            Err(error) => Err(format!("refused: {error}")),
        };
        match driven {
            Ok((law, end)) => return Ok((law.to_owned(), end)),
            Err(what) if what.starts_with("refused") => {
                let kind = what.chars().filter(|c| !c.is_ascii_digit()).take(90).collect();
                *refused.entry(kind).or_default() += 1;
            }
            Err(what) => return Err(format!("set {number}: {what}: {all}")),
        }
    }
}

/// Drives so many sets on all cores, and prints how they ended.
fn drive_sets(count: u64) {
    let catalog = Catalog::installed();
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
    let share = |thread: u64| {
        let (mut ends, mut refused, mut wrong) = (BTreeMap::new(), BTreeMap::new(), Vec::new());
        for number in (thread..count).step_by(threads as usize) {
            match set(number, &catalog, &mut refused) {
                Ok(end) => *ends.entry(end).or_insert(0_u64) += 1,
                Err(what) => wrong.push(what),
            }
        }
        (ends, refused, wrong)
    };
    let shares: Vec<_> = std::thread::scope(|scope| {
        let handles: Vec<_> = (0..threads).map(|thread| scope.spawn(move || share(thread))).collect();
        handles.into_iter().map(|handle| handle.join().unwrap()).collect()
    });
    let (mut ends, mut refused, mut wrong) = (BTreeMap::new(), BTreeMap::new(), Vec::new());
    for (e, r, w) in shares {
        e.into_iter().for_each(|(key, n)| *ends.entry(key).or_insert(0) += n);
        r.into_iter().for_each(|(key, n): (String, u64)| *refused.entry(key).or_insert(0) += n);
        wrong.extend(w);
    }
    for ((law, end), n) in &ends {
        eprintln!("{law}\t{end:?}\t{n}");
    }
    for (what, n) in &refused {
        eprintln!("drawn again {n} times, {what}");
    }
    assert!(
        wrong.is_empty(),
        "{} of {count}; the first: {}",
        wrong.len(),
        wrong.iter().take(5).cloned().collect::<Vec<_>>().join("\n")
    );
    let laws = catalog.registries()[0].1.len();
    assert_eq!(ends.keys().map(|(law, _)| law).collect::<std::collections::BTreeSet<_>>().len(), laws, "every law");
    let drawn_again: u64 = refused.values().sum();
    assert!(drawn_again < count, "{drawn_again} of {count} sets that the declarations allow are refused");
    let diverged: u64 = ends.iter().filter(|((_, end), _)| *end != Ended::Whole).map(|(_, n)| n).sum();
    assert!(diverged as f64 <= DIVERGED_MAX * count as f64, "{diverged} of {count} diverged");
}

/// Every number that the vehicle shows is one in every step, also in the step in which it has become too fast.
#[test]
fn law_no_legal_parameter_set_makes_a_number_that_is_none() {
    drive_sets(SETS);
}

/// What the test does not draw is known by name; whoever adds a text or a file decides here whether it matters.
#[test]
fn every_key_with_a_range_is_drawn() {
    let catalog = Catalog::installed();
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut without = Vec::new();
    for section in sections(&catalog).iter().filter(|section| !OTHER_SECTIONS.contains(&section.name)) {
        let keys = match &section.form {
            Form::Keys(keys) | Form::Drawn(keys) => keys.clone(),
            Form::Choice(entries) => entries.iter().flat_map(|entry| entry.keys.to_vec()).collect(),
        };
        let name = |key: &Key| format!("{}.{}", section.name, key.name);
        without.extend(keys.iter().filter(|key| value(&mut random, key).is_none()).map(name));
    }
    without.sort();
    assert_eq!(without, WITHOUT_RANGE);
}
