//! The result folder of a run, read.

use super::error::ReportError;
use super::table::{SchemaInfo, Table};
use crate::output::{file_error, part_of};
use crate::run::{Input, MANIFEST, Manifest, Summary};
use crate::sumo_files::{Conflict, Incident, NetworkRoad, each_conflict, incidents, is_network, network_roads};
use serde::de::DeserializeOwned;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// What a run has left. What is missing is `None`, and `missing` says why.
#[derive(Debug)]
pub struct RunData {
    /// Its folder.
    pub dir: PathBuf,
    /// `run.json`.
    pub manifest: Manifest,
    /// `summary.json`.
    pub summary: Option<Summary>,
    /// The vehicles, with their drive quality.
    pub vehicles: Option<Table>,
    /// The roads.
    pub edges: Option<Table>,
    /// Trajectories of some vehicles, once a second.
    pub sample: Option<Table>,
    /// Traces of those that were asked for.
    pub trace: Option<Table>,
    /// The network.
    pub roads: Option<Vec<NetworkRoad>>,
    /// Collisions, teleports and emergency braking in SUMO's log.
    pub incidents: Option<Vec<Incident>>,
    /// Conflicts that SUMO measured, the severest first, if any vehicle had the device.
    pub conflicts: Option<Vec<Conflict>>,
    /// What is not there, and why, one sentence each.
    pub missing: Vec<String>,
}

impl RunData {
    /// Reads the folder of a run.
    ///
    /// # Errors
    /// [`ReportError`] if `run.json` cannot be read, or a file is there that is not as it should be.
    pub fn read(dir: &Path) -> Result<Self, ReportError> {
        let manifest = Manifest::read(&dir.join(MANIFEST))?;
        let mut missing = Vec::new();
        let schema: SchemaInfo = read_json(&dir.join("schema.json"), &mut missing)?.unwrap_or_default();
        let summary = read_json(&dir.join("summary.json"), &mut missing)?;
        // The table of vehicles and the trace may have other names and formats: the schema knows them by their columns.
        let named = |default: &str, column: &str| {
            let of_run = |name: &&String| !["sample.csv", "edges.csv"].contains(&name.as_str());
            let has = |name: &&String| schema.files[*name].columns.iter().any(|c| c.name == column);
            schema.files.keys().filter(of_run).find(has).cloned().unwrap_or_else(|| default.to_owned())
        };
        let mut table = |name: &str, needed: bool| -> Result<Option<Table>, ReportError> {
            let path = dir.join(name);
            if !path.is_file() {
                if needed && part_of(&path).is_file() {
                    missing.push(format!(
                        "{name} is not whole: sumo-mfc recover {} makes a table of {name}.part.",
                        dir.display()
                    ));
                } else if needed {
                    missing.push(format!("{name} is not in the folder: what is made from it is left out."));
                }
                return Ok(None);
            }
            let info = schema.files.get(name).cloned().unwrap_or_default();
            Table::read(&path, &info).map(Some)
        };
        let mut vehicles = table(&named("vehicles.csv", "controller"), true)?;
        let quality = table("quality.csv", false)?;
        let (edges, sample) = (table("edges.csv", true)?, table("sample.csv", true)?);
        let trace_name = named("trace.csv", "alpha_hat");
        let trace = if trace_name.ends_with(".xml") {
            missing.push(format!("{trace_name}: traces are read from .csv and .parquet; this one is left out."));
            None
        } else {
            table(&trace_name, false)?
        };
        let log = dir.join("sumo/sumo.log");
        let incidents = match incidents(&log) {
            Ok(incidents) => Some(incidents),
            Err(_) => {
                missing.push("sumo/sumo.log cannot be read: safety events are left out.".to_owned());
                None
            }
        };
        if let (Some(vehicles), Some(quality)) = (&mut vehicles, quality)
            && !vehicles.append(quality)
        {
            missing.push("quality.csv is not of the vehicles of the table of vehicles: it is left out.".to_owned());
        }
        let roads = roads(&manifest, &mut missing);
        let conflicts = conflicts(&manifest, dir, &mut missing);
        let dir = dir.to_owned();
        Ok(Self { dir, manifest, summary, vehicles, edges, sample, trace, roads, incidents, conflicts, missing })
    }
}

/// The conflicts of SUMO's SSM devices: of the two entries of a pair that both have the device, one.
fn conflicts(manifest: &Manifest, dir: &Path, missing: &mut Vec<String>) -> Option<Vec<Conflict>> {
    let path = manifest.written(dir, "--device.ssm.file").filter(|path| path.is_file())?;
    let mut seen = BTreeSet::new();
    let mut all = Vec::new();
    let read = each_conflict(&path, |conflict| {
        let (ego, foe) = (conflict.ego.clone(), conflict.foe.clone());
        let pair = if ego < foe { [ego, foe] } else { [foe, ego] };
        let place = conflict.place.map(|place| place.map(f64::to_bits));
        if seen.insert((pair, conflict.time_s.map(f64::to_bits), place)) {
            all.push(conflict);
        }
    });
    if let Err(error) = read {
        missing.push(format!("{error}: conflicts after that are left out."));
    }
    all.sort_by(|a, b| severity(a).total_cmp(&severity(b)));
    Some(all)
}

/// The less, the severer: the shortest time between the two \[s\]; without one, what braking was needed.
fn severity(conflict: &Conflict) -> f64 {
    let times = [conflict.ttc_min_s, conflict.pet_s];
    let shortest = times.into_iter().flatten().reduce(f64::min);
    shortest.unwrap_or_else(|| 1e6 - conflict.drac_max_mps2.unwrap_or(0.0))
}

/// The network that the manifest names, if it is still there.
fn roads(manifest: &Manifest, missing: &mut Vec<String>) -> Option<Vec<NetworkRoad>> {
    let looks_like_one = |input: &&Input| input.path.contains(".net.");
    let by_name = manifest.inputs.iter().find(looks_like_one);
    let Some(input) = by_name.or_else(|| manifest.inputs.iter().find(|input| is_network(Path::new(&input.path))))
    else {
        missing.push("run.json names no network: the map is left out.".to_owned());
        return None;
    };
    let path = Path::new(&input.path);
    let Ok(now) = Input::of(path) else {
        missing.push(format!("The network {} is not there any more: the map is left out.", input.path));
        return None;
    };
    if now.sha256 != input.sha256 {
        missing.push(format!("The network {} has changed since the run: the map may not fit.", input.path));
    }
    match network_roads(path) {
        Ok(roads) => Some(roads),
        Err(error) => {
            missing.push(format!("{error}: the map is left out."));
            None
        }
    }
}

/// Reads a file of JSON; `None` if it is not there.
pub fn read_json<T: DeserializeOwned>(path: &Path, missing: &mut Vec<String>) -> Result<Option<T>, ReportError> {
    if !path.is_file() {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        missing.push(format!("{name} is not in the folder: what is made from it is left out."));
        return Ok(None);
    }
    let text = std::fs::read_to_string(path).map_err(file_error("read", path))?;
    let value = serde_json::from_str(&text).map_err(|error| file_error("read", path)(error.into()))?;
    Ok(Some(value))
}
