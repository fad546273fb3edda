//! The paper's fourteen numbers under one preset, on every recording that was driven, and how many of them came out.

use super::layout::Layout;
use super::published::{self, Published};
use super::reason;
use super::row::{Row, is_on_road};
use super::tally::{Tally, recording_name};
use super::verdict::Count;
use crate::page::{Cell, Head, Section, TableView};

const WHAT: &str = "All numbers that the paper prints about its results. Ten of them are facts of their own: the standard deviation of an error whose mean \
     is about zero is its RMS once more, and a mean within 0.05 m/s of zero says little. The paper's recording is not public; what ours ask for is \
     below. Steps are driven on no recording and are the same in every column. A claim in words is judged in one or several quantities, and came out \
     if it did in all of them.";

/// What is counted, in words, and where it is found.
type Counted = (&'static str, fn(&Tally) -> Count);
const COUNTS: [Counted; 3] =
    [("numbers", |tally| tally.numbers), ("facts", |tally| tally.facts), ("claims in words", |tally| tally.claims)];

/// The section; none if no number was driven.
pub fn section(layout: &Layout) -> Option<Section> {
    let recordings = layout.results.recordings();
    let tallies: Vec<Tally> = recordings.iter().map(|r| layout.results.tally(&layout.preset.name, r)).collect();
    let lines = published::all().filter_map(|number| line(layout, number, &recordings));
    let mut rows: Vec<Vec<Cell>> = lines.collect();
    if rows.is_empty() {
        return None;
    }
    for (what, of) in COUNTS {
        let label = format!("{what} reproduced, and partly");
        let first = [Cell::words(label), Cell::default(), Cell::default(), Cell::default()];
        rows.push(first.into_iter().chain(tallies.iter().map(|tally| counted(of(tally)))).collect());
    }
    let heads =
        [Head::text("number", ""), Head::text("controller", ""), Head::text("it", ""), Head::number("published", "")];
    let names = recordings.iter().map(|r| Head::number(title(layout, r), "mean over the seeds"));
    let table = TableView {
        id: "fourteen-table".into(),
        head: heads.into_iter().chain(names).collect(),
        rows,
        ..TableView::default()
    };
    let title = format!("The paper's fourteen numbers, preset {}", layout.preset.name);
    Some(Section { id: "fourteen".into(), title, text: vec![WHAT.into()], tables: vec![table], ..Section::default() })
}

fn title(layout: &Layout, recording: &str) -> String {
    match layout.recording.filter(|_| recording.is_empty()).and_then(|own| own.file_name()) {
        Some(own) => own.to_string_lossy().into_owned(),
        None => recording_name(recording).to_owned(),
    }
}

fn counted(count: Count) -> Cell {
    Cell::number(format!("{} + {} of {}", count.reproduced, count.partly, count.all()))
}

/// One number on every recording; none if it was driven on none.
fn line(layout: &Layout, number: (&str, &str, &str), recordings: &[&str]) -> Option<Vec<Cell>> {
    let (family, controller, quantity) = number;
    let row = |recording: &str| -> Option<&Row> {
        let test = if is_on_road(family) { format!("{family}{recording}") } else { family.to_owned() };
        let rows = [false, true].map(|n| layout.results.get(&test, &layout.preset.name, n, controller, quantity));
        rows.into_iter().flatten().find(|row| row.is_shown())
    };
    let found: Vec<Option<&Row>> = recordings.iter().map(|recording| row(recording)).collect();
    let any = found.iter().flatten().next()?;
    let published = match any.published()? {
        Published::AtMost(bound) => format!("≤ {bound}"),
        Published::Number { value, .. } => value.to_string(),
    };
    let first = [
        Cell::text(format!("{family}, {quantity}{}", reason::unit(any))),
        Cell::text(controller),
        Cell::words(any.weight().map(|weight| weight.to_string()).unwrap_or_default()),
        Cell::number(published),
    ];
    let shown = |row: &Option<&Row>| {
        row.map_or(Cell::default(), |row| reason::cell(&Row { spread: None, ..row.clone() }, layout.results))
    };
    Some(first.into_iter().chain(found.iter().map(shown)).collect())
}
