//! The command line: data on stdout, everything else on stderr, exit code 1 for whatever went wrong.

mod cli;

use std::{
    io::{ErrorKind, Write},
    process::ExitCode,
};

use clap::Parser;
use cli::{CheckArgs, Cli, Command, RunArgs};
use miette::{IntoDiagnostic, MietteHandlerOpts};
use sumo_mfc::{
    output::ResultDir,
    scenario::{Catalog, Scenario, template},
};

fn main() -> ExitCode {
    // Long paths stay whole, so that they can be copied and searched for.
    let _ = miette::set_hook(Box::new(|_| Box::new(MietteHandlerOpts::new().wrap_lines(false).build())));
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(usage) => {
            let _ = usage.print();
            return ExitCode::from(u8::from(usage.use_stderr()));
        }
    };
    let done = match cli.command {
        Command::Run(args) => run(&args),
        Command::Check(args) => check(&args),
        Command::List => list(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(report) => {
            eprintln!("{report:?}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &RunArgs) -> miette::Result<()> {
    let scenario = Scenario::load(&args.scenario.request(), &Catalog::installed())?;
    if !args.quiet {
        notes(&scenario);
    }
    let out_dir = args.out.clone().unwrap_or_else(|| scenario.default_folder());
    ResultDir::create(&out_dir, args.force).into_diagnostic()?;
    Ok(())
}

fn check(args: &CheckArgs) -> miette::Result<()> {
    let catalog = Catalog::installed();
    if args.template {
        return print(&template(&catalog));
    }
    let scenario = Scenario::load(&args.scenario.request(), &catalog)?;
    notes(&scenario);
    print(&scenario.to_toml())
}

fn list() -> miette::Result<()> {
    let catalog = Catalog::installed();
    let lines = catalog.registries().into_iter().flat_map(|registry| {
        registry.entries.iter().map(|e| format!("{}\t{}\t{}\n", registry.kind, e.name, e.summary))
    });
    print(&lines.collect::<String>())
}

fn notes(scenario: &Scenario) {
    for note in &scenario.notes {
        eprintln!("note: {note}");
    }
}

/// Writes data to stdout. A reader that has seen enough (`| head`) is no error.
fn print(text: &str) -> miette::Result<()> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
        done => done.into_diagnostic(),
    }
}
