//! Trajectories at the times that the user asks for.

use crate::support::{
    CAR, NEW, OLD, Row, Running, attribute, number, own, refusal, repository, run, straight_road, sumo_home,
};
use std::{collections::BTreeMap, process::Command};

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

/// Places are SUMO's own: those of its FCD output, whose rows stand under the time at which their step began.
#[test]
fn traced_and_sampled_vehicles_have_their_places() {
    for version in [NEW, OLD] {
        let result = run(version, &own("city"), &["--end", "40", "--trace", "all", "--fcd"]);
        let text = std::fs::read_to_string(result.dir.join("sumo/fcd.xml")).unwrap();
        let (mut rows, mut tenths) = (BTreeMap::new(), 0);
        for line in text.lines() {
            if line.contains("<timestep") {
                tenths = (attribute(line, "time").parse::<f64>().unwrap() * 10.0).round() as i64 + 1;
            } else if line.contains("<vehicle") {
                rows.insert((tenths, attribute(line, "id").to_owned()), line.to_owned());
            }
        }
        for file in ["trace.csv", "sample.csv"] {
            let table = result.table(file);
            assert!(table.len() > 300, "SUMO {version}: {} rows in {file}", table.len());
            for row in &table {
                let fcd = &rows[&((number(row, "time") * 10.0).round() as i64, row["id"].clone())];
                assert_eq!(row["lane"], attribute(fcd, "lane"), "SUMO {version}, {file}");
                for column in ["x", "y", "angle"] {
                    let theirs: f64 = attribute(fcd, column).parse().unwrap();
                    assert!((number(row, column) - theirs).abs() < 0.00501, "SUMO {version}, {file}: {row:?}, {fcd}");
                }
            }
        }
    }
}

/// Rows between the ends of SUMO's steps have no place: SUMO does not know any.
#[test]
fn within_a_step_there_is_no_place() {
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), &format!("{CAR}{EGO}"));
    let rows = run(NEW, &config, &["--end", "5", "--trace", "ego", "--trace-period", "0.05"]).table("trace.csv");
    let at_end = |row: &Row| ((number(row, "time") * 10.0).round() / 10.0 - number(row, "time")).abs() < 1e-9;
    assert!(rows.len() > 80 && rows.iter().any(|row| !at_end(row)));
    for row in &rows {
        assert_eq!(["x", "y", "angle", "lane"].map(|column| row[column].is_empty()), [!at_end(row); 4], "{row:?}");
    }
}

/// A trace in XML is what SUMO's own tool for trajectories draws.
#[test]
fn sumos_plot_trajectories_draws_a_trace() {
    let result = run(NEW, &own("city"), &["--end", "60", "--trace", "all", "--trace-output", "trace.xml"]);
    let site = |name: &str| {
        let lib = repository(&format!(".sumo/{name}/lib"));
        let python = std::fs::read_dir(&lib).unwrap_or_else(|e| panic!("{}: {e} (make setup-test)", lib.display()));
        python.map(|entry| entry.unwrap().path().join("site-packages")).next().unwrap()
    };
    for kind in ["xy", "td"] {
        let mut command = Command::new("python3");
        command.arg(sumo_home(NEW).join("tools/plot_trajectories.py")).args(["trace.xml", "-t", kind, "--blind"]);
        command.args(["-o", "plot.png", "--csv-output", "plot.csv"]).current_dir(&result.dir);
        command.env("PYTHONPATH", site("matplotlib")).env("MPLBACKEND", "Agg").env("SUMO_HOME", sumo_home(NEW));
        let ended = Running::start(command).wait();
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let drawn = std::fs::read_to_string(result.dir.join("plot.csv")).unwrap();
        // A block per vehicle, headed by its id.
        let ids = drawn.lines().filter(|line| line.starts_with('"')).count();
        assert_eq!(ids, result.vehicles().iter().filter(|row| number(row, "samples") > 0.0).count(), "{kind}");
        assert!(std::fs::metadata(result.dir.join("plot.png")).unwrap().len() > 10_000);
    }
}
