//! Scenarios as TOML: the resolved one (`check`) and the one with every key (`check --template`).

use std::fmt::Write;

use super::{
    catalog::Catalog,
    layout::{Form, sections},
    model::{Choice, Group, Preset, Scenario},
    reader::wanted,
    sections::{Egos, Named},
    spread::PerVehicle,
};
use crate::{
    keys::{Key, Keys, Kind, Value, Values},
    registry::Entry,
};

impl Scenario {
    /// The scenario as TOML in SI units. Reading it gives the same scenario.
    pub fn to_toml(&self) -> String {
        let mut out = Document::default();
        out.text("name", &self.name);
        out.section("sumo", &self.sumo);
        out.section("egos", &Egos { select: self.egos.clone() });
        let [own @ .., rest] = self.groups.as_slice() else { return out.0 };
        out.group("", rest);
        out.choice("plant", &self.plant);
        out.section("traffic", &self.traffic);
        out.section("coupling", &self.coupling);
        out.section("output", &self.output);
        for group in own {
            out.header("[[group]]");
            out.text("select", &group.select.to_string());
            out.group("group.", group);
        }
        out.0
    }
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
         # File names are relative to this file.\n",
    );
    out.push_str(&keys(Named::keys(), ""));
    for section in sections(catalog) {
        let _ = write!(out, "\n[{}]\n", section.name);
        if section.name == "vehicle" {
            out.extend(catalog.bodies.iter().map(|b| format!("# preset {}: {}\n", b.name, b.summary)));
            out.push_str(
                "# Any number of [vehicle] and [actuator] can be drawn per vehicle:\n\
                 # KEY = { distribution = \"normal\", mean = 1.0, std = 0.1, min = 0.5, max = 1.5 }  # min, max: default the range\n\
                 # KEY = { distribution = \"uniform\", min = 0.5, max = 1.5 }\n",
            );
        }
        out.push_str(&match section.form {
            Form::Keys(own) | Form::Drawn(own) => keys(&own, ""),
            Form::Choice(entries) => choice(&entries),
        });
    }
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
