//! More than fits into memory, in order: sorted runs in an unnamed file, merged as they are read.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::ops::Range;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

/// Bytes that are held in memory at most.
const HELD_BYTES: usize = 2 << 20;
/// Bytes of a run that are read at a time.
const READ_BYTES: usize = 8 << 10;
/// What the system's allocator takes for an item besides its bytes.
const ITEM_BYTES: usize = 80;

/// A key, compared byte by byte, and what belongs to it.
pub type Item = (Vec<u8>, Vec<u8>);

/// A file that has no name, in a folder that is made if it is missing.
pub(super) fn unnamed(folder: &Path) -> io::Result<File> {
    std::fs::create_dir_all(folder)?;
    tempfile::tempfile_in(folder)
}

/// A part of a file.
pub(super) struct Section<'f> {
    pub file: &'f File,
    pub range: Range<u64>,
}

impl Read for Section<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let wanted = bytes.len().min((self.range.end - self.range.start) as usize);
        let read = self.file.read_at(&mut bytes[..wanted], self.range.start)?;
        self.range.start += read as u64;
        Ok(read)
    }
}

/// Takes items in any order.
#[derive(Debug)]
pub struct Sorter {
    folder: PathBuf,
    limit: usize,
    held: Vec<Item>,
    bytes: usize,
    file: Option<File>,
    runs: Vec<Range<u64>>,
}

impl Sorter {
    /// What does not fit into memory will go to an unnamed file in `folder`.
    pub fn new(folder: &Path) -> Self {
        Self::holding(folder, HELD_BYTES)
    }

    fn holding(folder: &Path, limit: usize) -> Self {
        Self { folder: folder.to_owned(), limit, held: Vec::new(), bytes: 0, file: None, runs: Vec::new() }
    }

    /// Takes an item. No two may have the same key.
    ///
    /// # Errors
    /// Those of the file, e.g. if the disk is full.
    pub fn push(&mut self, key: Vec<u8>, value: Vec<u8>) -> io::Result<()> {
        self.bytes += key.len() + value.len() + ITEM_BYTES;
        self.held.push((key, value));
        if self.bytes > self.limit { self.write_run() } else { Ok(()) }
    }

    fn write_run(&mut self) -> io::Result<()> {
        self.held.sort_unstable();
        let file = match &mut self.file {
            Some(file) => file,
            none => none.insert(unnamed(&self.folder)?),
        };
        let begin = self.runs.last().map_or(0, |run| run.end);
        let (mut writer, mut end) = (BufWriter::new(&mut *file), begin);
        for (key, value) in self.held.drain(..) {
            for part in [&key, &value] {
                writer.write_all(&(part.len() as u32).to_le_bytes())?;
                writer.write_all(part)?;
                end += 4 + part.len() as u64;
            }
        }
        writer.flush()?;
        drop(writer);
        self.runs.push(begin..end);
        self.bytes = 0;
        Ok(())
    }

    /// All items in order.
    pub fn sorted(mut self) -> Sorted {
        self.held.sort_unstable();
        Sorted { held: self.held, file: self.file, runs: self.runs }
    }
}

/// Items in the order of their keys.
#[derive(Debug)]
pub struct Sorted {
    held: Vec<Item>,
    file: Option<File>,
    runs: Vec<Range<u64>>,
}

impl Sorted {
    /// The items; they can be read again.
    pub fn iter(&self) -> impl Iterator<Item = io::Result<Item>> {
        let sections = self.file.iter().flat_map(|file| self.runs.iter().map(move |run| (file, run.clone())));
        let runs = sections.map(|(file, range)| BufReader::with_capacity(READ_BYTES, Section { file, range }));
        let mut merge = Merge { runs: runs.collect(), held: self.held.iter(), next: BinaryHeap::new(), failed: None };
        (0..=self.runs.len()).for_each(|source| merge.pull(source));
        merge
    }
}

/// The next item of every run, and of those in memory.
struct Merge<'s> {
    runs: Vec<BufReader<Section<'s>>>,
    held: std::slice::Iter<'s, Item>,
    next: BinaryHeap<Reverse<(Item, usize)>>,
    failed: Option<io::Error>,
}

impl Merge<'_> {
    fn pull(&mut self, source: usize) {
        let item = match self.runs.get_mut(source) {
            Some(run) => read_item(run),
            None => Ok(self.held.next().cloned()),
        };
        match item {
            Ok(item) => self.next.extend(item.map(|item| Reverse((item, source)))),
            Err(error) => self.failed = Some(error),
        }
    }
}

impl Iterator for Merge<'_> {
    type Item = io::Result<Item>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(error) = self.failed.take() {
            self.next.clear();
            return Some(Err(error));
        }
        let Reverse((item, source)) = self.next.pop()?;
        self.pull(source);
        Some(Ok(item))
    }
}

fn read_item(run: &mut BufReader<Section<'_>>) -> io::Result<Option<Item>> {
    if run.buffer().is_empty() && run.get_ref().range.is_empty() {
        return Ok(None);
    }
    let mut part = || {
        let mut length = [0; 4];
        run.read_exact(&mut length)?;
        let mut bytes = vec![0; u32::from_le_bytes(length) as usize];
        run.read_exact(&mut bytes)?;
        Ok(bytes)
    };
    part().and_then(|key| Ok(Some((key, part()?))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn law_items_come_in_order_however_few_are_held() {
        let folder = tempfile::tempdir().unwrap();
        let mut stream = Stream::new(1, "sorted", "");
        let mut items: Vec<Item> = (0..1000_u32)
            .map(|n| {
                let key = [&stream.uniform().to_bits().to_be_bytes()[..], &n.to_be_bytes()].concat();
                (key, vec![b'x'; n as usize % 300])
            })
            .collect();
        for limit in [1, 5000, 30_000, 1 << 30] {
            let mut sorter = Sorter::holding(&folder.path().join("made"), limit);
            items.iter().for_each(|(key, value)| sorter.push(key.clone(), value.clone()).unwrap());
            assert!(sorter.bytes <= limit && (limit > 1 << 20) == sorter.runs.is_empty());
            let sorted = sorter.sorted();
            let found: Vec<Item> = sorted.iter().map(Result::unwrap).collect();
            assert_eq!(found, sorted.iter().map(Result::unwrap).collect::<Vec<_>>(), "twice the same");
            items.sort();
            assert!(found == items, "{limit}");
        }
        assert_eq!(std::fs::read_dir(folder.path().join("made")).unwrap().count(), 0, "the file has no name");
    }

    #[test]
    fn a_file_that_is_cut_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let mut sorter = Sorter::holding(folder.path(), 1);
        sorter.push(b"a".to_vec(), b"b".to_vec()).unwrap();
        sorter.file.as_ref().unwrap().set_len(7).unwrap();
        let sorted = sorter.sorted();
        assert!(sorted.iter().next().unwrap().is_err());
    }
}
