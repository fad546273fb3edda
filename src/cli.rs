//! The command line: data on stdout, everything else on stderr, exit code 1 for whatever went wrong.
//!
//! A crate with a law, body, target or plant of its own gets the whole command line with it from two lines:
//! ```no_run
//! use std::process::ExitCode;
//! use sumo_mfc::{cli, control::Build, registry::Entry, scenario::Catalog};
//!
//! fn command_line(law: Entry<Build>) -> ExitCode {
//!     let catalog = Catalog::installed().with_controller(law).expect("a name of its own");
//!     cli::main(&catalog)
//! }
//! ```
//! A program that is started in another way than by its own file, as the Python package is, makes a [`Call`] for
//! [`main_of`]; [`Planned`] is what the arguments of `run` ask for, for code that runs it itself.

mod arguments;
mod call;
mod help;
mod pages;
mod planned;
mod shared;
mod stability;
mod study;
mod tables;
mod tuning;

use std::{
    io::{ErrorKind, IsTerminal, Write},
    path::{Path, PathBuf},
    process::ExitCode,
};

use arguments::{CheckArgs, Cli, Command, ListArgs, ManArgs, PaperArgs, ReportArgs, RunArgs};
pub use call::Call;
use clap::Parser;
use miette::{IntoDiagnostic, MietteHandlerOpts};
pub use planned::{Planned, Usage};
use stability::StabilityArgs;
use tracing::level_filters::LevelFilter;
use tuning::TuneArgs;

use crate::{
    doctor, map,
    output::{FORMS, Form, write_table},
    paper::{self, demand},
    report,
    run::{self, RunError, RunResult, terminal_text},
    scenario::{Catalog, Scenario, schema, template},
    stability as margins, tune,
};

/// What is done when all went well, and what otherwise.
const SUCCESS: u8 = 0;
const FAILURE: u8 = 1;

/// Does what the arguments of the program ask for, with what `catalog` offers. Returns the exit code.
pub fn main(catalog: &Catalog) -> ExitCode {
    ExitCode::from(main_of(&Call::current(catalog)))
}

/// The same for arguments that come from somewhere else. Returns the exit code as a number.
pub fn main_of(call: &Call) -> u8 {
    // Long paths stay whole, so that they can be copied and searched for. Every error tells its causes itself.
    let handler = || MietteHandlerOpts::new().wrap_lines(false).without_cause_chain().build();
    let _ = miette::set_hook(Box::new(move |_| Box::new(handler())));
    let catalog = call.catalog;
    let cli = match Cli::try_parse_from(call.words()) {
        Ok(cli) => cli,
        Err(usage) => {
            let _ = usage.print();
            return u8::from(usage.use_stderr());
        }
    };
    let done = match cli.command {
        Command::Run(args) => run(&args, catalog),
        Command::Compare(args) => study::study(&args.study, args.arguments(), call),
        Command::Sweep(args) => study::study(&args.study, args.arguments(), call),
        Command::Report(args) => report_of(args),
        Command::Recover(args) => recover(&args.dirs),
        Command::Check(args) => check(&args, catalog),
        Command::Paper(args) => paper_tests(args),
        Command::Tune(args) => tuned(&args, catalog),
        Command::Stability(args) => stable(&args, catalog),
        Command::List(args) => list(&args, catalog),
        Command::Doctor => doctor(),
        Command::Completions(args) => print(&pages::completions(args.shell)),
        Command::Man(args) => man(&args),
        Command::SlurmTask(args) => study::slurm_task(&args, call),
    };
    done.unwrap_or_else(|report| {
        call.failed.iter().for_each(|failed| failed(&report));
        eprintln!("{report:?}");
        FAILURE
    })
}

fn run(args: &RunArgs, catalog: &Catalog) -> miette::Result<u8> {
    log(args.verbose)?;
    let Planned { scenario, mut options, .. } = Planned::of(args, catalog)?;
    if !args.quiet {
        notes(&scenario.notes);
    }
    options.session.tell = (!args.quiet).then_some(|line| eprintln!("note: {line}"));
    options.progress = !args.quiet && std::io::stderr().is_terminal();
    let result = match run::run(&scenario, &options) {
        Err(RunError::Interrupted(signal)) => return Ok(signal.exit_code()),
        done => done?,
    };
    if !args.quiet {
        notes(&result.notes);
    }
    told(&result, args)?;
    Ok(result.interrupted.map_or(SUCCESS, |signal| signal.exit_code()))
}

