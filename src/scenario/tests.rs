//! Scenarios as users write them.

use std::path::{Path, PathBuf};

use super::*;
use crate::{
    control::{Actuation, CONTROLLERS, Command, Observation},
    keys::{Key, Keys, NoKeys, Value, Values},
    lanes::LANES,
    plant::{BODIES, PLANTS},
    reference::TARGETS,
    registry::Entry,
    sumo_files::Source,
};

crate::choice! {
    enum Mode {
        Fast = "fast",
        Slow = "slow",
    }
}

crate::keys! {
    struct AdaptiveKeys {
        /// gain
        k_p: f64 = 1.0, "1/s", 0.0..=10.0;
        /// mode
        mode: Mode = Mode::Fast;
    }
}

crate::keys! {
    struct ClassicKeys {
        /// gain
        k_p: f64 = 1.0, "1/s", 0.0..=10.0;
        /// count
        count: Option<u16>, "-", 1..=9;
        /// flag
        flag: bool = false;
    }
}

crate::keys! {
    struct ProfileKeys {
        /// file
        file: Option<PathBuf>;
    }
}

/// A catalogue that does not change with the registries; what its entries build does not matter.
fn catalog() -> Catalog {
    fn entry<B: Clone>(like: &Entry<B>, name: &'static str, summary: &'static str, keys: &'static [Key]) -> Entry<B> {
        Entry { name, summary, keys, build: like.build.clone() }
    }
    let (controller, target, body) = (&CONTROLLERS[0], &TARGETS[0], &BODIES[0]);
    Catalog {
        controllers: vec![
            entry(controller, "adaptive", "adapts", AdaptiveKeys::keys()),
            entry(controller, "classic", "does not", ClassicKeys::keys()),
        ],
        targets: vec![
            entry(target, "traffic", "SUMO's", NoKeys::keys()),
            entry(target, "profile", "a file's", ProfileKeys::keys()),
        ],
        plants: vec![entry(&PLANTS[0], "seven_dof", "7 DoF", NoKeys::keys())],
        bodies: vec![entry(body, "car", "a car", body.keys), entry(body, "bus", "a bus", body.keys)],
    }
}

fn nets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("sumo_nets/light")
}

/// Loads a scenario of this text on our smallest network.
fn load_in(folder: &Path, text: &str, sets: &[&str]) -> Result<Scenario, ScenarioError> {
    let path = folder.join("town.toml");
    let config = format!("sumo.config = {:?}\n", nets().join("light.sumocfg"));
    std::fs::write(&path, config + text).unwrap();
    let overrides = sets.iter().map(|s| Override::set(s).unwrap()).collect();
    Scenario::load(&Request { scenario: Some(path), overrides }, &catalog())
}

fn load(text: &str, sets: &[&str]) -> Scenario {
    load_in(tempfile::tempdir().unwrap().path(), text, sets).unwrap()
}

const RICH: &str = r#"
name = "rich"
sumo.seed = 7
sumo.end_s = 120
sumo.options = ["--time-to-teleport", "-1"]
egos.select = "share:0.5"
controller = { name = "classic", k_p = 2, count = 3 }
vehicle.mass_kg = { distribution = "normal", mean = 1500, std = 100, min = 1000 }
actuator = { delay_s = 0.25, lag_s = { distribution = "uniform", min = 0.0, max = 0.1 } }
noise.power_db = -6
traffic.sigma = 0
coupling.control_period_s = 0.005
output = { trace = "a, b", trace_period_s = 1 }

[[group]]
select = "class:bus"
vehicle = { preset = "bus", mass_kg = 9000 }
controller.k_p = 0.5

[[group]]
select = "type:fast_*"
controller.name = "adaptive"
"#;

