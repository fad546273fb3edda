//! From what was written to a checked [`Scenario`].

use std::path::{Path, PathBuf};

use super::{
    Catalog, Choice, Group, Output, Override, PerVehicle, Preset, Scenario, ScenarioError, Selector, Vehicle,
    document::{self, Entry, Node, Table},
    section::{Section, known, text},
    sections::SumoKeys,
};
use crate::{
    keys::{Key, Keys, Kind},
    plant::ActuatorKeys,
    registry::{self, UnknownName, find},
    sumo_files::{Demand, LeftOpen, Source, SumoFileError, SumoSetup, absolute, is_xml, ours},
};

/// The sections of a scenario file.
const SECTIONS: &[&str] = &[
    "name",
    "sumo",
    "egos",
    "controller",
    "target",
    "vehicle",
    "plant",
    "actuator",
    "noise",
    "traffic",
    "coupling",
    "output",
    "group",
];

/// The sections that a `[[group]]` may have of its own.
const GROUP_SECTIONS: &[&str] = &["select", "controller", "target", "vehicle", "actuator", "noise"];

/// What the user asked for.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// A scenario file or SUMO configuration.
    pub scenario: Option<PathBuf>,
    /// What the command line sets, in order.
    pub overrides: Vec<Override>,
}

impl Request {
    /// The request for a file as it is.
    pub fn file(path: impl Into<PathBuf>) -> Self {
        Self { scenario: Some(path.into()), overrides: Vec::new() }
    }

    /// The same request with one more override.
    #[must_use]
    pub fn with(mut self, more: Override) -> Self {
        self.overrides.push(more);
        self
    }
}

pub(super) fn load(request: &Request, catalog: &Catalog, offline: bool) -> Result<Scenario, ScenarioError> {
    let mut notes = Vec::new();
    let mut root = match &request.scenario {
        Some(path) => read(path)?,
        None => Table::new(),
    };
    for given in &request.overrides {
        forget_other_choice(&mut root, given, catalog, &mut notes);
        given.apply(&mut root)?;
    }
    known("", &root, SECTIONS)?;
    let mut scenario = resolve(request, &root, catalog, offline)?;
    scenario.inputs.splice(0..0, request.scenario.iter().map(|p| absolute(Path::new(""), p)));
    let sumo = section(&root, "sumo", "sumo")?;
    let routes = sumo.get("routes").map(|entry| entry.place.clone());
    let open = LeftOpen { seed: !sumo.contains_key("seed"), ballistic: !sumo.contains_key("ballistic") };
    let demand = Demand::check(&mut scenario.sumo, open, routes, sumo.get("end_s").map(|entry| entry.place.clone()))?;
    scenario.inputs.extend(demand.inputs);
    scenario.notes.extend(demand.notes);
    let mut seen = std::collections::BTreeSet::new();
    scenario.inputs.retain(|path| seen.insert(path.clone()));
    scenario.notes.splice(0..0, notes);
    Ok(scenario)
}

/// The tables of a scenario file; a SUMO configuration is a scenario that says nothing else.
fn read(path: &Path) -> Result<Table, ScenarioError> {
    let unreadable = |reason| ScenarioError::Unreadable { path: path.to_owned(), reason };
    let is_toml = path.extension().is_some_and(|e| e == "toml");
    let is_network = path.to_string_lossy().trim_end_matches(".gz").ends_with(".net.xml");
    if is_network {
        return Err(SumoFileError::NoRoutes { net: path.to_owned() }.into());
    }
    if !is_toml && is_xml(path)? {
        let mut root = Table::new();
        Override::text("", "sumo.config", &path.to_string_lossy()).apply(&mut root)?;
        return Ok(root);
    }
    let text = std::fs::read_to_string(path).map_err(unreadable)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    match document::parse(path.display().to_string(), text, folder)?.node {
        Node::Table(root) => Ok(root),
        _ => Ok(Table::new()),
    }
}

/// The keys of `[controller]` belong to the controller that the file names. If the command line names another, they are
/// left out, and the user is told.
fn forget_other_choice(root: &mut Table, given: &Override, catalog: &Catalog, notes: &mut Vec<String>) {
    let Some((section, "name")) = given.path.split_once('.') else { return };
    let Some((_, entries)) = catalog.registries().into_iter().find(|(kind, _)| *kind == section) else { return };
    let Some(Entry { node: Node::Table(table), .. }) = root.get_mut(section) else { return };
    let old = match table.get("name").map(|e| &e.node) {
        Some(Node::Text(name)) => name.clone(),
        _ => entries.first().map_or("", |default| default.name).to_owned(),
    };
    if given.value.trim_matches('"') == old || entries.iter().all(|e| e.name != old) {
        return;
    }
    let dropped: Vec<String> =
        table.iter().filter(|(k, e)| *k != "name" && !e.place.origin.argument).map(|(k, _)| k.clone()).collect();
    if !dropped.is_empty() {
        notes.push(format!("{}: {section}.{} belong to {old} and are not used", given.shown, dropped.join(", ")));
        table.retain(|k, _| !dropped.contains(k));
    }
}

