//! `tune`: as many gains, the same drives and the same number of trials for every law; judged on other drives.

use std::{fs, path::Path, process::Command};

use assert_cmd::cargo::CommandCargoExt;
use tempfile::TempDir;

type Row = std::collections::BTreeMap<String, String>;

/// Two short recordings: to tune on, and to judge on.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, speed: fn(f64) -> f64| {
        let rows: String = (0..=600).map(|k| 0.1 * f64::from(k)).map(|t| format!("{t:.1},{:.4}\n", speed(t))).collect();
        fs::write(folder.path().join(name), format!("t_s,v_mps\n{rows}")).unwrap();
    };
    write("a.csv", |t| 10.0 + 6.0 * (0.2 * t).sin());
    write("b.csv", |t| 14.0 - 4.0 * (0.3 * t).cos());
    folder
}

fn command(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::cargo_bin("sumo-mfc").unwrap();
    command.current_dir(folder).args(["tune", "--train", "a.csv", "--test", "b.csv"]).args(args);
    command
}

fn rows(folder: &Path, args: &[&str]) -> Vec<Row> {
    let output = command(folder, args).args(["--seeds", "3", "-q", "-o", "out"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stdout.is_empty() && output.stderr.is_empty(), "-q is quiet");
    csv::Reader::from_path(folder.join("out/tune.csv")).unwrap().deserialize().map(Result::unwrap).collect()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column}: {row:?}"))
}

#[test]
fn every_law_gets_the_same_and_becomes_better() {
    let folder = folder();
    let all = ["--set", "noise.power_db=-12", "--condition", "ok:", "--condition", "late: actuator.delay_s=0.2"];
    let tuned = rows(folder.path(), &[&all[..], &["--trials", "30"]].concat());
    let untuned = rows(folder.path(), &[&all[..], &["--trials", "3"]].concat());
    let names: Vec<[&str; 2]> = tuned.iter().map(|row| ["condition", "controller"].map(|c| row[c].as_str())).collect();
    let laws = ["classic", "adaptive", "calibrating", "pid"];
    assert_eq!(names, ["ok", "late"].iter().flat_map(|c| laws.map(|law| [c, law])).collect::<Vec<_>>());
    let mut better = 0;
    for (row, before) in tuned.iter().zip(&untuned) {
        assert_eq!(row["gains"].split(' ').count(), 2, "{row:?}");
        assert!((20.0..=30.0).contains(&number(row, "trials")), "{row:?}");
        assert!(number(row, "train_rms") <= number(before, "train_rms"), "{row:?}, {before:?}");
        better += usize::from(number(row, "train_rms") < 0.95 * number(before, "train_rms"));
        assert!(number(row, "test_ci95") > 0.0, "each vehicle has noise of its own");
        assert_eq!(row["test_ratio"].is_empty(), row["controller"] == "classic");
        assert_eq!(row["unfinished"], "0");
    }
    assert!(better >= 4, "{better} of 8 became better by 5 %");
    // In the first condition both gains are the same ones.
    for row in &tuned[..4] {
        assert_eq!((&row["once_rms"], &row["once_ratio"]), (&row["test_rms"], &row["test_ratio"]));
    }
    assert_ne!(tuned[4]["once_rms"], tuned[4]["test_rms"]);
}

#[test]
fn what_judges_has_other_noise_than_what_was_tuned_on() {
    let folder = folder();
    let same = |noise: &str| {
        let set = format!("noise.power_db={noise}");
        let mut command = Command::cargo_bin("sumo-mfc").unwrap();
        command.current_dir(folder.path()).args(["tune", "--train", "a.csv", "--test", "a.csv", "--set", &set]);
        let output =
            command.args(["--controllers", "pid", "--seeds", "3", "--trials", "3", "--export", "json"]).output();
        let rows: serde_json::Value = serde_json::from_slice(&output.unwrap().stdout).unwrap();
        ["train_rms", "test_rms"].map(|column| rows[0][column].as_f64().unwrap())
    };
    let [train, test] = same("-12");
    assert!(train != test && (test / train - 1.0).abs() < 0.3, "{train}, {test}");
    let [train, test] = same("-200");
    assert!((test / train - 1.0).abs() < 1e-6, "without noise there is no difference: {train}, {test}");
}

