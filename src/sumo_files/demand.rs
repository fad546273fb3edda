//! Whether the files that SUMO is going to load are there and hold any traffic, checked before SUMO is started because
//! the answer then names the line that names the file.

use std::{
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use super::{
    configuration::Configuration,
    error::SumoFileError,
    include::Files,
    options::{INPUTS, given, is_true, list},
    path::absolute,
    redirect::writes_file,
    setup::{Source, SumoSetup},
};
use crate::place::Place;

/// Elements that put somebody on the road.
const TRAFFIC: &[&str] = &["vehicle", "trip", "flow", "person", "personFlow", "container", "containerFlow"];

/// What was found in the files that SUMO is going to load.
#[derive(Debug, Default)]
pub(crate) struct Demand {
    /// Every file, absolute.
    pub inputs: Vec<PathBuf>,
    /// What the user should be told.
    pub notes: Vec<String>,
}

impl Demand {
    /// Checks the inputs of SUMO; `routes` is where the scenario names its route files.
    pub fn check(setup: &SumoSetup, routes: Option<Place>) -> Result<Self, SumoFileError> {
        let given = given(&setup.options);
        let files = INPUTS.iter().filter_map(|(option, _)| given.get(*option)).flat_map(|value| list(value));
        let inputs = files.map(|f| absolute(Path::new(""), Path::new(f))).filter(|f| f.is_file()).collect();
        let mut found = Self { inputs, notes: Vec::new() };
        // Other clients and files given as options of SUMO may bring traffic that is not seen here.
        let may_be_empty = setup.num_clients > 1 || INPUTS.iter().any(|(option, _)| given.contains_key(*option));
        match &setup.source {
            Source::Running | Source::Offline => {}
            Source::Config(path) => found.configuration(setup, path, may_be_empty)?,
            Source::Network { net, routes: files, additional } => {
                let traffic = found.add_read(files.iter().chain(additional))?;
                if !may_be_empty && !traffic {
                    return Err(match routes {
                        Some(place) => empty(place, "sumo.routes", files),
                        None => SumoFileError::NoRoutes { net: net.clone() },
                    });
                }
            }
        }
        Ok(found)
    }

    fn configuration(&mut self, setup: &SumoSetup, path: &Path, may_be_empty: bool) -> Result<(), SumoFileError> {
        let configuration = Configuration::read(path)?;
        for (option, _) in INPUTS {
            let Some(setting) = configuration.get(option) else { continue };
            for file in configuration.files(option) {
                if !file.is_file() {
                    let (place, key) = (configuration.place(setting), setting.written.clone());
                    return Err(SumoFileError::MissingFile { place, key, path: file });
                }
                self.inputs.push(file);
            }
        }
        let net = configuration.files("net-file");
        if net.is_empty() && configuration.get("load-state").is_none() {
            return Err(SumoFileError::NoNetwork(path.to_owned()));
        }
        let additional = configuration.files("additional-files");
        let routes = configuration.files("route-files");
        let traffic = self.add_read(routes.iter().chain(&additional))?;
        self.notes.extend(overridden(setup, &configuration));
        // A saved state brings its vehicles along.
        if may_be_empty || traffic || configuration.get("load-state").is_some() {
            return Ok(());
        }
        Err(match configuration.get("route-files") {
            Some(setting) => empty(configuration.place(setting), &setting.written, &routes),
            None => SumoFileError::NoRoutes { net: net[0].clone() },
        })
    }

    /// Adds the files that demand and additional files read: those that they include, and definitions of single elements.
    /// Returns whether there is traffic in any of them. A file that breaks off counts as traffic: SUMO says what is wrong
    /// with it.
    fn add_read<'a>(&mut self, files: impl Iterator<Item = &'a PathBuf>) -> Result<bool, SumoFileError> {
        let mut reader = Files::default();
        let mut traffic = false;
        for file in files {
            let whole = reader.each(file, &mut |file, element| {
                traffic |= TRAFFIC.contains(&element.name());
                let folder = file.parent().unwrap_or(Path::new(""));
                for name in ["href", "file"] {
                    let named = element.attribute(name).filter(|_| !writes_file(element.name(), name));
                    self.inputs.extend(named.map(|v| absolute(folder, Path::new(&v))).filter(|p| p.is_file()));
                }
                ControlFlow::Continue(())
            })?;
            traffic |= !whole;
        }
        Ok(traffic)
    }
}

/// What the scenario changes in its configuration, in one line.
fn overridden(sumo: &SumoSetup, configuration: &Configuration) -> Option<String> {
    let step_s = configuration.value("step-length").map_or(Some(1.0), |v| v.parse::<f64>().ok());
    let ballistic = configuration.value("step-method.ballistic").is_some_and(is_true);
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
    (!changes.is_empty()).then(|| format!("{}: {}", configuration.origin.name, changes.join(", ")))
}

fn empty(place: Place, key: &str, files: &[PathBuf]) -> SumoFileError {
    let files = files.iter().map(|f| f.display().to_string()).collect::<Vec<_>>().join(", ");
    SumoFileError::EmptyDemand { place, key: key.to_owned(), files }
}
