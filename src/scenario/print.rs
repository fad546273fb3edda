//! Scenarios as TOML: the resolved one (`check`) and the one with every key (`check --template`).

use std::fmt::Write;

use super::{
    Catalog, Choice, Group, PerVehicle, Preset, Scenario,
    section::wanted,
    sections::{Coupling, Output, PresetKeys, SumoKeys, Traffic},
};
use crate::{
    keys::{Key, Keys, Kind, Value, Values},
    measurement::NoiseKeys,
    plant::ActuatorKeys,
    registry::Entry,
    sumo_files::Source,
};

/// The scenario as TOML; reading it gives the same scenario.
pub(super) fn scenario(scenario: &Scenario) -> String {
    let mut out = Document::default();
    out.text("name", &scenario.name);
    out.sumo(scenario);
    out.header("[egos]");
    out.text("select", &scenario.egos.to_string());
    let [own @ .., rest] = scenario.groups.as_slice() else { return out.0 };
    out.group("", rest);
    out.choice("plant", &scenario.plant);
    out.section("traffic", &scenario.traffic);
    out.section("coupling", &scenario.coupling);
    out.section("output", &scenario.output);
    for group in own {
        out.header("[[group]]");
        out.text("select", &group.select.to_string());
        out.group("group.", group);
    }
    out.0
}

/// TOML under construction.
#[derive(Default)]
struct Document(String);

impl Document {
    fn header(&mut self, header: &str) {
        self.0.push_str(&format!("\n{header}\n"));
    }

    fn line(&mut self, key: &str, value: impl std::fmt::Display) {
        self.0.push_str(&format!("{key} = {value}\n"));
    }

    fn text(&mut self, key: &str, text: &str) {
        self.line(key, quoted(text));
    }

    fn texts<T: AsRef<str>>(&mut self, key: &str, texts: impl IntoIterator<Item = T>) {
        let texts: Vec<String> = texts.into_iter().map(|t| quoted(t.as_ref())).collect();
        if !texts.is_empty() {
            self.line(key, format!("[{}]", texts.join(", ")));
        }
    }

    fn number(&mut self, key: &str, number: Option<f64>) {
        if let Some(number) = number {
            self.line(key, format!("{number:?}"));
        }
    }

    fn section<K: Keys>(&mut self, section: &str, keys: &K) {
        self.header(&format!("[{section}]"));
        let values = keys.to_values();
        for key in K::keys() {
            if let Some(value) = values.0.get(key.name) {
                self.line(key.name, literal(value));
            }
        }
    }

    fn values(&mut self, values: &Values) {
        for (key, value) in &values.0 {
            self.line(key, literal(value));
        }
    }

    fn per_vehicle(&mut self, keys: &PerVehicle) {
        self.values(&keys.values);
        for (key, distribution) in &keys.spread {
            self.line(key, distribution);
        }
    }

    fn choice<B>(&mut self, section: &str, choice: &Choice<B>) {
        self.header(&format!("[{section}]"));
        self.text("name", choice.name());
        self.values(&choice.values);
    }

    fn group(&mut self, prefix: &str, group: &Group) {
        self.choice(&format!("{prefix}controller"), &group.controller);
        self.choice(&format!("{prefix}target"), &group.target);
        self.header(&format!("[{prefix}vehicle]"));
        if let Preset::Named(preset) = &group.vehicle.preset {
            self.text("preset", preset.name);
        }
        self.per_vehicle(&group.vehicle.body);
        self.header(&format!("[{prefix}actuator]"));
        self.per_vehicle(&group.actuator);
        self.section(&format!("{prefix}noise"), &group.noise);
    }

    fn sumo(&mut self, scenario: &Scenario) {
        let sumo = &scenario.sumo;
        self.header("[sumo]");
        match &sumo.source {
            Source::Config(path) => self.text("config", &path.to_string_lossy()),
            Source::Network { net, routes, additional } => {
                self.text("net", &net.to_string_lossy());
                self.texts("routes", routes.iter().map(|p| p.to_string_lossy()));
                self.texts("additional", additional.iter().map(|p| p.to_string_lossy()));
            }
            Source::Running | Source::Offline => {}
        }
        self.number("step_length_s", Some(sumo.step_length_s));
        self.number("end_s", sumo.end_s);
        self.line("seed", sumo.seed);
        self.line("ballistic", sumo.ballistic);
        self.texts("options", &sumo.options);
        self.line("gui", sumo.gui);
        if let Some(port) = sumo.port {
            self.line("port", port);
        }
        self.line("num_clients", sumo.num_clients);
        if let Some(connect) = &sumo.connect {
            self.text("connect", connect);
        }
    }
}

