//! A finished figure: the drawing without its frame, for a page or as a file of its own.

use super::escape::escape;
use super::style::style;

/// Width of every figure in its own units.
pub const WIDTH: f64 = 640.0;

/// A finished figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// The file's stem.
    pub name: String,
    /// What it shows, for readers who cannot see it.
    pub title: String,
    /// The drawing, without the surrounding `<svg>`.
    body: String,
    width: f64,
    height: f64,
}

impl Figure {
    /// A drawing, `height` units high and as wide as a chart.
    pub fn drawn(name: &str, title: &str, body: String, height: f64) -> Self {
        Self { name: name.to_owned(), title: title.to_owned(), body, width: WIDTH, height }
    }

    /// The same drawing in another width.
    #[must_use]
    pub fn wide(self, width: f64) -> Self {
        Self { width, ..self }
    }

    /// For a page that has [`style`].
    pub fn inline(&self) -> String {
        self.wrapped("", "")
    }

    /// As a file of its own.
    pub fn file(&self) -> String {
        self.wrapped(" xmlns=\"http://www.w3.org/2000/svg\"", &format!("<style>{}</style>", style()))
    }

    fn wrapped(&self, attributes: &str, style: &str) -> String {
        let Self { title, width, height, body, .. } = self;
        let title = escape(title);
        format!(
            "<svg{attributes} class=\"fig\" viewBox=\"0 0 {width} {height}\" role=\"img\"><title>{title}</title>{style}{body}</svg>\n"
        )
    }
}