/// Says what a run came to, and writes its page.
fn told(result: &RunResult, args: &RunArgs) -> miette::Result<()> {
    let silent = args.quiet || args.export.export.is_some();
    if let Some(form) = args.export.export {
        print(&tables::summed_up(result, form))?;
    } else if !args.quiet {
        print(&terminal_text(&result.summary, &result.remarkable, &result.dir, &result.files))?;
    }
    match &result.profile {
        Some(profile) if args.export.export.is_some() => eprint!("{profile}"),
        Some(profile) => drop(print(&profile.to_string())?),
        None => {}
    }
    // After a signal the user waits for the end, not for a page.
    if !args.no_report && result.interrupted.is_none() {
        let page = write_report(&result.dir)?;
        if !silent {
            print(&line("look at", &page.display()))?;
        }
    }
    Ok(())
}

/// Tells on stderr what happens inside: with `-v`, or as the variable RUST_LOG says (a level such as `debug`).
fn log(verbose: bool) -> miette::Result<()> {
    let wanted = std::env::var("RUST_LOG").ok().filter(|level| !level.is_empty());
    let level = match wanted {
        Some(level) => level
            .parse()
            .map_err(|_| miette::miette!("RUST_LOG: found {level}, wanted off, error, warn, info, debug or trace"))?,
        None if verbose => LevelFilter::DEBUG,
        None => return Ok(()),
    };
    let colours = std::io::stderr().is_terminal();
    tracing_subscriber::fmt().with_writer(std::io::stderr).with_ansi(colours).with_max_level(level).init();
    Ok(())
}

fn check(args: &CheckArgs, catalog: &Catalog) -> miette::Result<u8> {
    if args.template {
        return print(&template(catalog));
    }
    if args.schema {
        return print(&schema(catalog));
    }
    let scenario = Scenario::load(&args.scenario.request(), catalog)?;
    notes(&scenario.notes);
    print(&scenario.to_toml())
}

fn recover(dirs: &[PathBuf]) -> miette::Result<u8> {
    for dir in dirs {
        let run::Recovered { tables, lost } = run::recover(dir)?;
        let rows = |(name, rows): &(String, Option<usize>)| match rows {
            Some(rows) => format!("{name} ({rows} rows)"),
            None => name.clone(),
        };
        let tables: Vec<String> = tables.iter().map(rows).collect();
        print(&format!("{}: {}\n", dir.display(), tables.join(", ")))?;
        if !lost.is_empty() {
            eprintln!("note: {}: lost: {}", dir.display(), lost.join(", "));
        }
    }
    Ok(SUCCESS)
}

fn report_of(args: ReportArgs) -> miette::Result<u8> {
    let quiet = args.quiet;
    let written = report::report(&args.request())?;
    if quiet { Ok(SUCCESS) } else { print(&format!("{}\n", written.page.display())) }
}

/// Writes the page that comes with a result, and returns its path. The result itself is whole whatever becomes of its page.
fn write_report(dir: &Path) -> miette::Result<PathBuf> {
    let request = report::Request { dirs: vec![dir.to_owned()], ..report::Request::default() };
    let written = report::report(&request)
        .map_err(|error| miette::miette!("the result is whole, but its report could not be written: {error}"))?;
    Ok(written.page)
}

/// A line of what a run or a study ends with.
fn line(name: &str, text: &impl std::fmt::Display) -> String {
    format!("{name:<14} {text}\n")
}

