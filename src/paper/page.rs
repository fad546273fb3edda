//! The page: the paper's own figures and table with ours in them, under one preset; the rest folded. All verdicts are those of
//! `results.csv`.

use super::fourteen;
use super::lab::{Finding, Lab};
use super::layout::Layout;
use super::library::Preset;
use super::overview::{Ranked, ranked};
use super::rest;
use super::results::Results;
use super::tally::Tally;
use crate::page::{Maker, Page, html};

/// One HTML file with everything in it.
///
/// # Errors
/// If the page's template is wrong.
pub fn page(
    test: &str,
    lab: &Lab,
    presets: &[&Preset],
    results: &Results,
    found: &Finding,
) -> Result<String, minijinja::Error> {
    let ranked = ranked(presets, results);
    let (first, tally) = &ranked[0];
    let layout = Layout { preset: first, results, found, recording: lab.driver.as_deref() };
    let mut page =
        Page { title: "Polack et al. 2017, reproduced".into(), about: about(first, tally), ..Page::default() };
    page.facts = facts(&ranked, lab);
    page.commands.push(["the same again".into(), format!("sumo-mfc paper {test}")]);
    page.sections = layout.sections();
    page.sections.extend(fourteen::section(&layout));
    page.sections.push(rest::section(&layout, &ranked, presets));
    html(&page, &Maker { command: "paper", figures: "figures" })
}

fn about(preset: &Preset, tally: &Tally) -> String {
    if tally.is_empty() {
        return "What lies beyond the paper: nothing of its own was driven.".into();
    }
    let Tally { numbers, facts, claims } = tally;
    format!(
        "The paper's experiments driven again, without SUMO. Under the preset {}, on the first recording, {} of {} published numbers are reproduced and \
         {} partly; of the {} that are facts of their own {} and {}; of {} claims in words {} and {}.",
        preset.name,
        numbers.reproduced,
        numbers.all(),
        numbers.partly,
        facts.all(),
        facts.reproduced,
        facts.partly,
        claims.all(),
        claims.reproduced,
        claims.partly
    )
}

fn facts(ranked: &[Ranked], lab: &Lab) -> Vec<[String; 2]> {
    let (first, tally) = &ranked[0];
    let mut facts = vec![[format!("preset {}", first.name), first.title.clone()]];
    if ranked.len() > 1 && !tally.is_empty() {
        let (reproduced, partly) = tally.rank();
        let why = format!(
            "Of the {} presets it matches the most of what was driven: {reproduced} of {} facts and claims reproduced, {partly} partly. The others \
             are folded below.",
            ranked.len(),
            tally.facts.all() + tally.claims.all()
        );
        facts.push(["why this preset first".to_owned(), why]);
    }
    if let Some(driver) = &lab.driver {
        facts.push(["recording".to_owned(), driver.display().to_string()]);
    }
    facts
}
