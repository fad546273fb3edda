//! `check --schema`: the JSON schema of a scenario file accepts what the program accepts, and refuses what it refuses.

use std::{fs, path::Path};

use assert_cmd::Command;
use jsonschema::Validator;
use serde_json::{Value, json};
use sumo_mfc::scenario::{Catalog, Request, Scenario, template};

fn validator() -> Validator {
    let output = Command::cargo_bin("sumo-mfc").unwrap().args(["check", "--schema"]).output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty());
    let schema: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    jsonschema::meta::validate(&schema).unwrap();
    jsonschema::draft202012::new(&schema).unwrap()
}

fn json(toml: &str) -> Value {
    toml_edit::de::from_str(toml).unwrap()
}

fn accepts(validator: &Validator, what: &str, toml: &str) {
    let errors: Vec<String> =
        validator.iter_errors(&json(toml)).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(errors.is_empty(), "{what}: {errors:#?}");
}

#[test]
fn val_shipped_scenarios_are_accepted_as_written_and_as_resolved() {
    let validator = validator();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        accepts(&validator, &path.to_string_lossy(), &fs::read_to_string(&path).unwrap());
        let resolved = Scenario::load(&Request::file(&path), &Catalog::installed()).unwrap().to_toml();
        accepts(&validator, &format!("{} resolved", path.display()), &resolved);
        count += 1;
    }
    assert!(count >= 5, "{count} scenarios");
    accepts(&validator, "template", &template(&Catalog::installed()));
}

#[test]
fn groups_distributions_and_dots_are_accepted() {
    let text = r#"
        name = "rich"
        sumo = { config = "a.sumocfg", options = ["--scale", "2"], seed = 7 }
        egos.select = "share:0.5"
        controller = { name = "classic", k_p = 2, estimator = "difference" }
        vehicle = { mass_kg = { distribution = "normal", mean = 1500, std = 100, min = 1000 }, tyre.curve = "wet.csv" }
        actuator = { delay_s = 0.25, lag_s = { distribution = "uniform", min = 0.0, max = 0.1 } }
        [[group]]
        select = "class:bus"
        vehicle = { preset = "bus", mass.kg = 9000 }
        controller.window_s = 0.3
        noise.power_db = -6
    "#;
    accepts(&validator(), "rich", text);
}

#[test]
fn law_every_entry_is_accepted_with_its_defaults_and_no_other() {
    let validator = validator();
    let [controllers, targets, plants, bodies] = Catalog::installed().registries();
    for (section, entries) in [&controllers, &targets, &plants] {
        for entry in entries {
            let mut table = json!({ "name": entry.name });
            for key in entry.keys {
                assert!(
                    !validator.is_valid(&json!({ *section: { "name": entry.name, key.name: {} } })),
                    "{}",
                    key.name
                );
                if let Some(sumo_mfc::keys::Value::Number(x)) = key.default {
                    table[key.name] = json!(x);
                }
            }
            assert!(validator.is_valid(&json!({ *section: table })), "{section} {}", entry.name);
        }
        assert!(!validator.is_valid(&json!({ *section: { "name": "nobody's" } })), "{section}");
    }
    for body in &bodies.1 {
        assert!(validator.is_valid(&json!({ "vehicle": { "preset": body.name } })), "{}", body.name);
    }
}

#[test]
fn what_the_program_refuses_is_refused() {
    let validator = validator();
    let folder = tempfile::tempdir().unwrap();
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("sumo_nets/light/light.sumocfg");
    for wrong in [
        "sumo.sed = 1",
        "trafic.sigma = 0",
        "sumo.seed = -1",
        "sumo.seed = 1.5",
        "sumo.gui = \"yes\"",
        "sumo.num_clients = 0",
        "sumo.options = [1]",
        "name = 7",
        "traffic.headway_margin_s = \"fast\"",
        "traffic.headway_margin_s = -0.1",
        "actuator.delay_s = \"250 ms\"",
        "actuator.delay_s = 250",
        "noise.power_db = { distribution = \"uniform\", min = 0, max = 1 }",
        "controller.name = \"clasic\"",
        "controller = { name = \"pid\", epsilon = 0.1 }",
        "controller = { name = \"classic\", estimator = \"algebra\" }",
        "vehicle.preset = \"lorry\"",
        "vehicle.mass_kg = { distribution = \"normal\", mean = 1500 }",
        "vehicle.mass_kg = { distribution = \"normal\", mean = 1500, sdt = 10 }",
        "vehicle.mass_kg = { distribution = \"gamma\", mean = 1500, std = 10 }",
        "vehicle.mass.pounds = 3000",
        "group = [{ vehicle.preset = \"bus\" }]",
        "group = [{ select = \"all\", sumo.seed = 1 }]",
    ] {
        assert!(!validator.is_valid(&json(wrong)), "{wrong}");
        let path = folder.path().join("wrong.toml");
        fs::write(&path, format!("sumo.config = {config:?}\n{wrong}\n")).unwrap();
        assert!(Scenario::load(&Request::file(&path), &Catalog::installed()).is_err(), "{wrong}");
    }
}
