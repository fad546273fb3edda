//! The command line: data on stdout, everything else on stderr, exit code 1 for whatever went wrong.

mod cli;

use std::{
    io::{ErrorKind, IsTerminal, Write},
    process::ExitCode,
};

use clap::Parser;
use cli::{CheckArgs, Cli, Command, PaperArgs, RunArgs};
use miette::{IntoDiagnostic, MietteHandlerOpts};
use sumo_mfc::{
    output::terminal_text,
    paper,
    run::{self, RunOptions},
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
        Command::Paper(args) => paper_tests(args),
        Command::List => list(),
    };
    done.unwrap_or_else(|report| {
        eprintln!("{report:?}");
        ExitCode::FAILURE
    })
}

fn run(args: &RunArgs) -> miette::Result<ExitCode> {
    let scenario = Scenario::load(&args.scenario.request(), &Catalog::installed())?;
    if !args.quiet {
        notes(&scenario.notes);
    }
    let options = RunOptions {
        out_dir: args.out.clone().unwrap_or_else(|| scenario.default_folder()),
        force: args.force,
        threads: args.threads.map(usize::from),
        progress: !args.quiet && std::io::stderr().is_terminal(),
    };
    let result = run::run(&scenario, &options)?;
    if !args.quiet {
        notes(&result.notes);
    }
    print(&terminal_text(&result.summary, &result.rows, &result.dir, &result.files))?;
    Ok(result.interrupted.map_or(ExitCode::SUCCESS, |signal| ExitCode::from(signal.exit_code())))
}

fn check(args: &CheckArgs) -> miette::Result<ExitCode> {
    let catalog = Catalog::installed();
    if args.template {
        return print(&template(&catalog));
    }
    let scenario = Scenario::load(&args.scenario.request(), &catalog)?;
    notes(&scenario.notes);
    print(&scenario.to_toml())
}

fn paper_tests(args: PaperArgs) -> miette::Result<ExitCode> {
    let PaperArgs { test, out, coarse, preset, driver, set } = args;
    let progress = std::io::stderr().is_terminal();
    let page = out.join("index.html");
    let results = paper::run(&paper::Request { test, out_dir: out, preset, driver, sets: set, coarse, progress })?;
    print(&format!("{}{}\n", results.table(), page.display()))
}

fn list() -> miette::Result<ExitCode> {
    let catalog = Catalog::installed();
    let lines = catalog.registries().into_iter().flat_map(|registry| {
        registry.entries.iter().map(|e| format!("{}\t{}\t{}\n", registry.kind, e.name, e.summary))
    });
    print(&lines.collect::<String>())
}

fn notes(notes: &[String]) {
    for note in notes {
        eprintln!("note: {note}");
    }
}

/// Writes data to stdout. A reader that has seen enough (`| head`) is no error.
fn print(text: &str) -> miette::Result<ExitCode> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(ExitCode::SUCCESS),
        done => done.map(|()| ExitCode::SUCCESS).into_diagnostic(),
    }
}
