//! The options that SUMO is going to run with. As in SUMO, one that stands behind `--` replaces the configuration's.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use super::{
    configuration::Configuration,
    error::SumoFileError,
    options::{given, is_true, list, seconds},
    path::{absolute, environment},
    setup::{Source, SumoSetup},
};
use crate::place::Place;

/// SUMO's own step \[s\].
const STEP_S: f64 = 1.0;

/// Options of SUMO by their long names.
#[derive(Debug)]
pub(super) struct Settings {
    /// What the user gives behind `--`.
    pub given: BTreeMap<String, String>,
    pub configuration: Option<Configuration>,
    /// The files that the scenario itself names.
    named: BTreeMap<&'static str, Vec<PathBuf>>,
}

impl Settings {
    /// Reads the configuration, if there is one.
    pub fn read(setup: &SumoSetup) -> Result<Self, SumoFileError> {
        let mut settings = Self { given: given(&setup.options), configuration: None, named: BTreeMap::new() };
        match setup.source() {
            Source::Config(path) => settings.configuration = Some(Configuration::read(path)?),
            Source::Network(net) => {
                settings.named = BTreeMap::from([
                    ("net-file", vec![net.to_owned()]),
                    ("route-files", setup.routes.clone()),
                    ("additional-files", setup.additional.clone()),
                ]);
            }
            Source::Running | Source::Offline => {}
        }
        Ok(settings)
    }

    /// The value of an option. That of a switch may be empty, which means yes.
    pub fn value(&self, option: &str) -> Option<&str> {
        let given = self.given.get(option).map(String::as_str);
        given.or_else(|| self.configuration.as_ref()?.value(option))
    }

    /// Whether a switch is on.
    pub fn is_on(&self, option: &str) -> bool {
        self.value(option).is_some_and(|value| value.is_empty() || is_true(value))
    }

    /// A time \[s\].
    pub fn time_s(&self, option: &str) -> Option<f64> {
        self.value(option).and_then(seconds)
    }

    /// SUMO's step, that of SUMO itself if no option says otherwise; `None` if it cannot be read \[s\].
    pub fn step_s(&self) -> Option<f64> {
        self.value("step-length").map_or(Some(STEP_S), seconds)
    }

    /// The files that an option names, absolute.
    pub fn files(&self, option: &str) -> Vec<PathBuf> {
        match (self.given.get(option), &self.configuration) {
            (Some(value), _) => {
                list(value).map(|file| absolute(Path::new(""), Path::new(&environment(file)))).collect()
            }
            (None, Some(configuration)) => configuration.files(option),
            (None, None) => self.named.get(option).cloned().unwrap_or_default(),
        }
    }

    /// Where an option is set, and by which name.
    pub fn place(&self, option: &str) -> Option<(Place, String)> {
        if self.given.contains_key(option) {
            return Some((Place::argument(&format!("-- --{option}")), option.to_owned()));
        }
        let configuration = self.configuration.as_ref()?;
        let setting = configuration.get(option)?;
        Some((configuration.place(setting), setting.written.clone()))
    }
}

/// The same SUMO with the step, the stepping method and the collisions that its configuration, or SUMO itself, has.
///
/// # Errors
/// A configuration that cannot be read.
pub fn as_configured(setup: &SumoSetup) -> Result<SumoSetup, SumoFileError> {
    let settings = Settings::read(setup)?;
    Ok(SumoSetup {
        step_length_s: settings.step_s().unwrap_or(setup.step_length_s),
        ballistic: settings.is_on("step-method.ballistic"),
        contacts: Some(false),
        ..setup.clone()
    })
}
