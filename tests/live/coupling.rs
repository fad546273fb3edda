//! One ego: SUMO's speed is the body's, no creep, no freeze, red lights obeyed.

use crate::support::{CAR, NEW, OLD, Row, attribute, elements, number, own, plain_sumo, run, straight_road};
use std::path::Path;

const DEMAND: &str = r#"<vehicle id="ego" type="car" depart="0" departSpeed="0"><route edges="ab bc"/></vehicle>"#;

/// When plain SUMO drives faster than 18 m/s: the end of the first step with such a speed [s].
fn plain_time_s(version: &str, config: &Path, step: &str) -> f64 {
    let fcd = config.with_file_name(format!("fcd-{version}-{step}.xml"));
    let options = ["--step-length", step, "--step-method.ballistic", "true", "--end", "30", "--precision", "6"];
    let mut args: Vec<&str> = vec!["-c", config.to_str().unwrap(), "--fcd-output", fcd.to_str().unwrap()];
    args.extend(options);
    plain_sumo(version, &args);
    let speeds = elements(&fcd, "vehicle");
    let index = speeds.iter().position(|e| attribute(e, "speed").parse::<f64>().unwrap() >= 18.0).unwrap();
    let begin_s: f64 = attribute(&elements(&fcd, "timestep")[index], "time").parse().unwrap();
    begin_s + step.parse::<f64>().unwrap()
}

/// When the body does.
fn body_time_s(trace: &[Row]) -> f64 {
    number(trace.iter().find(|row| number(row, "speed") >= 18.0).expect("18 m/s is reached"), "time")
}

fn accelerates_as_plain_sumo(version: &str, steps: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), &format!("{CAR}{DEMAND}"));
    for step in steps {
        let plain_s = plain_time_s(version, &config, step);
        let step_s: f64 = step.parse().unwrap();
        for controller in ["classic", "adaptive"] {
            let args = ["--step-length", step, "--controller", controller, "--trace", "all", "--end", "30"];
            let result = run(version, &config, &args);
            let trace = result.table("trace.csv");
            let late_s = body_time_s(&trace) - plain_s;
            assert!(
                late_s.abs() <= 0.3_f64.max(step_s) + 1e-9,
                "SUMO {version}, {controller}, step {step}: 18 m/s {late_s} s after plain SUMO"
            );
            // No creep: it gets to the limit and stays there.
            let last = number(trace.last().unwrap(), "speed");
            assert!((last - 20.0).abs() < 0.05, "SUMO {version}, {controller}, step {step}: {last} m/s at the end");
        }
    }
}

#[test]
fn val_accelerates_as_plain_sumo_does_at_every_step_length_new() {
    accelerates_as_plain_sumo(NEW, &["0.01", "0.05", "0.1", "0.5", "1"]);
}

#[test]
fn val_accelerates_as_plain_sumo_does_at_every_step_length_old() {
    accelerates_as_plain_sumo(OLD, &["0.01", "0.05", "0.1", "0.5", "1"]);
}

