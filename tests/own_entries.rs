//! A law, a target, a plant and a body of another crate serve under their names as the installed ones do.

use std::fs;
use std::path::{Path, PathBuf};

use sumo_mfc::keys::NoKeys;
use sumo_mfc::plant::{BODIES, SevenDof, model, preset};
use sumo_mfc::reference::{Target, target};
use sumo_mfc::registry::{RegistrationError, find};
use sumo_mfc::run::{self, RunOptions, SessionOptions};
use sumo_mfc::scenario::{Catalog, Override, Request, Scenario, schema, template};
use sumo_mfc::study::{Arguments, Definition, settings};

#[path = "../examples/external/own_law/src/main.rs"]
#[allow(dead_code)]
mod own_law;

sumo_mfc::keys! {
    struct FineKeys {
        /// largest integration step
        step_s: f64 = 0.005, "s", 1e-4..=0.01;
    }
}

fn catalog() -> Catalog {
    let heavy = || {
        let mut body = (find("body", &BODIES, "car").unwrap().build)();
        body.mass_kg *= 1.5;
        body
    };
    Catalog::installed()
        .with_controller(own_law::proportional())
        .and_then(|catalog| {
            catalog.with_target(target("open", "the lane's limit", |_: NoKeys, _: &Path| Ok(Target::Limit)))
        })
        .and_then(|catalog| {
            catalog.with_plant(model("fine", "7 DoF in small steps", |keys: FineKeys| SevenDof::new(keys.step_s)))
        })
        .and_then(|catalog| catalog.with_body(preset("heavy", "a loaded car", heavy)))
        .unwrap()
}

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn sumo() -> PathBuf {
    let pythons = fs::read_dir(repository(".sumo/1.28.0/lib")).expect("type make setup-test").flatten();
    pythons.map(|python| python.path().join("site-packages/sumo/bin/sumo")).find(|sumo| sumo.is_file()).unwrap()
}

fn request(sets: &[&str]) -> Request {
    let request = Request::file(repository("scenarios/straight.toml"));
    sets.iter().fold(request, |request, set| request.with(Override::set(set).unwrap()))
}

const OWN: [&str; 6] = [
    "controller.name=proportional",
    "controller.k_p=2",
    "target.name=open",
    "plant.name=fine",
    "vehicle.preset=heavy",
    "sumo.end_s=20",
];

/// Runs a scenario, and returns the rows of `vehicles.csv`.
fn run(scenario: &Scenario, out_dir: PathBuf) -> Vec<String> {
    let session = SessionOptions { out_dir: out_dir.clone(), sumo: Some(sumo()), ..SessionOptions::default() };
    run::run(scenario, &RunOptions { session, ..RunOptions::default() }).unwrap();
    fs::read_to_string(out_dir.join("vehicles.csv")).unwrap().lines().map(str::to_owned).collect()
}

#[test]
fn own_entries_are_listed_and_shown_with_their_keys() {
    let lines = catalog().lines();
    for line in ["controller\tproportional\tP with feed-forward", "target\topen", "plant\tfine", "body\theavy"] {
        assert!(lines.contains(line), "{lines}");
    }
    let template = template(&catalog());
    for part in ["# name = \"proportional\"", "step_s = 0.005  # a number in s from 0.0001 to 0.01", "# preset heavy: "]
    {
        assert!(template.contains(part), "{template}");
    }
    assert!(schema(&catalog()).contains("\"proportional\"") && schema(&catalog()).contains("\"heavy\""));
}

#[test]
fn own_entries_are_suggested_and_their_keys_checked() {
    let message = |sets: &[&str]| Scenario::load(&request(sets), &catalog()).unwrap_err().to_string();
    let unknown = message(&["controller.name=proportinal"]);
    assert!(unknown.contains("did you mean \"proportional\"?"), "{unknown}");
    let range = message(&["controller.name=proportional", "controller.k_p=1000"]);
    assert!(range.contains("controller.k_p: found 1000, wanted a number in 1/s from 0 to 100"), "{range}");
    let body = message(&["vehicle.preset=heavvy"]);
    assert!(body.contains("did you mean \"heavy\"?"), "{body}");
    let installed = Scenario::load(&request(&OWN), &Catalog::installed()).unwrap_err().to_string();
    assert!(installed.contains("unknown") && installed.contains("more)"), "{installed}");
}

#[test]
fn a_name_is_taken_once() {
    let again = catalog().with_controller(own_law::proportional()).unwrap_err();
    assert_eq!(again, RegistrationError::NameTaken { kind: "controller", name: "proportional" });
}

#[test]
fn own_entries_run_in_sumo_and_a_resolved_scenario_gives_the_same_rows() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = Scenario::load(&request(&OWN), &catalog()).unwrap();
    let rows = run(&scenario, folder.path().join("out"));
    assert!(rows.len() > 1 && rows[1..].iter().all(|row| row.contains(",proportional,open,")), "{rows:?}");

    let resolved = folder.path().join("resolved.toml");
    fs::write(&resolved, scenario.to_toml()).unwrap();
    let again = Scenario::load(&Request::file(resolved), &catalog()).unwrap();
    assert_eq!(run(&again, folder.path().join("again")), rows);

    let weak = Scenario::load(&request(&[&OWN[..], &["controller.k_p=0.1"]].concat()), &catalog()).unwrap();
    assert_ne!(run(&weak, folder.path().join("weak")), rows, "the law reads its key");
}

#[test]
fn own_laws_are_compared_and_loaded_offline() {
    let controllers = ["proportional".to_owned(), "pid".to_owned()].to_vec();
    let arguments = Arguments { request: request(&[]), controllers, ..Arguments::default() };
    let definition = Definition::read(&arguments).unwrap();
    let settings = settings(&definition, &catalog()).unwrap();
    assert_eq!(settings[0].scenario.groups[0].controller.name(), "proportional");
    assert_eq!(settings[1].reference, Some(0));

    let offline = Request::default().with(Override::set("controller.name=proportional").unwrap());
    let scenario = Scenario::load_offline(&offline, &catalog()).unwrap();
    assert_eq!(scenario.groups[0].controller.name(), "proportional");
}