#[test]
fn a_scenario_is_what_its_file_says() {
    let rich = load(RICH, &[]);
    assert_eq!((rich.name.as_str(), rich.sumo.seed, rich.sumo.end_s), ("rich", 7, Some(120.0)));
    assert_eq!((rich.sumo.step_length_s, rich.coupling.control_period_s), (0.1, 0.005));
    assert_eq!(rich.sumo.options, ["--time-to-teleport", "-1"]);
    assert_eq!(rich.traffic.sigma, Some(0.0));
    assert_eq!(rich.output.trace, Trace::Ids(vec!["a".into(), "b".into()]));
    assert_eq!(rich.default_folder(), PathBuf::from("out/rich-classic-7"));

    let [bus, fast, rest] = rich.groups.as_slice() else { panic!("three groups") };
    let gain = |group: &Group| (group.controller.name(), group.controller.values.get::<f64>("k_p").unwrap());
    assert_eq!((gain(bus), gain(fast), gain(rest)), (("classic", 0.5), ("adaptive", 1.0), ("classic", 2.0)));
    assert_eq!(bus.controller.values.get::<i64>("count"), Some(3), "inherited key by key");
    assert_eq!(fast.controller.values.get::<i64>("count"), None, "another controller has keys of its own");
    let preset = match &bus.vehicle.preset {
        Preset::Named(entry) => entry.name,
        Preset::ByClass(_) => "by class",
    };
    assert!(matches!(&rest.vehicle.preset, Preset::ByClass(bodies) if bodies.len() == 2));
    assert_eq!((preset, bus.vehicle.body.values.get::<f64>("mass_kg")), ("bus", Some(9000.0)));
    assert!(bus.vehicle.body.spread.is_empty() && rest.vehicle.body.values.0.is_empty());
    let mass = Distribution::Normal { mean: 1500.0, std: 100.0, min: 1000.0, max: 100_000.0 };
    assert_eq!(rest.vehicle.body.spread, [("mass_kg", mass)]);
    assert_eq!((bus.noise.power_db, rest.noise.power_db), (Some(-6.0), Some(-6.0)));
    assert_eq!(rest.actuator.values.get::<f64>("delay_s"), Some(0.25));
    assert_eq!(fast.actuator.spread, [("lag_s", Distribution::Uniform { min: 0.0, max: 0.1 })]);
    assert_eq!(fast.actuator.values.get::<f64>("lag_s"), None);
}

#[test]
fn the_first_group_that_matches_counts() {
    let rich = load(RICH, &[]);
    let group = |type_id, class| {
        let ego = EgoInfo { id: "v", type_id, class, param: false };
        Group::of(&rich.groups, &ego, rich.sumo.seed)
    };
    assert_eq!(group("city", "bus"), Some(0));
    assert_eq!(group("fast_bus", "bus"), Some(0));
    assert_eq!(group("fast_car", "passenger"), Some(1));
    assert_eq!(group("car", "passenger"), Some(2));
}

#[test]
fn set_takes_the_same_way_as_the_file() {
    let plain = load("controller.name = \"classic\"", &[]);
    assert_eq!(plain.groups[0].noise.power_db, None);
    let set = load(
        "controller.name = \"classic\"",
        &["controller.k_p=1.2", "noise.power_db=-6", "actuator.delay_s=0.25", "traffic.sigma=0", "egos.select=type:e*"],
    );
    let group = &set.groups[0];
    assert_eq!((group.controller.name(), group.controller.values.get::<f64>("k_p").unwrap()), ("classic", 1.2));
    assert_eq!(
        (group.noise.power_db, group.actuator.values.get::<f64>("delay_s"), set.traffic.sigma),
        (Some(-6.0), Some(0.25), Some(0.0))
    );
    assert_eq!(set.egos.to_string(), "type:e*");
    let file = "controller = { name = \"classic\", k_p = 1.2 }\nnoise.power_db = -6\nactuator.delay_s = 0.25\n\
                traffic.sigma = 0\negos.select = \"type:e*\"";
    assert_eq!(load(file, &[]).to_toml(), set.to_toml());

    let rich =
        load(RICH, &["group.0.vehicle.mass_kg=8000", "vehicle.mass_kg.std=50", "sumo.options=[\"--scale\", \"2\"]"]);
    assert_eq!(rich.groups[0].vehicle.body.values.get::<f64>("mass_kg").unwrap(), 8000.0);
    assert!(matches!(rich.groups[2].vehicle.body.spread[0].1, Distribution::Normal { std: 50.0, .. }));
    assert_eq!(rich.sumo.options, ["--scale", "2"]);
}