fn resolve(request: &Request, root: &Table, catalog: &Catalog, offline: bool) -> Result<Scenario, ScenarioError> {
    let section = |name: &str| section(root, name, name);
    let (sumo, mut inputs) = sumo(&section("sumo")?, offline)?;
    let egos = section("egos")?;
    known("egos", &egos, &["select"])?;
    let plant = choice("plant", "plant", &catalog.plants, &section("plant")?, &mut inputs)?;
    let scenario = Scenario {
        name: name(request, root, &sumo)?,
        egos: selector(&egos, "egos.select")?.unwrap_or(Selector::All),
        groups: groups(root, catalog, &mut inputs)?,
        plant,
        coupling: keys("coupling", &section("coupling")?)?,
        traffic: keys("traffic", &section("traffic")?)?,
        output: output(&section("output")?)?,
        sumo,
        inputs,
        notes: Vec::new(),
    };
    whole_periods(&scenario, root)?;
    Ok(scenario)
}

/// The table of a section; nothing is an empty one.
pub(super) fn section(root: &Table, name: &str, path: &str) -> Result<Table, ScenarioError> {
    match root.get(name) {
        None => Ok(Table::new()),
        Some(Entry { node: Node::Table(table), .. }) => Ok(table.clone()),
        Some(entry) => Err(wrong(entry, path, &format!("a section [{name}]"))),
    }
}

fn wrong(entry: &Entry, key: &str, wanted: &str) -> ScenarioError {
    ScenarioError::WrongValue {
        place: entry.place.clone(),
        key: key.to_owned(),
        found: entry.node.shown(),
        wanted: wanted.to_owned(),
    }
}

/// The keys of a section.
fn keys<K: Keys>(path: &str, table: &Table) -> Result<K, ScenarioError> {
    Ok(K::from_values(&Section { path, keys: K::keys(), others: &[], spread: false }.check(table)?.values))
}

fn name(request: &Request, root: &Table, sumo: &SumoSetup) -> Result<String, ScenarioError> {
    if let Some(entry) = root.get("name") {
        let name = text(entry, "name")?;
        // The name becomes a folder of the results.
        if name.is_empty() || name.starts_with('.') || name.contains(['/', '\\']) {
            return Err(wrong(entry, "name", "a name without slashes that does not start with a dot"));
        }
        return Ok(name.to_owned());
    }
    let file = match (&request.scenario, &sumo.source) {
        (Some(path), _) | (None, Source::Config(path) | Source::Network { net: path, .. }) => path.as_path(),
        (None, Source::Running) => return Ok("running".to_owned()),
        (None, Source::Offline) => return Ok("offline".to_owned()),
    };
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let endings = [".net.xml", ".sumocfg", ".sumo.cfg", ".toml", ".xml", ".cfg"];
    let stem = endings.iter().find_map(|e| name.strip_suffix(e)).unwrap_or(name);
    Ok(if stem.is_empty() { "scenario".to_owned() } else { stem.to_owned() })
}

fn sumo(table: &Table, offline: bool) -> Result<(SumoSetup, Vec<PathBuf>), ScenarioError> {
    let keys: SumoKeys = keys("sumo", table)?;
    let source = match (keys.config, keys.net, &keys.connect) {
        (Some(config), None, _) => Source::Config(config),
        (None, Some(net), _) => Source::Network { net, routes: keys.routes, additional: keys.additional },
        (None, None, Some(_)) => Source::Running,
        (None, None, None) if offline => Source::Offline,
        (None, None, None) => return Err(ScenarioError::NoSource("nothing to run".to_owned())),
        (Some(_), Some(_), _) => {
            return Err(wrong(&table["net"], "sumo.net", "either sumo.config or sumo.net, not both"));
        }
    };
    if let (Source::Config(_) | Source::Running | Source::Offline, Some((key, entry))) =
        (&source, table.get_key_value("routes").or(table.get_key_value("additional")))
    {
        return Err(wrong(entry, &format!("sumo.{key}"), "sumo.net beside it"));
    }
    if let Some(connect) = &keys.connect
        && connect.rsplit_once(':').is_none_or(|(host, port)| host.is_empty() || port.parse::<u16>().is_err())
    {
        return Err(wrong(&table["connect"], "sumo.connect", "HOST:PORT"));
    }
    let setup = SumoSetup {
        source,
        step_length_s: keys.step_length_s,
        end_s: keys.end_s,
        seed: u64::from(keys.seed),
        ballistic: keys.ballistic,
        options: options(table, keys.options)?,
        gui: keys.gui,
        port: keys.port,
        num_clients: keys.num_clients,
        connect: keys.connect,
    };
    let inputs = match &setup.source {
        Source::Config(config) => vec![config.clone()],
        Source::Network { net, routes, additional } => {
            std::iter::once(net).chain(routes).chain(additional).cloned().collect()
        }
        Source::Running | Source::Offline => Vec::new(),
    };
    Ok((setup, inputs))
}

