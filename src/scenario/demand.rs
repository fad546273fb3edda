//! Whether the files that SUMO is going to load are there and hold any traffic, checked before SUMO is started because
//! the answer then names the line that names the file.

use std::path::{Path, PathBuf};

use quick_xml::{Reader, events::Event};

use super::{
    Scenario, ScenarioError, Source,
    document::{Node, Table},
    error::Place,
    redirect::{self, is_compressed},
    section::absolute,
    sumo_arguments::given,
    sumocfg::{Configuration, INPUTS, is_true, list},
};

/// Elements that put somebody on the road, or somebody else's file in place.
const TRAFFIC: &[&str] = &["vehicle", "trip", "flow", "person", "personFlow", "container", "containerFlow", "include"];

/// Checks the inputs of SUMO, adds them to the scenario's inputs and notes what is overridden.
pub(super) fn check(scenario: &mut Scenario, root: &Table) -> Result<(), ScenarioError> {
    let given = given(&scenario.sumo.options);
    let files = INPUTS.iter().filter_map(|(option, _)| given.get(*option)).flat_map(|value| list(value));
    scenario.inputs.extend(files.map(|f| absolute(Path::new(""), Path::new(f))).filter(|f| f.is_file()));
    // Other clients and files given as options of SUMO may bring traffic that is not seen here.
    let may_be_empty = scenario.sumo.num_clients > 1 || INPUTS.iter().any(|(option, _)| given.contains_key(*option));
    match scenario.sumo.source.clone() {
        Source::Running | Source::Offline => Ok(()),
        Source::Config(path) => configuration(scenario, &path, may_be_empty),
        Source::Network { net, routes, additional } => {
            add_included(scenario, &additional)?;
            if may_be_empty || any_traffic(routes.iter().chain(&additional)) {
                return Ok(());
            }
            let named = match root.get("sumo").map(|e| &e.node) {
                Some(Node::Table(sumo)) => sumo.get("routes"),
                _ => None,
            };
            match named {
                Some(entry) => Err(empty(entry.place.clone(), "sumo.routes", &routes)),
                None => Err(ScenarioError::NoRoutes { net }),
            }
        }
    }
}

fn configuration(scenario: &mut Scenario, path: &Path, may_be_empty: bool) -> Result<(), ScenarioError> {
    let configuration = Configuration::read(path)?;
    for (option, _) in INPUTS {
        let Some(setting) = configuration.get(option) else { continue };
        for file in configuration.files(option) {
            if !file.is_file() {
                let (place, key) = (configuration.place(setting), setting.written.clone());
                return Err(ScenarioError::MissingFile { place, key, path: file });
            }
            scenario.inputs.push(file);
        }
    }
    let net = configuration.files("net-file");
    if net.is_empty() && configuration.get("load-state").is_none() {
        return Err(ScenarioError::NoSource(path.display().to_string()));
    }
    let additional = configuration.files("additional-files");
    add_included(scenario, &additional)?;
    notes(scenario, &configuration);
    let routes = configuration.files("route-files");
    // A saved state brings its vehicles along.
    if may_be_empty || configuration.get("load-state").is_some() || any_traffic(routes.iter().chain(&additional)) {
        return Ok(());
    }
    match configuration.get("route-files") {
        Some(setting) => Err(empty(configuration.place(setting), &setting.written, &routes)),
        None => Err(ScenarioError::NoRoutes { net: net[0].clone() }),
    }
}

fn add_included(scenario: &mut Scenario, additional: &[PathBuf]) -> Result<(), ScenarioError> {
    for file in additional {
        if is_compressed(file) {
            scenario
                .notes
                .push(format!("{}: compressed, so files that it has SUMO write stay where it says", file.display()));
            continue;
        }
        scenario.inputs.extend(redirect::included(file)?);
    }
    Ok(())
}

/// What the configuration wants otherwise.
fn notes(scenario: &mut Scenario, configuration: &Configuration) {
    let step_s = configuration.value("step-length").map_or(Some(1.0), |v| v.parse::<f64>().ok());
    let ballistic = configuration.value("step-method.ballistic").is_some_and(is_true);
    let sumo = &scenario.sumo;
    let mut changes = Vec::new();
    if step_s != Some(sumo.step_length_s) {
        let theirs = step_s.map_or("unreadable".to_owned(), |s| format!("{s} s"));
        changes.push(format!("step length {} s instead of {theirs} (--step-length decides)", sumo.step_length_s));
    }
    if ballistic != sumo.ballistic {
        let (ours, theirs) = if ballistic { ("Euler", "ballistic") } else { ("ballistic", "Euler") };
        changes.push(format!("{ours} steps instead of {theirs} (--set sumo.ballistic decides)"));
    }
    if configuration.value("random").is_some_and(is_true) {
        changes.push(format!("seed {} instead of a random one", sumo.seed));
    }
    if !changes.is_empty() {
        scenario.notes.push(format!("{}: {}", configuration.origin.name, changes.join(", ")));
    }
}

fn empty(place: Place, key: &str, files: &[PathBuf]) -> ScenarioError {
    let files = files.iter().map(|f| f.display().to_string()).collect::<Vec<_>>().join(", ");
    ScenarioError::EmptyDemand { place, key: key.to_owned(), files }
}

fn any_traffic<'a>(files: impl IntoIterator<Item = &'a PathBuf>) -> bool {
    files.into_iter().any(|f| has_traffic(f))
}

/// Whether a file has traffic in it. It is read up to the first vehicle only. What cannot be read here (compressed,
/// broken) counts as traffic: SUMO says what is wrong with it.
fn has_traffic(file: &Path) -> bool {
    if is_compressed(file) {
        return true;
    }
    let Ok(mut reader) = Reader::from_file(file) else { return true };
    let mut buffer = Vec::new();
    loop {
        match reader.read_event_into(&mut buffer) {
            Ok(Event::Start(tag) | Event::Empty(tag)) if TRAFFIC.contains(&tag.name().as_ref()) => return true,
            Ok(Event::Eof) => return false,
            Ok(_) => buffer.clear(),
            Err(_) => return true,
        }
    }
}
