//! A measured tyre curve, from the file to the road.

use crate::support::{CAR, NEW, Row, number, run, straight_road};
use std::fs;
use std::path::Path;

const DEMAND: &str = r#"<vehicle id="ego" type="car" depart="0" departSpeed="0"><route edges="ab bc"/></vehicle>"#;
/// Static load of a front wheel of the preset `car` [N] and the μ of the curve.
const FRONT_LOAD_N: f64 = 1719.0 * 9.80665 * 1.513 / (2.0 * 2.708);
const FRICTION: f64 = 0.6;

/// The trace of a run with these lines in the section [vehicle].
fn trace(folder: &Path, name: &str, vehicle: &str) -> Vec<Row> {
    let path = folder.join(format!("{name}.toml"));
    fs::write(&path, format!("[sumo]\nconfig = \"made.sumocfg\"\nend_s = 15.0\n\n[vehicle]\n{vehicle}\n")).unwrap();
    run(NEW, &path, &["--trace", "all"]).table("trace.csv")
}

/// A car that wants 2.6 m/s² on a wet road shows its tyre in the slip: the curve in the file has to drive like the
/// constants that it was made from, and unlike the preset.
#[test]
fn a_measured_curve_drives_like_the_constants_behind_it() {
    let folder = tempfile::tempdir().unwrap();
    straight_road(folder.path(), &format!("{CAR}{DEMAND}"));
    let shape = |slip: f64| {
        let x = 8.0 * slip;
        libm::sin(1.5 * libm::atan(x - 0.3 * (x - libm::atan(x))))
    };
    let points = (1..=250).map(|k| 0.004 * f64::from(k));
    let rows: String = points.map(|slip| format!("{slip},{}\n", FRICTION * FRONT_LOAD_N * shape(slip))).collect();
    fs::write(folder.path().join("wet.csv"), format!("slip,force_n\n{rows}")).unwrap();

    let known = format!("friction = {FRICTION}\nlongitudinal_b = 8.0\nlongitudinal_c = 1.5\nlongitudinal_e = 0.3");
    let slip = |name: &str, vehicle: &str| {
        let rows = trace(folder.path(), name, vehicle);
        let driving = rows.iter().filter(|row| number(row, "time") < 7.0);
        driving.map(|row| number(row, "slip_front")).fold(0.0, f64::max)
    };
    let measured = slip("measured", "tyre.curve = \"wet.csv\"");
    let (known, preset) = (slip("known", &known), slip("preset", "mass_kg = 1719.0"));
    println!("largest slip: curve {measured:.4}, constants {known:.4}, preset {preset:.4}");
    assert!(known > 0.05 && known < 0.3, "{known}");
    assert!((measured / known - 1.0).abs() < 0.02, "{measured} against {known}");
    assert!(preset < 0.6 * known, "{preset}");
}
