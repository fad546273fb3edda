//! The city with every car equipped: bodies and controllers leave the traffic what it was.

use crate::support::{NEW, OLD, Outcome, Row, number, own, run};

/// Arrivals and mean time loss within 5 % of the ideal controller, and no collision.
fn keeps_the_traffic(version: &str, step: &str, end: &str) {
    let go = |controller: &str| -> Outcome {
        let args = ["--controller", controller, "--step-length", step, "--end", end, "--set", "traffic.sigma=0"];
        run(version, &own("city"), &args)
    };
    let ideal = go("ideal");
    for controller in ["adaptive", "classic"] {
        let what = format!("SUMO {version}, {controller}, step {step}");
        let ours = go(controller);
        for key in ["arrived", "time_loss_mean_s"] {
            let (wanted, got) = (ideal.sumo(key), ours.sumo(key));
            assert!((got / wanted - 1.0).abs() <= 0.05, "{what}: {key} {got} instead of {wanted}");
        }
        assert_eq!(ours.sumo("collisions"), 0.0, "{what}");
        assert_eq!(ours.sumo("teleports"), ideal.sumo("teleports"), "{what}");
        let rows = ours.vehicles();
        assert_eq!(rows.len() as f64, ours.sumo("inserted"), "{what}: a row per vehicle");
        for row in &rows {
            assert_eq!(row["collisions"], "0", "{what}: {}", row["id"]);
            if row["complete"] == "true" {
                let shares: f64 = ["share_traffic", "share_limit", "share_profile", "share_clamp"]
                    .iter()
                    .map(|c| number(row, c))
                    .sum();
                assert!((shares - 1.0).abs() < 1e-9, "{what}: shares of {} sum to {shares}", row["id"]);
            }
        }
        // SUMO stops a car within a step, which at 1 s is metres; what matters is what the controller adds to it.
        let (wanted_m, gap_m) = (mean_gap_m(&ideal.vehicles()), mean_gap_m(&rows));
        assert!((gap_m - wanted_m).abs() < 0.1, "{what}: mean odometer gap {gap_m} m instead of {wanted_m} m");
        assert!(step != "0.1" || gap_m.abs() < 0.1, "{what}: mean odometer gap {gap_m} m");
    }
}

fn mean_gap_m(rows: &[Row]) -> f64 {
    let gaps_m: Vec<f64> = rows.iter().filter(|r| r["complete"] == "true").map(|r| number(r, "odometer_gap")).collect();
    gaps_m.iter().sum::<f64>() / gaps_m.len() as f64
}

#[test]
fn the_city_with_steps_of_a_tenth_of_a_second() {
    keeps_the_traffic(NEW, "0.1", "400");
}

#[test]
fn the_city_with_steps_of_a_second() {
    keeps_the_traffic(NEW, "1", "600");
    keeps_the_traffic(OLD, "1", "600");
}

/// The lateral states are really excited by the road, and nobody spins.
#[test]
fn cars_turn_with_the_road_and_do_not_spin() {
    let result = run(NEW, &own("city"), &["--end", "200", "--trace", "all", "--trace-period", "1"]);
    let trace = result.table("trace.csv");
    let largest = |column: &str| trace.iter().map(|row| number(row, column).abs()).fold(0.0, f64::max);
    assert!(largest("lateral_speed") > 0.02, "{}", largest("lateral_speed"));
    assert!(largest("lateral_speed") < 2.0, "{}", largest("lateral_speed"));
    assert!(largest("yaw_rate") > 0.2, "{}", largest("yaw_rate"));
    assert!(largest("yaw_rate") < 2.5, "{}", largest("yaw_rate"));
    // A quarter turn of the road is a quarter turn of the body: the sum over all cars of both senses of rotation is large.
    let turned: f64 = trace.iter().map(|row| number(row, "yaw_rate").abs()).sum();
    assert!(turned > 100.0, "{turned} rad in all");
}
