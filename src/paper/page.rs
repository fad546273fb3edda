//! The page.

use super::Lab;
use super::figure::Figure;
use super::library::Preset;
use super::results::Results;

/// One HTML file with everything in it.
pub fn page(_lab: &Lab, _presets: &[&Preset], _results: &Results, figures: &[Figure]) -> String {
    figures.iter().map(Figure::inline).collect()
}