/// SUMO's further options, of which none is set here already.
fn options(table: &Table, options: Vec<String>) -> Result<Vec<String>, ScenarioError> {
    match (ours(&options), table.get("options")) {
        (Some((option, instead)), Some(entry)) => Err(ScenarioError::WrongValue {
            place: entry.place.clone(),
            key: "sumo.options".to_owned(),
            found: option,
            wanted: format!("{instead} in its place"),
        }),
        _ => Ok(options),
    }
}

fn output(table: &Table) -> Result<Output, ScenarioError> {
    let output: Output = keys("output", table)?;
    for (key, name) in [("vehicles", &output.vehicles), ("trace_file", &output.trace_file)] {
        let plain = !name.contains(['/', '\\']) && [".csv", ".parquet", ".xml"].iter().any(|e| name.ends_with(e));
        if !plain {
            let wanted = "a file name without folder that ends in .csv, .parquet or .xml";
            return Err(wrong(&table[key], &format!("output.{key}"), wanted));
        }
    }
    Ok(output)
}

fn selector(table: &Table, path: &str) -> Result<Option<Selector>, ScenarioError> {
    let Some(entry) = table.get("select") else { return Ok(None) };
    Selector::parse(text(entry, path)?).map(Some).map_err(|wanted| wrong(entry, path, &wanted))
}

/// What `table` picks from the entries of a kind, with the values of its keys; the first entry is the default.
fn choice<B: Clone>(
    kind: &'static str,
    path: &str,
    entries: &[registry::Entry<B>],
    table: &Table,
    inputs: &mut Vec<PathBuf>,
) -> Result<Choice<B>, ScenarioError> {
    let key = format!("{path}.name");
    let chosen = match table.get("name") {
        None => &entries[0],
        Some(entry) => {
            let name = text(entry, &key)?;
            find(kind, entries, name).map_err(|unknown| unknown_name(entry, &key, unknown))?
        }
    };
    let values = Section { path, keys: chosen.keys, others: &["name"], spread: false }.check(table)?.values;
    for key in chosen.keys.iter().filter(|k| k.kind == Kind::File) {
        inputs.extend(values.get::<PathBuf>(key.name));
    }
    Ok(Choice { entry: chosen.clone(), values })
}

fn unknown_name(entry: &Entry, key: &str, unknown: UnknownName) -> ScenarioError {
    ScenarioError::UnknownName { place: entry.place.clone(), key: key.to_owned(), unknown: Box::new(unknown) }
}

/// The `[[group]]`s, and last the one that the file's own sections describe.
fn groups(root: &Table, catalog: &Catalog, inputs: &mut Vec<PathBuf>) -> Result<Vec<Group>, ScenarioError> {
    let mut groups = Vec::new();
    let listed = match root.get("group") {
        None => &Vec::new(),
        Some(Entry { node: Node::List(list), .. }) => list,
        Some(entry) => return Err(wrong(entry, "group", "groups, each headed [[group]]")),
    };
    for (index, entry) in listed.iter().enumerate() {
        let path = format!("group.{index}");
        let Node::Table(own) = &entry.node else { return Err(wrong(entry, &path, "a table")) };
        known(&path, own, GROUP_SECTIONS)?;
        let select = selector(own, &format!("{path}.select"))?
            .ok_or_else(|| wrong(entry, &format!("{path}.select"), "a selector: select = \"type:bus*\""))?;
        groups.push(group(select, root, Some((&path, own)), catalog, inputs)?);
    }
    groups.push(group(Selector::All, root, None, catalog, inputs)?);
    Ok(groups)
}