#[test]
fn another_controller_leaves_the_files_keys_behind() {
    let file = "controller = { name = \"classic\", k_p = 2, count = 3 }";
    let other = load(file, &["controller.name=adaptive", "controller.mode=slow"]);
    let controller = &other.groups[0].controller;
    assert_eq!(
        (
            controller.name(),
            controller.values.get::<f64>("k_p").unwrap(),
            controller.values.get::<String>("mode").as_deref()
        ),
        ("adaptive", 1.0, Some("slow"))
    );
    assert!(other.notes.iter().any(|n| n.contains("controller.count, k_p belong to classic")), "{:?}", other.notes);
    let same = load(file, &["controller.name=classic"]);
    assert_eq!(same.groups[0].controller.values.get::<f64>("k_p").unwrap(), 2.0);
}

#[test]
fn law_a_resolved_scenario_is_a_fixed_point() {
    let folder = tempfile::tempdir().unwrap();
    for text in ["", RICH, "target = { name = \"profile\", file = \"speeds.csv\" }"] {
        std::fs::write(folder.path().join("speeds.csv"), "s_m,v_mps\n0,10\n").unwrap();
        let first = load_in(folder.path(), text, &[]).unwrap();
        let other = tempfile::tempdir().unwrap();
        let path = other.path().join("elsewhere.toml");
        std::fs::write(&path, first.to_toml()).unwrap();
        let second = Scenario::load(&Request::file(path), &catalog()).unwrap();
        assert_eq!(first.to_toml(), second.to_toml());
        assert_eq!((&first.name, &first.sumo), (&second.name, &second.sumo));
        assert_eq!(first.inputs[1..], second.inputs[1..], "the same inputs but for the scenario file itself");
    }
}

#[test]
fn bare_configurations_and_networks_are_scenarios() {
    let config = nets().join("light.sumocfg");
    let scenario = Scenario::load(&Request::file(&config), &catalog()).unwrap();
    assert_eq!(scenario.name, "light");
    assert_eq!(scenario.sumo.source(), Source::Config(&config));
    assert!(matches!(scenario.egos, Selector::All));
    let group = &scenario.groups[0];
    assert_eq!((group.controller.name(), group.target.name(), scenario.groups.len()), ("adaptive", "traffic", 1));
    let inputs = [config, nets().join("light.net.xml"), nets().join("light.rou.xml")];
    assert_eq!(scenario.inputs, inputs);

    let overrides = vec![
        Override::text("--net", "sumo.net", &nets().join("light.net.xml").to_string_lossy()),
        Override::texts("--routes", "sumo.routes", &[nets().join("light.rou.xml").to_string_lossy().into_owned()]),
        Override::literal("--seed", "sumo.seed", 5),
    ];
    let scenario = Scenario::load(&Request { scenario: None, overrides }, &catalog()).unwrap();
    assert_eq!((scenario.name.as_str(), scenario.sumo.seed, scenario.inputs.len()), ("light", 5, 2));
    assert!(matches!(scenario.sumo.source(), Source::Network(_)));

    let connect = Override::text("--connect", "sumo.connect", "localhost:8813");
    let scenario = Scenario::load(&Request { scenario: None, overrides: vec![connect] }, &catalog()).unwrap();
    assert_eq!((scenario.sumo.source(), scenario.name.as_str()), (Source::Running, "running"));
}

#[test]
fn a_key_of_endless_parts_is_refused() {
    let set = format!("{}b=1", "a.".repeat(40_000));
    let error = load_in(tempfile::tempdir().unwrap().path(), "", &[&set]).unwrap_err().to_string();
    assert!(error.ends_with("a. ...: found 40001 parts, wanted a key of at most 80 parts"), "{error}");
}

