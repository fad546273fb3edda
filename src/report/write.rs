//! From folders to a page and its figures.

use super::data::RunData;
use super::error::ReportError;
use super::run_page;
use super::study_data::{STUDY, StudyData};
use super::study_page;
use crate::output::write_whole;
use crate::page::{Maker, Page, Section, html};
use crate::run::MANIFEST;
use std::path::{Path, PathBuf};

/// What a report leaves in the folder of a result: name, meaning.
pub const FILES: [[&str; 2]; 2] = [
    ["report.html", "The result as a page, which needs no other file and no network"],
    ["report/", "The figures of the page, as SVG"],
];

/// What a report is made of.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// One result folder, or two to compare.
    pub dirs: Vec<PathBuf>,
    /// The page \[default: `report.html` in the first folder\].
    pub out: Option<PathBuf>,
    /// A vehicle to show at once.
    pub vehicle: Option<String>,
}

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// The page.
    pub page: PathBuf,
    /// The folder of its figures.
    pub figures: PathBuf,
}

/// Writes the page of a result, and each of its figures as SVG into a folder of the same name beside it.
///
/// # Errors
/// [`ReportError`] if a folder holds no result, a file cannot be read or is not as it should be, or the disk is full.
pub fn report(request: &Request) -> Result<Written, ReportError> {
    let vehicle = request.vehicle.as_deref();
    let page = match request.dirs.as_slice() {
        [] => return Err(ReportError::Many(0)),
        [_] | [_, _] => page(&request.dirs, vehicle)?,
        more => return Err(ReportError::Many(more.len())),
    };
    let path = request.out.clone().unwrap_or_else(|| request.dirs[0].join("report.html"));
    let figures = match path.extension() {
        Some(_) => path.with_extension(""),
        None => path.with_extension("figures"),
    };
    for figure in page.sections.iter().flat_map(Section::all_figures) {
        write_whole(&figures.join(format!("{}.svg", figure.name)), &figure.file)?;
    }
    let folder = figures.file_name().unwrap_or_default().to_string_lossy();
    write_whole(&path, &html(&page, &Maker { command: "report", figures: &folder })?)?;
    Ok(Written { page: path, figures })
}

fn page(dirs: &[PathBuf], vehicle: Option<&str>) -> Result<Page, ReportError> {
    let is_study = |dir: &Path| match (dir.join(STUDY).is_file(), dir.join(MANIFEST).is_file()) {
        (true, _) => Ok(true),
        (_, true) => Ok(false),
        _ => Err(ReportError::NoResult(dir.to_owned())),
    };
    let studies = dirs.iter().filter_map(|dir| is_study(dir).map(|study| study.then_some(dir)).transpose());
    let studies: Vec<&PathBuf> = studies.collect::<Result<_, _>>()?;
    if studies.is_empty() {
        let runs: Vec<RunData> = dirs.iter().map(|dir| RunData::read(dir)).collect::<Result<_, _>>()?;
        return run_page::page(&runs, vehicle);
    }
    if let Some(run) = dirs.iter().find(|dir| !studies.contains(dir)) {
        return Err(ReportError::Mixed(run.clone(), studies[0].clone()));
    }
    if let Some(id) = vehicle {
        let near = "; a study has no single vehicles: ask for the report of one of its cases".to_owned();
        return Err(ReportError::Vehicle { id: id.to_owned(), near });
    }
    let studies: Vec<StudyData> = studies.iter().map(|dir| StudyData::read(dir)).collect::<Result<_, _>>()?;
    Ok(study_page::page(&studies))
}
