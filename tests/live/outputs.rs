//! SUMO's own outputs and its log: as the user asked for them.

use crate::support::{
    CAR, NEW, OLD, Outcome, attribute, configuration, elements, number, own, plain_sumo, run, straight_road,
};
use std::{collections::BTreeMap, fs, path::Path};

/// The times at which a file has samples.
fn times(path: &std::path::Path, element: &str) -> Vec<f64> {
    let time = |e: &String| attribute(e, if element == "data" { "timestep" } else { "time" }).parse().unwrap();
    elements(path, element).iter().map(time).collect()
}

/// Ten steps in place of one make no output ten times as long, where SUMO can keep the sampling.
#[test]
fn outputs_keep_the_configurations_sampling() {
    const OUTPUTS: [(&str, &str); 4] = [
        ("fcd-output", "timestep"),
        ("emission-output", "timestep"),
        ("summary-output", "step"),
        ("queue-output", "data"),
    ];
    let folder = tempfile::tempdir().unwrap();
    let ego = r#"<vehicle id="ego" type="car" depart="0"><route edges="ab bc"/></vehicle>"#;
    let config = straight_road(folder.path(), "");
    let named: String = OUTPUTS.iter().map(|(option, _)| format!(r#"<{option} value="{option}.xml"/>"#)).collect();
    let more = format!(r#"<output>{named}<netstate-dump value="dump.xml"/></output><time><end value="20"/></time>"#);
    configuration(folder.path(), &folder.path().join("made.net.xml"), &format!("{CAR}{ego}"), &more);
    for version in [NEW, OLD] {
        plain_sumo(version, &["-c", config.to_str().unwrap()]);
        let result = run(version, &config, &[]);
        for (option, element) in OUTPUTS {
            let theirs = times(&folder.path().join(format!("{option}.xml")), element);
            assert!(theirs.len() >= 20, "SUMO {version}: {option} of plain SUMO has {theirs:?}");
            let ours = times(&result.dir.join(format!("sumo/{option}.xml")), element);
            assert_eq!(ours, theirs, "SUMO {version}: {option}");
        }
        let said = &result.ended.stderr;
        assert!(said.contains("fcd-output, emission-output, summary-output, queue-output sampled as before"), "{said}");
        assert!(said.contains("netstate-dump larger, with a sample in each of the shorter steps"), "{said}");
        // A period that the user gives stands.
        let given = run(version, &config, &["--", "--device.fcd.period", "5"]);
        assert_eq!(times(&given.dir.join("sumo/fcd-output.xml"), "timestep"), [0.0, 5.0, 10.0, 15.0], "SUMO {version}");
        assert!(!given.ended.stderr.contains("fcd-output"), "{}", given.ended.stderr);
    }
}

/// Our questions leave no error in SUMO's log, also where vehicles arrive, are teleported and taken out.
#[test]
fn our_questions_are_no_errors_in_sumos_log() {
    for version in [NEW, OLD] {
        let options = ["--end", "200", "--", "--time-to-teleport", "20", "--time-to-teleport.remove", "true"];
        let result = run(version, &own("city"), &options);
        assert!(result.sumo("arrived") > 20.0, "SUMO {version}");
        let log = fs::read_to_string(result.dir.join("sumo/sumo.log")).unwrap();
        let errors: Vec<_> = log.lines().filter(|line| line.contains("rror")).collect();
        assert_eq!(errors, [""; 0], "SUMO {version}");
    }
}

/// What SUMO says of vehicles that it left out reaches the user.
#[test]
fn vehicles_that_sumo_leaves_out_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let demand = format!(
        r#"{CAR}<vehicle id="ego" type="car" depart="0"><route edges="ab bc"/></vehicle>
        <trip id="back" type="car" depart="1" from="bc" to="ab"/><trip id="again" type="car" depart="2" from="bc" to="ab"/>"#
    );
    let config = straight_road(folder.path(), &demand);
    for version in [NEW, OLD] {
        let result = run(version, &config, &["--end", "30", "--", "--ignore-route-errors"]);
        let line =
            "SUMO's log has 2 warnings about vehicles that it left out; the first: No route for vehicle 'back' found.";
        assert!(result.ended.stderr.contains(line), "SUMO {version}: {}", result.ended.stderr);
        assert!(result.json("run.json")["notes"].to_string().contains("No route for vehicle 'back'"), "SUMO {version}");
        let whole = run(version, &own("straight"), &["--end", "10"]);
        assert!(!whole.ended.stderr.contains("left out"), "SUMO {version}: {}", whole.ended.stderr);
    }
}

/// `-q` leaves nothing but errors.
#[test]
fn quiet_is_quiet() {
    let result = run(NEW, &own("straight"), &["--end", "10", "-q"]);
    assert_eq!((result.ended.stdout.as_str(), result.ended.stderr.as_str()), ("", ""));
    let told = run(NEW, &own("straight"), &["--end", "10"]);
    assert!(
        told.ended.stdout.starts_with("vehicles ") && told.ended.stderr.contains("note: "),
        "{}",
        told.ended.stderr
    );
}

/// A car that stops on its way, so that signals change.
const STOPPING: &str = r#"<vehicle id="ego" type="car" depart="0"><route edges="ab bc"/><stop lane="ab_0" endPos="150" duration="3"/></vehicle>"#;

/// `--fcd`: SUMO's own rows hold what our trace has at the same time.
#[test]
fn fcd_holds_our_signals() {
    let folder = tempfile::tempdir().unwrap();
    let config = straight_road(folder.path(), &format!("{CAR}{STOPPING}"));
    for version in [NEW, OLD] {
        let late = ["--set", "actuator.delay_s=0.3", "--trace", "ego", "--fcd"];
        let result = run(version, &config, &late);
        let trace = result.table("trace.csv");
        let rows = timed(&result.dir.join("sumo/fcd.xml"));
        let (mut compared, mut largest) = (0, 0.0_f64);
        for row in &trace {
            let Some(fcd) = rows.get(&row["time"]).filter(|line| line.contains("mfc.err")) else { continue };
            let shown = |name: &str| attribute(fcd, name).parse::<f64>().unwrap();
            let error = number(row, "speed") - number(row, "reference");
            for (name, wanted) in
                [("mfc.err", error), ("mfc.torque", number(row, "torque")), ("mfc.alpha", number(row, "alpha_hat"))]
            {
                assert!((shown(name) - wanted).abs() < 1e-4, "SUMO {version}: {name} at {}: {fcd}", row["time"]);
            }
            compared += 1;
            largest = largest.max(error.abs());
        }
        assert!(compared > trace.len() - 3, "SUMO {version}: {compared} of {} rows", trace.len());
        assert!(largest > 0.1, "SUMO {version}: {largest}: the errors are worth comparing");
    }
}

/// The configuration's FCD output stays where it is, and other parameters that it asks for stay in it.
#[test]
fn fcd_of_the_configuration_gets_our_signals_beside_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let ego = STOPPING.replace("><route", r#"><param key="fleet" value="north"/><route"#);
    let config = straight_road(folder.path(), "");
    let more = r#"<output><fcd-output value="mine.xml"/><fcd-output.params value="fleet"/></output>"#;
    configuration(folder.path(), &folder.path().join("made.net.xml"), &format!("{CAR}{ego}"), more);
    let check = |result: &Outcome, file: &str| {
        let fcd = fs::read_to_string(result.dir.join("sumo").join(file)).unwrap();
        for wanted in ["fleet=\"north\"", "mfc.err=\"", "mfc.torque=\"", "mfc.alpha=\""] {
            assert!(fcd.contains(wanted), "{wanted} in {file}");
        }
    };
    check(&run(NEW, &config, &["--fcd"]), "mine.xml");
    check(&run(NEW, &config, &["--fcd", "--", "--fcd-output.params", "fleet,other"]), "mine.xml");
    // Without the option nothing is added.
    let plain = run(NEW, &config, &[]);
    let fcd = fs::read_to_string(plain.dir.join("sumo/mine.xml")).unwrap();
    assert!(fcd.contains("fleet=") && !fcd.contains("mfc."), "{fcd}");
}

/// The vehicle lines of an FCD output with a single vehicle, by their time.
fn timed(path: &Path) -> BTreeMap<String, String> {
    let text = fs::read_to_string(path).unwrap();
    let (mut rows, mut time) = (BTreeMap::new(), 0.0);
    for line in text.lines() {
        if line.contains("<timestep") {
            time = attribute(line, "time").parse::<f64>().unwrap();
        } else if line.contains("<vehicle") {
            rows.insert(time.to_string(), line.to_owned());
        }
    }
    rows
}
