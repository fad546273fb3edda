//! The same bytes from the same seed, on any number of threads, and from the resolved scenario.

use crate::clients::{free_port, somebodys_sumo};
use crate::support::{NEW, Outcome, Running, own, program, repository, run};
use std::fs;

const ARGS: [&str; 8] = ["--end", "150", "--step-length", "0.5", "--set", "noise.power_db=-20", "--trace", "all"];

fn with(more: &[&str]) -> Outcome {
    run(NEW, &own("city"), &[&ARGS[..], more].concat())
}

#[test]
fn law_one_seed_gives_one_result_on_any_number_of_threads() {
    let first = with(&["-j", "1"]);
    let vehicles = first.bytes("vehicles.csv");
    for threads in [["-j", "1"], ["-j", "2"]] {
        let again = with(&threads);
        for file in ["vehicles.csv", "edges.csv", "sample.csv", "trace.csv"] {
            assert!(again.bytes(file) == first.bytes(file), "{file} differs with {threads:?}");
        }
    }
    assert!(with(&["--seed", "7"]).bytes("vehicles.csv") != vehicles, "another seed, the same bytes");
}

#[test]
fn law_the_resolved_scenario_gives_the_same_result() {
    let folder = tempfile::tempdir().unwrap();
    for scenario in [own("light"), repository("scenarios/straight.toml")] {
        let args = ["--set", "noise.power_db=-20", "--set", "controller.k_p=1.5", "--egos", "share:1"];
        let mut check = program(NEW);
        check.arg("check").arg(&scenario).args(args);
        let checked = Running::start(check).wait();
        assert_eq!(checked.code, Some(0), "{}", checked.stderr);
        let resolved = folder.path().join("resolved.toml");
        fs::write(&resolved, checked.stdout).unwrap();
        let [direct, resolved] = [run(NEW, &scenario, &args), run(NEW, &resolved, &[])];
        for file in ["vehicles.csv", "edges.csv", "sample.csv"] {
            assert!(direct.bytes(file) == resolved.bytes(file), "{file} of {}", scenario.display());
        }
    }
}

/// A SUMO of our own is asked in several messages, told speeds while other bodies still drive, and not told what it
/// knows; a shared one is told everything in one message, and read by subscriptions. It is the same drive.
#[test]
fn law_how_sumo_is_asked_and_told_changes_nothing() {
    for target in ["traffic", "path_cacc"] {
        shared_is_the_same(target);
    }
}

fn shared_is_the_same(target: &str) {
    let args = ["--target", target, "--end", "240", "--step-length", "0.5", "--trace", "all", "--trace-period", "5"];
    let first = run(NEW, &own("city"), &args);
    let port = free_port();
    let folder = tempfile::tempdir().unwrap();
    let sumo = somebodys_sumo(NEW, &own("city"), &folder.path().join("trips.xml"), port, "1");
    let shared = run(NEW, &own("city"), &[&args[..], &["--connect", &format!("127.0.0.1:{port}")]].concat());
    assert_eq!(sumo.wait().code, Some(0));
    assert!(first.bytes("trace.csv") == shared.bytes("trace.csv"), "trace.csv");
    assert!(first.vehicles().len() > 256, "more than one convoy");
    for (own, theirs) in first.vehicles().iter().zip(shared.vehicles()) {
        for column in ["id", "samples", "error_rms", "speed_gap_rms", "torque_rms", "odometer_gap", "share_traffic"] {
            assert_eq!(own[column], theirs[column], "{column} of {}", own["id"]);
        }
    }
}
