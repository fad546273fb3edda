//! Studies against real SUMO: one engine, two faces; nothing in the tables depends on who ran what, when and in what order.

mod interrupted;
mod joined;
#[path = "../live/support.rs"]
#[allow(dead_code)]
mod support;
mod warm_up;
mod wrong;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use support::{Ended, NEW, Running, json, number, plain_sumo, program, repository, table};

/// `sumo-mfc SUBCOMMAND ARGS -o DIR`.
fn command(subcommand: &str, dir: &Path, args: &[&str]) -> Command {
    let mut command = program(NEW);
    command.current_dir(repository("")).arg(subcommand).args(args).arg("-o").arg(dir);
    command
}

/// The same, to its end.
fn ended(subcommand: &str, dir: &Path, args: &[&str]) -> Ended {
    Running::start(command(subcommand, dir, args)).wait()
}

/// A study that must succeed.
fn study(subcommand: &str, dir: &Path, args: &[&str]) -> Ended {
    let ended = ended(subcommand, dir, args);
    assert_eq!(ended.code, Some(0), "{args:?}:\n{}", ended.stderr);
    ended
}

/// The bytes of the tables.
fn tables(dir: &Path) -> [Vec<u8>; 4] {
    ["cases.csv", "comparison.csv", "vehicles.parquet", "study.json"].map(|name| fs::read(dir.join(name)).unwrap())
}

/// Traffic that differs from seed to seed.
const MOTORWAY: [&str; 4] = ["scenarios/motorway.toml", "--set", "traffic.sigma=0.5", "-q"];

#[test]
fn a_controller_differs_from_itself_by_nothing_at_all() {
    let folder = tempfile::tempdir().unwrap();
    study(
        "compare",
        folder.path(),
        &[&MOTORWAY[..], &["--end", "150", "--controllers", "pid,pid", "--seeds", "1..3"]].concat(),
    );
    let rows = table(&folder.path().join("comparison.csv"));
    let (own, again) = rows.split_at(rows.len() / 2);
    assert!(own.iter().all(|row| row["diff"].is_empty()));
    let loss = again.iter().find(|row| row["metric"] == "timeloss_mean").unwrap();
    assert!(number(loss, "completed") > 30.0 && number(loss, "ci95") > 0.0, "seeds differ, vehicles arrive: {loss:?}");
    let measured = again.iter().filter(|row| row["seeds"] != "0");
    assert!(measured.clone().count() > 20, "all but conflicts and string stability, which nobody asked for");
    for row in measured {
        assert_eq!((number(row, "diff"), number(row, "diff_ci95"), &*row["p_holm"]), (0.0, 0.0, ""), "{row:?}");
        let zero = |column: &str| row[column].is_empty() || number(row, column) == 0.0;
        assert!(zero("completed_diff") && zero("share_better"), "{row:?}");
    }
}

#[test]
fn compare_sweep_and_a_file_give_the_same_tables() {
    let folder = tempfile::tempdir().unwrap();
    let dir = |name: &str| folder.path().join(name);
    let short = ["--end", "60", "-q"];
    let scenario = "scenarios/motorway.toml";
    study(
        "compare",
        &dir("compare"),
        &[&[scenario, "--controllers", "ideal,pid", "--seeds", "1,2"], &short[..]].concat(),
    );
    let sweep = ["--vary", "controller.name=ideal,pid", "--reference", "controller.name=ideal", "--seeds", "1..2"];
    study("sweep", &dir("sweep"), &[&[scenario, "-j", "1"], &sweep[..], &short].concat());
    let file = dir("study.toml");
    let text = format!(
        "scenario = {:?}\nseeds = \"1..2\"\nreference = {{ \"controller.name\" = \"ideal\" }}\n\
         [[vary]]\ncontroller.name = [\"ideal\", \"pid\"]\n",
        repository(scenario)
    );
    fs::write(&file, text).unwrap();
    study("sweep", &dir("file"), &[&[file.to_str().unwrap()], &short[..]].concat());
    let wanted = tables(&dir("compare"));
    assert!(wanted[0].len() > 300);
    assert_eq!(tables(&dir("sweep"))[..3], wanted[..3]);
    assert_eq!(tables(&dir("file"))[..3], wanted[..3]);
}

