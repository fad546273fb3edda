//! From what was written to a checked [`Scenario`].

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use super::{
    catalog::Catalog,
    document::{self, Entry, Node, Override, Table},
    error::{Mistake, ScenarioError, Wrong},
    layout::sections,
    model::{Choice, Group, Preset, Scenario, Vehicle},
    parameters,
    reader::{Reader, names},
    sections::{Egos, Named, Output},
    selector::Selector,
    trace::{Trace, TraceRows, whole},
};
use crate::{
    keys::{Key, Keys, Kind, Values},
    plant::{ActuatorKeys, BodyKeys},
    registry,
    sumo_files::{
        Demand, LeftOpen, Source, SumoFileError, SumoSetup, absolute, below_results, bounded, is_xml, ours,
        refused_of_file,
    },
};

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

impl Scenario {
    /// Reads and checks a scenario.
    ///
    /// # Errors
    /// [`ScenarioError::Mistakes`] with all mistakes, each with file, line, key, what was found and what was wanted; or
    /// files that cannot be used.
    pub fn load(request: &Request, catalog: &Catalog) -> Result<Self, ScenarioError> {
        let scenario = Self::load_offline(request, catalog)?;
        if scenario.sumo.source() == Source::Offline { Err(ScenarioError::NoSource) } else { Ok(scenario) }
    }

    /// The same for vehicles that drive without SUMO: the scenario need not name anything for SUMO to load.
    ///
    /// # Errors
    /// As [`Scenario::load`].
    pub fn load_offline(request: &Request, catalog: &Catalog) -> Result<Self, ScenarioError> {
        let root = request.scenario.as_deref().map_or(Ok(Table::new()), read)?;
        Self::of_tables(root, request, catalog)
    }

    /// Reads a resolved scenario ([`Scenario::to_toml`]); `name` is where it stands, for messages.
    ///
    /// # Errors
    /// As [`Scenario::load`].
    pub fn from_toml(name: &str, text: &str, catalog: &Catalog) -> Result<Self, ScenarioError> {
        let root = document::parse(name.to_owned(), text.to_owned(), PathBuf::new()).map_err(alone)?;
        Self::of_tables(root, &Request::default(), catalog)
    }

    fn of_tables(mut root: Table, request: &Request, catalog: &Catalog) -> Result<Self, ScenarioError> {
        let (mut reader, mut notes) = (Reader::default(), Vec::new());
        for given in &request.overrides {
            forget_other_choice(&mut root, given, catalog, &mut notes);
            reader.noted(given.apply(&mut root));
        }
        let names = sections(catalog).into_iter().map(|section| section.name);
        reader.known("", &root, &["name", "group"].into_iter().chain(names).collect::<Vec<_>>());
        let mut scenario = resolve(&mut reader, request, &root, catalog);
        reader.whole(())?;
        let own = request.scenario.iter().map(|path| absolute(Path::new(""), path));
        scenario.inputs = own.chain(files(&scenario)).collect();
        scenario.sumo.contacts.get_or_insert(scenario.groups.iter().any(Group::has_body));
        let sumo = reader.section(&root, "sumo", "sumo");
        let place = |key: &str| sumo.get(key).map(|entry| entry.place.clone());
        let open = LeftOpen { seed: !sumo.contains_key("seed"), ballistic: !sumo.contains_key("ballistic") };
        let demand = Demand::check(&mut scenario.sumo, open, place("routes"), place("end_s"))?;
        scenario.inputs.extend(demand.inputs);
        let mut seen = BTreeSet::new();
        scenario.inputs.retain(|path| seen.insert(path.clone()));
        let checked = parameters::check(&demand.params)?;
        scenario.dead_time_max_s = checked.dead_time_max_s;
        let of_options = std::mem::take(&mut scenario.notes);
        scenario.notes = [notes, of_options, demand.notes, checked.notes].concat();
        if let Some(types) = &demand.types {
            let select = reader.section(&root, "egos", "egos").get("select").cloned();
            let wanted = select.as_ref().zip(scenario.egos.misses(types));
            reader.noted(wanted.map_or(Ok(()), |(entry, wanted)| Err(entry.wrong("egos.select", wanted))));
            scenario.notes.extend(idle_groups(&scenario.groups, types));
        }
        reader.whole(())?;
        Ok(scenario)
    }
}

