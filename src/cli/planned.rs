//! A run as the arguments of `run` ask for it, before it begins.

use std::ffi::OsString;

use clap::Parser;

use super::arguments::{Cli, Command, PROGRAM, RunArgs};
use crate::{
    run::{self, RunOptions, SessionOptions},
    scenario::{Catalog, Scenario},
};

/// A run as the arguments of `run` ask for it.
pub struct Planned {
    /// What is run. Its notes have been told to nobody.
    pub scenario: Scenario,
    /// How. It tells nothing and shows no progress.
    pub options: RunOptions,
    /// Whether a page is wanted of the result.
    pub report: bool,
}

/// Arguments that the command line does not take. The text is what it says then.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("{0}")]
pub struct Usage(String);

impl Planned {
    /// Reads the arguments behind `sumo-mfc run`.
    ///
    /// # Errors
    /// [`Usage`], or what is wrong with the scenario.
    pub fn parse(arguments: &[OsString], catalog: &Catalog) -> miette::Result<Self> {
        let words = [PROGRAM.into(), "run".into()].into_iter().chain(arguments.iter().cloned());
        match Cli::try_parse_from(words) {
            Ok(Cli { command: Command::Run(args), .. }) => Self::of(&args, catalog),
            Ok(_) => unreachable!("the first word is run"),
            Err(usage) => Err(Usage(usage.render().to_string()).into()),
        }
    }

    /// What these arguments ask for.
    pub(super) fn of(args: &RunArgs, catalog: &Catalog) -> miette::Result<Self> {
        let scenario = match &args.from {
            Some(manifest) => run::repeated(manifest, catalog)?,
            None => Scenario::load(&args.scenario.request(), catalog)?,
        };
        let session = SessionOptions {
            out_dir: args.out.clone().unwrap_or_else(|| scenario.default_folder()),
            force: args.force,
            backend: args.backend,
            profile: args.profile,
            ..SessionOptions::default()
        };
        let threads = args.threads.map(usize::from);
        let options = RunOptions { session, threads, tied: args.tied, ..RunOptions::default() };
        Ok(Self { scenario, options, report: !args.no_report })
    }
}