#[test]
fn a_bootstrap_interval_is_given_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let args = [&MOTORWAY[..], &["--end", "60", "--controllers", "ideal,pid", "--seeds", "1..5"]].concat();
    study("compare", folder.path(), &args);
    let ends = |row: &support::Row| ["diff_boot_low", "diff_boot_high"].map(|column| row[column].parse::<f64>().ok());
    assert!(table(&folder.path().join("comparison.csv")).iter().all(|row| ends(row) == [None; 2]));
    study("compare", folder.path(), &[&args[..], &["--collect", "--bootstrap", "500"]].concat());
    let rows = table(&folder.path().join("comparison.csv"));
    let row = rows.iter().find(|row| row["metric"] == "error_rms_mean" && !row["diff"].is_empty()).unwrap();
    let ([Some(low), Some(high)], diff) = (ends(row), number(row, "diff")) else { panic!("{row:?}") };
    assert!(low < diff && diff < high && high - low < 6.0 * number(row, "diff_ci95"), "{row:?}");
    assert!(rows.iter().all(|row| ends(row)[0].is_none() || number(row, "diff_sd") > 0.0));
}

#[test]
fn axes_multiply_and_the_keys_of_one_vary_together() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("grid.toml");
    let text = format!(
        "scenario = {:?}\nseeds = \"7,9\"\nreference = {{ \"egos.select\" = \"all\" }}\n\
         [[vary]]\n\"egos.select\" = [\"share:0.5\", \"all\"]\n\
         [[vary]]\n\"controller.k_p\" = [1, 2.5, 3]\n\"actuator.delay_s\" = \"0..0.2..0.1\"\n",
        repository("scenarios/straight.toml")
    );
    fs::write(&file, text).unwrap();
    let listed =
        study("sweep", folder.path(), &[file.to_str().unwrap(), "--plan", "--vary", "noise.power_db=-6"]).stdout;
    let lines: Vec<&str> = listed.lines().collect();
    assert_eq!(lines.len(), 2 * 2 * 3 + 1, "{listed}");
    let last = "0012\tegos.select=all actuator.delay_s=0.2 controller.k_p=3 noise.power_db=-6\tseed 9\tmissing";
    assert_eq!(lines[11], last);
    assert!(lines[12].starts_with("12 cases in ") && lines[12].ends_with("0 done, 0 failed, 12 missing"), "{listed}");
    assert!(!folder.path().join("cases").exists(), "a plan runs nothing");
}

#[test]
fn plain_is_sumo_alone_in_its_own_steps() {
    let folder = tempfile::tempdir().unwrap();
    let (cars, dir) = (folder.path().join("alone"), folder.path().join("study"));
    fs::create_dir(&cars).unwrap();
    let demand =
        r#"<vType id="car" sigma="0.5"/><flow id="f" type="car" begin="0" end="100" number="20" from="ab" to="bc"/>"#;
    let config = support::straight_road(&cars, demand);
    let config = config.to_str().unwrap();
    study("sweep", &dir, &[config, "-q", "--vary", "controller.name=plain,adaptive", "--seeds", "3,4"]);
    let rows = table(&dir.join("cases.csv"));
    assert_eq!((&*rows[0]["controller.name"], &*rows[0]["egos"], &*rows[1]["egos"]), ("plain", "0", "20"));
    assert_eq!((&*rows[0]["error_rms_mean"], &*rows[0]["arrived"]), ("", "20"));
    for (case, seed) in [("0001", "3"), ("0003", "4")] {
        let alone = cars.join(format!("{seed}.xml"));
        plain_sumo(NEW, &["-c", config, "--seed", seed, "--tripinfo-output", alone.to_str().unwrap()]);
        let with_us = support::elements(&dir.join("cases").join(case).join("sumo/tripinfo.xml"), "tripinfo");
        assert_eq!(with_us, support::elements(&alone, "tripinfo"));
        let losses = with_us.iter().map(|trip| support::attribute(trip, "timeLoss").parse::<f64>().unwrap());
        let row = rows.iter().find(|row| row["seed"] == seed && row["controller.name"] == "plain").unwrap();
        assert!((losses.sum::<f64>() / 20.0 - number(row, "timeloss_mean")).abs() < 1e-9);
    }
}