#[test]
fn overridden_stepping_is_announced_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sumocfg");
    let input = format!("<n value=\"{0}/light.net.xml\"/><r value=\"{0}/light.rou.xml\"/>", nets().display());
    let notes = |time: &str, sets: &[&str]| {
        std::fs::write(&path, format!("<configuration>{input}{time}</configuration>")).unwrap();
        let overrides = sets.iter().map(|s| Override::set(s).unwrap()).collect();
        Scenario::load(&Request { scenario: Some(path.clone()), overrides }, &catalog()).unwrap().notes
    };
    let [note] = notes("", &[]).try_into().unwrap();
    assert!(
        note.contains("step length 0.1 s instead of 1 s") && note.contains("ballistic steps instead of Euler"),
        "{note}"
    );
    let ours = "<step-length value=\"0.1\"/><step-method.ballistic value=\"true\"/>";
    let ours = format!("{ours}<collision.mingap-factor value=\"0\"/>");
    assert_eq!(notes(&ours, &[]), Vec::<String>::new());
    let theirs = ["sumo.step_length_s=1", "sumo.ballistic=false"];
    let [note] = notes("", &theirs).try_into().unwrap();
    assert!(
        note.ends_with("collisions are contacts instead of gaps below minGap (-- --collision.mingap-factor decides)")
    );
    let gaps = notes(&ours.replace("\"0\"", "\"0.5\""), &[]);
    assert!(gaps[0].contains("collisions are gaps below 0.5 minGap, as it says"), "{gaps:?}");
    let random = notes(&format!("{ours}<random value=\"true\"/>"), &[]);
    assert!(random[0].contains("seed 23423 instead of a random one"), "{random:?}");
}

#[test]
fn law_included_files_are_inputs_and_may_not_include_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("a.add.xml", "<additional><include href=\"b.add.xml\"/></additional>");
    write("b.add.xml", "<additional><vType id=\"x\"/></additional>");
    let text = format!(
        "[sumo]\nnet = {:?}\nroutes = {:?}\nadditional = \"a.add.xml\"",
        nets().join("light.net.xml"),
        nets().join("light.rou.xml")
    );
    write("s.toml", &text);
    let request = Request::file(folder.path().join("s.toml"));
    let inputs = Scenario::load(&request, &catalog()).unwrap().inputs;
    let names: Vec<_> = inputs.iter().map(|p| p.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["s.toml", "light.net.xml", "light.rou.xml", "a.add.xml", "b.add.xml"]);

    write("b.add.xml", "<additional><include href=\"a.add.xml\"/></additional>");
    let error = Scenario::load(&request, &catalog()).unwrap_err().to_string();
    assert!(error.contains("includes itself"), "{error}");
    write("b.add.xml", "<additional>\n<include href=\"c.add.xml\"/></additional>");
    let error = Scenario::load(&request, &catalog()).unwrap_err().to_string();
    assert!(error.contains("b.add.xml:2: include: ") && error.contains("c.add.xml does not exist"), "{error}");
    write("b.add.xml", "<additional>");
    assert!(Scenario::load(&request, &catalog()).is_ok(), "SUMO says what is wrong with it");
}

#[test]
fn the_template_shows_every_key() {
    insta::assert_snapshot!(template(&catalog()));
}

#[test]
fn law_the_template_is_a_valid_scenario_of_defaults() {
    for catalog in [catalog(), Catalog::installed()] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("town.toml");
        let text = template(&catalog);
        std::fs::write(&path, &text).unwrap();
        let config = nets().join("light.sumocfg").to_string_lossy().into_owned();
        let config = Override::text("", "sumo.config", &config);
        let from_template = Scenario::load(&Request::file(&path).with(config.clone()), &catalog).unwrap();
        std::fs::write(&path, "").unwrap();
        let from_nothing = Scenario::load(&Request::file(&path).with(config), &catalog).unwrap();
        assert_eq!(from_template.to_toml(), from_nothing.to_toml());
        for (_, entries) in catalog.registries() {
            for entry in &entries {
                assert!(text.contains(entry.name), "{}", entry.name);
                assert!(entry.keys.iter().all(|k| text.contains(&format!("{} = ", k.name))), "{}", entry.name);
            }
        }
    }
}

