//! The file of finished jobs, from which a second call goes on.

use super::cell::Cell;
use super::grid::Grid;
use crate::paper::{PaperError, write};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

pub const HEADER: &str = "controller,period_s,k_p,scale,limit_mps2,delay_s,error_rms,overshoot_1";

/// The cells of all whole jobs in a file. A job or line that was cut off by the end of its program is not taken.
fn finished(text: &str, grid: &Grid) -> Vec<Cell> {
    let lines = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
    let mut cells: Vec<Cell> = lines.filter_map(|line| Cell::read(line.trim_end())).collect();
    let mut counts = BTreeMap::new();
    for cell in &cells {
        *counts.entry(cell.job()).or_insert(0) += 1;
    }
    let whole = grid.scales.len() * grid.limits_mps2.len() * grid.delays_s.len();
    cells.retain(|cell| counts[&cell.job()] == whole);
    cells
}

/// The file of finished jobs.
pub struct Part {
    pub path: PathBuf,
    pub cells: Vec<Cell>,
    file: Mutex<std::fs::File>,
}

impl Part {
    /// Takes over what an earlier call with the same key finished, whole or not.
    pub fn open(whole: &Path, key: &str, grid: &Grid) -> Result<Self, PaperError> {
        let path = whole.with_extension("csv.part");
        let mut cells = Vec::new();
        for old in [whole, &path] {
            let Ok(text) = std::fs::read_to_string(old) else { continue };
            if text.starts_with(&format!("# {key}\n")) {
                cells = finished(&text, grid);
            }
        }
        let text: String = cells.iter().map(Cell::line).collect();
        write(&path, &format!("# {key}\n{HEADER}\n{text}"))?;
        let file = std::fs::OpenOptions::new().append(true).open(&path).map_err(PaperError::reading(&path))?;
        Ok(Self { path, cells, file: Mutex::new(file) })
    }

    /// Adds the cells of one job in one write.
    pub fn append(&self, cells: &[Cell]) -> Result<(), PaperError> {
        let text: String = cells.iter().map(Cell::line).collect();
        let mut file = self.file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        file.write_all(text.as_bytes()).map_err(PaperError::reading(&self.path))
    }
}
