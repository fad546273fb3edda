//! What the page has below the paper's own results, folded: the presets beside each other, all numbers of each, and what lies beyond the
//! paper.

use super::demand;
use super::lab::Finding;
use super::layout::Layout;
use super::library::Preset;
use super::overview::{self, Ranked};
use super::reason;
use super::results::Results;
use super::row::{Row, family};
use super::verdict::Verdict;
use crate::figure::Figure;
use crate::page::{Cell, FigureView, Head, Section, TableView};

/// Tests in the order of the page, with their titles.
const TESTS: [(&str, &str); 5] = [
    ("step", "Steps of position"),
    ("sine", "Sinusoid of position"),
    ("driver", "A driver's recording"),
    ("delay", "250 ms between command and torque"),
    ("disturb", "Disturbances"),
];

/// What lies beyond the paper: test, title, what it is.
const BEYOND: [(&str, &str, &str); 2] = [
    (
        "map",
        "Where adaptation helps",
        "Not in the paper: nobody has published where in the space of its open values the adaptive law is better. RMS error on SUMO's racing lap with noise and \
         overshoot of the first step over torque scale, K_P, control period, torque limit and delay; T = 0.2 s, the same gains for both laws. Blue: the \
         adaptive law is better. The ring is the preset default. Laws at gains of their own, tuned alike, are compared by sumo-mfc tune (make tuning).",
    ),
    (
        "law",
        "A law behind the step test",
        "Not in the paper: where the torque scale is much weaker than α says, the overshoots of the two laws are in the ratio 2√(Δt/T), whatever mass, \
         K_P, α and torque limit. The published ratios are 0.41. Every point is a pair of step tests. docs/overshoot-ratio.md derives the law.",
    ),
];

const DISTURBANCES: &str = "Section 2 of the paper: no vehicle data is needed; external disturbances are part of F and rejected with it. The paper shows no test. The \
     sinusoid of 200 m again. From s = 200 m on one thing is other than before. Numbers are RMS errors from there to the end at 600 m; pid is the \
     baseline with its own default tuning. The bounds are those of the paper's own errors in Table 2, and not ratios to the undisturbed drive, which a law \
     that follows badly keeps easily. A disturbance under which torque or tyres cannot do what the sinusoid asks for is left out.";
const SHORT_SINE: &str = "sine_200m is a sinusoid of 200 m, which asks for 2.5 m/s² in place of 0.8: how much hangs on what the paper leaves open.";
const RECORDINGS: &str = "driver is our lap, straight; driver_path the same along the reconstructed path; driver_racing and driver_racing_path are SUMO's racing lap; \
     driver_udds and driver_hwfet are the EPA driving cycles. Under the preset default the other laws drive too, with their own default gains.";

const DEMANDS: &str = "Errors grow with what a recording asks for. Ours beside two of people that others published, from which we took these figures by the same formulas: a lap driven by hand on a handling \
     course, and a racing driver. UDDS and HWFET were put together from recordings of drivers in \
     traffic; both are limited to 1.5 m/s² for the dynamometers of their time.";

const PAPER: &str = "The paper: P. Polack, B. d'Andréa-Novel, M. Fliess, A. de La Fortelle, L. Menhour: Finite-Time Stabilization of Longitudinal Control for \
     Autonomous Vehicles via a Model-Free Approach, IFAC World Congress 2017.";

/// Everything that the first part of the page does not show.
pub fn section(layout: &Layout, ranked: &[Ranked], presets: &[&Preset]) -> Section {
    let (results, found) = (layout.results, layout.found);
    let mut parts =
        vec![verdicts(), folded("demand", "What the recordings ask for", DEMANDS, vec![demand::table(&demand::all())])];
    parts.extend(overview::sections(ranked, presets, results));
    // The first preset, then the others as they are listed.
    let others = presets.iter().filter(|p| p.name != layout.preset.name);
    for preset in [layout.preset].into_iter().chain(others.copied()) {
        parts.extend(of_preset(preset, layout));
    }
    for (test, title, text) in BEYOND {
        // A preset may be called like a test.
        let is_preset = |f: &Figure| presets.iter().any(|p| f.name.starts_with(&format!("{}_", p.name)));
        let once = found.figures.iter().filter(|f| f.name.starts_with(&format!("{test}_")) && !is_preset(f));
        let figures: Vec<FigureView> = once.map(|figure| FigureView::new(figure, "")).collect();
        if !figures.is_empty() {
            parts.push(Section { figures, ..folded(test, title, text, Vec::new()) });
        }
    }
    Section {
        id: "rest".into(),
        title: "All presets and numbers".into(),
        text: vec![PAPER.into(), "Folded below: the other presets, all numbers of each, and what lies beyond the paper. What is unfolded is printed too. Every number is in results.csv beside this page, what the figures show in series/.".into()],
        parts,
        ..Section::default()
    }
}