/// Groups of vTypes that the demand does not have.
fn idle_groups<'a>(groups: &'a [Group], types: &'a BTreeSet<String>) -> impl Iterator<Item = String> + 'a {
    let missed = |(index, group): (usize, &Group)| {
        let wanted = group.select.misses(types)?;
        Some(format!("group.{index}.select: found \"{}\", wanted {wanted}", group.select))
    };
    groups.iter().enumerate().filter_map(missed)
}

/// The tables of a scenario file; a SUMO configuration is a scenario that says nothing else.
pub(crate) fn read(path: &Path) -> Result<Table, ScenarioError> {
    let is_toml = path.extension().is_some_and(|e| e == "toml");
    if path.to_string_lossy().trim_end_matches(".gz").ends_with(".net.xml") {
        return Err(SumoFileError::NoRoutes { net: path.to_owned() }.into());
    }
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let parsed = if !is_toml && is_xml(path)? {
        let mut root = Table::new();
        Override::text("", "sumo.config", &path.to_string_lossy()).apply(&mut root).map(|()| root)
    } else {
        let unreadable = |reason| ScenarioError::Unreadable { path: path.to_owned(), reason };
        let text = std::fs::File::open(path).and_then(bounded).map_err(unreadable)?;
        document::parse(path.display().to_string(), text, folder)
    };
    parsed.map_err(alone)
}

/// The error of one mistake.
fn alone(mistake: Mistake) -> ScenarioError {
    ScenarioError::Mistakes { first: Box::new(mistake), more: Vec::new() }
}

/// The files that the scenario itself names, but for those of SUMO's configuration.
fn files(scenario: &Scenario) -> Vec<PathBuf> {
    let named = |keys: &[Key], values: &Values| -> Vec<PathBuf> {
        keys.iter().filter(|k| matches!(k.kind, Kind::File)).filter_map(|k| values.get(k.name)).collect()
    };
    let mut files: Vec<PathBuf> = scenario.sumo.files().cloned().collect();
    files.extend(named(scenario.plant.entry.keys, &scenario.plant.values));
    for group in &scenario.groups {
        files.extend(named(group.controller.entry.keys, &group.controller.values));
        files.extend(named(group.target.entry.keys, &group.target.values));
        files.extend(named(BodyKeys::keys(), &group.vehicle.body.values));
    }
    files
}

/// The keys of `[controller]` belong to the controller that the file names. If the command line names another one, the keys
/// are left out and a note says so.
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

fn resolve(reader: &mut Reader, request: &Request, root: &Table, catalog: &Catalog) -> Scenario {
    let table = |reader: &mut Reader, name: &str| reader.section(root, name, name);
    let [sumo, egos, plant, coupling, traffic, output] =
        ["sumo", "egos", "plant", "coupling", "traffic", "output"].map(|name| table(reader, name));
    let named = Named::from_values(&reader.values("", root, Named::keys(), false).values);
    let mut notes = Vec::new();
    let sumo = self::sumo(reader, &sumo, &mut notes);
    // The file's own sections come first, so that a mistake in them is not said to be a group's.
    let rest = group(reader, Selector::All, root, None, catalog);
    let mut groups = own_groups(reader, root, catalog);
    groups.push(rest);
    let scenario = Scenario {
        name: named.name.unwrap_or_else(|| name(request, &sumo)),
        egos: reader.keys::<Egos>("egos", &egos).select,
        groups,
        plant: choice(reader, "plant", "plant", &catalog.plants, &plant),
        coupling: reader.keys("coupling", &coupling),
        traffic: reader.keys("traffic", &traffic),
        output: reader.keys("output", &output),
        sumo,
        dead_time_max_s: 0.0,
        inputs: Vec::new(),
        notes,
    };
    whole_periods(reader, &scenario, root);
    names_of_their_own(reader, &scenario.output, &output);
    scenario
}

/// The name of a scenario that has none: that of its file.
fn name(request: &Request, sumo: &SumoSetup) -> String {
    let file = match (&request.scenario, sumo.source()) {
        (Some(path), _) => path.as_path(),
        (None, Source::Config(path) | Source::Network(path)) => path,
        (None, Source::Running) => return "running".to_owned(),
        (None, Source::Offline) => return "offline".to_owned(),
    };
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let endings = [".net.xml", ".sumocfg", ".sumo.cfg", ".toml", ".xml", ".cfg"];
    let stem = endings.iter().find_map(|e| name.strip_suffix(e)).unwrap_or(name);
    if stem.is_empty() { "scenario".to_owned() } else { stem.to_owned() }
}

