//! `sweep` and `compare`.

use std::{collections::BTreeMap, ffi::OsString};

use super::{
    SUCCESS,
    arguments::{SlurmTaskArgs, StudyArgs},
    call::Call,
    line, notes, print,
    tables::{CaseLine, Standing as Listed, standings},
    write_report,
};
use crate::{
    registry::find,
    run::{Backend, RunError},
    study::{
        Arguments, Case, Definition, EXECUTORS, Ended, Plan, Standing, State, StudyError, Turn, Work, advice, collect,
        exported_table, run_task, terminal_table,
    },
    traci::SumoBinary,
};

/// Plans a study, runs what is not done, and prints the table.
pub fn study(args: &StudyArgs, arguments: Arguments, call: &Call) -> miette::Result<u8> {
    let executor = find("executor", EXECUTORS, &args.executor).map_err(StudyError::from)?.build;
    if args.executor != "slurm" && !args.slurm.is_empty() {
        miette::bail!("--slurm: found the executor {}, wanted --executor slurm with it", args.executor);
    }
    if args.executor == "slurm" && args.shard.is_some() {
        miette::bail!("--shard: found the executor slurm, which divides the cases itself; wanted one of the two");
    }
    let shard = args.shard.as_deref().map(shard).transpose()?;
    let definition = Definition::read(&arguments)?;
    let plan = Plan::new(&definition, args.out.clone(), call.catalog)?;
    let mine = |case: &&Case| shard.is_none_or(|(i, n)| case.number % n == i % n);
    if args.plan || args.status {
        let standing = if args.status { (executor.standing)(&plan)? } else { BTreeMap::new() };
        return match args.export.export {
            Some(form) => print(&standings(&plan.keys, &open_cases(&plan, mine, args.status, &standing), form)),
            None => print(&listed(&plan, mine, args.status, &standing)),
        };
    }
    if args.collect {
        return tables(&plan, args);
    }
    if !args.quiet {
        notes(&plan.settings[0].scenario.notes);
        notes(advice(plan.seeds.len()).as_slice());
    }
    let todo: Vec<&Case> =
        plan.cases.iter().filter(mine).filter(|case| args.force || State::of(&plan, case) != State::Done).collect();
    obstacle(args.backend, &plan.sumo, args.quiet)?;
    let program = call.program()?;
    let work = Work {
        plan: &plan,
        cases: &todo,
        jobs: args.jobs.map(usize::from),
        backend: args.backend,
        program: &program,
        tables: &collecting(&call.arguments),
        force: args.force,
        wait: args.wait,
        slurm: &definition.slurm,
        quiet: args.quiet,
    };
    let ended = (executor.execute)(&work)?;
    if let Ended::Queued(jobs) = ended {
        return queued(&plan, todo.len(), &jobs, args.quiet);
    }
    if let Ended::Interrupted(signal) = ended {
        let done = plan.cases.iter().filter(|case| State::of(&plan, case) == State::Done).count();
        eprintln!("stopped: {done} of {} cases are done; the same command goes on from there", plan.cases.len());
        return Ok(signal.exit_code());
    }
    if shard.is_none() {
        return tables(&plan, args);
    }
    let failed = todo.iter().filter(|case| State::of(&plan, case) != State::Done).count();
    if !args.quiet {
        eprintln!(
            "this shard is done; when all are, the same command with --collect in place of --shard makes the tables"
        );
    }
    failures(failed)
}

/// Says what stands against SUMO in the processes of the cases, before any of them begins.
fn obstacle(backend: Backend, sumo: &SumoBinary, quiet: bool) -> miette::Result<()> {
    match (backend, Backend::obstacle(sumo)) {
        (Backend::Libsumo, Some(why)) => Err(RunError::Backend(why).into()),
        (Backend::Auto, Some(why)) if !quiet => {
            notes(&[format!("SUMO runs in processes of its own: {why}")]);
            Ok(())
        }
        _ => Ok(()),
    }
}

/// The arguments of this call, changed so that they write the tables.
fn collecting(arguments: &[OsString]) -> Vec<OsString> {
    let mut arguments = arguments.iter().cloned();
    let subcommand = arguments.next();
    subcommand.into_iter().chain(["--collect".into()]).chain(arguments).collect()
}

/// Prints the numbers of the jobs, and how to go on.
fn queued(plan: &Plan, cases: usize, jobs: &[String], quiet: bool) -> miette::Result<u8> {
    if !quiet {
        let (cases, last) = (counted(cases, "case"), jobs.last().map_or("", String::as_str));
        eprintln!(
            "{cases} in the queue; job {last} writes the tables into {} when the others have ended; the same command with \
             --status tells how far they are, scancel stops them",
            plan.dir.display()
        );
    }
    print(&format!("{}\n", jobs.join(" ")))
}

/// Runs one task of a job array.
pub fn slurm_task(args: &SlurmTaskArgs, call: &Call) -> miette::Result<u8> {
    const INDEX: &str = "SLURM_ARRAY_TASK_ID";
    let index = std::env::var(INDEX).ok().and_then(|index| index.parse().ok());
    let index =
        index.ok_or_else(|| miette::miette!("{INDEX} is not set: Slurm sets it for the tasks of job arrays"))?;
    let program = call.program()?;
    let failed = run_task(&args.intent, &args.name, index, &program)?;
    for reason in &failed {
        eprintln!("{reason}");
    }
    Ok(u8::from(!failed.is_empty()))
}

