//! Whether the files that SUMO is going to load are there and hold any traffic, checked before SUMO is started because
//! the answer then names the line that names the file.

use std::{
    collections::BTreeSet,
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use super::{
    error::SumoFileError,
    include::Files,
    options::{INPUTS, objection},
    path::absolute,
    redirect::{refuse_sockets, writes_file},
    sampling::Sampling,
    settings::Settings,
    setup::{Source, SumoSetup},
    xml::Element,
};
use crate::place::Place;

/// Elements that put somebody on the road.
const TRAFFIC: &[&str] = &["vehicle", "trip", "flow", "person", "personFlow", "container", "containerFlow"];

/// Elements that carry parameters of vehicles.
pub(super) const CARRIERS: &[&str] = &["vehicle", "trip", "flow", "vType"];

/// A parameter of ours in the demand.
#[derive(Debug)]
pub(crate) struct Param {
    /// The file.
    pub path: PathBuf,
    /// The line, from 1.
    pub line: usize,
    /// Its key.
    pub key: String,
    /// Its value.
    pub value: String,
}

/// What was found in the files that SUMO is going to load.
#[derive(Debug, Default)]
pub(crate) struct Demand {
    /// Every file, absolute.
    pub inputs: Vec<PathBuf>,
    /// What the user should be told.
    pub notes: Vec<String>,
    /// The ids of all vTypes; none if there may be more of them than the files name.
    pub types: Option<BTreeSet<String>>,
    /// The parameters of vehicles and vTypes whose keys speak of `mfc`.
    pub params: Vec<Param>,
    /// The first vType that moves by SUMO's train model.
    train: Option<String>,
}

/// What the scenario leaves to the configuration.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LeftOpen {
    /// SUMO's seed.
    pub seed: bool,
    /// The stepping method.
    pub ballistic: bool,
}

impl Demand {
    /// Checks the inputs of SUMO, and settles what the scenario leaves open; `routes` is where it names its route files,
    /// `end` where it sets its end.
    pub fn check(
        setup: &mut SumoSetup,
        open: LeftOpen,
        routes: Option<Place>,
        end: Option<Place>,
    ) -> Result<Self, SumoFileError> {
        let settings = Settings::read(setup)?;
        let mut found = Self::default();
        if matches!(setup.source(), Source::Running | Source::Offline) {
            return Ok(found);
        }
        found.add_named(&settings)?;
        refuse(setup, &settings, end)?;
        let (additional, files) = (settings.files("additional-files"), settings.files("route-files"));
        found.types = Some(BTreeSet::new());
        let traffic = found.add_read(files.iter().chain(&additional))?;
        // Other clients, files given as options of SUMO, and a saved state bring traffic that is not seen here.
        let may_be_empty = setup.num_clients > 1
            || INPUTS.iter().any(|option| settings.given.contains_key(*option))
            || settings.value("load-state").is_some()
            || setup.load_state.is_some();
        if !traffic && !may_be_empty {
            return Err(match (routes.map(|place| (place, "sumo.routes".to_owned())), settings.place("route-files")) {
                (Some((place, key)), _) | (None, Some((place, key))) => empty(place, key, &files),
                (None, None) => SumoFileError::NoRoutes { net: settings.files("net-file").swap_remove(0) },
            });
        }
        found.types = found.types.filter(|_| !may_be_empty);
        found.settle(setup, open, &settings);
        Ok(found)
    }

    /// Adds the files that options name. Those of the scenario itself are known to exist.
    fn add_named(&mut self, settings: &Settings) -> Result<(), SumoFileError> {
        for option in INPUTS {
            let Some((place, key)) = settings.place(option) else { continue };
            for path in settings.files(option) {
                if !path.is_file() {
                    return Err(SumoFileError::MissingFile { place, key, path });
                }
                self.inputs.push(path);
            }
        }
        match &settings.configuration {
            Some(configuration) if settings.files("net-file").is_empty() && settings.value("load-state").is_none() => {
                Err(SumoFileError::NoNetwork(PathBuf::from(&configuration.origin.name)))
            }
            _ => Ok(()),
        }
    }

    /// Fills what the scenario leaves open, and notes what it changes in its configuration.
    fn settle(&mut self, setup: &mut SumoSetup, open: LeftOpen, settings: &Settings) {
        let theirs = settings.value("seed").and_then(|seed| seed.parse().ok());
        if let (true, Some(seed)) = (open.seed, theirs) {
            setup.seed = seed;
        }
        let default = || settings.value("default.carfollowmodel").filter(|model| *model == "Rail");
        let train = self.train.take().map(|id| format!("the vType \"{id}\" has carFollowModel=\"Rail\""));
        let train = train.or_else(|| Some(format!("default.carfollowmodel is {}", default()?)));
        if let Some(train) = train.filter(|_| open.ballistic && setup.ballistic && setup.connect.is_none()) {
            setup.ballistic = false;
            self.notes.push(format!("Euler steps: {train}, and trains know no others (--set sumo.ballistic decides)"));
        }
        self.notes.extend(overridden(setup, theirs, settings));
    }

