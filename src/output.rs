//! Tables to files: CSV, Parquet, and XML in the manner of SUMO.
//!
//! Every format takes the rows of a [`Layout`](crate::table::Layout), and knows nothing of what they mean. The suffix of
//! the path chooses the format from [`FORMATS`]. Every file is written as `.part` and renamed once it is whole
//! ([`PartFile`]), so a file without that suffix is complete. Where rows must not be lost before, the `.part` is a journal.
//!
//! A new format is one file with a [`Sink`] and one line in [`FORMATS`]. What goes to stdout instead of a file has [`FORMS`].

mod atomic;
mod csv;
mod error;
mod forms;
mod journal;
mod numbers;
mod parquet;
mod sink;
mod sorted;
mod text;
mod write;
mod xml;

pub use atomic::{PartFile, part_of, write_json, write_whole};
pub use error::OutputError;
pub(crate) use error::{file_error, meant};
pub use forms::{FORMS, Form};
#[cfg(test)]
pub(crate) use journal::texts;
pub(crate) use journal::{Journal, read_journal, whole_lines, whole_of, write_over};
pub(crate) use numbers::Numbers;
pub use sink::Sink;
pub(crate) use sorted::{Item, Sorted, Sorter};
pub use text::append;
pub use write::{FORMATS, OpenSink, Table, write_table};