/// Writes and prints the tables.
fn tables(plan: &Plan, args: &StudyArgs) -> miette::Result<u8> {
    let _turn = Turn::wait(&plan.dir)?;
    let tables = collect(plan)?;
    tables.write(plan)?;
    let [done, failed, missing] = tables.counts;
    if !args.quiet {
        eprintln!("{}: {done} cases done, {failed} failed, {missing} missing", plan.dir.display());
    }
    match args.export.export {
        Some(form) => print(&exported_table(&plan.keys, &tables.comparison, form))?,
        None if args.quiet => SUCCESS,
        None => print(&terminal_table(&plan.keys, plan.seeds.len(), &tables.comparison))?,
    };
    if !args.no_report {
        let page = write_report(&plan.dir)?;
        if !args.quiet && args.export.export.is_none() {
            print(&line("look at", &page.display()))?;
        }
    }
    failures(failed)
}

/// What failed is in the tables, and no success.
fn failures(failed: usize) -> miette::Result<u8> {
    if failed > 0 {
        return Err(miette::miette!(
            "{} failed; --status says why, and the same command tries again",
            counted(failed, "case")
        ));
    }
    Ok(SUCCESS)
}

/// The cases as rows; with `open`, only those that are not done.
fn open_cases(
    plan: &Plan,
    mine: impl Fn(&&Case) -> bool,
    open: bool,
    standing: &BTreeMap<usize, Standing>,
) -> Vec<Listed> {
    let listed = plan.cases.iter().filter(mine).map(|case| {
        let (status, reason) = told(State::of(plan, case), standing.get(&case.number));
        let reason = reason.trim_start_matches(": ").to_owned();
        let line = CaseLine { case: case.number as u64, seed: case.seed, status, reason };
        Listed { values: plan.settings[case.setting].values.clone(), line }
    });
    listed.filter(|case| !open || case.line.status != DONE).collect()
}

/// One line per case, what they come to, and how long those take that are left; with `open`, only cases that are not done.
fn listed(plan: &Plan, mine: impl Fn(&&Case) -> bool, open: bool, standing: &BTreeMap<usize, Standing>) -> String {
    let (mut text, mut wall_s, mut cases) = (String::new(), 0.0, 0);
    let mut counts = WORDS.map(|word| (word, 0_usize));
    for case in plan.cases.iter().filter(mine) {
        let (word, reason) = told(State::of(plan, case), standing.get(&case.number));
        cases += 1;
        counts.iter_mut().filter(|(known, _)| *known == word).for_each(|(_, count)| *count += 1);
        wall_s += plan.wall_s(case).unwrap_or(0.0);
        if !open || word != DONE {
            let (setting, seed) = (plan.shown(case.setting), case.seed);
            text += &format!("{:04}\t{setting}\tseed {seed}\t{word}{reason}\n", case.number);
        }
    }
    // A scheduler's words are told where there is one.
    let counted = counts.iter().enumerate().filter(|(k, (_, count))| *k < 3 || *count > 0);
    let counted: Vec<String> = counted.map(|(_, (word, count))| format!("{count} {word}")).collect();
    text += &format!("{cases} cases in {}: {}\n", plan.dir.display(), counted.join(", "));
    let done = counts[0].1;
    if done > 0 && done < cases {
        let each_s = wall_s / done as f64;
        let left_s = each_s * (cases - done) as f64;
        text += &format!(
            "{each_s:.1} s for each of those done: {left_s:.0} s for the others, shared by as many as run at a time\n"
        );
    }
    text
}

const DONE: &str = "done";
/// The words for cases; the first three are always counted.
const WORDS: [&str; 6] = [DONE, "failed", "missing", "running", "pending", "uncertain"];

/// The word for a case, from its folder and what a scheduler knows, and the reason if it failed. A task that was stopped
/// may have seen SUMO die first; that its task was stopped is the better reason.
fn told(state: State, standing: Option<&Standing>) -> (&'static str, String) {
    match (standing, &state) {
        (Some(Standing::Running), _) => ("running", String::new()),
        (Some(Standing::Pending), _) => ("pending", String::new()),
        (Some(Standing::Lost(reason)), State::Missing | State::Failed(_)) | (_, State::Failed(reason)) => {
            ("failed", format!(": {reason}"))
        }
        (Some(Standing::Uncertain), State::Missing) => ("uncertain", String::new()),
        (_, State::Done | State::Missing) => (state.as_str(), String::new()),
    }
}

/// A number of things.
fn counted(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

/// `I/N` as two numbers.
fn shard(text: &str) -> miette::Result<(usize, usize)> {
    let pair = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    let pair = pair.filter(|(i, n): &(usize, usize)| (1..=*n).contains(i));
    pair.ok_or_else(|| miette::miette!("--shard: found {text}, wanted I/N with I from 1 to N"))
}
