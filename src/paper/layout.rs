//! The results of the paper in its own order and numbering, Figures 2 to 9 and Table 2, with ours in them: one preset.

use super::lab::Finding;
use super::library::Preset;
use super::reason;
use super::results::Results;
use super::row::Row;
use crate::figure::Figure;
use crate::page::{Cell, FigureView, Head, Section, TableView};
use std::path::Path;

/// A quantity beside a figure: the controller, its name in `results.csv`, and in words.
type Quantity = (&'static str, &'static str, &'static str);

/// A figure of the paper.
struct PaperFigure {
    number: u8,
    /// The end of the name of our figure.
    what: &'static str,
    title: &'static str,
    /// The paper's caption.
    caption: &'static str,
    /// What is ours in it.
    ours: &'static str,
    /// What the paper says that can be read off it.
    quantities: &'static [Quantity],
}

/// A part of the paper's Section 5.
struct Chapter {
    /// The test that it is about.
    test: &'static str,
    title: &'static str,
    /// How it is done here.
    here: &'static str,
    figures: &'static [PaperFigure],
    /// What the paper says without a figure.
    words: &'static [Quantity],
}

const CHAPTERS: &[Chapter] = &[
    Chapter {
        test: "step",
        title: "5.1 Steps",
        here: "From rest, 10 m/s from s = 0 and 20 m/s from s = 100 m; the paper gives neither heights nor places. Overshoot and undershoot are \
               relative to the target; settled means within 2 % of it until the next step or the end at 600 m, and of the torque within 5 % of \
               its largest value.",
        figures: &[
            PaperFigure {
                number: 2,
                what: "speed",
                title: "speed",
                caption: "Comparison of the longitudinal speeds between classic and adaptive model-free control to successive steps in target speed",
                ours: "Dotted: how high the published overshoots reach above these targets.",
                quantities: &[
                    ("classic", "overshoot_1", "classic, overshoot of the first step"),
                    ("classic", "overshoot_2", "classic, overshoot of the second step"),
                    ("adaptive", "overshoot_1", "adaptive, overshoot of the first step"),
                    ("adaptive", "overshoot_2", "adaptive, overshoot of the second step"),
                ],
            },
            PaperFigure {
                number: 3,
                what: "error",
                title: "speed error",
                caption: "Comparison of the longitudinal speed errors (ground truth) between classic and adaptive model-free control to successive steps in target speed",
                ours: "Dotted: the published overshoots as errors. The paper reads off this figure that the adaptive law has settled after 50 to 100 m.",
                quantities: &[
                    ("adaptive", "settling_1", "adaptive, metres until settled, first step"),
                    ("adaptive", "settling_2", "adaptive, metres until settled, second step"),
                    ("classic", "undershoot_1", "classic, undershoot of the first step"),
                    ("classic", "undershoot_2", "classic, undershoot of the second step"),
                    ("adaptive", "undershoot_1", "adaptive, undershoot of the first step"),
                    ("adaptive", "undershoot_2", "adaptive, undershoot of the second step"),
                ],
            },
            PaperFigure {
                number: 4,
                what: "torque",
                title: "torque of one front wheel",
                caption: "Comparison of the computed motor/brake torque control input for one of the front wheel between the classic and adaptive model-free approach to successive steps in target speed",
                ours: "",
                quantities: &[
                    ("adaptive", "torque_settling_1", "adaptive, metres until the torque is near 0, first step"),
                    ("adaptive", "torque_settling_2", "adaptive, metres until the torque is near 0, second step"),
                ],
            },
            PaperFigure {
                number: 5,
                what: "alpha",
                title: "the adapted gain α̂",
                caption: "Evolution of the estimation of α̂(t) with the curvilinear abscissa for successive steps in target speed",
                ours: "Relative to nominal, on a logarithmic axis. The strip below the curve is where α̂ is within 5 % of nominal; the shares are of the time.",
                quantities: &[
                    ("adaptive", "alpha_nominal_share", "share of the time with α̂ exactly nominal"),
                    ("adaptive", "alpha_ratio_max", "largest α̂ over nominal while the speed exceeds the target"),
                ],
            },
        ],
        words: &[("adaptive", "jerk_rms", "adaptive, RMS of the jerk (abstract, conclusion)")],
    },
    Chapter {
        test: "sine",
        title: "5.2 Sinusoid",
        here: "From rest onto 15 m/s + 5 m/s sin(2π s/600 m), three wavelengths; the paper gives neither range nor wavelength, and no number. Its words speak \
               for a slow sinusoid: both laws do about the same, so neither is at its torque limit. Overshoot is taken in the first oscillation after the \
               reference was first reached; settled, or converged, means within 5 % of the reference for the rest of it. From there on the RMS error is taken: \
               before, the launch from rest decides it, which is the torque limit's.",
        figures: &[
            PaperFigure {
                number: 6,
                what: "speed",
                title: "speed",
                caption: "Comparison of the longitudinal speeds between classic and adaptive model-free control to a sinusoidal target speed",
                ours: "",
                quantities: &[
                    ("adaptive", "settling_1", "adaptive, metres until settled"),
                    ("adaptive", "overshoot_1", "adaptive, overshoot in the first oscillation"),
                ],
            },
            PaperFigure {
                number: 7,
                what: "error",
                title: "speed error",
                caption: "Comparison of the longitudinal speed errors (ground truth) between classic and adaptive model-free control to a sinusoidal target speed",
                ours: "",
                quantities: &[("adaptive", "error_rms_converged", "adaptive, RMS error once converged")],
            },
        ],
        words: &[],
    },
    Chapter {
        test: "driver",
        title: "5.3 Driver's recording",
        here: "The paper's recording is not public, so neither curves nor errors can be the same: errors grow with what a recording asks for.",
        figures: &[
            PaperFigure {
                number: 8,
                what: "speed",
                title: "speed",
                caption: "Comparison of the longitudinal speeds between classic and adaptive model-free control on real driver reference data",
                ours: "Its numbers are in Table 2.",
                quantities: &[],
            },
            PaperFigure {
                number: 9,
                what: "error",
                title: "speed error",
                caption: "Comparison of the longitudinal speed errors (ground truth) between classic and adaptive model-free control on real driver reference data",
                ours: "Its numbers are in Table 2.",
                quantities: &[],
            },
        ],
        words: &[("adaptive", "jerk_rms", "adaptive, RMS of the jerk (abstract, conclusion)")],
    },
    Chapter {
        test: "delay",
        title: "5.4 Delay of 250 ms",
        here: "The recording again. The paper has no figure of it.",
        figures: &[],
        words: &[
            ("classic", "error_rms", "classic, RMS error"),
            ("adaptive", "error_rms", "adaptive, RMS error"),
            ("adaptive", "rms_over_prompt_classic", "adaptive with delay over classic without, RMS error"),
        ],
    },
];

const LAP: &str = "Ours is a lap of a circuit of our own by a driver of our own (sumo-mfc paper record), brisk as a handling lap of a human is; what it asks for is below, beside SUMO's racing lap and the EPA cycles UDDS and HWFET.";
const OF_DRIVES: &str = "The figures are of the drive without noise, the numbers means over 20 seeds of noise.";

/// The columns of Table 2: our name, and the paper's.
const TABLE_2: [(&str, &str); 3] =
    [("error_mean", "Average"), ("error_std", "Std. dev."), ("error_rms", "Root mean square")];
const TABLE_2_CAPTION: &str =
    "Comparison between the error of classic MFC and adaptive MFC on real driver reference data";

/// One preset's results.
pub struct Layout<'a> {
    /// The preset.
    pub preset: &'a Preset,
    /// All numbers.
    pub results: &'a Results,
    /// All figures.
    pub found: &'a Finding,
    /// Somebody's own recording, in place of ours.
    pub recording: Option<&'a Path>,
}

