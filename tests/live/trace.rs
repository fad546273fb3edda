//! Trajectories at the times that the user asks for.

use crate::support::{CAR, NEW, OLD, Row, number, refusal, run, straight_road};

const EGO: &str = r#"<vehicle id="ego" type="car" depart="0"><route edges="ab bc"/></vehicle>
    <vehicle id="late" type="car" depart="1.5"><route edges="ab bc"/></vehicle>"#;

fn of<'a>(rows: &'a [Row], id: &str) -> Vec<&'a Row> {
    rows.iter().filter(|row| row["id"] == id).collect()
}

/// A trace finer than SUMO's step has a row per control period, and at the ends of steps the rows of the coarse one.
#[test]
fn a_trace_may_be_finer_than_sumos_step() {
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), &format!("{CAR}{EGO}"));
    for version in [NEW, OLD] {
        for target in ["traffic", "limit"] {
            let what = format!("SUMO {version}, {target}");
            let trace = |period: &str| {
                let args = ["--end", "10", "--target", target, "--set", "noise.power_db=-20", "--trace", "all"];
                run(version, &config, &[&args[..], &["--trace-period", period]].concat()).table("trace.csv")
            };
            let (fine, coarse) = (trace("0.01"), trace("0.1"));
            let (all, fifth) = (of(&fine, "ego"), trace("0.05"));
            let wanted: Vec<&Row> = all.iter().skip(4).step_by(5).copied().collect();
            assert_eq!(of(&fifth, "ego"), wanted, "{what}: every fifth control period");
            assert!(fine.is_sorted_by_key(|row| number(row, "time")), "{what}");
            for id in ["ego", "late"] {
                let (fine, coarse) = (of(&fine, id), of(&coarse, id));
                assert_eq!(fine.len(), 10 * coarse.len(), "{what}, {id}");
                let at_ends: Vec<&Row> = fine.iter().skip(9).step_by(10).copied().collect();
                assert_eq!(at_ends, coarse, "{what}, {id}");
                let steps = fine.windows(2).map(|w| number(w[1], "time") - number(w[0], "time"));
                assert!(steps.map(|s| (s - 0.01).abs()).all(|off| off < 1e-9), "{what}, {id}");
                // The noise is drawn in every control period, not once a step.
                let measured = fine.windows(2).filter(|w| w[0]["measured_speed"] != w[1]["measured_speed"]);
                assert!(measured.count() > fine.len() / 2, "{what}, {id}");
            }
        }
    }
}

#[test]
fn a_trace_period_that_fits_no_step_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), &format!("{CAR}{EGO}"));
    for period in ["0.03", "0.15", "0.001"] {
        let said = refusal(NEW, &config, &["--trace", "ego", "--trace-period", period]);
        let wanted = "wanted a multiple of SUMO's step (0.1 s), or a part of it of whole control periods (0.01 s)";
        assert!(said.contains(&format!("output.trace_period_s: found {period}")) && said.contains(wanted), "{said}");
    }
}