fn folded(id: &str, title: &str, text: &str, tables: Vec<TableView>) -> Section {
    let text = if text.is_empty() { Vec::new() } else { vec![text.to_owned()] };
    Section { id: id.to_owned(), title: title.to_owned(), text, tables, folded: true, ..Section::default() }
}

fn verdicts() -> Section {
    let meaning = [
        (
            Verdict::Reproduced,
            "The number is within its tolerance: overshoots within 1 and 0.7 points for classic, 0.7 and 0.5 for adaptive; standard deviation and RMS within 15 %; mean within 0.05 m/s.",
        ),
        (
            Verdict::Partly,
            "Not the number, but within a factor of 2 of it, and adaptive gains at least half of what it gains in the paper.",
        ),
        (Verdict::NotReproduced, "Neither."),
    ];
    let row = |(verdict, text): (Verdict, &str)| {
        vec![Cell::number(verdict.to_string()).shown_as(reason::class(verdict)), Cell::words(text)]
    };
    let table = TableView {
        id: "verdicts".into(),
        head: vec![Head::text("verdict", ""), Head::text("of a published number", "")],
        rows: meaning.map(row).into(),
        ..TableView::default()
    };
    let text = "A claim in words is judged by a criterion, the same for every preset, that is told with each verdict.";
    folded("verdict-meanings", "What the verdicts mean", text, vec![table])
}

/// All tests under one preset; of the first preset the figures that are not above.
fn of_preset(preset: &Preset, layout: &Layout) -> Option<Section> {
    let (results, found) = (layout.results, layout.found);
    let mut parts = Vec::new();
    for (test, title) in TESTS {
        let rows: Vec<&Row> =
            results.rows.iter().filter(|r| family(&r.test) == test && r.preset == preset.name).collect();
        if rows.is_empty() {
            continue;
        }
        let text = match test {
            "sine" => SHORT_SINE,
            "driver" => RECORDINGS,
            "disturb" => DISTURBANCES,
            _ => "",
        };
        let text = if text.is_empty() { Vec::new() } else { vec![text.to_owned()] };
        let (id, title) = (format!("{}-{test}", preset.name), title.to_owned());
        let tables = vec![table(&format!("{id}-numbers"), &rows, results)];
        let figures = figures(preset, test, layout, found);
        parts.push(Section { id, title, text, tables, figures, nested: true, ..Section::default() });
    }
    let title = format!("Preset {}: {}", preset.name, preset.title);
    let section = Section { parts, ..folded(&format!("preset-{}", preset.name), &title, "", Vec::new()) };
    (!section.parts.is_empty()).then_some(section)
}

/// Of the presets but the first, the page has the errors; all figures are files as well.
fn figures(preset: &Preset, test: &str, layout: &Layout, found: &Finding) -> Vec<FigureView> {
    let prefix = format!("{}_{test}_", preset.name);
    let all = preset.name == layout.preset.name || test == "step" || test == "disturb";
    let wanted = |f: &&Figure| f.name.starts_with(&prefix) && !layout.shows(f) && (all || f.name.ends_with("error"));
    found.figures.iter().filter(wanted).map(|figure| FigureView::new(figure, "")).collect()
}

fn table(id: &str, rows: &[&Row], results: &Results) -> TableView {
    let head = vec![
        Head::text("test", ""),
        Head::text("controller", ""),
        Head::text("quantity", "as in results.csv"),
        Head::number("without noise", ""),
        Head::number("with noise", "mean ± standard deviation over the seeds"),
        Head::text("published", ""),
        Head::text("verdict, and why", ""),
    ];
    let line = |row: &&&Row| {
        let noisy = results.get(&row.test, &row.preset, true, row.controller, row.quantity);
        let judged = if row.is_shown() || noisy.is_none_or(|n| !n.is_shown()) { Some(**row) } else { noisy };
        let why = judged.and_then(|r| Some(format!("{}: {}", results.verdict(r)?, reason::why(r, results))));
        vec![
            Cell::text(&row.test),
            Cell::text(row.controller),
            Cell::text(format!("{}{}", row.quantity, reason::unit(row))),
            reason::cell(row, results),
            noisy.map_or(Cell::default(), |n| reason::cell(n, results)),
            Cell::words(reason::published(row)),
            Cell::words(why.unwrap_or_default()),
        ]
    };
    let rows = rows.iter().filter(|r| !r.noise).map(|row| line(&row)).collect();
    TableView { id: id.to_owned(), head, rows, ..TableView::default() }
}
