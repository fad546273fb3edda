//! What the tests are given, and what they give back.

use super::library::Library;
use super::row::Row;
use super::series::Series;
use crate::figure::Figure;
use std::path::PathBuf;

/// Seeds of the noise.
pub const SEEDS: usize = 20;

/// What the tests are given.
#[derive(Debug)]
pub struct Lab {
    /// Scenario files and presets.
    pub library: Library,
    /// Somebody's own recording, in place of ours.
    pub driver: Option<PathBuf>,
}

/// What came out of a test.
#[derive(Debug, Clone, Default)]
pub struct Finding {
    /// Numbers.
    pub rows: Vec<Row>,
    /// Figures.
    pub figures: Vec<Figure>,
    /// What the figures show, as numbers.
    pub series: Vec<Series>,
    /// The end of what the command prints.
    pub text: String,
}

impl Finding {
    /// Adds another one behind it.
    pub fn extend(&mut self, other: Self) {
        self.rows.extend(other.rows);
        self.figures.extend(other.figures);
        self.series.extend(other.series);
        self.text += &other.text;
    }
}
