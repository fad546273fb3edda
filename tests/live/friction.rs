//! The friction of SUMO's lanes, on request.

use crate::support::{CAR, NEW, OLD, configuration, network, number, run};

/// On ice of friction 0.1 a car that wants 2.6 m/s² gets what the tyres hold, and its statistics say so; on the dry lane
/// before it, and without the option, it gets what it wants.
#[test]
fn the_friction_of_a_lane_limits_the_tyres() {
    const ICE: f64 = 0.1;
    let folder = tempfile::tempdir().unwrap();
    let nodes = r#"<node id="a" x="0" y="0"/><node id="b" x="1000" y="0"/><node id="c" x="2000" y="0"/>"#;
    let edge = |id: &str, ends: &str, friction: f64| {
        format!(r#"<edge id="{id}" {ends} numLanes="1" speed="40" friction="{friction}"/>"#)
    };
    let edges = edge("dry", r#"from="a" to="b""#, 1.0) + &edge("ice", r#"from="b" to="c""#, ICE);
    let net = network(folder.path(), nodes, &edges);
    let demand = format!(
        r#"{CAR}<vehicle id="dry" type="car" depart="0" departSpeed="0"><route edges="dry ice"/></vehicle>
        <vehicle id="ice" type="car" depart="0" departSpeed="0"><route edges="ice"/></vehicle>"#
    );
    let config = configuration(folder.path(), &net, &demand, "");
    let gained_mps = |version: &str, friction: &str| {
        let set = format!("coupling.friction={friction}");
        let result = run(version, &config, &["--end", "8", "--trace", "all", "--set", &set]);
        let rows = result.table("trace.csv");
        ["dry", "ice"].map(|id| number(rows.iter().rfind(|row| row["id"] == id).unwrap(), "speed"))
    };
    for version in [NEW, OLD] {
        let ([dry, on_ice], without) = (gained_mps(version, "true"), gained_mps(version, "false"));
        println!("SUMO {version}: {dry:.2} m/s dry, {on_ice:.2} m/s on ice");
        assert!(
            (without[0] - without[1]).abs() < 0.01 && (without[0] - dry).abs() < 1e-9,
            "SUMO {version}: {without:?}"
        );
        // Two driven wheels of four carry about half of the car.
        let held_mps2 = on_ice / 7.9;
        assert!(held_mps2 < 9.81 * ICE && held_mps2 > 0.3 * 9.81 * ICE, "SUMO {version}: {held_mps2} m/s²");
    }
}
