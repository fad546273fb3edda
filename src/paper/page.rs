//! The page: the paper's own figures and table with ours in them, under one preset; the rest folded. All verdicts are those of
//! `results.csv`.

use super::lab::{Finding, Lab};
use super::layout::Layout;
use super::library::Preset;
use super::overview::{Ranked, ranked, total};
use super::rest;
use super::results::Results;
use super::verdict::Count;
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
    let (first, counts) = &ranked[0];
    let layout = Layout { preset: first, results, found, recording: lab.driver.as_deref() };
    let mut page =
        Page { title: "Polack et al. 2017, reproduced".into(), about: about(first, counts), ..Page::default() };
    page.facts = facts(&ranked, lab);
    page.commands.push(["the same again".into(), format!("sumo-mfc paper {test}")]);
    page.sections = layout.sections();
    page.sections.push(rest::section(&layout, &ranked, presets));
    html(&page, &Maker { command: "paper", figures: "figures" })
}

fn about(preset: &Preset, [numbers, words]: &[Count; 2]) -> String {
    if numbers.all() + words.all() == 0 {
        return "What lies beyond the paper: nothing of its own was driven.".into();
    }
    format!(
        "The paper's experiments driven again, without SUMO. Under the preset {} {} of {} published numbers are reproduced and {} partly; of {} \
         claims in words {} and {}.",
        preset.name,
        numbers.reproduced,
        numbers.all(),
        numbers.partly,
        words.all(),
        words.reproduced,
        words.partly
    )
}

fn facts(ranked: &[Ranked], lab: &Lab) -> Vec<[String; 2]> {
    let (first, counts) = &ranked[0];
    let mut facts = vec![[format!("preset {}", first.name), first.title.clone()]];
    if ranked.len() > 1 && total(counts).all() > 0 {
        let Count { reproduced, partly, .. } = total(counts);
        let why = format!(
            "Of the {} presets it matches the most of what was driven: {reproduced} of {} numbers and claims reproduced, {partly} partly. The others \
             are folded below.",
            ranked.len(),
            total(counts).all()
        );
        facts.push(["why this preset first".to_owned(), why]);
    }
    if let Some(driver) = &lab.driver {
        facts.push(["recording".to_owned(), driver.display().to_string()]);
    }
    facts
}
