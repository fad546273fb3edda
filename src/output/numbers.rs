//! Numbers of many columns, each to be read in order: a few of each in memory, the others as sorted runs in one unnamed file.

use super::sorted::{Section, unnamed};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Numbers of a column that are held in memory at most.
const HELD: usize = 4096;
/// Bytes of a run that are read at a time.
const READ_BYTES: usize = 4 << 10;

/// Columns of numbers.
#[derive(Debug)]
pub struct Numbers {
    folder: PathBuf,
    limit: usize,
    columns: Vec<Column>,
    file: Option<File>,
    end: u64,
}

#[derive(Debug, Clone, Default)]
struct Column {
    held: Vec<i64>,
    runs: Vec<Range<u64>>,
    count: usize,
}

/// A number that is ordered like `f64::total_cmp`, and back again.
fn ordered(bits: i64) -> i64 {
    bits ^ (((bits >> 63) as u64) >> 1) as i64
}

impl Numbers {
    /// So many columns; what does not fit into memory will go to an unnamed file in `folder`.
    pub fn new(folder: &Path, columns: usize) -> Self {
        Self { folder: folder.to_owned(), limit: HELD, columns: vec![Column::default(); columns], file: None, end: 0 }
    }

    /// Takes a number of a column.
    ///
    /// # Errors
    /// Those of the file, e.g. if the disk is full.
    pub fn push(&mut self, column: usize, value: f64) -> io::Result<()> {
        let column = &mut self.columns[column];
        column.held.push(ordered(value.to_bits() as i64));
        column.count += 1;
        if column.held.len() < self.limit {
            return Ok(());
        }
        column.held.sort_unstable();
        let bytes: Vec<u8> = column.held.drain(..).flat_map(i64::to_le_bytes).collect();
        let file = match &mut self.file {
            Some(file) => file,
            none => none.insert(unnamed(&self.folder)?),
        };
        file.write_all(&bytes)?;
        let begin = self.end;
        self.end += bytes.len() as u64;
        column.runs.push(begin..self.end);
        Ok(())
    }

    /// How many numbers a column has.
    pub fn count(&self, column: usize) -> usize {
        self.columns[column].count
    }

    /// The numbers of a column, the smallest first.
    ///
    /// # Errors
    /// Those of the file.
    pub fn sorted(&mut self, column: usize) -> io::Result<impl Iterator<Item = io::Result<f64>>> {
        let column = &mut self.columns[column];
        column.held.sort_unstable();
        let sections = self.file.iter().flat_map(|file| column.runs.iter().map(move |run| (file, run.clone())));
        let mut runs: Vec<_> =
            sections.map(|(file, range)| BufReader::with_capacity(READ_BYTES, Section { file, range })).collect();
        let mut held = column.held.iter();
        let mut pull = move |source: usize| -> io::Result<Option<i64>> {
            let Some(run) = runs.get_mut(source) else { return Ok(held.next().copied()) };
            if run.buffer().is_empty() && run.get_ref().range.is_empty() {
                return Ok(None);
            }
            let mut bytes = [0; 8];
            run.read_exact(&mut bytes)?;
            Ok(Some(i64::from_le_bytes(bytes)))
        };
        let mut next = BinaryHeap::new();
        for source in 0..=column.runs.len() {
            next.extend(pull(source)?.map(|number| Reverse((number, source))));
        }
        Ok(std::iter::from_fn(move || {
            let Reverse((number, source)) = next.pop()?;
            match pull(source) {
                Ok(more) => next.extend(more.map(|number| Reverse((number, source)))),
                Err(error) => return Some(Err(error)),
            }
            Some(Ok(f64::from_bits(ordered(number) as u64)))
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_every_column_comes_in_the_order_of_total_cmp() {
        let folder = tempfile::tempdir().unwrap();
        let mut numbers = Numbers { limit: 7, ..Numbers::new(folder.path(), 3) };
        let values = |column: usize| {
            let number = move |n: u32| f64::from(n * 7919 % 1009) - 500.0 + column as f64 / 8.0;
            (0..100 * column as u32).map(number).chain([-0.0, 0.0, f64::INFINITY, f64::MIN_POSITIVE, f64::MIN])
        };
        for column in 0..3 {
            values(column).for_each(|value| numbers.push(column, value).unwrap());
        }
        for column in 0..3 {
            let mut wanted: Vec<f64> = values(column).collect();
            wanted.sort_by(f64::total_cmp);
            let found: Vec<f64> = numbers.sorted(column).unwrap().map(Result::unwrap).collect();
            assert_eq!(found.len(), numbers.count(column));
            assert!(found.iter().map(|x| x.to_bits()).eq(wanted.iter().map(|x| x.to_bits())), "{found:?}");
        }
    }
}
