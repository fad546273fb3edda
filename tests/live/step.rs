//! The paper's step test inside SUMO: the same overshoots as offline.

use crate::support::{NEW, OLD, Running, number, own, program, run, table};
use std::collections::BTreeMap;

/// The controllers' and the body's settings of the paper's preset `default`, as `--set` takes them.
fn preset() -> Vec<String> {
    let text = std::fs::read_to_string(crate::support::repository("scenarios/paper/presets/default.toml")).unwrap();
    let mut section = String::new();
    let mut sets = Vec::new();
    for line in text.lines().map(|l| l.split(" #").next().unwrap_or_default().trim()) {
        if let Some(name) = line.strip_prefix('[').and_then(|l| l.strip_suffix(']')) {
            section = name.to_owned();
        } else if let (false, Some((key, value))) = (section.is_empty(), line.split_once('=')) {
            sets.extend(["--set".to_owned(), format!("{section}.{}={}", key.trim(), value.trim())]);
        }
    }
    sets
}

/// Both overshoots of both laws as the paper's test has them offline, without noise [%].
fn offline() -> BTreeMap<(String, String), f64> {
    let folder = tempfile::tempdir().unwrap();
    let mut command = program(NEW);
    command.current_dir(crate::support::repository("."));
    command.args(["paper", "step", "--preset", "default", "-o"]).arg(folder.path());
    let ended = Running::start(command).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let rows = table(&folder.path().join("results.csv"));
    let wanted = rows.iter().filter(|r| r["noise"] == "off" && r["quantity"].starts_with("overshoot"));
    wanted.map(|r| ((r["controller"].clone(), r["quantity"].clone()), number(r, "value"))).collect()
}

/// The limit of the lane is the target, SUMO clamps nothing, the odometers agree, and both laws overshoot as they do offline.
#[test]
fn val_the_limit_in_sumo_gives_the_overshoots_of_the_offline_test() {
    let offline = offline();
    let sets = preset();
    for version in [NEW, OLD] {
        for law in ["classic", "adaptive"] {
            let mut args =
                vec!["--target", "limit", "--controller", law, "--trace", "all", "--set", "vehicle.preset=\"car\""];
            args.extend(sets.iter().map(String::as_str));
            let outcome = run(version, &own("straight"), &args);
            let ego = outcome.vehicle("ego");
            assert_eq!(ego["clamped_steps"], "0", "{version} {law}");
            assert!(number(&ego, "odometer_gap").abs() < 0.1, "{version} {law}: {}", ego["odometer_gap"]);
            let trace = outcome.table("trace.csv");
            for (target_mps, quantity) in [(10.0, "overshoot_1"), (20.0, "overshoot_2")] {
                let there = trace.iter().filter(|r| number(r, "target") == target_mps);
                let peak_mps = there.map(|r| number(r, "speed")).fold(0.0, f64::max);
                let inside = 100.0 * (peak_mps / target_mps - 1.0);
                let outside = offline[&(law.to_owned(), quantity.to_owned())];
                println!("{version} {law} {quantity}: {inside:.2} % in SUMO, {outside:.2} % offline");
                assert!((inside - outside).abs() < 1.0, "{version} {law} {quantity}: {inside} against {outside}");
            }
        }
    }
}
