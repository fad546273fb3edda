//! One setting of a study: the scenario that it makes, whatever the seed.

use super::definition::{Axis, Definition};
use super::error::StudyError;
use crate::scenario::{Catalog, Override, Scenario, ScenarioError, Selector};
use crate::sumo_files::{as_configured, named_output, refused_of_file};

/// The key that chooses the controller.
const CONTROLLER: &str = "controller.name";
/// The controller of a study that is none: SUMO without us.
pub const PLAIN: &str = "plain";

/// One setting.
#[derive(Debug, Clone)]
pub struct Setting {
    /// The values of the varied keys, as the tables show them.
    pub values: Vec<String>,
    /// The setting with which it is compared; none for a reference itself.
    pub reference: Option<usize>,
    /// What runs; each case has its own seed.
    pub scenario: Scenario,
    /// True for SUMO without us.
    pub plain: bool,
}

/// All settings: the product of the axes, the last of them fastest.
///
/// # Errors
/// A setting that makes no scenario, or one that cannot be studied.
pub fn settings(definition: &Definition, catalog: &Catalog) -> Result<Vec<Setting>, StudyError> {
    let axes = &definition.axes;
    let count: usize = axes.iter().map(|axis| axis.rows.len()).product();
    let compared = axes.iter().any(|axis| axis.reference.is_some());
    let mut all = Vec::with_capacity(count);
    for index in 0..count {
        let rows = rows(axes, index);
        let own: Vec<usize> = rows.iter().zip(axes).map(|(row, axis)| axis.reference.unwrap_or(*row)).collect();
        let reference = Some(place(axes, &own)).filter(|reference| compared && *reference != index);
        all.push(setting(definition, &rows, reference, catalog)?);
    }
    Ok(all)
}

/// The rows of the axes that make the setting of a place, and back.
fn rows(axes: &[Axis], mut index: usize) -> Vec<usize> {
    let mut rows = vec![0; axes.len()];
    for (row, axis) in rows.iter_mut().zip(axes).rev() {
        (*row, index) = (index % axis.rows.len(), index / axis.rows.len());
    }
    rows
}

fn place(axes: &[Axis], rows: &[usize]) -> usize {
    axes.iter().zip(rows).fold(0, |place, (axis, row)| place * axis.rows.len() + row)
}

fn setting(
    definition: &Definition,
    rows: &[usize],
    reference: Option<usize>,
    catalog: &Catalog,
) -> Result<Setting, StudyError> {
    let (mut values, mut overrides) = (Vec::new(), Vec::new());
    for (axis, row) in definition.axes.iter().zip(rows) {
        for ((key, place), literal) in axis.keys.iter().zip(&axis.shown).zip(&axis.rows[*row]) {
            // An argument says all of it; a place in a file does not say which of the values.
            let shown = if place.starts_with('-') { place.clone() } else { format!("{place}: {key} = {literal}") };
            values.push(literal.trim_matches('"').to_owned());
            overrides.push(Override { shown, path: key.clone(), value: literal.clone() });
        }
    }
    // A setting that names no controller may still be of a scenario that was overridden with one.
    let all = || definition.request.overrides.iter().chain(&overrides);
    let controller = all().rev().find(|given| given.path == CONTROLLER);
    let plain = controller.is_some_and(|given| given.value.trim_matches('"') == PLAIN);
    let mut request = definition.request.clone();
    request.overrides.extend(overrides);
    if plain {
        request.overrides.retain(|given| !given.path.starts_with("controller."));
    }
    let mut scenario = Scenario::load(&request, catalog)?;
    fit(&scenario)?;
    if plain {
        scenario = without_us(scenario)?;
    }
    Ok(Setting { values, reference, scenario, plain })
}

/// The same traffic without any ego, in the step and the stepping of its configuration.
fn without_us(mut scenario: Scenario) -> Result<Scenario, StudyError> {
    scenario.sumo = as_configured(&scenario.sumo).map_err(ScenarioError::from)?;
    scenario.coupling.control_period_s = scenario.sumo.step_length_s;
    scenario.egos = Selector::Share(0.0);
    scenario.groups.drain(..scenario.groups.len() - 1);
    Ok(scenario)
}

/// Refuses what would make cases depend on each other, or hide their results.
fn fit(scenario: &Scenario) -> Result<(), StudyError> {
    let sumo = &scenario.sumo;
    let unfit = |key, found: String, wanted| Err(StudyError::Unfit { key, found, wanted });
    let alone = "nothing: each case of a study starts a SUMO of its own";
    if let Some(option) = named_output(&sumo.options) {
        return unfit("sumo.options", option, "no option that names files to write: each case has a folder of its own");
    }
    if let Some((option, wanted)) = refused_of_file(&sumo.options) {
        return unfit("sumo.options", option, wanted);
    }
    match (&sumo.connect, sumo.port, sumo.num_clients, sumo.gui) {
        (Some(connect), ..) => unfit("sumo.connect", connect.clone(), alone),
        (_, Some(port), ..) => unfit("sumo.port", port.to_string(), alone),
        (_, _, clients, _) if clients > 1 => unfit("sumo.num_clients", clients.to_string(), "1: cases run unattended"),
        (.., true) => unfit("sumo.gui", "true".to_owned(), "false: cases run unattended"),
        _ if !scenario.output.vehicles.ends_with(".csv") => {
            unfit("output.vehicles", scenario.output.vehicles.clone(), "a table in CSV, from which vehicles are paired")
        }
        _ => Ok(()),
    }
}