impl Layout<'_> {
    /// A section per part of the paper's Section 5. What was not driven is named; nothing if no part was.
    pub fn sections(&self) -> Vec<Section> {
        if CHAPTERS.iter().any(|chapter| self.has(chapter.test)) {
            CHAPTERS.iter().map(|chapter| self.chapter(chapter)).collect()
        } else {
            Vec::new()
        }
    }

    /// The figures that [`Self::sections`] have.
    pub fn shows(&self, figure: &Figure) -> bool {
        let is = |chapter: &Chapter, it: &PaperFigure| figure.name == self.name(chapter, it);
        CHAPTERS.iter().any(|chapter| chapter.figures.iter().any(|it| is(chapter, it)))
    }

    fn name(&self, chapter: &Chapter, figure: &PaperFigure) -> String {
        format!("{}_{}_{}", self.preset.name, chapter.test, figure.what)
    }

    fn has(&self, test: &str) -> bool {
        self.results.rows.iter().any(|row| row.test == test && row.preset == self.preset.name)
    }

    /// The row that stands for what the paper shows.
    fn row(&self, test: &str, (controller, quantity, _): Quantity) -> Option<&Row> {
        let rows = [false, true].map(|noise| self.results.get(test, &self.preset.name, noise, controller, quantity));
        rows.into_iter().flatten().find(|row| row.is_shown())
    }

    fn chapter(&self, chapter: &Chapter) -> Section {
        let mut parts: Vec<Section> = chapter.figures.iter().map(|figure| self.figure(chapter, figure)).collect();
        if chapter.test == "driver" {
            parts.push(self.table_2());
        }
        let words = self.table(&format!("{}-words", chapter.test), chapter.test, chapter.words);
        let title = if chapter.figures.is_empty() { "In the text" } else { "Without a figure" };
        if !words.rows.is_empty() {
            parts.push(part(&format!("{}-text", chapter.test), title, vec![words]));
        }
        parts.extend(self.other_recordings(chapter));
        let text = match self.recording.filter(|_| chapter.test == "driver") {
            _ if !self.has(chapter.test) => not_driven(chapter.test),
            Some(own) => format!("{} Driven here: {}. {OF_DRIVES}", chapter.here, own.display()),
            None if chapter.test == "driver" => format!("{} {LAP} {OF_DRIVES}", chapter.here),
            None => chapter.here.to_owned(),
        };
        Section { id: chapter.test.into(), title: chapter.title.into(), text: vec![text], parts, ..Section::default() }
    }

    fn figure(&self, chapter: &Chapter, figure: &PaperFigure) -> Section {
        let title = format!("Figure {}: {}", figure.number, figure.title);
        let mut section = part(&format!("figure-{}", figure.number), &title, Vec::new());
        let name = self.name(chapter, figure);
        let Some(drawn) = self.found.figures.iter().find(|f| f.name == name) else {
            section.text.push(not_driven(chapter.test));
            return section;
        };
        let caption = format!("In the paper: “{}.” {}", figure.caption, figure.ours);
        section.figures.push(FigureView::new(drawn, caption.trim()));
        section.tables.push(self.table(&format!("figure-{}-numbers", figure.number), chapter.test, figure.quantities));
        if section.tables[0].rows.is_empty() {
            section.tables.clear();
        }
        section.beside = true;
        section
    }

    fn table(&self, id: &str, test: &str, quantities: &[Quantity]) -> TableView {
        let line = |it: &Quantity| reason::line(it.2.to_owned(), self.row(test, *it)?, self.results);
        let rows = quantities.iter().filter_map(line).collect();
        TableView { id: id.to_owned(), head: reason::head(), rows, ..TableView::default() }
    }

    fn table_2(&self) -> Section {
        let mut section = part("table-2", "Table 2: the error", Vec::new());
        if self.has("driver") {
            section.tables.push(self.errors("table2", "driver"));
        } else {
            section.text.push(not_driven("driver"));
        }
        section
    }

    /// Table 2 as it is printed, with ours beside each number, for one recording.
    fn errors(&self, id: &str, test: &str) -> TableView {
        let columns = TABLE_2.iter().flat_map(|(_, title)| {
            [
                Head::number(format!("{title}: paper"), "m/s"),
                Head::number("ours", "m/s, mean ± standard deviation over the seeds"),
            ]
        });
        let head = [Head::text("MFC", "")].into_iter().chain(columns).chain([Head::text("verdict, and why", "")]);
        let row = |controller: &'static str| {
            let mut cells = vec![Cell::text(controller)];
            let mut reasons = Vec::new();
            for (quantity, title) in TABLE_2 {
                let row = self.row(test, (controller, quantity, ""))?;
                let verdict = self.results.verdict(row)?;
                cells.extend([Cell::number(reason::published(row)), reason::cell(row, self.results)]);
                reasons.push(format!("{title} {verdict}: {}", reason::why(row, self.results)));
            }
            cells.push(Cell::words(reasons.join("\n")));
            Some(cells)
        };
        TableView {
            id: id.to_owned(),
            caption: format!("In the paper: “{TABLE_2_CAPTION}.” [m/s]"),
            head: head.collect(),
            rows: ["adaptive", "classic"].into_iter().filter_map(row).collect(),
            ..TableView::default()
        }
    }

    /// The same numbers on what else was driven.
    fn other_recordings(&self, chapter: &Chapter) -> Option<Section> {
        let prefix = format!("{}_", chapter.test);
        let mut tests: Vec<&str> = Vec::new();
        for row in self.results.rows.iter().filter(|r| r.preset == self.preset.name && r.test.starts_with(&prefix)) {
            if !tests.contains(&row.test.as_str()) {
                tests.push(&row.test);
            }
        }
        let mut tables = Vec::new();
        for test in tests.into_iter().filter(|test| self.results.rows.iter().any(|r| r.test == *test && r.is_shown())) {
            let table = if chapter.test == "driver" {
                let title = format!("Table 2 on {test}");
                TableView { fold: title, open: true, ..self.errors(&format!("table2-{test}"), test) }
            } else {
                TableView {
                    fold: test.to_owned(),
                    open: true,
                    ..self.table(&format!("words-{test}"), test, chapter.words)
                }
            };
            tables.push(table);
        }
        let title = "The same on the other recordings";
        let section = Section { folded: true, ..part(&format!("{}-others", chapter.test), title, tables) };
        (!section.tables.is_empty()).then_some(section)
    }
}

fn part(id: &str, title: &str, tables: Vec<TableView>) -> Section {
    Section { id: id.to_owned(), title: title.to_owned(), tables, nested: true, ..Section::default() }
}

fn not_driven(test: &str) -> String {
    format!(
        "Not on this page, because its test was not asked for: sumo-mfc paper {test} drives it, sumo-mfc paper all drives all."
    )
}