fn quoted(text: &str) -> String {
    toml_edit::Value::from(text).to_string()
}

/// A value as TOML.
pub(super) fn literal(value: &Value) -> String {
    match value {
        Value::Number(x) => format!("{x:?}"),
        Value::Integer(x) => x.to_string(),
        Value::Flag(x) => x.to_string(),
        Value::Text(x) => quoted(x),
        Value::Texts(list) => format!("[{}]", list.iter().map(|x| quoted(x)).collect::<Vec<_>>().join(", ")),
    }
}

/// A scenario file with every key, its unit, range and default. Keys without a default and keys of other choices than the
/// default ones are commented out.
pub fn template(catalog: &Catalog) -> String {
    let mut out = String::from(
        "# Every key of a scenario file. Values shown are the defaults; a key behind # has none, or belongs to another name.\n\
         # File names are relative to this file.\n\
         # name = \"...\"  # names the folder of the results; default: this file's name\n",
    );
    let mut section = |header: &str, body: &str| {
        let _ = write!(out, "\n[{header}]\n{body}");
    };
    section("sumo", &keys(SumoKeys::keys(), ""));
    section("egos", "select = \"all\"  # all | param | type:GLOB | id:REGEX | class:NAME | share:0.25\n");
    let [choices @ .., (_, bodies)] = catalog.registries();
    for (name, entries) in &choices {
        section(name, &choice(entries));
    }
    let body_keys = bodies.first().map_or("".into(), |body| keys(body.keys, ""));
    let bodies: String = bodies.iter().map(|b| format!("# preset {}: {}\n", b.name, b.summary)).collect();
    let drawn = "# Any number of [vehicle] and [actuator] can be drawn per vehicle:\n\
                 # KEY = { distribution = \"normal\", mean = 1.0, std = 0.1, min = 0.5, max = 1.5 }  # min, max: default the range\n\
                 # KEY = { distribution = \"uniform\", min = 0.5, max = 1.5 }\n";
    section("vehicle", &(bodies + drawn + &keys(PresetKeys::keys(), "") + &body_keys));
    section("actuator", &keys(ActuatorKeys::keys(), ""));
    section("noise", &keys(NoiseKeys::keys(), ""));
    section("traffic", &keys(Traffic::keys(), ""));
    section("coupling", &keys(Coupling::keys(), ""));
    section("output", &keys(Output::keys(), ""));
    out.push_str(
        "\n# Groups get their own settings; the first that matches a vehicle counts, keys left out are those above.\n\
         # [[group]]\n# select = \"class:bus\"\n# [group.vehicle]\n# preset = \"bus\"\n# [group.controller]\n# name = \"...\"\n",
    );
    out
}

/// The keys of a section that chooses by name; the first is the default.
fn choice(entries: &[Entry<()>]) -> String {
    let mut body = String::new();
    for (index, entry) in entries.iter().enumerate() {
        let (mark, comment) = if index == 0 { ("", "") } else { ("# ", "#   ") };
        let _ = write!(body, "{mark}name = \"{}\"  # {}\n{}", entry.name, entry.summary, keys(entry.keys, comment));
    }
    body
}

fn keys(keys: &[Key], comment: &str) -> String {
    let line = |key: &Key| {
        let value = match (&key.default, key.kind) {
            (Some(default), _) => literal(default),
            (None, Kind::Texts | Kind::Files) => "[\"...\"]".to_owned(),
            (None, _) => "...".to_owned(),
        };
        let mark = if key.default.is_none() && comment.is_empty() { "# " } else { "" };
        format!("{comment}{mark}{} = {value}  # {}: {}\n", key.name, wanted(key.kind), key.help)
    };
    keys.iter().map(line).collect()
}
