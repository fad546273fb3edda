//! `quality.csv`: drive quality, comfort, work and string stability, against what the trace of the same run says.

use crate::support::{NEW, OLD, Outcome, Row, number, run, straight_road};

/// Cars that follow each other with imperfect drivers.
const PLATOON: &str = r#"<vType id="car" accel="2.6" decel="4.5" sigma="0.5" speedFactor="1" speedDev="0"/>
    <flow id="f" type="car" begin="0" end="12" number="6" from="ab" to="bc" departSpeed="10"/>"#;

fn drive(version: &str, args: &[&str]) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), PLATOON);
    run(version, &config, &[&["--seed", "4", "--trace", "all"], args].concat())
}

/// The speeds of a vehicle at whole steps, by time in tenths of a second.
fn speeds(trace: &[Row], id: &str, column: &str) -> Vec<(i64, f64)> {
    let own = trace.iter().filter(|row| row["id"] == id);
    own.map(|row| ((number(row, "time") * 10.0).round() as i64, number(row, column))).collect()
}

#[test]
fn without_a_controller_the_body_drives_what_was_wanted() {
    let result = drive(NEW, &["--controller", "ideal"]);
    let rows = result.table("quality.csv");
    assert_eq!(rows.len(), 6);
    for row in rows {
        for rating in ["energy_rating", "distance_rating", "speed_change_rating", "inertial_work_rating"] {
            assert!(number(&row, rating).abs() < 1e-9, "{row:?}");
        }
        for metric in ["comfort_accel", "motion_sickness", "high_jerk_share"] {
            let (own, wanted) = (number(&row, metric), number(&row, &format!("{metric}_target")));
            assert!((own - wanted).abs() < 1e-6 * wanted.max(1.0), "{metric}: {own} and {wanted}");
        }
        assert_eq!((&*row["tractive_work"], &*row["energy_per_km"]), ("", ""), "there is no torque");
    }
}

#[test]
fn ratings_and_work_are_those_of_the_trace() {
    let result = drive(NEW, &["--controller", "pid", "--trace-period", "0.01", "--set", "actuator.lag_s=0.3"]);
    let (trace, rows) = (result.table("trace.csv"), result.table("quality.csv"));
    for row in rows {
        let own: Vec<&Row> = trace.iter().filter(|line| line["id"] == row["id"]).collect();
        let change = |column: &str| {
            let ends: Vec<f64> = own.iter().skip(9).step_by(10).map(|line| number(line, column)).collect();
            (ends[0] - 10.0).abs() + ends.windows(2).map(|v| (v[1] - v[0]).abs()).sum::<f64>()
        };
        let wanted = 100.0 * (change("speed") / change("target") - 1.0);
        assert!(
            (number(&row, "speed_change_rating") - wanted).abs() < 0.02 * wanted.abs().max(1.0),
            "{wanted}: {row:?}"
        );
        // At the hub instead of at the wheel: less by what slips.
        let work = |sign: f64| {
            let powers = own.iter().map(|line| (sign * number(line, "torque")).max(0.0) * number(line, "speed"));
            powers.sum::<f64>() * 0.01 / 1000.0
        };
        for (column, sign) in [("tractive_work", 1.0), ("braking_work", -1.0)] {
            // With a wheel radius between 0.25 and 0.4 m.
            let radius_m = work(sign) / number(&row, column);
            assert!((0.25..0.4).contains(&radius_m), "{column}: {radius_m} m");
        }
        let per_km = number(&row, "tractive_work") / 3.6 / (number(own.last().unwrap(), "distance") / 1000.0);
        assert!((number(&row, "energy_per_km") - per_km).abs() < 0.01 * per_km, "{per_km}: {row:?}");
    }
}

/// Each car follows the one before it from its own departure to that one's arrival.
#[test]
fn string_gains_are_those_of_the_trace() {
    for version in [NEW, OLD] {
        let result = drive(version, &["--controller", "classic", "--set", "output.platoons=true"]);
        let (trace, rows) = (result.table("trace.csv"), result.table("quality.csv"));
        let of = |id: &str| rows.iter().find(|row| row["id"] == id).unwrap();
        assert_eq!((&*of("f.0")["following_time"], &*of("f.0")["string_gain_l2"]), ("", ""), "it follows nobody");
        for k in 1..6 {
            let (own, ahead) =
                (speeds(&trace, &format!("f.{k}"), "speed"), speeds(&trace, &format!("f.{}", k - 1), "speed"));
            let pairs: Vec<[f64; 2]> = own
                .iter()
                .filter_map(|(time, v)| Some([*v, ahead.iter().find(|(t, _)| t == time)?.1]))
                // Who is ahead is read once a second.
                .skip(10)
                .collect();
            let n = pairs.len() as f64;
            let norm = |i: usize| {
                let mean = pairs.iter().map(|v| v[i]).sum::<f64>() / n;
                pairs.iter().map(|v| (v[i] - mean).powi(2)).sum::<f64>().sqrt()
            };
            let row = of(&format!("f.{k}"));
            let (gain, wanted) = (number(row, "string_gain_l2"), norm(0) / norm(1));
            assert!((gain - wanted).abs() < 0.05 * wanted, "SUMO {version}, f.{k}: {gain} instead of {wanted}");
            assert!((number(row, "following_time") - 0.1 * n).abs() < 2.5, "{row:?}, {n} steps");
        }
        let without = drive(version, &["--controller", "classic"]);
        assert!(without.table("quality.csv").iter().all(|row| row["following_time"].is_empty()));
        assert_eq!(without.bytes("vehicles.csv"), result.bytes("vehicles.csv"), "asking changes nothing");
    }
}
