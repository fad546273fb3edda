//! Configurations that were not made for this program run unchanged to their end and stay as they are.

use crate::support::{NEW, OLD, attribute, elements, foreign, number, run};
use std::fs;
use std::path::Path;
use std::time::SystemTime;

/// Every file below a folder with its size and the time of its last change.
fn listing(folder: &Path) -> Vec<(String, u64, SystemTime)> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let meta = entry.metadata().unwrap();
        if meta.is_dir() {
            files.extend(listing(&entry.path()));
        }
        files.push((entry.path().display().to_string(), meta.len(), meta.modified().unwrap()));
    }
    files.sort();
    files
}

fn runs_to_its_end(version: &str, name: &str, args: &[&str], at_least: usize) {
    let what = format!("SUMO {version}, {name} {args:?}");
    let config = foreign(name);
    let folder = config.parent().unwrap();
    let before = listing(folder);
    let result = run(version, &config, args);
    assert_eq!(listing(folder), before, "{what}: the configuration's folder has changed");

    let statistics = result.dir.join("sumo/statistics.xml");
    let inserted: usize = attribute(&elements(&statistics, "vehicles")[0], "inserted").parse().unwrap();
    let rows = result.vehicles();
    assert_eq!(rows.len(), inserted, "{what}");
    assert!(inserted >= at_least, "{what}: {inserted} vehicles");
    let trips = elements(&result.dir.join("sumo/tripinfo.xml"), "tripinfo");
    let arrived = trips.iter().filter(|trip| attribute(trip, "arrival") != "-1.00").count();
    assert_eq!(rows.iter().filter(|row| row["complete"] == "true").count(), arrived, "{what}");
    let last_s = rows.iter().map(|row| number(row, "depart")).fold(0.0, f64::max);
    let end_s: f64 = if name.starts_with("cologne") { 28_800.0 } else { 61_200.0 };
    assert!(last_s <= end_s && last_s > end_s - 60.0, "{what}: the last departure is at {last_s} s");
    assert_eq!(result.sumo("collisions"), 0.0, "{what}");
    let worst =
        rows.iter().filter(|row| row["complete"] == "true").map(|row| number(row, "error_rms")).fold(0.0, f64::max);
    assert!(worst < 0.1, "{what}: an error of {worst} m/s (RMS)");
    assert_eq!(result.json("run.json")["status"], "complete", "{what}");
}

#[test]
fn foreign_configurations_at_the_default_step() {
    runs_to_its_end(NEW, "cologne1", &[], 2000);
    runs_to_its_end(NEW, "ingolstadt1", &[], 1700);
}

#[test]
fn foreign_configurations_at_steps_of_a_second() {
    runs_to_its_end(NEW, "cologne8", &["--step-length", "1"], 2000);
    runs_to_its_end(OLD, "cologne8", &["--step-length", "1"], 2000);
}

#[test]
fn a_large_foreign_configuration() {
    runs_to_its_end(NEW, "ingolstadt21", &["--step-length", "1"], 4000);
}
