//! What SUMO says about dangerous moments: the warnings of its log, and the conflicts that its SSM devices measured.

use super::data::RunData;
use super::number::{counted, or_dash};
use crate::page::{Cell, Head, Section, TableView};
use crate::sumo_files::Conflict;
use std::collections::BTreeMap;

/// Lines of a kind that a table has at most.
const LINES: usize = 50;

/// The section of all runs.
pub fn safety_section(runs: &[RunData], names: &[Option<&str>]) -> Section {
    let mut section = Section { id: "safety".into(), title: "Safety events".into(), ..Section::default() };
    for (run, name) in runs.iter().zip(names) {
        warnings(&mut section, run, *name);
        section.tables.extend(run.conflicts.as_deref().and_then(|conflicts| conflict_table(conflicts, *name)));
        if run.conflicts.as_ref().is_some_and(Vec::is_empty) {
            let of = of(*name);
            section.text.push(format!("{of}SUMO's SSM devices saw no conflict."));
        }
    }
    section
}

fn of(name: Option<&str>) -> String {
    name.map(|name| format!("{name}: ")).unwrap_or_default()
}

fn warnings(section: &mut Section, run: &RunData, name: Option<&str>) {
    let Some(incidents) = &run.incidents else { return };
    let of = of(name);
    if incidents.is_empty() {
        section.text.push(format!("{of}SUMO's log names no collision, no teleport and no emergency braking."));
    }
    let mut kinds: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for incident in incidents {
        kinds.entry(incident.kind).or_default().push(&incident.text);
    }
    for (kind, lines) in kinds {
        section.tables.push(TableView {
            id: format!("safety-{}{}", kind.replace(' ', "-"), name.unwrap_or_default()),
            caption: "Warnings of SUMO's log (sumo/sumo.log), of all vehicles, equipped or not.".into(),
            fold: format!("{of}{kind}: {}{}", counted(lines.len(), "warning", "warnings"), first(lines.len())),
            open: lines.len() <= 5,
            head: vec![Head::text("warning", "")],
            rows: lines.iter().take(LINES).map(|line| vec![Cell::text(*line)]).collect(),
        });
    }
}

fn conflict_table(conflicts: &[Conflict], name: Option<&str>) -> Option<TableView> {
    let number = |value: Option<f64>| Cell::number(or_dash(value));
    let row = |conflict: &Conflict| {
        vec![
            Cell::text(&*conflict.ego),
            Cell::text(&*conflict.foe),
            number(conflict.time_s),
            number(conflict.ttc_min_s),
            number(conflict.drac_max_mps2),
            number(conflict.pet_s),
        ]
    };
    let severest = if conflicts.len() > LINES { format!(", the severest {LINES}") } else { String::new() };
    (!conflicts.is_empty()).then(|| TableView {
        id: format!("safety-conflicts{}", name.unwrap_or_default()),
        caption: "Conflicts that SUMO's SSM devices measured, the shortest time between the two first; a pair of which both have the device stands once.".into(),
        fold: format!("{}{}{severest}", of(name), counted(conflicts.len(), "conflict", "conflicts")),
        open: conflicts.len() <= 5,
        head: vec![
            Head::text("vehicle", "the one with the device"),
            Head::text("other", "the other one"),
            Head::number("time [s]", "when the first of the measures was at its worst"),
            Head::number("TTC [s]", "smallest time to collision"),
            Head::number("DRAC [m/s²]", "largest deceleration to avoid a crash"),
            Head::number("PET [s]", "post-encroachment time"),
        ],
        rows: conflicts.iter().take(LINES).map(row).collect(),
    })
}

fn first(lines: usize) -> String {
    if lines > LINES { format!(", the first {LINES}") } else { String::new() }
}
