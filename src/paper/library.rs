//! The scenario files of the experiments. Each is a fragment of a scenario; one experiment is put together from
//! `vehicle.toml`, a preset, the test and what `--set` says, later ones winning.

use super::compared::{CONTROLLERS as PAPERS, every_law};
use super::error::{PaperError, write};
use crate::control::CONTROLLERS;
use crate::registry::{UnknownName, find, nearest};
use crate::scenario::{Catalog, Override, Request, Scenario};
use std::path::{Path, PathBuf};
use toml_edit::{DocumentMut, Item};

/// Where the files are in a clone of the repository.
const IN_REPOSITORY: &str = "scenarios/paper";

/// Puts the files of the library into the program, so that it works wherever it is called.
macro_rules! carried {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../scenarios/paper/", $name)))),*]
    };
}

const CARRIED: &[(&str, &str)] = carried![
    "vehicle.toml",
    "step.toml",
    "sine.toml",
    "driver.toml",
    "delay.toml",
    "disturb.toml",
    "presets/default.toml",
    "presets/best.toml",
    "presets/printed.toml",
    "presets/step1.toml",
    "presets/step2.toml",
    "presets/step3.toml",
    "presets/step4.toml",
    "presets/step5.toml",
    "presets/step6.toml",
    "presets/delay_a.toml",
    "presets/delay_b.toml",
    "presets/delay_d.toml",
    "data/handling_lap.csv",
    "data/racing_lap.csv",
    "data/udds.csv",
    "data/hwfet.csv",
];

/// The text of a file that is in the program, by its name below `scenarios/paper`.
pub fn carried(name: &str) -> Option<&'static str> {
    CARRIED.iter().find(|(carried, _)| *carried == name).map(|(_, text)| *text)
}

/// The preset whose settings are those that the product ships with.
pub const DEFAULT: &str = "default";

/// A preset: one choice of all that the paper leaves open.
#[derive(Debug, Clone)]
pub struct Preset {
    /// The file's stem.
    pub name: String,
    /// One line.
    pub title: String,
    /// What it is for and where it ends.
    pub why: String,
    settings: Vec<Override>,
}

/// The files, and what the command line changes.
#[derive(Debug, Clone)]
pub struct Library {
    folder: PathBuf,
    sets: Vec<Override>,
    /// All presets, `default` and `best` first.
    pub presets: Vec<Preset>,
}

impl Library {
    /// Opens `scenarios/paper` below the working directory; where there is none, the program's own copy, which it writes
    /// to `spare`.
    ///
    /// # Errors
    /// [`PaperError::File`] if a file cannot be read or written, [`PaperError::Fragment`] if it is not what it should be or
    /// there is no preset.
    pub fn open(spare: &Path, sets: &[Override]) -> Result<Self, PaperError> {
        let here = Path::new(IN_REPOSITORY);
        let folder = if here.join("presets").is_dir() { here.to_owned() } else { carry(spare)? };
        let mut library = Self { folder, sets: sets.to_vec(), presets: Vec::new() };
        let listed = std::fs::read_dir(library.folder.join("presets")).map_err(PaperError::reading(&library.folder))?;
        let mut names: Vec<String> = listed
            .filter_map(|entry| Some(entry.ok()?.file_name().to_str()?.strip_suffix(".toml")?.to_owned()))
            .collect();
        names.sort_by_key(|name| (name != DEFAULT, name != "best", name.clone()));
        if names.is_empty() {
            let what = "presets: no file *.toml, wanted at least one".to_owned();
            return Err(PaperError::Fragment { path: library.folder, what });
        }
        library.presets = names.into_iter().map(|name| library.preset(name)).collect::<Result<_, _>>()?;
        Ok(library)
    }

    /// The folder of the files.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The preset called `name`.
    ///
    /// # Errors
    /// [`PaperError::Unknown`] with all known names.
    pub fn find(&self, name: &str) -> Result<&Preset, PaperError> {
        self.presets.iter().find(|p| p.name == name).ok_or_else(|| {
            let known: Vec<String> = self.presets.iter().map(|p| p.name.clone()).collect();
            let suggestion = nearest(name, known.iter().map(String::as_str)).map(str::to_owned);
            PaperError::Unknown(UnknownName { kind: "preset", name: name.to_owned(), suggestion, known })
        })
    }

    fn preset(&self, name: String) -> Result<Preset, PaperError> {
        let path = self.folder.join("presets").join(format!("{name}.toml"));
        let document = read(&path)?;
        let text = |key: &str| document.get(key).and_then(Item::as_str).unwrap_or_default().to_owned();
        let settings = settings(&path, &document)?;
        Ok(Preset { name, title: text("title"), why: text("why"), settings })
    }

