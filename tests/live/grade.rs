//! The slope of SUMO's road, on request.

use crate::support::{CAR, NEW, OLD, configuration, network, number, run};
use std::path::Path;

const DEMAND: &str = r#"<vehicle id="ego" type="car" depart="0" departSpeed="0"><route edges="up"/></vehicle>"#;
/// Rise per metre of the road's plan.
const GRADE: f64 = 0.05;

/// Torque [N·m] and speed [m/s] of the car between 25 and 30 s, when it cruises.
fn cruise(version: &str, configuration: &Path, grade: &str) -> (f64, f64) {
    let set = format!("coupling.grade={grade}");
    let outcome = run(version, configuration, &["--end", "30", "--trace", "all", "--set", &set]);
    let rows = outcome.table("trace.csv");
    let cruising: Vec<_> = rows.iter().filter(|row| number(row, "time") > 25.0).collect();
    let mean = |column: &str| cruising.iter().map(|row| number(row, column)).sum::<f64>() / cruising.len() as f64;
    (mean("torque"), mean("speed"))
}

/// On a climb of 5 % the torque is the car's weight along the slope times the wheel radius, at the same speed; without the
/// option the road is flat.
#[test]
fn a_climb_costs_the_weight_along_the_slope() {
    let folder = tempfile::tempdir().unwrap();
    let nodes = format!(r#"<node id="a" x="0" y="0" z="0"/><node id="b" x="2000" y="0" z="{}"/>"#, 2000.0 * GRADE);
    let net = network(folder.path(), &nodes, r#"<edge id="up" from="a" to="b" numLanes="1" speed="20"/>"#);
    let configuration = configuration(folder.path(), &net, &format!("{CAR}{DEMAND}"), "");
    let wanted_nm = 1719.0 * 9.80665 * libm::sin(libm::atan(GRADE)) * 0.3;
    for version in [NEW, OLD] {
        let (flat_nm, flat_mps) = cruise(version, &configuration, "false");
        let (climb_nm, climb_mps) = cruise(version, &configuration, "true");
        println!("{version}: {flat_nm:.1} N·m flat, {climb_nm:.1} N·m uphill, by the slope {wanted_nm:.1} N·m");
        assert!(flat_nm.abs() < 5.0, "{version}: {flat_nm}");
        assert!((climb_nm / wanted_nm - 1.0).abs() < 0.02, "{version}: {climb_nm} against {wanted_nm}");
        assert!(
            (flat_mps - 20.0).abs() < 0.01 && (climb_mps - 20.0).abs() < 0.01,
            "{version}: {flat_mps}, {climb_mps}"
        );
    }
}
