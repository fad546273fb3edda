//! The page of one run, or of two side by side.

use super::data::RunData;
use super::error::ReportError;
use super::figures::{boxes, distribution, time_space};
use super::fleet::{counts, fleet, side_by_side};
use super::groups::{NAMES, groups};
use super::head;
use super::number::counted;
use super::road_map::maps;
use super::safety::safety_section;
use super::traces;
use super::vehicles;
use crate::page::{Page, Section};
use crate::registry::nearest;

/// What a page takes without figures and data: styles, script, tables \[bytes\].
const OWN: usize = 150_000;

/// The page.
///
/// # Errors
/// [`ReportError::Vehicle`] if nothing is known of the vehicle that is asked for.
pub fn page(runs: &[RunData], vehicle: Option<&str>) -> Result<Page, ReportError> {
    let names: Vec<Option<&str>> = NAMES.into_iter().map(|name| (runs.len() > 1).then_some(name)).collect();
    if let Some(id) = vehicle
        && !runs.iter().any(|run| traces::ids(run).any(|known| known == id))
    {
        let near = nearest(id, runs.iter().flat_map(traces::ids)).map(|near| format!("; did you mean {near}?"));
        return Err(ReportError::Vehicle { id: id.to_owned(), near: near.unwrap_or_default() });
    }
    let folders: Vec<String> = runs.iter().map(|run| head::folder_name(&run.dir)).collect();
    let mut page = Page { title: folders.join(" and "), about: about(runs), ..Page::default() };
    for (run, name) in runs.iter().zip(&names) {
        head::add(&mut page, run, *name);
    }
    page.sections.push(fleet_section(runs, &folders));
    page.sections.push(error_section(runs));
    let mut space = Section { id: "space".into(), title: "Time and space".into(), ..Section::default() };
    space.figures.extend(maps(runs, &names));
    space.figures.extend(runs.iter().zip(&names).filter_map(|(run, name)| time_space(run, *name)));
    page.sections.push(space);
    page.sections.push(safety_section(runs, &names));
    if let Some(id) = vehicle {
        let figures = runs.iter().zip(&names).flat_map(|(run, name)| traces::figures(run, *name, id)).collect();
        page.sections.push(Section {
            id: "vehicle".into(),
            title: format!("Vehicle {id}"),
            figures,
            ..Section::default()
        });
    }
    if let Some(table) = vehicles::joined(runs) {
        let (series, mut text) = traces::series(runs, vehicle);
        let drawn: usize =
            page.sections.iter().flat_map(|section| &section.figures).map(|figure| figure.file.len()).sum();
        let used = OWN + drawn + series.iter().map(|series| series.to_string().len()).sum::<usize>();
        let data = vehicles::data(&table, &series, vehicle, used);
        if data["stride"] != 1 {
            text.insert(0, format!(
                "{} of {} vehicles are in this table, every {}th and those with curves: all would make the page too large. All figures and the table of the fleet are made from all vehicles.",
                data["shown"], data["all"], data["stride"]
            ));
        }
        page.data = Some(data.to_string());
        let tables = vec![vehicles::table(&table)];
        page.sections.push(Section {
            id: "vehicles".into(),
            title: "Vehicles".into(),
            text,
            tables,
            ..Section::default()
        });
    }
    page.sections
        .retain(|section| !section.tables.is_empty() || !section.figures.is_empty() || !section.text.is_empty());
    Ok(page)
}

fn about(runs: &[RunData]) -> String {
    let egos: Vec<String> = runs
        .iter()
        .map(|run| run.summary.as_ref().map_or(0, |summary| summary.count("vehicles")) as usize)
        .map(|count| counted(count, "equipped vehicle", "equipped vehicles"))
        .collect();
    match runs {
        [_, _] => format!("Two runs side by side: A with {}, B with {}.", egos[0], egos[1]),
        _ => format!("One run of SUMO with {}.", egos[0]),
    }
}

fn fleet_section(runs: &[RunData], folders: &[String]) -> Section {
    let mut section = Section { id: "fleet".into(), title: "The fleet".into(), ..Section::default() };
    let names: Vec<String> = match runs {
        [_, _] => NAMES.iter().zip(folders).map(|(name, folder)| format!("{name}: {folder}")).collect(),
        _ => vec!["vehicles".to_owned()],
    };
    section.tables.extend(counts(runs, &names));
    if let [a, b] = runs {
        let (table, figures) = side_by_side(a, b);
        section.tables.extend(table);
        section.figures = figures;
    } else {
        section.tables.extend(runs.iter().filter_map(fleet));
    }
    section
}

fn error_section(runs: &[RunData]) -> Section {
    let groups = groups(runs);
    let mut section = Section { id: "errors".into(), title: "Errors".into(), ..Section::default() };
    section.figures.extend(distribution(runs, &groups, "error_rms"));
    section.figures.extend(distribution(runs, &groups, "speed_gap_rms"));
    let columns = ["error_rms", "speed_gap_rms", "overshoot_max", "error_max_abs"];
    section.figures.extend(boxes(runs, &groups, &columns, "m/s"));
    section.figures.extend(distribution(runs, &groups, "timeloss"));
    section
}