/// The light is red until 120 s and 500 m from the start.
fn obeys_the_light(version: &str, controller: &str, step: &str) {
    let what = format!("SUMO {version}, {controller}, step {step}");
    let args = ["--controller", controller, "--step-length", step, "--trace", "all"];
    let result = run(version, &own("light"), &args);
    let trace = result.table("trace.csv");
    let before = trace.iter().rfind(|row| number(row, "time") <= 120.0).unwrap();
    assert!(number(before, "distance") < 500.0, "{what}: it is over the line at red");
    assert!(number(before, "distance") > 495.0, "{what}: it creeps or stops {} m from the start", before["distance"]);
    for row in trace.iter().filter(|row| (60.0..=120.0).contains(&number(row, "time"))) {
        for column in ["speed", "lateral_speed", "yaw_rate", "slip_front", "slip_rear", "torque"] {
            assert_eq!(number(row, column), 0.0, "{what}: {column} at {} s", row["time"]);
        }
    }
    // It starts again as it started first: no jump of torque, and 18 m/s as long after green.
    let first = number(&trace[0], "torque");
    let start = trace.iter().find(|row| number(row, "time") > 120.0 && number(row, "speed") > 0.0).unwrap();
    assert!(number(start, "torque") <= 1.2 * first.max(2.6 * 1100.0), "{what}: torque jumps to {}", start["torque"]);
    let green = trace.iter().find(|row| number(row, "time") > 120.0 && number(row, "speed") >= 18.0).unwrap();
    let first_s = body_time_s(&trace);
    let again_s = number(green, "time") - 120.0;
    assert!((again_s - first_s).abs() <= 1.0 + step.parse::<f64>().unwrap(), "{what}: {first_s} s, then {again_s} s");
    let row = result.vehicle("ego");
    assert_eq!(row["reason"], "arrived", "{what}");
    let largest = if step == "0.1" { 0.1 } else { 0.5 };
    assert!(number(&row, "odometer_gap").abs() < largest, "{what}: odometer gap {} m", row["odometer_gap"]);
    assert!(number(&row, "error_max_abs") < 0.3, "{what}: error {} m/s", row["error_max_abs"]);
}

#[test]
fn stops_at_red_stands_exactly_and_starts_again() {
    for version in [NEW, OLD] {
        for controller in ["classic", "adaptive"] {
            obeys_the_light(version, controller, "0.1");
        }
        obeys_the_light(version, "adaptive", "1");
        obeys_the_light(version, "pid", "0.1");
    }
}

/// The body leads, the limit jumps from 10 to 20 m/s: SUMO must not clip the overshoot.
#[test]
fn a_leading_body_is_not_clamped_and_shows_its_overshoot() {
    for version in [NEW, OLD] {
        for controller in ["classic", "adaptive"] {
            let what = format!("SUMO {version}, {controller}");
            let result = run(version, &own("straight"), &["--target", "limit", "--controller", controller]);
            let row = result.vehicle("ego");
            assert_eq!(row["reason"], "arrived", "{what}");
            assert_eq!(row["clamped_steps"], "0", "{what}");
            assert_eq!(number(&row, "share_limit"), 1.0, "{what}");
            assert!(number(&row, "odometer_gap").abs() < 0.1, "{what}: odometer gap {} m", row["odometer_gap"]);
            // It really leads: from rest to a step of 10 m/s is an error of 10 m/s.
            assert!(number(&row, "error_max_abs") > 9.0, "{what}: {}", row["error_max_abs"]);
        }
    }
}

/// A profile over the position, driven in SUMO: the body leads along it, whatever the lane's limit.
#[test]
fn a_profile_is_driven_without_clamps() {
    let shapes: [&[&str]; 2] = [
        &["--set", "target.shape=step", "--set", "target.step_at=0, 300", "--set", "target.step_speeds_mps=10, 25"],
        &["--set", "target.shape=sine"],
    ];
    for version in [NEW, OLD] {
        for shape in shapes {
            let what = format!("SUMO {version}, {shape:?}");
            let result = run(version, &own("straight"), &[&["--target", "profile", "--trace", "all"], shape].concat());
            let row = result.vehicle("ego");
            assert_eq!((row["reason"].as_str(), row["clamped_steps"].as_str()), ("arrived", "0"), "{what}");
            assert_eq!(number(&row, "share_profile"), 1.0, "{what}");
            assert!(number(&row, "odometer_gap").abs() < 0.1, "{what}: odometer gap {} m", row["odometer_gap"]);
            let trace = result.table("trace.csv");
            let fastest = trace.iter().map(|row| number(row, "speed")).fold(0.0, f64::max);
            assert!(fastest > 19.0, "{what}: {fastest} m/s");
            let settled: Vec<&Row> = trace.iter().filter(|row| number(row, "distance") > 600.0).collect();
            let error = |row: &Row| (number(row, "speed") - number(row, "reference")).abs();
            let worst = settled.iter().map(|row| error(row)).fold(0.0, f64::max);
            assert!(worst < 0.5, "{what}: {worst} m/s off at the end");
        }
    }
}