fn sumo(reader: &mut Reader, table: &Table, notes: &mut Vec<String>) -> SumoSetup {
    let mut setup: SumoSetup = reader.keys("sumo", table);
    match (table.contains_key("config"), table.get("net")) {
        (true, Some(net)) => reader.note(net.wrong("sumo.net", "either sumo.config or sumo.net, not both")),
        (_, Some(_)) => {}
        (_, None) => {
            for key in ["routes", "additional"] {
                if let Some(entry) = table.get(key) {
                    reader.note(entry.wrong(&format!("sumo.{key}"), "sumo.net beside it"));
                }
            }
        }
    }
    if let (Some((found, instead)), Some(entry)) = (ours(&setup.options), table.get("options")) {
        let what = Wrong::Value { found, wanted: format!("{instead} in its place") };
        reader.note(Mistake { place: entry.place.clone(), key: "sumo.options".to_owned(), what });
    }
    // A scenario may come from a stranger; what the user types is the user's own affair.
    if let Some(entry) = table.get("options").filter(|entry| !entry.place.origin.argument) {
        if let Some((found, wanted)) = refused_of_file(&setup.options) {
            let what = Wrong::Value { found, wanted: wanted.to_owned() };
            reader.note(Mistake { place: entry.place.clone(), key: "sumo.options".to_owned(), what });
        }
        let told;
        (setup.options, told) = below_results(&setup.options);
        notes.extend(
            told.into_iter().map(|line| format!("{}: sumo.options: {line} (behind -- any place goes)", entry.place)),
        );
    }
    setup
}

/// What `table` picks from the entries of a kind, with the values of its keys; the first entry is the default.
fn choice<B: Clone>(
    reader: &mut Reader,
    kind: &'static str,
    path: &str,
    entries: &[registry::Entry<B>],
    table: &Table,
) -> Choice<B> {
    let named = reader.named(kind, entries, table, (path, "name"));
    if named.is_none() && table.contains_key("name") {
        // Nobody knows which keys an unknown entry takes.
        return Choice { entry: entries[0].clone(), values: Values::default() };
    }
    let entry = named.unwrap_or_else(|| entries[0].clone());
    reader.known(path, table, &names(&["name"], entry.keys));
    let values = reader.values(path, table, entry.keys, false).values;
    Choice { entry, values }
}

/// The `[[group]]`s.
fn own_groups(reader: &mut Reader, root: &Table, catalog: &Catalog) -> Vec<Group> {
    let listed = match root.get("group") {
        None => return Vec::new(),
        Some(Entry { node: Node::List(list), .. }) => list,
        Some(entry) => {
            reader.note(entry.wrong("group", "groups, each headed [[group]]"));
            return Vec::new();
        }
    };
    let names = sections(catalog).into_iter().filter(|s| s.grouped).map(|section| section.name);
    let names: Vec<&str> = ["select"].into_iter().chain(names).collect();
    let mut groups = Vec::new();
    for (index, entry) in listed.iter().enumerate() {
        let path = format!("group.{index}");
        let Node::Table(own) = &entry.node else {
            reader.note(entry.wrong(&path, "a table"));
            continue;
        };
        reader.known(&path, own, &names);
        if !own.contains_key("select") {
            reader.note(entry.wrong(&format!("{path}.select"), "a selector: select = \"type:bus*\""));
        }
        let select = Egos::from_values(&reader.values(&path, own, Egos::keys(), false).values).select;
        groups.push(group(reader, select, root, Some((&path, own)), catalog));
    }
    groups
}