    /// The scenario of a test under a preset with a controller; `more`, meant for just this
    /// controller, comes before the command line's own settings.
    ///
    /// # Errors
    /// [`PaperError`] if a file is not a fragment or the whole not a scenario.
    pub fn scenario(
        &self,
        test: &str,
        preset: &Preset,
        controller: &str,
        more: &[Override],
    ) -> Result<Scenario, PaperError> {
        let mut settings = Vec::new();
        for name in ["vehicle", test] {
            let path = self.folder.join(format!("{name}.toml"));
            settings.push(self::settings(&path, &read(&path)?)?);
        }
        let [vehicle, test] = <[_; 2]>::try_from(settings).expect("two files were read");
        let chosen = Override::text("controller", "controller.name", controller);
        let those_for = |laws: &[&str], settings: &[Override]| -> Vec<Override> {
            settings.iter().filter(|given| concerns(laws, controller, &given.path)).cloned().collect()
        };
        let files = [vehicle, preset.settings.clone(), test].concat();
        let every_law: Vec<&str> = every_law().collect();
        let overrides =
            [vec![chosen], those_for(&PAPERS, &files), more.to_vec(), those_for(&every_law, &self.sets)].concat();
        Ok(Scenario::load_offline(&Request { scenario: None, overrides }, &Catalog::installed())?)
    }

    /// Which of the laws that are driven the command line's settings of `[controller]` reach: a line for each that is not
    /// for all of them.
    ///
    /// # Errors
    /// [`PaperError::Setting`] if one chooses the law, or is for none of them though another law has the key.
    pub fn reached(&self, driven: &[&str]) -> Result<Vec<String>, PaperError> {
        let mut lines = Vec::new();
        for given in &self.sets {
            let Some(key) = given.path.strip_prefix("controller.") else { continue };
            let refused = |what: String| Err(PaperError::Setting { shown: given.shown.clone(), what });
            let (with, without): (Vec<&str>, Vec<&str>) = driven.iter().partition(|law| has(law, key));
            if key == "name" {
                return refused(format!(
                    "found a choice of the law, wanted none: the tests drive {}",
                    driven.join(", ")
                ));
            }
            if with.is_empty() && every_law().any(|law| has(law, key)) {
                return refused(format!("found a key of other laws than those that are driven: {}", driven.join(", ")));
            }
            if !with.is_empty() && !without.is_empty() {
                lines.push(format!("{}: for {}; not a key of {}", given.shown, with.join(", "), without.join(", ")));
            }
        }
        Ok(lines)
    }
}

/// Whether a setting that is meant for `laws` is one for `controller`: not if that does not have the key and another one
/// does.
fn concerns(laws: &[&str], controller: &str, path: &str) -> bool {
    let Some(key) = path.strip_prefix("controller.") else { return true };
    laws.contains(&controller) && (has(controller, key) || !laws.iter().any(|law| has(law, key)))
}

/// Whether a law has a key.
pub fn has(controller: &str, key: &str) -> bool {
    find("controller", &CONTROLLERS, controller).is_ok_and(|entry| entry.keys.iter().any(|known| known.name == key))
}

/// Writes the program's own copy of the files.
fn carry(spare: &Path) -> Result<PathBuf, PaperError> {
    for (name, text) in CARRIED {
        write(&spare.join(name), text)?;
    }
    Ok(spare.to_owned())
}

fn read(path: &Path) -> Result<DocumentMut, PaperError> {
    let text = std::fs::read_to_string(path).map_err(PaperError::reading(path))?;
    text.parse().map_err(|e: toml_edit::TomlError| PaperError::Fragment { path: path.to_owned(), what: e.to_string() })
}

/// The sections of a fragment as settings; a profile's file is relative to the fragment's folder.
fn settings(path: &Path, document: &DocumentMut) -> Result<Vec<Override>, PaperError> {
    let mut settings = Vec::new();
    for (section, item) in document.iter() {
        let Some(table) = item.as_table() else { continue };
        for (key, item) in table.iter() {
            let Some(value) = item.as_value() else {
                let what = format!("[{section}] {key}: found a table, wanted a value");
                return Err(PaperError::Fragment { path: path.to_owned(), what });
            };
            let dotted = format!("{section}.{key}");
            let from = format!("{}: {dotted} =", path.display());
            settings.push(match value.as_str() {
                Some(file) if dotted == "target.file" => {
                    let folder = path.parent().unwrap_or(Path::new(""));
                    Override::text(&from, &dotted, &folder.join(file).to_string_lossy())
                }
                _ => Override::literal(&from, &dotted, value.clone().decorated("", "")),
            });
        }
    }
    Ok(settings)
}
