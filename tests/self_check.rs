//! `sumo-mfc doctor` and its self-check of the coupling, on the oldest and the newest supported SUMO: it passes, and each
//! way to get the coupling wrong makes it fail. A missing SUMO is a failure, not a skip.

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use predicates::prelude::*;
use sumo_mfc::cosim::Fault;
use sumo_mfc::doctor::{Report, examine};

const NEW: &str = "1.28.0";
const OLD: &str = "1.15.0";
const TOO_OLD: &str = "1.14.1";

/// The SUMO of this version below `.sumo/`; `make` installs it.
fn binary(version: &str) -> PathBuf {
    let lib = Path::new(env!("CARGO_MANIFEST_DIR")).join(".sumo").join(version).join("lib");
    let pythons =
        std::fs::read_dir(&lib).unwrap_or_else(|_| panic!("no SUMO {version} below .sumo/: type make setup-test"));
    let mut paths = pythons.flatten().map(|python| python.path().join("site-packages/sumo/bin/sumo"));
    paths.find(|path| path.is_file()).expect("a SUMO binary below .sumo/")
}

fn report(version: &str, fault: Fault) -> Report {
    let report = examine(Some(&binary(version)), fault);
    println!("{version} {fault:?}\n{report}");
    report
}

/// The names of the failed checks of one controller.
#[track_caller]
fn failed(report: &Report, controller: &str) -> Vec<String> {
    let own = format!("{controller}: ");
    let checks: Vec<_> = report.checks.iter().filter_map(|c| Some((c.name.strip_prefix(&own)?, c.passed))).collect();
    assert_eq!(checks.len(), 6, "{report}");
    checks.into_iter().filter(|(_, passed)| !passed).map(|(name, _)| name.to_owned()).collect()
}

/// The fault is noticed with either controller, by at least the check that is meant for it.
#[track_caller]
fn is_noticed(fault: Fault, by: &str) {
    for version in [NEW, OLD] {
        let report = report(version, fault);
        assert!(!report.is_well());
        for controller in ["classic", "adaptive"] {
            let failed = failed(&report, controller);
            assert!(failed.iter().any(|name| name == by), "{controller} on {version}: {by} passed\n{report}");
        }
    }
}

#[test]
fn the_coupling_passes() {
    for version in [NEW, OLD] {
        let report = report(version, Fault::None);
        assert!(report.is_well(), "{version}\n{report}");
        assert_eq!(report.checks.len(), 3 + 2 * 6);
    }
}

#[test]
fn a_reference_given_as_a_step_is_noticed() {
    is_noticed(Fault::StepReference, "no creep");
}

#[test]
fn speed_without_traci_as_the_target_is_noticed() {
    is_noticed(Fault::SpeedWithoutTraci, "no creep");
}

#[test]
fn a_speed_that_is_not_sent_back_is_noticed() {
    is_noticed(Fault::NotSentBack, "SUMO's choice follows from it");
}

fn doctor() -> Command {
    let mut command = Command::cargo_bin("sumo-mfc").unwrap();
    command.arg("doctor").env_remove("SUMO_HOME").env_remove("SUMO_BINARY");
    command
}

#[test]
fn doctor_shows_what_it_found() {
    let said = predicate::str::contains("1.28.0, TraCI API 22").and(predicate::str::contains("from SUMO_BINARY"));
    doctor().env("SUMO_BINARY", binary(NEW)).assert().success().stdout(said);
}

#[test]
fn doctor_says_what_to_type_without_sumo() {
    let nowhere = tempfile::tempdir().unwrap();
    let said = ["failed", "pip install eclipse-sumo==1.28.0", "apt-get install sumo", "make setup"];
    let said = said.into_iter().map(predicate::str::contains);
    let assert = doctor().env("PATH", nowhere.path()).current_dir(nowhere.path()).assert().code(1);
    said.fold(assert, |assert, one| assert.stdout(one));
}

#[test]
fn doctor_refuses_a_sumo_that_is_too_old() {
    let said = predicate::str::contains("1.14.1 is too old, SUMO 1.15 or newer is needed");
    doctor()
        .env("SUMO_BINARY", binary(TOO_OLD))
        .assert()
        .code(1)
        .stdout(said.and(predicate::str::contains("make setup")));
}
