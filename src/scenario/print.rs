//! Scenarios as TOML: the resolved one (`check`) and the one with every key (`check --template`).

use std::fmt::Write;

use toml_edit::Value as Toml;

use super::{
    Catalog, Choice, Distribution, Group, Named, Options, Quantity, Scenario, Trace,
    catalog::{ACTUATOR_KEYS, COUPLING_KEYS, NOISE_KEYS, OUTPUT_KEYS, PRESET_KEY, SUMO_KEYS, SUMO_LISTS, TRAFFIC_KEYS},
    load::choices,
    section::wanted,
};
use crate::{
    keys::{Key, Value, Values},
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
    out.header("[traffic]");
    out.number("sigma", scenario.traffic.sigma);
    out.header("[coupling]");
    out.number("control_period_s", Some(scenario.control_period_s));
    out.number("lead_mps", Some(scenario.coupling.lead_mps));
    out.line("grade", scenario.coupling.grade);
    out.header("[output]");
    out.text("vehicles", &scenario.output.vehicles);
    let trace = match &scenario.output.trace {
        Trace::None => "none".to_owned(),
        Trace::All => "all".to_owned(),
        Trace::Ids(ids) => ids.join(","),
    };
    out.text("trace", &trace);
    out.number("trace_period_s", scenario.output.trace_period_s);
    out.text("trace_file", &scenario.output.trace_file);
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

    fn values(&mut self, values: &Values) {
        for (key, value) in &values.0 {
            match value {
                Value::Number(x) => self.line(key, format!("{x:?}")),
                Value::Integer(x) => self.line(key, x),
                Value::Flag(x) => self.line(key, x),
                Value::Text(x) => self.text(key, x),
            }
        }
    }

    fn choice(&mut self, section: &str, choice: &Choice) {
        self.header(&format!("[{section}]"));
        self.text("name", choice.name);
        self.values(&choice.values);
    }

    fn spread(&mut self, key: &str, distribution: &Distribution) {
        self.line(key, distribution);
    }

    fn group(&mut self, prefix: &str, group: &Group) {
        self.choice(&format!("{prefix}controller"), &group.controller);
        self.choice(&format!("{prefix}target"), &group.target);
        self.header(&format!("[{prefix}vehicle]"));
        if let Some(preset) = &group.vehicle.preset {
            self.text(PRESET_KEY.name, preset);
        }
        self.values(&group.vehicle.values);
        for (key, distribution) in &group.vehicle.spread {
            self.spread(key, distribution);
        }
        self.header(&format!("[{prefix}actuator]"));
        for (key, quantity) in [("delay_s", group.actuator.delay_s), ("lag_s", group.actuator.lag_s)] {
            match quantity {
                Quantity::Fixed(value) => self.number(key, Some(value)),
                Quantity::Drawn(distribution) => self.spread(key, &distribution),
            }
        }
        self.header(&format!("[{prefix}noise]"));
        self.number("power_db", group.noise_power_db);
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
    Toml::from(text).to_string()
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
    let lists: String =
        SUMO_LISTS.iter().map(|(name, _, help)| format!("# {name} = [\"...\"]  # list of texts: {help}\n")).collect();
    section("sumo", &(keys(SUMO_KEYS, "") + &lists));
    section("egos", "select = \"all\"  # all | param | type:GLOB | id:REGEX | class:NAME | share:0.25\n");
    for (name, options, default) in choices(catalog) {
        section(name, &choice(options, default));
    }
    let bodies =
        catalog.bodies.entries.iter().map(|b| format!("# preset {}: {}\n", b.name, b.summary)).collect::<String>();
    let drawn = "# Any number of [vehicle] and [actuator] can be drawn per vehicle:\n\
                 # KEY = { distribution = \"normal\", mean = 1.0, std = 0.1, min = 0.5, max = 1.5 }  # min, max: default the range\n\
                 # KEY = { distribution = \"uniform\", min = 0.5, max = 1.5 }\n";
    section("vehicle", &(bodies + drawn + &keys(&[PRESET_KEY], "") + &keys(catalog.body_keys, "")));
    section("actuator", &keys(ACTUATOR_KEYS, ""));
    section("noise", &keys(NOISE_KEYS, ""));
    section("traffic", &keys(TRAFFIC_KEYS, ""));
    section("coupling", &keys(COUPLING_KEYS, ""));
    section("output", &keys(OUTPUT_KEYS, ""));
    out.push_str(
        "\n# Groups get their own settings; the first that matches a vehicle counts, keys left out are those above.\n\
         # [[group]]\n# select = \"class:bus\"\n# [group.vehicle]\n# preset = \"bus\"\n# [group.controller]\n# name = \"...\"\n",
    );
    out
}

/// The keys of a section that chooses by name.
fn choice(options: &Options, default: &str) -> String {
    let mut body = String::new();
    for Named { name, summary, keys: own } in options.entries.iter().filter(|e| e.name == default) {
        let _ = write!(body, "name = \"{name}\"  # {summary}\n{}", keys(own, ""));
    }
    for Named { name, summary, keys: own } in options.entries.iter().filter(|e| e.name != default) {
        let _ = write!(body, "# name = \"{name}\"  # {summary}\n{}", keys(own, "#   "));
    }
    body
}

fn keys(keys: &[Key], comment: &str) -> String {
    let line = |key: &Key| {
        let (mark, value) = match key.default {
            "" if comment.is_empty() => ("# ", "..."),
            "" => ("", "..."),
            default => ("", default),
        };
        format!("{comment}{mark}{} = {value}  # {}: {}\n", key.name, wanted(key.kind), key.help)
    };
    keys.iter().map(line).collect()
}
