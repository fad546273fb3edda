//! The command line of SUMO. SUMO refuses an option that is given twice, so what the user gives replaces what we would.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use super::{
    configuration::Configuration,
    error::SumoFileError,
    options::{AFFIXES, given, is_no_file, list, placed, without, writes},
    path::absolute,
    redirect::Redirect,
    sampling::Sampling,
    settings::Settings,
    setup::{Source, SumoSetup},
    state::state_time,
};

/// Options that the scenario has keys for, or that the exchange needs: SUMO's option, what to use instead.
const OURS: &[(&str, &str)] = &[
    ("configuration-file", "the scenario or sumo.config"),
    ("net-file", "--net or sumo.net"),
    ("route-files", "--routes or sumo.routes"),
    ("step-length", "--step-length or sumo.step_length_s"),
    ("end", "--end or sumo.end_s"),
    ("seed", "--seed or sumo.seed"),
    ("random", "--seed or sumo.seed"),
    ("step-method.ballistic", "sumo.ballistic"),
    ("remote-port", "--port or sumo.port"),
    ("num-clients", "--num-clients or sumo.num_clients"),
];

/// SUMO's SSM device in every vehicle, for the measures that are common in safety studies; thresholds are SUMO's own.
const SAFETY: [(&str, &str); 4] = [
    ("device.ssm.probability", "1"),
    ("device.ssm.measures", "TTC DRAC PET"),
    ("device.ssm.thresholds", "3.0 3.0 2.0"),
    ("device.ssm.trajectories", "false"),
];

/// The generic parameters by which egos show their error [m/s], torque \[N·m\] and α̂/α_nominal in SUMO's FCD output.
pub const SIGNALS: [&str; 3] = ["mfc.err", "mfc.torque", "mfc.alpha"];

/// How to start SUMO, and what it will leave behind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SumoCommand {
    /// All arguments but `--remote-port`.
    pub arguments: Vec<String>,
    /// SUMO's statistic output.
    pub statistics: PathBuf,
    /// SUMO's tripinfo output.
    pub tripinfo: PathBuf,
    /// SUMO's log.
    pub log: PathBuf,
    /// The log of SUMO's SSM devices, where vehicles have them.
    pub conflicts: PathBuf,
}

/// Builds SUMO's command line. What the configuration or its additional files would write elsewhere goes to `out_dir`/sumo,
/// where rewritten copies of such additional files are left.
///
/// # Errors
/// A file that cannot be read or written.
pub fn sumo_arguments(setup: &SumoSetup, out_dir: &Path) -> Result<SumoCommand, SumoFileError> {
    let folder = absolute(Path::new(""), &out_dir.join("sumo"));
    if setup.connect.is_none() && folder.to_string_lossy().contains(':') {
        return Err(SumoFileError::Colon(folder));
    }
    let mut redirect = Redirect::new(&folder);
    let mut options = placed(&setup.options, |name| redirect.target(&folder, name));
    let setup = &SumoSetup { options: options.clone(), ..setup.clone() };
    let settings = Settings::read(setup)?;
    let mut line = Line { arguments: Vec::new(), given: settings.given.clone() };
    let mut outputs = BTreeMap::new();
    if let Source::Config(path) = setup.source() {
        line.push("configuration-file", &path.to_string_lossy());
    }
    if let Some(configuration) = &settings.configuration {
        outputs = configured(&mut line, configuration, &mut redirect);
    }
    options = loading(&mut line, setup, &settings, (&mut redirect, options))?;
    if let Some(state) = &setup.load_state {
        line.push("begin", &state_time(state)?);
    }
    stepping(&mut line, setup, &settings);
    if setup.fcd {
        options = with_signals(&mut line, options, &settings);
    }
    line.push("no-step-log", "true");
    if setup.gui {
        line.push("start", "true");
        line.push("quit-on-end", "true");
    }
    let mut ours = |option: &str, file: &str| {
        let path = outputs.get(option).cloned().unwrap_or_else(|| {
            let path = redirect.own(file);
            line.push(option, &path.to_string_lossy());
            path
        });
        line.written(option, path)
    };
    let statistics = ours("statistic-output", "statistics.xml");
    let log = ours("log", "sumo.log");
    // Vehicles may bring this device along in their parameters; without a name its file lands beside the configuration.
    // A name of their own would win over this one: it is changed in copies of the files that give it.
    let conflicts = ours("device.ssm.file", "ssm.xml");
    let tripinfo = ours("tripinfo-output", "tripinfo.xml");
    if setup.fcd {
        ours("fcd-output", "fcd.xml");
    }
    if !outputs.contains_key("tripinfo-output") {
        line.push("tripinfo-output.write-unfinished", "true");
    }
    let mut arguments = line.arguments;
    arguments.extend(options);
    Ok(SumoCommand { arguments, statistics, tripinfo, log, conflicts })
}

