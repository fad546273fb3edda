//! Crates of their own use this one as a library, each with its own Cargo.toml and lock file: they build, and run real SUMO.

#[allow(dead_code, reason = "the other tests against SUMO use the rest")]
#[path = "live/support.rs"]
mod support;

use std::process::Command;

use support::{Ended, NEW, Running, own, repository, sumo_home, table};

/// Builds and runs a crate of `examples/external/`; all of them share what they build.
fn cargo_run(name: &str, arguments: &[&str]) -> Ended {
    let mut command = Command::new(env!("CARGO"));
    command.arg("run").arg("-q").arg("--locked").arg("--manifest-path");
    command.arg(repository("examples/external").join(name).join("Cargo.toml"));
    command.arg("--target-dir").arg(repository("target/external")).arg("--").args(arguments);
    command.env("SUMO_HOME", sumo_home(NEW)).env_remove("SUMO_BINARY").current_dir(repository(""));
    let ended = Running::start_for(command, std::time::Duration::from_secs(1200)).wait();
    assert_eq!(ended.code, Some(0), "{name} {arguments:?}:\n{}\n{}", ended.stdout, ended.stderr);
    ended
}

/// A law of thirty lines in another crate serves as those of this one do.
#[test]
fn a_law_of_another_crate_drives_in_sumo() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("result");
    let listed = cargo_run("own_law", &["list"]).stdout;
    assert!(listed.contains("controller\tproportional\t"), "{listed}");
    let arguments = ["run", "scenarios/straight.toml", "--controller", "proportional", "--target", "traffic"];
    cargo_run("own_law", &[&arguments[..], &["--trace", "all", "-o", dir.to_str().unwrap()]].concat());
    let rows = table(&dir.join("vehicles.csv"));
    assert_eq!(
        (rows.len(), rows[0]["controller"].as_str(), rows[0]["reason"].as_str()),
        (1, "proportional", "arrived")
    );
    assert!(support::number(&rows[0], "error_rms") < 0.1, "{rows:?}");
    assert!(table(&dir.join("trace.csv")).len() > 500);
    // A study runs its cases as processes of the same program, so the law serves there as well.
    let study = folder.path().join("study");
    let controllers = ["--controllers", "proportional,pid", "--seeds", "1", "--end", "5"];
    cargo_run(
        "own_law",
        &[&["compare", "scenarios/straight.toml", "-o", study.to_str().unwrap()], &controllers[..]].concat(),
    );
    let cases = table(&study.join("cases.csv"));
    assert_eq!(cases.iter().map(|row| row["controller.name"].as_str()).collect::<Vec<_>>(), ["proportional", "pid"]);
    assert!(cases.iter().all(|row| row["status"] == "done" && row["egos"] == "1"), "{cases:?}");
    let summary = support::json(&dir.join("summary.json"));
    assert!(summary["fleet"]["error_rms"]["p50"].as_f64().unwrap() < 0.1, "{summary}");
}

/// The TraCI client alone, without the crate's default features.
#[test]
fn the_traci_client_serves_alone() {
    let config = own("light");
    let printed = cargo_run("traci_only", &["-c", config.to_str().unwrap(), "--step-length", "0.1"]).stdout;
    let lines: Vec<&str> = printed.lines().collect();
    assert!(lines[0].contains(NEW), "{printed}");
    let speeds: Vec<f64> = lines[1..]
        .iter()
        .map(|line| line.trim_end_matches(" m/s").rsplit(' ').next().unwrap().parse().unwrap())
        .collect();
    assert!(speeds.len() > 50 && speeds.iter().any(|speed_mps| *speed_mps > 5.0), "{printed}");
    let tree = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "-e", "normal", "--prefix", "none", "--manifest-path"])
        .arg(repository("examples/external/traci_only/Cargo.toml"))
        .output()
        .unwrap();
    let tree = String::from_utf8(tree.stdout).unwrap();
    assert!(tree.contains("tokio v"), "{tree}");
    for heavy in ["parquet", "clap", "miette", "indicatif"] {
        assert!(!tree.lines().any(|line| line.starts_with(&format!("{heavy} v"))), "{heavy} is compiled for nothing");
    }
}
