//! All cases of a study, known before anything runs.

use super::definition::Definition;
use super::error::StudyError;
use super::setting::{Setting, settings};
use super::statistics::advice;
use super::warm_up::WarmUp;
use crate::output::{OutputError, write_json};
use crate::run::{Input, Manifest, Status, Summary};
use crate::scenario::{Catalog, Scenario};
use crate::sumo_files::{SumoSetup, plain_until, span_s};
use crate::traci::{SumoBinary, find_sumo};
use serde_json::json;
use std::collections::{BTreeMap, btree_map};
use std::path::{Path, PathBuf};

/// One run of a study.
#[derive(Debug, Clone)]
pub struct Case {
    /// Its number, from 1: the name of its folder.
    pub number: usize,
    /// Which setting.
    pub setting: usize,
    /// The seed.
    pub seed: u64,
    /// What makes it: [`Manifest::identity`].
    pub identity: String,
}

/// A study that can be run.
#[derive(Debug)]
pub struct Plan {
    /// The folder of the results.
    pub dir: PathBuf,
    /// The varied keys, the columns of the tables.
    pub keys: Vec<String>,
    /// The seeds.
    pub seeds: Vec<u64>,
    /// Resamples of the bootstrap of every difference; 0 = none.
    pub bootstrap: u32,
    /// The settings.
    pub settings: Vec<Setting>,
    /// The cases, seed by seed: more seeds add cases at the end.
    pub cases: Vec<Case>,
    /// The SUMO that runs them.
    pub sumo: SumoBinary,
    /// Its version.
    pub sumo_version: String,
    inputs: Vec<Vec<Input>>,
    /// By setting: what SUMO simulates before its cases begin, and until when \[s\].
    warm_ups: Vec<Option<(SumoSetup, f64)>>,
}

impl Plan {
    /// Plans a study, in `dir` or a folder named after it.
    ///
    /// # Errors
    /// Whatever would keep a case from being run.
    pub fn new(definition: &Definition, dir: Option<PathBuf>, catalog: &Catalog) -> Result<Self, StudyError> {
        let settings = settings(definition, catalog)?;
        let sumo = find_sumo(None)?;
        let mut plan = Self {
            dir: dir.unwrap_or_else(|| definition.default_folder(&settings[0].scenario.name)),
            keys: definition.axes.iter().flat_map(|axis| axis.keys.clone()).collect(),
            seeds: definition.seeds.clone(),
            bootstrap: definition.bootstrap,
            inputs: hashed(&settings)?,
            warm_ups: warm_ups(&settings, definition.warm_up_s)?,
            settings,
            cases: Vec::new(),
            sumo_version: sumo.version_text()?,
            sumo,
        };
        if !definition.twins {
            plan.refuse_twins()?;
        }
        for &seed in &plan.seeds {
            for setting in 0..plan.settings.len() {
                let mut case = Case { number: plan.cases.len() + 1, setting, seed, identity: String::new() };
                case.identity = plan.manifest(&case).identity(&plan.sumo_version);
                plan.cases.push(case);
            }
        }
        Ok(plan)
    }

    /// Two settings that make the same scenario would count one run twice. `plain` has no controller whose settings could
    /// tell them apart.
    fn refuse_twins(&self) -> Result<(), StudyError> {
        let mut seen = BTreeMap::new();
        for (index, setting) in self.settings.iter().enumerate() {
            let what = if setting.plain { setting.values.join("\n") } else { setting.scenario.to_toml() };
            match seen.entry((setting.plain, what)) {
                btree_map::Entry::Vacant(free) => free.insert(index),
                btree_map::Entry::Occupied(taken) => {
                    let (first, second) = (self.shown(*taken.get()), self.shown(index));
                    return Err(StudyError::Duplicate { first, second });
                }
            };
        }
        Ok(())
    }

    /// A setting in words.
    pub fn shown(&self, setting: usize) -> String {
        let pairs = self.keys.iter().zip(&self.settings[setting].values);
        let shown: Vec<String> = pairs.map(|(key, value)| format!("{key}={value}")).collect();
        if shown.is_empty() { "as it is".to_owned() } else { shown.join(" ") }
    }

    /// What a case runs.
    fn scenario(&self, case: &Case) -> Scenario {
        let mut scenario = self.settings[case.setting].scenario.clone();
        scenario.sumo.seed = case.seed;
        if let Some(warm_up) = self.warm_up(case) {
            scenario.sumo.load_state = Some(warm_up.state);
        }
        scenario
    }