#[test]
fn law_a_law_beside_itself_has_a_ratio_of_one() {
    let folder = folder();
    let rows = rows(folder.path(), &["--controllers", "pid,pid", "--set", "noise.power_db=-12", "--trials", "9"]);
    assert_eq!([&*rows[1]["test_ratio"], &*rows[1]["test_ratio_ci95"], &*rows[1]["once_ratio"]], ["1", "0", "1"]);
}

#[test]
fn law_a_wrong_torque_scale_is_the_key_of_those_that_have_one_and_slopes_are_felt() {
    let folder = folder();
    let conditions = [
        "ok:",
        "key: controller.accel_per_unit_mps2=4",
        "told: law.torque_scale=4",
        "level: road.grade=0",
        "up: road.grade=0.05",
        "down: road.grade=-0.05",
        "hills: road.grade=0.05 road.hill_m=200",
    ];
    let args: Vec<&str> = conditions.iter().flat_map(|condition| ["--condition", condition]).collect();
    let rows = rows(folder.path(), &[&args[..], &["--controllers", "classic", "--trials", "3"]].concat());
    let errors: Vec<f64> = rows.iter().map(|row| number(row, "once_rms")).collect();
    let [ok, key, told, level, up, down, hills] = errors[..] else { panic!("{errors:?}") };
    assert_eq!([key, ok], [told, level]);
    assert!(told > 1.5 * ok && hills > 1.5 * ok && up > 1.05 * ok && down > 1.05 * ok, "{errors:?}");
    assert_ne!(up, down);
}

#[test]
fn law_the_number_of_threads_changes_nothing() {
    let folder = folder();
    let of = |threads: &str| {
        let mut command = command(folder.path(), &["--trials", "9", "--set", "noise.power_db=-6", "-q", "-o", threads]);
        assert!(command.env("RAYON_NUM_THREADS", threads).status().unwrap().success());
        fs::read(folder.path().join(threads).join("tune.csv")).unwrap()
    };
    assert_eq!(of("1"), of("3"));
}

#[test]
fn gains_that_are_found_are_arguments_that_are_taken() {
    let folder = folder();
    let found = rows(folder.path(), &["--controllers", "calibrating", "--trials", "9"]);
    let sets: Vec<&str> = found[0]["gains"].split(' ').flat_map(|gain| ["--set", gain]).collect();
    let mut check = Command::cargo_bin("sumo-mfc").unwrap();
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/straight.toml");
    let output = check.arg("check").arg(scenario).args(["--controller", "calibrating"]).args(sets).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn what_cannot_be_tuned_is_told() {
    let folder = folder();
    for (args, wanted) in [
        (&["--gains", "3"][..], "the controller classic has 2 to tune: k_p, window_s"),
        (&["--gains", "0"], "--gains: found 0"),
        (&["--controllers", "pidd"], "did you mean \"pid\"?"),
        (&["--controllers", "ideal"], "the controller ideal has 0 to tune"),
        (&["--condition", "late"], "wanted \"NAME: KEY=VALUE KEY=VALUE\""),
        (&["--condition", "late: actuator.delay_s"], "wanted \"NAME: KEY=VALUE KEY=VALUE\""),
        (&["--condition", "late: actuator.delays=1"], "delay_s"),
        (&["--condition", "up: road.grade=steep"], "found \"road.grade=steep\", wanted a number from -0.3 to 0.3"),
        (&["--condition", "up: law.torque_scale=0"], "wanted a number from 0.01 to 100"),
        (&["--trials", "0"], "wanted a whole number above 0"),
        (&["--test", "c.csv"], "c.csv"),
    ] {
        let output = command(folder.path(), args).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(1), "{args:?}: {said}");
        assert!(said.contains(wanted), "{args:?}: {said}");
        assert!(!folder.path().join("out").exists(), "{args:?}");
    }
}
