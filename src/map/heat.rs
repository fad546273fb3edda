//! Heat maps of ratios: blue below 1, red above, one step of colour per factor.

use crate::figure::{Figure, escape};
use std::fmt::Write;

/// Ratios from 1/4 to 4 fill the scale.
const FULL: f64 = 4.0;
const WIDTH: f64 = 760.0;

/// One table of ratios.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Panel {
    /// Above it.
    pub title: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Names of the rows, from below.
    pub rows: Vec<String>,
    /// Ratios by row and column; none is left blank.
    pub ratios: Vec<Vec<Option<f64>>>,
    /// A point to mark, in columns and rows.
    pub mark: Option<(f64, f64)>,
}

/// Panels side by side.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Heat<'a> {
    /// Title.
    pub title: String,
    /// What the columns are.
    pub x: &'a str,
    /// What the rows are.
    pub y: &'a str,
    /// The panels.
    pub panels: Vec<Panel>,
}

/// Blue, nearly white, red for 1/4, 1, 4.
fn colour(ratio: f64) -> String {
    let at = (libm::log(ratio) / libm::log(FULL)).clamp(-1.0, 1.0);
    let (end, share) = if at < 0.0 { ([33.0, 102.0, 172.0], -at) } else { ([200.0, 40.0, 50.0], at) };
    let white = [246.0, 244.0, 240.0];
    let mix = |i: usize| (white[i] + (end[i] - white[i]) * share) as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// Draws panels of ratios.
pub fn heat_map(name: &str, heat: &Heat) -> Figure {
    const LEFT: f64 = 74.0;
    const TOP: f64 = 64.0;
    const GAP: f64 = 12.0;
    let panels = heat.panels.len().max(1) as f64;
    let width = (WIDTH - LEFT - 12.0 - GAP * (panels - 1.0)) / panels;
    let rows = heat.panels.iter().map(|p| p.rows.len()).max().unwrap_or(0) as f64;
    let cell_height = if heat.panels.len() == 1 { 22.0 } else { 17.0 };
    let bottom = TOP + rows * cell_height;
    let mut body = format!("<text class=\"title\" x=\"16\" y=\"20\">{}</text>", escape(&heat.title));
    for (p, panel) in heat.panels.iter().enumerate() {
        let left = LEFT + p as f64 * (width + GAP);
        let place = Place { left, bottom, width: width / panel.columns.len() as f64, height: cell_height };
        draw_panel(&mut body, panel, &place, p == 0);
    }
    // The names of the columns hang down at 60 degrees.
    let longest = heat.panels.iter().flat_map(|p| &p.columns).map(|c| c.chars().count()).max().unwrap_or(0);
    let (middle, low) = (0.5 * (LEFT + WIDTH), bottom + (26.0 + 5.0 * longest as f64).max(62.0));
    let _ = write!(body, "<text x=\"{middle}\" y=\"{low}\" text-anchor=\"middle\">{}</text>", escape(heat.x));
    let middle = 0.5 * (TOP + bottom);
    let _ = write!(
        body,
        "<text transform=\"translate(16 {middle}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        escape(heat.y)
    );
    scale(&mut body, low + 12.0);
    Figure::drawn(name, &heat.title, body, low + 44.0).wide(WIDTH)
}

/// Where a panel is and how large its cells are.
struct Place {
    left: f64,
    bottom: f64,
    width: f64,
    height: f64,
}

fn draw_panel(body: &mut String, panel: &Panel, place: &Place, first: bool) {
    let Place { left, bottom, width, height } = *place;
    let _ = write!(body, "<text x=\"{left:.1}\" y=\"56\">{}</text>", escape(&panel.title));
    for (r, row) in panel.ratios.iter().enumerate() {
        let y = bottom - (r + 1) as f64 * height;
        let base = y + 0.5 * height + 4.0;
        if first {
            let end = left - 6.0;
            let _ = write!(
                body,
                "<text class=\"soft\" x=\"{end:.1}\" y=\"{base:.1}\" text-anchor=\"end\">{}</text>",
                escape(&panel.rows[r])
            );
        }
        for (c, ratio) in row.iter().enumerate() {
            let Some(ratio) = ratio else { continue };
            let x = left + c as f64 * width;
            let _ = write!(
                body,
                "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{}\"><title>{} / {}: {ratio:.2}</title></rect>",
                colour(*ratio),
                escape(&panel.columns[c]),
                escape(&panel.rows[r]),
            );
            if width > 30.0 {
                let middle = x + 0.5 * width;
                let _ = write!(
                    body,
                    "<text class=\"cell\" x=\"{middle:.1}\" y=\"{base:.1}\" text-anchor=\"middle\">{ratio:.2}</text>"
                );
            }
        }
    }
    for (c, name) in panel.columns.iter().enumerate() {
        let (x, y) = (left + (c as f64 + 0.5) * width + 4.0, bottom + 8.0);
        let _ = write!(
            body,
            "<text class=\"soft\" font-size=\"10\" transform=\"translate({x:.1} {y:.1}) rotate(-60)\" text-anchor=\"end\">{}</text>",
            escape(name)
        );
    }
    if let Some((column, row)) = panel.mark {
        let (x, y) = (left + (column + 0.5) * width, bottom - (row + 0.5) * height);
        let _ = write!(body, "<circle class=\"mark\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"8\"/>");
    }
}

/// The scale of colours.
fn scale(body: &mut String, top: f64) {
    for (i, ratio) in [0.25, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0].into_iter().enumerate() {
        let x = 220.0 + 40.0 * i as f64;
        let (middle, base) = (x + 20.0, top + 12.0);
        let _ = write!(
            body,
            "<rect x=\"{x}\" y=\"{top}\" width=\"40\" height=\"16\" fill=\"{}\"/><text class=\"cell\" x=\"{middle}\" y=\"{base}\" text-anchor=\"middle\">{ratio}</text>",
            colour(ratio)
        );
    }
}