/// One group, or what the file's own sections describe.
fn group(reader: &mut Reader, select: Selector, root: &Table, own: Option<(&str, &Table)>, catalog: &Catalog) -> Group {
    let path = |name: &str| own.map_or(name.to_owned(), |(path, _)| format!("{path}.{name}"));
    // A group inherits the file's section key by key, unless it chooses another name: then the keys are others too.
    let merged = |reader: &mut Reader, name: &str, default: Option<&str>| -> Table {
        let keys = if name == "vehicle" { BodyKeys::keys() } else { &[] };
        let top = undotted(reader.section(root, name, name), keys);
        let Some((_, own)) = own else { return top };
        let own = undotted(reader.section(own, name, &path(name)), keys);
        let named = |t: &Table| match t.get("name").map(|e| &e.node) {
            Some(Node::Text(name)) => Some(name.clone()),
            _ => None,
        };
        let inherited = named(&top).or(default.map(str::to_owned));
        let mut table = if named(&own).is_some() && named(&own) != inherited { Table::new() } else { top };
        table.extend(own);
        table
    };
    let (controllers, targets) = (&catalog.controllers, &catalog.targets);
    let controller = merged(reader, "controller", controllers.first().map(|e| e.name));
    let target = merged(reader, "target", targets.first().map(|e| e.name));
    let [vehicle, actuator, noise] = ["vehicle", "actuator", "noise"].map(|name| merged(reader, name, None));
    reader.known(&path("actuator"), &actuator, &names(&[], ActuatorKeys::keys()));
    Group {
        select,
        controller: choice(reader, "controller", &path("controller"), controllers, &controller),
        target: choice(reader, "target", &path("target"), targets, &target),
        vehicle: self::vehicle(reader, &path("vehicle"), &vehicle, catalog),
        actuator: reader.values(&path("actuator"), &actuator, ActuatorKeys::keys(), true),
        noise: reader.keys(&path("noise"), &noise),
    }
}

/// A key may be written with a dot in place of its first underscore, `tyre.curve` for `tyre_curve`. A table under a name
/// that is no key gives way to its entries, if all of them become keys.
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

fn vehicle(reader: &mut Reader, path: &str, table: &Table, catalog: &Catalog) -> Vehicle {
    reader.known(path, table, &names(&["preset"], BodyKeys::keys()));
    let preset = reader.named("body", &catalog.bodies, table, (path, "preset"));
    let preset = preset.map_or_else(|| Preset::ByClass(catalog.bodies.clone()), Preset::Named);
    Vehicle { preset, body: reader.values(path, table, BodyKeys::keys(), true) }
}

/// No table of the result takes the name of another one.
fn names_of_their_own(reader: &mut Reader, output: &Output, table: &Table) {
    let traced = output.trace != Trace::None;
    let named = [("vehicles", Some(&output.vehicles)), ("trace_file", traced.then_some(&output.trace_file))];
    let quality = output.quality.then_some("quality.csv");
    let mut taken: Vec<&str> = ["edges.csv", "sample.csv"].into_iter().chain(quality).collect();
    for (key, name) in named {
        let Some(name) = name else { continue };
        // One of two keys may keep its default; then the other one is wrong.
        let set = [key, "vehicles"].into_iter().find_map(|key| Some((key, table.get(key)?)));
        if let (true, Some((key, entry))) = (taken.contains(&name.as_str()), set) {
            let wanted = format!("another name: the results have one {name} already");
            reader.note(entry.wrong(&format!("output.{key}"), wanted));
        }
        taken.push(name);
    }
}

/// SUMO rounds its step to 1 ms, a step holds whole control periods, and rows of a trace fall on their ends.
fn whole_periods(reader: &mut Reader, scenario: &Scenario, root: &Table) {
    let (step_s, period_s) = (scenario.sumo.step_length_s, scenario.coupling.control_period_s);
    let at = |name: &str, key: &str| match root.get(name).map(|e| &e.node) {
        Some(Node::Table(table)) => table.get(key),
        _ => None,
    };
    let (step, period, trace) =
        (at("sumo", "step_length_s"), at("coupling", "control_period_s"), at("output", "trace_period_s"));
    if [step, period, trace].into_iter().flatten().any(|entry| reader.refused(entry)) {
        return;
    }
    let mut note = |entry: Option<&Entry>, key: &str, found: f64, wanted: String| {
        if let Some(entry) = entry {
            let what = Wrong::Value { found: format!("{found:?}"), wanted };
            reader.note(Mistake { place: entry.place.clone(), key: key.to_owned(), what });
        }
    };
    // One of step and period was given: the defaults fit each other.
    if whole(step_s / 0.001).is_none() {
        let wanted = "a whole number of milliseconds, as SUMO has it".to_owned();
        note(step.or(period), "sumo.step_length_s", step_s, wanted);
    } else if whole(step_s / period_s).is_none() {
        let wanted = format!("a whole number of control periods (coupling.control_period_s = {period_s:?})");
        note(step.or(period), "sumo.step_length_s", step_s, wanted);
    } else if let (Some(trace_s), true) = (scenario.output.trace_period_s, scenario.sumo.connect.is_none())
        && let Err(wanted) = TraceRows::every(trace_s, step_s, period_s)
    {
        note(trace, "output.trace_period_s", trace_s, wanted);
    }
}