    /// Adds the files that demand and additional files read: those that they include, and definitions of single elements.
    /// Returns whether there is traffic in any of them. A file that breaks off counts as traffic: SUMO says what is wrong
    /// with it.
    fn add_read<'a>(&mut self, files: impl Iterator<Item = &'a PathBuf>) -> Result<bool, SumoFileError> {
        let mut reader = Files::default();
        let (mut traffic, mut refused) = (false, Ok(()));
        for file in files {
            let whole = reader.each(file, &mut |file, element| {
                refused = refuse_sockets(file, element);
                if refused.is_err() {
                    return ControlFlow::Break(());
                }
                traffic |= TRAFFIC.contains(&element.name());
                if let ("vType", Some(types)) = (element.name(), &mut self.types) {
                    types.extend(element.attribute("id"));
                }
                self.params.extend(ours(file, element));
                if self.train.is_none() && moves_by_rail(element) {
                    self.train = element.attribute("id");
                }
                let folder = file.parent().unwrap_or(Path::new(""));
                for name in ["href", "file"] {
                    let named = element.attribute(name).filter(|_| !writes_file(element.name(), name));
                    self.inputs.extend(named.map(|v| absolute(folder, Path::new(&v))).filter(|p| p.is_file()));
                }
                ControlFlow::Continue(())
            })?;
            std::mem::replace(&mut refused, Ok(()))?;
            traffic |= !whole;
        }
        Ok(traffic)
    }
}

/// The parameter of ours that an element is.
fn ours(file: &Path, element: &Element<'_>) -> Option<Param> {
    if element.name() != "param" || !CARRIERS.contains(&element.parent) {
        return None;
    }
    let key = element.attribute("key").filter(|key| key.split('.').any(|part| part == "mfc"))?;
    let value = element.attribute("value").unwrap_or_default();
    Some(Param { path: file.to_owned(), line: element.line, key, value })
}

/// Whether an element is a vType with SUMO's train model.
fn moves_by_rail(element: &Element<'_>) -> bool {
    element.name() == "vType" && element.attribute("carFollowModel").is_some_and(|model| model == "Rail")
}

/// Refuses what makes no sense: another kind of simulation, and an end before the begin.
fn refuse(setup: &SumoSetup, settings: &Settings, end: Option<Place>) -> Result<(), SumoFileError> {
    let theirs = settings
        .configuration
        .iter()
        .flat_map(|configuration| configuration.settings.iter().map(|setting| (configuration.place(setting), setting)));
    // What stands behind `--` replaces the configuration's.
    for (place, setting) in theirs.filter(|(_, setting)| !settings.given.contains_key(&setting.name)) {
        if let Some(wanted) = objection(&setting.name, &setting.value) {
            let (key, found) = (setting.written.clone(), setting.value.clone());
            return Err(SumoFileError::Setting { place, key, found, wanted: wanted.to_owned() });
        }
    }
    if let Some((place, key)) = settings.place("mesosim").filter(|_| settings.is_on("mesosim")) {
        let (found, wanted) =
            ("true".to_owned(), "false: SUMO's mesoscopic vehicles have no speed to follow".to_owned());
        return Err(SumoFileError::Setting { place, key, found, wanted });
    }
    let begin_s = settings.time_s("begin").unwrap_or(0.0);
    match (setup.end_s, end) {
        (Some(end_s), Some(place)) if end_s <= begin_s => Err(SumoFileError::Setting {
            place,
            key: "sumo.end_s".to_owned(),
            found: end_s.to_string(),
            wanted: format!("more than {begin_s}, where the simulation begins"),
        }),
        _ => Ok(()),
    }
}

/// What the scenario changes in its configuration, in one line.
fn overridden(setup: &SumoSetup, seed: Option<u64>, settings: &Settings) -> Option<String> {
    // A SUMO that runs already has started with its own options.
    let configuration = settings.configuration.as_ref().filter(|_| setup.connect.is_none())?;
    let step_s = settings.step_s();
    let ballistic = settings.is_on("step-method.ballistic");
    let mut changes = Vec::new();
    if step_s != Some(setup.step_length_s) {
        let theirs = step_s.map_or("unreadable".to_owned(), |s| format!("{s} s"));
        changes.push(format!(
            "step length {} s instead of {theirs} (--step-length decides; alone it changed mean time losses by -26 to +81 % \
             in docs/matrix.md, sweep --vary controller.name=plain,ideal shows by how much here)",
            setup.step_length_s
        ));
        changes.extend(Sampling::of(settings, setup.step_length_s).notes());
    }
    if ballistic != setup.ballistic {
        let (ours, theirs) = if ballistic { ("Euler", "ballistic") } else { ("ballistic", "Euler") };
        changes.push(format!("{ours} steps instead of {theirs} (--set sumo.ballistic decides)"));
    }
    if settings.is_on("random") {
        changes.push(format!("seed {} instead of a random one (--seed decides)", setup.seed));
    } else if let Some(theirs) = seed.filter(|seed| *seed != setup.seed) {
        changes.push(format!("seed {} instead of {theirs} (--seed decides)", setup.seed));
    }
    let clients = settings.value("num-clients").filter(|clients| *clients != setup.num_clients.to_string());
    if let Some(theirs) = clients {
        changes.push(format!("{} TraCI clients instead of {theirs} (--num-clients decides)", setup.num_clients));
    }
    if let Some(teleports) = settings.value("max-num-teleports").filter(|n| n.parse() != Ok(-1)) {
        changes
            .push(format!("no end after {teleports} teleports (SUMO heeds max-num-teleports only without a client)"));
    }
    match settings.value("collision.mingap-factor") {
        None if setup.contacts == Some(true) => changes.push(
            "collisions are contacts instead of gaps below minGap (-- --collision.mingap-factor decides)".to_owned(),
        ),
        Some(factor) if setup.contacts == Some(true) && factor.parse() != Ok(0.0) => {
            changes.push(format!("collisions are gaps below {factor} minGap, as it says (0 counts contacts)"));
        }
        _ => {}
    }
    (!changes.is_empty()).then(|| format!("{}: {}", configuration.origin.name, changes.join(", ")))
}

fn empty(place: Place, key: String, files: &[PathBuf]) -> SumoFileError {
    let files = files.iter().map(|f| f.display().to_string()).collect::<Vec<_>>().join(", ");
    SumoFileError::EmptyDemand { place, key, files }
}
