//! What the command line is called with.

use std::ffi::OsString;

use super::arguments::PROGRAM;
use crate::{
    scenario::Catalog,
    study::{Program, StudyError},
};

/// One call of the command line.
pub struct Call<'a> {
    /// How the program is started again, for the cases of a study; `None` = by the file of this process.
    pub program: Option<Program>,
    /// The arguments behind the name of the program.
    pub arguments: Vec<OsString>,
    /// What scenarios can choose from.
    pub catalog: &'a Catalog,
    /// Is told of the error that ends the call, beside what is printed of it.
    pub failed: Option<&'a (dyn Fn(&miette::Report) + Sync)>,
}

impl<'a> Call<'a> {
    /// The call that this process is.
    pub fn current(catalog: &'a Catalog) -> Self {
        Self { program: None, arguments: std::env::args_os().skip(1).collect(), catalog, failed: None }
    }

    /// The name of the program and its arguments.
    pub(super) fn words(&self) -> impl Iterator<Item = OsString> {
        [PROGRAM.into()].into_iter().chain(self.arguments.iter().cloned())
    }

    /// How the program is started again.
    pub(super) fn program(&self) -> Result<Program, StudyError> {
        self.program.clone().map_or_else(|| Program::current().map_err(StudyError::from), Ok)
    }
}
