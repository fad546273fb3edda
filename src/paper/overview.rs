//! The presets beside each other: what they are, which matches the most, and each of the paper's numbers and claims under all of them.

use super::claims;
use super::library::Preset;
use super::reason;
use super::results::Results;
use super::row::Row;
use super::tally::Tally;
use crate::page::{Cell, Head, Section, TableView};
use std::cmp::Reverse;

/// A preset with its counts on the first recording.
pub type Ranked<'a> = (&'a Preset, Tally);

/// The presets, those that match the most first; equal ones as they are listed.
pub fn ranked<'a>(presets: &[&'a Preset], results: &Results) -> Vec<Ranked<'a>> {
    let mut ranked: Vec<Ranked> = presets.iter().map(|p| (*p, results.tally(&p.name, ""))).collect();
    ranked.sort_by_key(|(_, tally)| Reverse(tally.rank()));
    ranked
}

/// What the presets are, how they rank, and what comes out under each of them.
pub fn sections(ranked: &[Ranked], presets: &[&Preset], results: &Results) -> Vec<Section> {
    let folded = |id: &str, title: &str, text: &str, table: TableView| Section {
        id: id.to_owned(),
        title: title.to_owned(),
        text: if text.is_empty() { Vec::new() } else { vec![text.to_owned()] },
        tables: vec![table],
        folded: true,
        ..Section::default()
    };
    let of_presets = "The paper leaves open the vehicle, the control period, K_P, the torque's scale and limits, where the steps are and \
                      what the driver drove. A preset is one choice of all that, and every test runs under every preset: nothing is \
                      picked test by test. A preset was fitted to some of the published numbers, so that it meets these is no evidence that it is what \
                      the authors used; what it says about the others is.";
    let of_ranking = "With the first recording: steps and sinusoid without noise, the recording with noise, mean over the seeds. Ranked by facts and \
                      claims; the numbers that are no facts of their own do not count here, nor do the disturbances, of which the paper shows no test. \
                      counts.csv has every preset on every recording.";
    let glances = [
        glance("numbers", presets, results, &|r| r.published().is_some()),
        glance("claims", presets, results, &|r| claims::about(r).is_some()),
    ];
    let titles = ["Published numbers against presets", "Claims in words against presets"];
    let mut sections = vec![folded("presets", "What the presets are", of_presets, meanings(presets))];
    if ranked.iter().any(|(_, tally)| !tally.is_empty()) {
        sections.push(folded("ranking", "Which preset matches the most", of_ranking, ranking(ranked)));
    }
    for (table, title) in glances.into_iter().zip(titles).filter(|(table, _)| !table.rows.is_empty()) {
        sections.push(folded(&format!("all-{}", table.id), title, "", table));
    }
    sections
}

fn meanings(presets: &[&Preset]) -> TableView {
    let row = |p: &&Preset| vec![Cell::text(&p.name), Cell::words(format!("{}. {}", p.title, p.why))];
    TableView {
        id: "preset-meanings".into(),
        head: vec![Head::text("preset", ""), Head::text("what it is", "")],
        rows: presets.iter().map(row).collect(),
        ..TableView::default()
    }
}

fn ranking(ranked: &[Ranked]) -> TableView {
    let groups = ["numbers", "facts", "claims"];
    let head = groups.iter().flat_map(|group| {
        ["reproduced", "partly", "not"].map(|verdict| Head::number(format!("{group}: {verdict}"), ""))
    });
    let row = |(preset, tally): &Ranked| {
        let counts = [tally.numbers, tally.facts, tally.claims].into_iter().flat_map(|count| {
            [(count.reproduced, "yes"), (count.partly, "part"), (count.not, "no")]
                .map(|(count, class)| Cell::number(count.to_string()).shown_as(class))
        });
        [Cell::text(&preset.name)].into_iter().chain(counts).collect()
    };
    TableView {
        id: "ranking-table".into(),
        head: [Head::text("preset", "")].into_iter().chain(head).collect(),
        rows: ranked.iter().map(row).collect(),
        ..TableView::default()
    }
}

/// What the paper says of quantities that `wanted` picks, against presets.
fn glance(id: &str, presets: &[&Preset], results: &Results, wanted: &dyn Fn(&Row) -> bool) -> TableView {
    let mut shown: Vec<&Row> = Vec::new();
    for row in results.rows.iter().filter(|r| wanted(r) && r.is_shown()) {
        if !shown.iter().any(|w| (&w.test, w.controller, w.quantity) == (&row.test, row.controller, row.quantity)) {
            shown.push(row);
        }
    }
    let heads = ["test", "quantity", "published"].map(|name| Head::text(name, ""));
    let names = presets.iter().map(|p| Head::number(&p.name, &p.title));
    let row = |w: &&Row| {
        let first = [
            Cell::text(format!("{}, {}", w.test, w.controller)),
            Cell::text(format!("{}{}", w.quantity, reason::unit(w))),
            Cell::words(reason::published(w)),
        ];
        let under = presets.iter().map(|p| {
            let row = results.get(&w.test, &p.name, w.noise, w.controller, w.quantity);
            row.map_or(Cell::default(), |row| reason::cell(&Row { spread: None, ..row.clone() }, results))
        });
        first.into_iter().chain(under).collect()
    };
    TableView {
        id: id.to_owned(),
        head: heads.into_iter().chain(names).collect(),
        rows: shown.iter().map(row).collect(),
        ..TableView::default()
    }
}
