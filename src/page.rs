//! What a page says, and the template that makes HTML of it: the report's pages and the paper's are made here.
//!
//! A page is one file that asks nobody for anything. Everything that it says can be read without JavaScript.

use crate::figure::{Figure, style};
use minijinja::value::Serde;
use minijinja::{Environment, Value, context};
use serde::Serialize;

const TEMPLATE: &str = include_str!("page/templates/page.html");
const STYLE: &str = include_str!("page/templates/style.css");
const SCRIPT: &str = include_str!("page/templates/report.js");
const CHART_SCRIPT: &str = include_str!("page/templates/uplot/uPlot.iife.min.js");
const CHART_STYLE: &str = include_str!("page/templates/uplot/uPlot.min.css");
const CHART_LICENCE: &str = include_str!("page/templates/uplot/LICENSE");

/// A page.
#[derive(Debug, Default, Serialize)]
pub struct Page {
    /// Title.
    pub title: String,
    /// What it is about, in a sentence.
    pub about: String,
    /// What was run, label and value.
    pub facts: Vec<[String; 2]>,
    /// Commands that do it again, each with what it does.
    pub commands: Vec<[String; 2]>,
    /// The input files, path and SHA-256.
    pub inputs: Vec<[String; 2]>,
    /// What a reader has to know before believing the numbers.
    pub warnings: Vec<String>,
    /// Notes of the run.
    pub notes: Vec<String>,
    /// What came out.
    pub sections: Vec<Section>,
    /// Data of the script, JSON.
    #[serde(skip)]
    pub data: Option<String>,
}

/// A part of a page.
#[derive(Debug, Default, Serialize)]
pub struct Section {
    /// Its anchor.
    pub id: String,
    /// Title.
    pub title: String,
    /// Sentences above everything.
    pub text: Vec<String>,
    /// Tables.
    pub tables: Vec<TableView>,
    /// Figures.
    pub figures: Vec<FigureView>,
    /// A part of the section above: its title is smaller.
    pub nested: bool,
    /// Folded below its title.
    pub folded: bool,
    /// The figures stand first, and the tables beside them where there is room.
    pub beside: bool,
    /// Smaller parts.
    pub parts: Vec<Section>,
}

impl Section {
    /// All figures, those of its parts included.
    pub fn all_figures(&self) -> impl Iterator<Item = &FigureView> {
        let of_parts: Vec<&FigureView> =
            self.parts.iter().flat_map(|part| part.all_figures().collect::<Vec<_>>()).collect();
        self.figures.iter().chain(of_parts)
    }
}

/// A cell: its text, and classes that say how it is shown (`text`, `words` for whole sentences, nothing for numbers; `yes`,
/// `part`, `no` for verdicts, `bad`, `sure`).
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Cell {
    /// What it says.
    pub text: String,
    /// How it is shown.
    pub class: &'static str,
}

impl Cell {
    /// A text.
    pub fn text(text: impl Into<String>) -> Self {
        Self { text: text.into(), class: "text" }
    }

    /// A number.
    pub fn number(text: impl Into<String>) -> Self {
        Self { text: text.into(), class: "" }
    }

    /// A sentence.
    pub fn words(text: impl Into<String>) -> Self {
        Self { text: text.into(), class: "text words" }
    }

    /// In another class.
    #[must_use]
    pub fn shown_as(self, class: &'static str) -> Self {
        Self { class, ..self }
    }
}

/// The header of a column.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Head {
    /// What it says.
    pub text: String,
    /// What the column means.
    pub meaning: String,
    /// As of a cell.
    pub class: &'static str,
}

impl Head {
    /// A column of texts.
    pub fn text(text: impl Into<String>, meaning: impl Into<String>) -> Self {
        Self { text: text.into(), meaning: meaning.into(), class: "text" }
    }

    /// A column of numbers.
    pub fn number(text: impl Into<String>, meaning: impl Into<String>) -> Self {
        Self { text: text.into(), meaning: meaning.into(), class: "" }
    }
}

/// A table.
#[derive(Debug, Clone, Default, Serialize)]
pub struct TableView {
    /// Its id, for the script and the tests.
    pub id: String,
    /// One sentence on what it shows.
    pub caption: String,
    /// If not empty, the table is folded below this line.
    pub fold: String,
    /// Whether a folded table is shown at first.
    pub open: bool,
    /// The columns.
    pub head: Vec<Head>,
    /// The rows.
    pub rows: Vec<Vec<Cell>>,
}

/// A figure on a page.
#[derive(Debug, Serialize)]
pub struct FigureView {
    /// The file's stem.
    pub name: String,
    /// One sentence on what it shows, with its unit.
    pub caption: String,
    /// The drawing.
    svg: String,
    /// Whether it takes the whole width.
    pub wide: bool,
    /// Whether it can be zoomed.
    pub zoom: bool,
    /// The drawing as a file.
    #[serde(skip)]
    pub file: String,
}

impl FigureView {
    /// A figure with its sentence.
    pub fn new(figure: &Figure, caption: impl Into<String>) -> Self {
        let (svg, file) = (figure.inline(), figure.file());
        Self { name: figure.name.clone(), caption: caption.into(), svg, wide: false, zoom: false, file }
    }

    /// Over the whole width.
    #[must_use]
    pub fn wide(self) -> Self {
        Self { wide: true, ..self }
    }

    /// To be zoomed.
    #[must_use]
    pub fn zoomed(self) -> Self {
        Self { zoom: true, ..self }
    }
}

/// Whether there is something for the script to do.
fn needs_script(page: &Page) -> bool {
    page.data.is_some() || page.sections.iter().flat_map(Section::all_figures).any(|figure| figure.zoom)
}

/// Who makes a page.
#[derive(Debug, Clone, Copy)]
pub struct Maker<'a> {
    /// The command: `report`, `paper`.
    pub command: &'a str,
    /// The folder beside the page that has its figures as files.
    pub figures: &'a str,
}

/// The page as HTML.
///
/// # Errors
/// If the template is wrong.
pub fn html(page: &Page, maker: &Maker) -> Result<String, minijinja::Error> {
    let mut environment = Environment::new();
    environment.add_template("page.html", TEMPLATE)?;
    // In JSON `<` stands only in texts. Written as an escape it can neither end the script nor begin a comment.
    let data = page.data.as_ref().map(|data| data.replace('<', "\\u003c"));
    let safe = |text: &str| Value::from_safe_string(text.to_owned());
    let licence = CHART_LICENCE.replace("*/", "* /");
    environment.get_template("page.html")?.render(context! {
        command => maker.command,
        figures => maker.figures,
        page => Value::from(Serde(page)),
        version => env!("CARGO_PKG_VERSION"),
        style => safe(STYLE),
        figure_style => safe(&style()),
        chart_style => safe(CHART_STYLE),
        chart_licence => safe(&licence),
        chart_script => safe(CHART_SCRIPT),
        script => needs_script(page).then(|| safe(SCRIPT)),
        data => data.map(Value::from_safe_string),
    })
}