/// What SUMO loads: the files themselves, or the copies of those that name outputs. Returns the user's options without
/// the files that copies replace.
fn loading(
    line: &mut Line,
    setup: &SumoSetup,
    settings: &Settings,
    (redirect, mut options): (&mut Redirect, Vec<String>),
) -> Result<Vec<String>, SumoFileError> {
    // A saved state has vTypes and vehicles with devices that write; the settings of the window may ask for snapshots.
    let windowed = ["gui-settings-file", "alternative-net-file"].into_iter().filter(|_| setup.gui);
    let always = ["net-file", "route-files", "additional-files", "load-state"];
    for option in always.into_iter().chain(windowed) {
        let named = match &setup.load_state {
            Some(state) if option == "load-state" => vec![state.clone()],
            _ => settings.files(option),
        };
        let copies = redirect.all_loaded(&named)?;
        if copies != named && line.given.remove(option).is_some() {
            options = without(&options, option);
        }
        let ours = settings.configuration.is_none() || option == "load-state" && setup.load_state.is_some();
        if copies != named || ours {
            line.push_list(option, &copies);
        }
    }
    Ok(options)
}

/// How SUMO steps, what it draws its random numbers from, and what its devices measure.
fn stepping(line: &mut Line, setup: &SumoSetup, settings: &Settings) {
    line.push("step-length", &setup.step_length_s.to_string());
    for (option, period_s) in Sampling::of(settings, setup.step_length_s).periods {
        line.push(option, &period_s);
    }
    line.push("seed", &setup.seed.to_string());
    line.push("random", "false");
    line.push("step-method.ballistic", &setup.ballistic.to_string());
    if setup.num_clients > 1 || settings.value("num-clients").is_some() {
        line.push("num-clients", &setup.num_clients.to_string());
    }
    if setup.contacts == Some(true) && settings.value("collision.mingap-factor").is_none() {
        line.push("collision.mingap-factor", "0");
    }
    if setup.safety {
        SAFETY.iter().for_each(|(option, value)| line.push(option, value));
    }
}

/// Lets the FCD output have [`SIGNALS`] beside the parameters that the user asks for. Returns the user's options without
/// those.
fn with_signals(line: &mut Line, options: Vec<String>, settings: &Settings) -> Vec<String> {
    let theirs = settings.value("fcd-output.params").unwrap_or_default();
    let params: Vec<&str> = list(theirs).filter(|name| !SIGNALS.contains(name)).chain(SIGNALS).collect();
    let given = line.given.remove("fcd-output.params").is_some();
    line.push("fcd-output.params", &params.join(","));
    if given { without(&options, "fcd-output.params") } else { options }
}

/// Redirects what a configuration writes. Returns where its outputs go, by option.
fn configured(line: &mut Line, configuration: &Configuration, redirect: &mut Redirect) -> BTreeMap<String, PathBuf> {
    let home = &configuration.origin.folder;
    redirect.take_prefix(configuration.value("output-prefix").unwrap_or_default());
    let mut outputs = BTreeMap::new();
    for option in &AFFIXES[..2] {
        if configuration.get(option).is_some() {
            line.push(option, "");
        }
    }
    for setting in configuration.settings.iter().filter(|s| writes(&s.name) && !is_no_file(&s.value)) {
        if outputs.contains_key(&setting.name) {
            continue;
        }
        let targets: Vec<String> = list(&setting.value).map(|f| redirect.target(home, f)).collect();
        line.push(&setting.name, &targets.join(","));
        outputs.insert(setting.name.clone(), PathBuf::from(targets.join(",")));
    }
    let saves = ["save-state.times", "save-state.period"].iter().any(|o| configuration.get(o).is_some());
    if saves && !outputs.contains_key("save-state.prefix") {
        line.push("save-state.prefix", &redirect.target(home, "state"));
    }
    outputs
}

/// The first of the user's options that is not the user's to give, with what to use instead.
pub(crate) fn ours(options: &[String]) -> Option<(String, &'static str)> {
    let given = given(options);
    OURS.iter()
        .find(|(option, _)| given.contains_key(*option))
        .map(|(option, instead)| (format!("--{option}"), *instead))
}

struct Line {
    arguments: Vec<String>,
    given: BTreeMap<String, String>,
}

impl Line {
    /// Adds an option, unless the user gives it.
    fn push(&mut self, option: &str, value: &str) {
        if !self.given.contains_key(option) {
            self.arguments.push(format!("--{option}"));
            self.arguments.push(value.to_owned());
        }
    }

    fn push_list(&mut self, option: &str, files: &[PathBuf]) {
        if !files.is_empty() {
            self.push(option, &files.iter().map(|f| f.to_string_lossy()).collect::<Vec<_>>().join(","));
        }
    }

    /// Where SUMO writes the file of an option in the end: the user's name, prefix and suffix count.
    fn written(&self, option: &str, ours: PathBuf) -> PathBuf {
        let path = match self.given.get(option) {
            Some(value) => absolute(Path::new(""), Path::new(value)),
            None => ours,
        };
        let Some(name) = path.file_name().map(|name| name.to_string_lossy().into_owned()) else { return path };
        let affix = |option: &str| self.given.get(option).map_or("", String::as_str);
        // SUMO puts the suffix before the last dot, and before .xml.gz and its like as a whole.
        let dot = ["gz", "zst"].iter().find_map(|z| name.strip_suffix(&format!(".{z}"))).unwrap_or(&name).rfind('.');
        let (stem, ending) = name.split_at(dot.unwrap_or(name.len()));
        path.with_file_name(format!("{}{stem}{}{ending}", affix("output-prefix"), affix("output-suffix")))
    }
}