/// Two cases, of which the first cannot be run.
fn half_failing(dir: &Path) -> Ended {
    let options = r#"sumo.options=["--no-such-option"],["--no-warnings"]"#;
    ended("sweep", dir, &["scenarios/straight.toml", "--end", "5", "--vary", options, "--seeds", "1"])
}

#[test]
fn a_case_that_fails_keeps_its_row_and_the_others_are_run() {
    let folder = tempfile::tempdir().unwrap();
    let first = half_failing(folder.path());
    assert_eq!(first.code, Some(1));
    assert!(first.stderr.contains("1 case failed;"), "{}", first.stderr);
    let rows = table(&folder.path().join("cases.csv"));
    assert_eq!((&*rows[0]["status"], &*rows[1]["status"]), ("failed", "done"));
    assert!(rows[0]["reason"].contains("no-such-option"), "{:?}", rows[0]);
    // Only what failed is tried again.
    let again = half_failing(folder.path()).stderr;
    assert!(again.contains("[1/1] case 0001,") && !again.contains("case 0002,"), "{again}");
}

fn result(dir: &Path) -> [Vec<u8>; 3] {
    ["vehicles.csv", "sample.csv", "sumo/tripinfo.xml"].map(|name| fs::read(dir.join(name)).unwrap())
}

#[test]
fn a_case_is_repeated_bit_for_bit_while_its_inputs_are_what_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let dir = |name: &str| folder.path().join(name);
    fs::create_dir(dir("road")).unwrap();
    let demand =
        format!(r#"{}<flow id="f" type="car" begin="0" end="50" number="9" from="ab" to="bc"/>"#, support::CAR);
    let config = support::straight_road(&dir("road"), &demand);
    let args = [config.to_str().unwrap(), "-q", "--end", "60", "--vary", "noise.power_db=-6,-3", "--seeds", "5"];
    study("sweep", &dir("study"), &args);
    let case = dir("study").join("cases/0002");
    let manifest: PathBuf = case.join("run.json");
    let from = ["--from", manifest.to_str().unwrap()];
    study("run", &dir("again"), &from);
    let trips = |dir: &Path| support::elements(&dir.join("sumo/tripinfo.xml"), "tripinfo");
    assert_eq!(result(&dir("again"))[..2], result(&case)[..2]);
    assert_eq!(trips(&dir("again")), trips(&case));
    let (again, first) = (json(&dir("again").join("run.json")), json(&manifest));
    assert_eq!((&again["inputs"], &again["scenario"]), (&first["inputs"], &first["scenario"]));

    let routes = dir("road").join("made.rou.xml");
    fs::write(&routes, fs::read_to_string(&routes).unwrap().replace("number=\"9\"", "number=\"8\"")).unwrap();
    let changed = ended("run", &dir("third"), &from);
    assert_eq!(changed.code, Some(1));
    assert!(changed.stderr.contains("made.rou.xml has changed since"), "{}", changed.stderr);
    // The study has changed with it: all cases are run again.
    study("sweep", &dir("study"), &args);
    assert!(table(&dir("study").join("cases.csv")).iter().all(|row| row["inserted"] == "8"));
}
