//! The result of a run that was killed, or could not write its tables: what is left in `.part` becomes tables.

use super::error::RunError;
use super::joined::{by_departure, by_id, packed, unpacked};
use super::manifest::{Manifest, Status};
use super::result_dir::{MANIFEST, ResultDir, SUMMARY};
use super::rows::{QUALITY, VEHICLES};
use crate::output::{Item, Sorter, file_error, part_of, read_journal, whole_lines, whole_of, write_over};
use crate::table::{Layout, Shape};
use std::fs::OpenOptions;
use std::io;
use std::path::Path;
use toml_edit::DocumentMut;

/// What became of a result.
#[derive(Debug)]
pub struct Recovered {
    /// The tables that are whole now, each with its number of rows, if they were counted.
    pub tables: Vec<(String, Option<usize>)>,
    /// What is not there.
    pub lost: Vec<String>,
}

/// Makes tables of what a run has left in `dir`, and marks it incomplete. Rows are those of vehicles that had left the
/// road, ordered as ever; what only the end of a run knows (time losses, SUMO's totals, roads, the sample) is lost.
///
/// # Errors
/// [`RunError::NothingToRecover`] if the result is whole or nothing is left of one, [`RunError::Busy`] if its run goes on,
/// or a file that cannot be read or written.
pub fn recover(path: &Path) -> Result<Recovered, RunError> {
    let mut manifest = Manifest::read(&path.join(MANIFEST))?;
    let dir = ResultDir::open(path)?;
    let nothing = |why: &str| RunError::NothingToRecover { dir: path.to_owned(), why: why.to_owned() };
    if manifest.status == Status::Complete {
        return Err(nothing("its result is whole"));
    }
    let named = |key: &str, default: &str| {
        let scenario = manifest.scenario.parse::<DocumentMut>().ok();
        let name = scenario.as_ref().and_then(|scenario| scenario.get("output")?.get(key)?.as_str());
        name.unwrap_or(default).to_owned()
    };
    let (vehicles, trace) = (named("vehicles", "vehicles.csv"), named("trace_file", "trace.csv"));
    let mut tables = Vec::new();
    for (name, shape) in [(vehicles.as_str(), &VEHICLES.shape), ("quality.csv", &QUALITY.shape)] {
        let (whole, journal) = (dir.file(name), part_of(&dir.file(name)));
        if whole.is_file() && journal.is_file() {
            // The program ended between the two: the table has more than its journal.
            std::fs::remove_file(&journal).map_err(file_error("remove", &journal))?;
            tables.push((name.to_owned(), None));
        } else if journal.is_file() {
            tables.push((name.to_owned(), Some(table(&whole, shape)?)));
        }
    }
    let left = part_of(&dir.file(&trace));
    if trace.ends_with(".csv") && left.is_file() {
        cut_torn_line(&left).map_err(file_error("read", &left))?;
        std::fs::rename(&left, dir.file(&trace)).map_err(file_error("rename", &left))?;
        tables.push((trace.clone(), None));
    }
    if tables.is_empty() {
        return Err(nothing("it holds no .part of a table"));
    }
    let wanted = [&vehicles, "quality.csv", "edges.csv", "sample.csv", SUMMARY];
    let mut lost: Vec<String> =
        wanted.into_iter().filter(|name| !dir.file(name).is_file()).map(str::to_owned).collect();
    if left.is_file() {
        lost.push(format!("{trace} (a part of such a file cannot be read)"));
    }
    let killed = || "the program ended without writing its result".to_owned();
    let reason = manifest.reason.clone().unwrap_or_else(killed);
    dir.finish(&mut manifest, Some(format!("{reason}; recovered")))?;
    Ok(Recovered { tables, lost })
}

/// Makes the table of a journal, in the order of every such table; memory does not grow with it. Returns the number of its
/// rows.
fn table(path: &Path, shape: &Shape) -> Result<usize, RunError> {
    let layout = Layout::of_texts(shape);
    let place = |name: &str| layout.place(name).expect("tables of vehicles have this column");
    let (depart, id) = (place("depart"), place("id"));
    let folder = path.parent().unwrap_or(Path::new(""));
    let (mut rows, mut count) = (Sorter::new(folder), 0);
    for row in read_journal(path, shape)? {
        let row = row?;
        let depart_s = layout.cell(&row, depart).number().unwrap_or(f64::INFINITY);
        let key = by_departure(depart_s, &by_id(&row[id], count));
        rows.push(key, packed(&row)).map_err(file_error("write a file in", folder))?;
        count += 1;
    }
    let rows = rows.sorted();
    let texts = |item: io::Result<Item>| {
        let (_, bytes) = item.map_err(file_error("read a file in", folder))?;
        Ok(unpacked(&bytes))
    };
    write_over(path, &layout, rows.iter().map(texts))?;
    let _ = std::fs::remove_file(whole_of(path));
    Ok(count as usize)
}

/// Cuts a file behind its last line break.
fn cut_torn_line(path: &Path) -> io::Result<()> {
    let file = OpenOptions::new().read(true).write(true).open(path)?;
    file.set_len(whole_lines(&file)?)
}

#[cfg(test)]
mod tests {
    use super::super::rows::tests::vehicle;
    use super::*;
    use crate::output::{Journal, write_table};

    #[test]
    fn a_table_that_is_whole_is_not_replaced_by_its_journal() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("vehicles.csv");
        let manifest = Manifest::new(1, String::new(), Vec::new());
        ResultDir::create(folder.path(), false).unwrap().write_manifest(&manifest).unwrap();
        let rows = [vehicle("a", 1.0), vehicle("b", 2.0)];
        Journal::create(&path, &VEHICLES).unwrap().append(&rows[..1]).unwrap();
        // Killed after the table had its name, before the journal was gone.
        let journal = std::fs::read(part_of(&path)).unwrap();
        write_table(&path, &VEHICLES, &rows).unwrap();
        std::fs::write(part_of(&path), journal).unwrap();
        let whole = std::fs::read(&path).unwrap();
        assert_eq!(recover(folder.path()).unwrap().tables, [("vehicles.csv".to_owned(), None)]);
        assert_eq!(std::fs::read(&path).unwrap(), whole);
        assert!(!part_of(&path).exists());
        assert_eq!(Manifest::read(&folder.path().join(MANIFEST)).unwrap().status, Status::Incomplete);
    }
}