fn group(
    select: Selector,
    root: &Table,
    own: Option<(&str, &Table)>,
    catalog: &Catalog,
    inputs: &mut Vec<PathBuf>,
) -> Result<Group, ScenarioError> {
    let path = |name: &str| own.map_or(name.to_owned(), |(path, _)| format!("{path}.{name}"));
    // A group inherits the file's section key by key, unless it chooses another name: then the keys are others too.
    let merged = |name: &str, default: Option<&str>| -> Result<Table, ScenarioError> {
        let keys = if name == "vehicle" { body_keys(catalog) } else { &[] };
        let top = undotted(section(root, name, name)?, keys);
        let Some((_, own)) = own else { return Ok(top) };
        let own = undotted(section(own, name, &path(name))?, keys);
        let named = |t: &Table| match t.get("name").map(|e| &e.node) {
            Some(Node::Text(name)) => Some(name.clone()),
            _ => None,
        };
        let inherited = named(&top).or(default.map(str::to_owned));
        let mut table = if named(&own).is_some() && named(&own) != inherited { Table::new() } else { top };
        table.extend(own);
        Ok(table)
    };
    let controllers = &catalog.controllers;
    let targets = &catalog.targets;
    let controller = merged("controller", controllers.first().map(|e| e.name))?;
    let target = merged("target", targets.first().map(|e| e.name))?;
    Ok(Group {
        select,
        controller: choice("controller", &path("controller"), controllers, &controller, inputs)?,
        target: choice("target", &path("target"), targets, &target, inputs)?,
        vehicle: vehicle(&path("vehicle"), &merged("vehicle", None)?, catalog, inputs)?,
        actuator: per_vehicle(&path("actuator"), ActuatorKeys::keys(), &[], &merged("actuator", None)?)?,
        noise: keys(&path("noise"), &merged("noise", None)?)?,
    })
}

/// The keys of a body; all presets have the same.
fn body_keys(catalog: &Catalog) -> &'static [Key] {
    catalog.bodies.first().map_or(&[], |body| body.keys)
}

/// Keys may be written with a dot in place of their first underscore, `tyre.curve` for `tyre_curve`: a table under a name that is no
/// key gives way to its entries, if all of them become keys.
fn undotted(table: Table, keys: &[Key]) -> Table {
    let is_key = |name: &str| keys.iter().any(|key| key.name == name);
    let mut flat = Table::new();
    for (name, entry) in table {
        let joined = |sub: &String| format!("{name}_{sub}");
        match entry.node {
            Node::Table(inner) if !is_key(&name) && inner.keys().all(|sub| is_key(&joined(sub))) => {
                flat.extend(inner.into_iter().map(|(sub, entry)| (joined(&sub), entry)));
            }
            node => {
                flat.entry(name).or_insert(Entry { node, place: entry.place });
            }
        }
    }
    flat
}

fn vehicle(path: &str, table: &Table, catalog: &Catalog, inputs: &mut Vec<PathBuf>) -> Result<Vehicle, ScenarioError> {
    let body = per_vehicle(path, body_keys(catalog), &["preset"], table)?;
    let preset = match table.get("preset") {
        None => Preset::ByClass(catalog.bodies.clone()),
        Some(entry) => {
            let key = format!("{path}.preset");
            let name = text(entry, &key)?;
            let found = find("body", &catalog.bodies, name).map_err(|unknown| unknown_name(entry, &key, unknown))?;
            Preset::Named(found.clone())
        }
    };
    for key in body_keys(catalog).iter().filter(|k| k.kind == Kind::File) {
        inputs.extend(body.values.get::<PathBuf>(key.name));
    }
    Ok(Vehicle { preset, body })
}

fn per_vehicle(path: &str, keys: &[Key], others: &[&str], table: &Table) -> Result<PerVehicle, ScenarioError> {
    Section { path, keys, others, spread: true }.check(table)
}

/// SUMO rounds its step to 1 ms, and a step holds whole control periods.
fn whole_periods(scenario: &Scenario, root: &Table) -> Result<(), ScenarioError> {
    let (step_s, period_s) = (scenario.sumo.step_length_s, scenario.coupling.control_period_s);
    let whole = |ratio: f64| ratio > 0.5 && (ratio - ratio.round()).abs() < 1e-6 * ratio;
    let wanted = if !whole(step_s / 0.001) {
        "a whole number of milliseconds, as SUMO has it".to_owned()
    } else if !whole(step_s / period_s) {
        format!("a whole number of control periods (coupling.control_period_s = {period_s:?})")
    } else {
        return Ok(());
    };
    let at = |name: &str, key: &str| match root.get(name).map(|e| &e.node) {
        Some(Node::Table(table)) => table.get(key).cloned(),
        _ => None,
    };
    // One of the two was given: the defaults fit each other.
    match at("sumo", "step_length_s").or_else(|| at("coupling", "control_period_s")) {
        None => Ok(()),
        Some(entry) => Err(ScenarioError::WrongValue {
            place: entry.place,
            key: "sumo.step_length_s".to_owned(),
            found: format!("{step_s:?}"),
            wanted,
        }),
    }
}
