//! `sumo-mfc doctor` and its self-check of the coupling, on the oldest and the newest supported SUMO: it passes, and each
//! way to get the coupling wrong makes it fail. A missing SUMO is a failure, not a skip.

#[allow(dead_code, reason = "the faults at random use the rest")]
mod proxy;
mod step_reference;

use std::path::{Path, PathBuf};
use std::time::Duration;

use assert_cmd::Command;
use predicates::prelude::*;
use proxy::Fault;
use step_reference::StepReference;
use sumo_mfc::control::Law;
use sumo_mfc::cosim::self_check::{self, Check};
use sumo_mfc::cosim::{CosimError, TraciLink, WorldSetup};
use sumo_mfc::doctor;
use sumo_mfc::run;
use sumo_mfc::scenario::{Catalog, Request, Scenario};
use sumo_mfc::sumo_files::sumo_arguments;
use sumo_mfc::traci::{Client, SumoProcess, find_sumo};

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

const PATIENCE: Duration = Duration::from_secs(30);

/// Another program may snatch the free port before SUMO listens there.
const ATTEMPTS: usize = 3;

/// The self-check through a proxy, with a world that `change` may have made wrong.
fn checks(version: &str, fault: Fault, change: fn(&mut WorldSetup)) -> Vec<Check> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in self_check::FILES {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let (file, _) = self_check::FILES[self_check::FILES.len() - 1];
    let scenario = Scenario::load(&Request::file(folder.path().join(file)), &Catalog::installed()).unwrap();
    std::fs::create_dir(folder.path().join("sumo")).unwrap();
    let line = sumo_arguments(&scenario.sumo, folder.path()).unwrap().arguments;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let attempt = async || -> Result<Vec<Check>, CosimError> {
        let sumo = find_sumo(Some(&binary(version)))?;
        let process = SumoProcess::spawn(&sumo, &line, None, folder.path())?;
        let address = format!("127.0.0.1:{}", proxy::start(process.port(), fault).port);
        let client = Client::connect(address, PATIENCE).await?;
        let mut setup = run::world(&scenario).unwrap();
        change(&mut setup);
        let checks = self_check::examine(TraciLink::new(client, false), setup).await?;
        process.shut_down(PATIENCE).await?;
        Ok(checks)
    };
    let mut error = None;
    for _ in 0..ATTEMPTS {
        match runtime.block_on(attempt()) {
            Ok(checks) => return checks,
            Err(failed) => error = Some(failed),
        }
    }
    panic!("{version}, {fault:?}: {error:?}");
}

/// The names of the failed checks of one controller.
#[track_caller]
fn failed(checks: &[Check], controller: &str) -> Vec<String> {
    let own = format!("{controller}: ");
    let checks: Vec<_> = checks.iter().filter_map(|c| Some((c.name.strip_prefix(&own)?, c.passed))).collect();
    assert_eq!(checks.len(), 6, "{checks:?}");
    checks.into_iter().filter(|(_, passed)| !passed).map(|(name, _)| name.to_owned()).collect()
}

/// The fault is noticed with either controller, by at least the check that is meant for it.
#[track_caller]
fn is_noticed(fault: Fault, change: fn(&mut WorldSetup), by: &str) {
    for version in [NEW, OLD] {
        let checks = checks(version, fault, change);
        for controller in ["classic", "adaptive"] {
            let failed = failed(&checks, controller);
            println!("{controller} on {version}: {failed:?}");
            assert!(failed.iter().any(|name| name == by), "{controller} on {version}: {by} passed\n{checks:#?}");
        }
    }
}

#[test]
fn the_coupling_passes() {
    for version in [NEW, OLD] {
        let report = doctor::examine(Some(&binary(version)));
        assert!(report.is_well(), "{version}\n{report}");
        assert_eq!(report.checks.len(), 3 + 2 * 6);
    }
}

/// The proxy itself is not what the check notices.
#[test]
fn the_coupling_passes_through_a_proxy_that_alters_nothing() {
    for version in [NEW, OLD] {
        let checks = checks(version, Fault::None, |_| {});
        assert_eq!(checks.len(), 2 * 6);
        assert!(checks.iter().all(|check| check.passed), "{version}\n{checks:#?}");
    }
}

#[test]
fn a_reference_given_as_a_step_is_noticed() {
    let change = |setup: &mut WorldSetup| {
        for block in &mut setup.blocks {
            let law = std::mem::replace(&mut block.law, Box::new(|| unreachable!("replaced below")));
            block.law = Box::new(move || match law().block() {
                Some(controller) => Law::Block(Box::new(StepReference::around(controller))),
                None => Law::Nothing,
            });
        }
    };
    is_noticed(Fault::None, change, "no creep");
}

#[test]
fn speed_without_traci_as_the_target_is_noticed() {
    is_noticed(Fault::SpeedWithoutTraci, |_| {}, "no creep");
}

#[test]
fn a_speed_that_is_not_sent_back_is_noticed() {
    is_noticed(Fault::NotSentBack, |_| {}, "SUMO's choice follows from it");
}

fn doctor_command() -> Command {
    let mut command = Command::cargo_bin("sumo-mfc").unwrap();
    command.arg("doctor").env_remove("SUMO_HOME").env_remove("SUMO_BINARY");
    command
}

#[test]
fn doctor_shows_what_it_found() {
    let said = predicate::str::contains("1.28.0, TraCI API 22").and(predicate::str::contains("from SUMO_BINARY"));
    doctor_command().env("SUMO_BINARY", binary(NEW)).assert().success().stdout(said);
}

#[test]
fn doctor_says_what_to_type_without_sumo() {
    let nowhere = tempfile::tempdir().unwrap();
    let said = ["failed", "pip install eclipse-sumo==1.28.0", "apt-get install sumo", "make setup"];
    let said = said.into_iter().map(predicate::str::contains);
    let assert = doctor_command().env("PATH", nowhere.path()).current_dir(nowhere.path()).assert().code(1);
    said.fold(assert, |assert, one| assert.stdout(one));
}

#[test]
fn doctor_refuses_a_sumo_that_is_too_old() {
    let said = predicate::str::contains("1.14.1 is too old, SUMO 1.15 or newer is needed");
    doctor_command()
        .env("SUMO_BINARY", binary(TOO_OLD))
        .assert()
        .code(1)
        .stdout(said.and(predicate::str::contains("make setup")));
}