    /// The warm-up of a case, if the study has one.
    pub fn warm_up(&self, case: &Case) -> Option<WarmUp> {
        let warm_up = self.warm_ups[case.setting].as_ref()?;
        let made_of = format!("{} {:?}", self.sumo_version, self.inputs[case.setting]);
        Some(WarmUp::new(&std::path::absolute(&self.dir).ok()?, warm_up, case.seed, &made_of))
    }

    /// What `run.json` says of a case before it runs.
    pub fn manifest(&self, case: &Case) -> Manifest {
        let inputs = self.inputs[case.setting].clone();
        let scenario = self.scenario(case).to_toml();
        let sumo_version = Some(self.sumo_version.clone());
        Manifest { status: Status::Planned, sumo_version, ..Manifest::new(case.seed, scenario, inputs) }
    }

    /// The folder of a case.
    pub fn case_dir(&self, case: &Case) -> PathBuf {
        case_dir(&self.dir, case.number)
    }

    /// How long a case took, if its result is there \[s\].
    pub fn wall_s(&self, case: &Case) -> Option<f64> {
        let text = std::fs::read_to_string(self.case_dir(case).join("summary.json")).ok()?;
        serde_json::from_str::<Summary>(&text).ok().map(|summary| summary.wall_s)
    }

    /// Writes `study.json`.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the file.
    pub fn write(&self) -> Result<PathBuf, OutputError> {
        let reference = |setting: &Setting| setting.reference.map(|reference| self.settings[reference].values.clone());
        let settings = self.settings.iter().map(|s| json!({ "values": s.values, "reference": reference(s) }));
        let cases = self.cases.iter().map(
            |case| json!({ "case": case.number, "setting": case.setting, "seed": case.seed, "sha256": case.identity }),
        );
        let mut inputs: Vec<&Input> = self.inputs.iter().flatten().collect();
        inputs.sort_by(|a, b| a.path.cmp(&b.path));
        inputs.dedup();
        let study = json!({
            "schema": 1,
            "version": env!("CARGO_PKG_VERSION"),
            "sumo_version": self.sumo_version,
            "keys": self.keys,
            "seeds": self.seeds,
            "advice": advice(self.seeds.len()),
            "inputs": inputs,
            "settings": settings.collect::<Vec<_>>(),
            "cases": cases.collect::<Vec<_>>(),
        });
        write_json(&self.dir.join("study.json"), &study)
    }
}

/// The warm-up of every setting.
fn warm_ups(settings: &[Setting], warm_up_s: Option<f64>) -> Result<Vec<Option<(SumoSetup, f64)>>, StudyError> {
    let Some(warm_up_s) = warm_up_s else { return Ok(vec![None; settings.len()]) };
    let of_setting = |setting: &Setting| {
        let sumo = &setting.scenario.sumo;
        if let Some(state) = &sumo.load_state {
            let (found, wanted) = (state.display().to_string(), "nothing: warm_up_s makes a state for each seed");
            return Err(StudyError::Unfit { key: "sumo.load_state", found, wanted });
        }
        let (begin_s, end_s) = span_s(sumo)?;
        let until_s = begin_s + warm_up_s;
        if end_s.is_some_and(|end_s| end_s <= until_s) {
            let found = format!("{warm_up_s}, which ends at {until_s} s");
            return Err(StudyError::Unfit { key: "warm_up_s", found, wanted: "less than the simulation lasts" });
        }
        Ok(Some((plain_until(sumo, until_s)?, until_s)))
    };
    settings.iter().map(of_setting).collect()
}

/// The folder of a case in that of its study.
pub fn case_dir(study: &Path, number: usize) -> PathBuf {
    study.join("cases").join(format!("{number:04}"))
}

/// The inputs of every setting; each file is read once.
fn hashed(settings: &[Setting]) -> Result<Vec<Vec<Input>>, OutputError> {
    let mut known = BTreeMap::<&Path, Input>::new();
    let mut input = |path| match known.entry(path) {
        btree_map::Entry::Occupied(known) => Ok(known.get().clone()),
        btree_map::Entry::Vacant(new) => Input::of(path).map(|input| new.insert(input).clone()),
    };
    settings.iter().map(|setting| setting.scenario.inputs.iter().map(|path| input(path)).collect()).collect()
}
