//! Objects of SUMO as the beginnings of commands.

use super::error::{BatchError, MAX_ID_BYTES};
use super::wire::put_text;

/// A prebuilt command head for one object: what a per-step command copies before it appends its numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Prefix {
    head: Box<[u8]>,
    known: bool,
}

impl Prefix {
    /// Prepares the commands for the object `id`.
    ///
    /// # Errors
    /// If the id is longer than [`MAX_ID_BYTES`].
    pub fn new(id: &str) -> Result<Self, BatchError> {
        check_id(id)?;
        Ok(Self { known: false, ..Self::of_known(id) })
    }

    /// The same for an object that SUMO has named and keeps, such as the vType of a vehicle: no error text will repeat
    /// its id, which may have any length.
    #[must_use]
    pub fn of_known(id: &str) -> Self {
        let mut head = vec![0, 0, 0];
        put_text(&mut head, id);
        Self { head: head.into(), known: true }
    }

    /// Room for length, command and variable, then the id with its length.
    pub(super) fn head(&self) -> &[u8] {
        &self.head
    }

    pub(super) fn id_bytes(&self) -> &[u8] {
        &self.head[3..]
    }

    pub(super) fn is_known(&self) -> bool {
        self.known
    }
}

pub(super) fn check_id(id: &str) -> Result<(), BatchError> {
    if id.len() <= MAX_ID_BYTES { Ok(()) } else { Err(too_long(id, id.len())) }
}

pub(super) fn too_long(id: &str, length: usize) -> BatchError {
    BatchError::IdTooLong { id: id.chars().take(40).collect(), length }
}