#[test]
fn law_every_choice_of_every_registry_loads_with_its_defaults() {
    let catalog = Catalog::installed();
    let config = nets().join("light.sumocfg");
    let [sections @ .., _] = catalog.registries();
    for (section, entries) in &sections {
        for entry in entries {
            let mut request =
                Request::file(&config).with(Override::set(&format!("{section}.name={}", entry.name)).unwrap());
            for (key, value) in Values::defaults(entry.keys).0 {
                let value = print::literal(&value);
                request = request.with(Override::set(&format!("{section}.{key}={value}")).unwrap());
            }
            let given = Scenario::load(&request, &catalog).unwrap();
            let plain = Request::file(&config).with(Override::set(&format!("{section}.name={}", entry.name)).unwrap());
            assert_eq!(
                given.to_toml(),
                Scenario::load(&plain, &catalog).unwrap().to_toml(),
                "{section} {}",
                entry.name
            );
        }
    }
}

#[test]
fn values_of_every_kind_survive_printing() {
    let text = "controller = { name = \"classic\", k_p = 1e-3, count = 9, flag = true }\nname = \"tötal \\\"q\\\"\"";
    let scenario = load(text, &[]);
    let values = &scenario.groups[0].controller.values;
    assert_eq!(values.0["flag"], Value::Flag(true));
    let printed = scenario.to_toml();
    assert!(printed.contains("k_p = 0.001\n") && printed.contains("count = 9\n") && printed.contains("flag = true\n"));
    let again: toml_edit::DocumentMut = printed.parse().unwrap();
    assert_eq!(again["name"].as_str(), Some("tötal \"q\""));
}

#[test]
fn a_dot_in_place_of_the_first_underscore_is_the_same_key() {
    let mass =
        |scenario: &Scenario, group: usize| scenario.groups[group].vehicle.body.values.get::<f64>("mass_kg").unwrap();
    assert_eq!(mass(&load("vehicle.mass.kg = 1200\n", &[]), 0), 1200.0);
    assert_eq!(mass(&load("vehicle.mass_kg = 1200\n", &["vehicle.mass.kg=1300"]), 0), 1300.0);
    let groups = load("vehicle.mass_kg = 1200\n[[group]]\nselect = \"type:bus*\"\nvehicle.mass.kg = 9000\n", &[]);
    assert_eq!((mass(&groups, 0), mass(&groups, 1)), (9000.0, 1200.0));
    let folder = tempfile::tempdir().unwrap();
    let error = load_in(folder.path(), "vehicle.mass.pounds = 3000\n", &[]).unwrap_err().to_string();
    assert!(error.contains("vehicle.mass"), "{error}");
}

/// A law with a model has the actuators of its vehicles for it, unless its keys say otherwise.
#[test]
fn a_law_with_a_model_is_told_of_the_actuators() {
    let torques_nm = |set: &[(&'static str, f64)]| {
        let overrides = set.iter().map(|(key, value)| Override::literal("test", key, format!("{value:?}")));
        let named = Override::text("test", "controller.name", "smith_pi");
        let request = Request { scenario: None, overrides: overrides.chain([named]).collect() };
        let scenario = Scenario::load_offline(&request, &Catalog::installed()).unwrap();
        let mut law = (scenario.blocks(&scenario.groups[0]).law)().block().unwrap();
        let one = |_| {
            let observation = Observation {
                measured_mps: [5.0; LANES],
                reference_mps: [6.0; LANES],
                nominal_nm_per_mps2: [500.0; LANES],
                ..Observation::default()
            };
            let mut command = Command::default();
            law.command(&observation, &mut command);
            law.feedback(&Actuation { saturated_mps2: [1.0; LANES], ..Actuation::default() });
            command.torque_nm[0]
        };
        (0..50).map(one).collect::<Vec<f64>>()
    };
    let (delay, model) = ("actuator.delay_s", "controller.model_delay_s");
    assert_eq!(torques_nm(&[(delay, 0.25)]), torques_nm(&[(model, 0.25)]));
    assert_eq!(torques_nm(&[(delay, 0.25), (model, 0.1)]), torques_nm(&[(model, 0.1)]));
    assert_ne!(torques_nm(&[(delay, 0.25)]), torques_nm(&[]));
}