fn paper_tests(args: PaperArgs) -> miette::Result<u8> {
    let sets = args.overrides();
    let PaperArgs { test, out, coarse, preset, driver, export, quiet, seed, .. } = args;
    if test == "record" {
        if coarse || preset.is_some() || driver.is_some() || !sets.is_empty() {
            miette::bail!("record: found options of the tests, wanted --seed, --out, --export and --quiet only");
        }
        return recorded(&out, seed.unwrap_or(1), export.export, quiet);
    }
    if seed.is_some() {
        miette::bail!("--seed: found the test {test}, wanted record: the tests have seeds of their own");
    }
    if test == "map" && export.export.is_some() {
        miette::bail!("--export: found the test map, which has no table of published numbers; its own are in map.csv");
    }
    let progress = !quiet && std::io::stderr().is_terminal();
    let page = out.join("index.html");
    let request = paper::Request { test, out_dir: out, preset, driver, sets, coarse, progress };
    let results = paper::run(&request, map::finding)?;
    match export.export {
        Some(form) => print(&tables::reproduced(&results, form)),
        None if quiet => Ok(SUCCESS),
        None => print(&format!("{}{}\n", results.table(), page.display())),
    }
}

fn recorded(dir: &Path, seed: u64, form: Option<Form>, quiet: bool) -> miette::Result<u8> {
    let (file, demands) = paper::record(dir, seed)?;
    match form {
        Some(form) => print(&form.text(&demand::layout(), &demands)),
        None if quiet => Ok(SUCCESS),
        None => print(&format!("{}{}\n", demand::lines(&demands), file.display())),
    }
}

fn tuned(args: &TuneArgs, catalog: &Catalog) -> miette::Result<u8> {
    let rows = tune::tune(&args.request(!args.quiet && std::io::stderr().is_terminal()), catalog)?;
    let layout = tune::layout();
    let path = write_table(&args.out.join("tune.csv"), &layout, &rows).into_diagnostic()?;
    match args.export.export {
        Some(form) if !form.for_people => print(&form.text(&layout, &rows)),
        Some(form) => print(&tables::tuned(&rows, form)),
        None if args.quiet => Ok(SUCCESS),
        None => print(&format!("{}written        {}\n", tables::tuned(&rows, FORMS[0].build), path.display())),
    }
}

fn stable(args: &StabilityArgs, catalog: &Catalog) -> miette::Result<u8> {
    let found = margins::examine(&args.request(!args.quiet && std::io::stderr().is_terminal()), catalog)?;
    let (loops, strings) = (margins::margin_layout(), margins::string_layout());
    let written = [
        write_table(&args.out.join("margins.csv"), &loops, &found.margins),
        write_table(&args.out.join("strings.csv"), &strings, &found.strings),
        write_table(&args.out.join("sweep.csv"), &margins::sweep_layout(), &found.sweep),
    ];
    let written = written.into_iter().collect::<Result<Vec<_>, _>>().into_diagnostic()?;
    let tables = |form: Form| format!("{}\n{}", form.text(&loops, &found.margins), form.text(&strings, &found.strings));
    match args.export.export {
        Some(form) if form.for_people => print(&tables(form)),
        Some(form) => print(&form.text(&loops, &found.margins)),
        None if args.quiet => Ok(SUCCESS),
        None => print(&format!("{}\nwritten        {}\n", tables(FORMS[0].build), paths(&written))),
    }
}

fn paths(written: &[PathBuf]) -> String {
    written.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}

fn list(args: &ListArgs, catalog: &Catalog) -> miette::Result<u8> {
    print(&args.export.export.map_or_else(|| catalog.lines(), |form| tables::listed(catalog, form)))
}

fn man(args: &ManArgs) -> miette::Result<u8> {
    match &args.out {
        Some(dir) => pages::write_manuals(dir).map(|()| SUCCESS).map_err(|error| miette::miette!("{error}")),
        None => print(&pages::manual().into_diagnostic()?),
    }
}

fn doctor() -> miette::Result<u8> {
    let report = doctor::examine(None);
    print(&report.to_string())?;
    Ok(if report.is_well() { SUCCESS } else { FAILURE })
}

fn notes(notes: &[String]) {
    for note in notes {
        eprintln!("note: {note}");
    }
}

/// Writes data to stdout. A reader that has seen enough (`| head`) is no error.
fn print(text: &str) -> miette::Result<u8> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(SUCCESS),
        done => done.map(|()| SUCCESS).into_diagnostic(),
    }
}
