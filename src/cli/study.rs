//! `sweep` and `compare`.

use std::process::ExitCode;

use super::{arguments::StudyArgs, notes, print, write_report};
use crate::{
    registry::find,
    scenario::Catalog,
    study::{
        Arguments, Case, Definition, EXECUTORS, Ended, Plan, State, StudyError, Work, advice, collect, terminal_table,
        warm_up,
    },
};

/// Plans a study, runs what is not done, and prints the table.
pub fn study(args: &StudyArgs, arguments: Arguments, catalog: &Catalog) -> miette::Result<ExitCode> {
    let execute = find("executor", EXECUTORS, &args.executor).map_err(StudyError::from)?.build;
    let shard = args.shard.as_deref().map(shard).transpose()?;
    let definition = Definition::read(&arguments)?;
    let plan = Plan::new(&definition, args.out.clone(), catalog)?;
    let mine = |case: &&Case| shard.is_none_or(|(i, n)| case.number % n == i % n);
    if args.plan || args.status {
        return print(&listed(&plan, mine, args.status));
    }
    if args.collect {
        return tables(&plan, args);
    }
    if !args.quiet {
        notes(&plan.settings[0].scenario.notes);
        notes(advice(plan.seeds.len()).as_slice());
    }
    plan.write().map_err(StudyError::from)?;
    let todo: Vec<&Case> =
        plan.cases.iter().filter(mine).filter(|case| args.force || State::of(&plan, case) != State::Done).collect();
    let program = std::env::current_exe().map_err(StudyError::from)?;
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = args.jobs.map_or_else(cores, usize::from);
    let mut ended = warm_up(&plan, &todo, jobs, args.quiet)?;
    if ended == Ended::All {
        ended = execute(&Work { plan: &plan, cases: &todo, jobs, program: &program, quiet: args.quiet })?;
    }
    if let Ended::Interrupted(signal) = ended {
        let done = plan.cases.iter().filter(|case| State::of(&plan, case) == State::Done).count();
        eprintln!("stopped: {done} of {} cases are done; the same command goes on from there", plan.cases.len());
        return Ok(ExitCode::from(signal.exit_code()));
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

/// Writes and prints the tables.
fn tables(plan: &Plan, args: &StudyArgs) -> miette::Result<ExitCode> {
    let tables = collect(plan)?;
    tables.write(plan)?;
    let [done, failed, missing] = tables.counts;
    if !args.quiet {
        eprintln!("{}: {done} cases done, {failed} failed, {missing} missing", plan.dir.display());
    }
    print(&terminal_table(&plan.keys, plan.seeds.len(), &tables.comparison))?;
    if !args.no_report {
        write_report(&plan.dir, args.quiet)?;
    }
    failures(failed)
}

/// What failed is in the tables, and no success.
fn failures(failed: usize) -> miette::Result<ExitCode> {
    if failed > 0 {
        let cases = if failed == 1 { "case" } else { "cases" };
        return Err(miette::miette!("{failed} {cases} failed; --status says why, and the same command tries again"));
    }
    Ok(ExitCode::SUCCESS)
}

/// One line per case, what they come to, and how long those take that are left; with `open`, only cases that are not done.
fn listed(plan: &Plan, mine: impl Fn(&&Case) -> bool, open: bool) -> String {
    let (mut text, mut counts, mut wall_s) = (String::new(), [0_usize; 3], 0.0);
    for case in plan.cases.iter().filter(mine) {
        let state = State::of(plan, case);
        let reason = if let State::Failed(reason) = &state { format!(": {reason}") } else { String::new() };
        counts[match state {
            State::Done => 0,
            State::Failed(_) => 1,
            State::Missing => 2,
        }] += 1;
        wall_s += plan.wall_s(case).unwrap_or(0.0);
        if !open || state != State::Done {
            let (setting, seed) = (plan.shown(case.setting), case.seed);
            text += &format!("{:04}\t{setting}\tseed {seed}\t{}{reason}\n", case.number, state.as_str());
        }
    }
    let [done, failed, missing] = counts;
    text += &format!(
        "{} cases in {}: {done} done, {failed} failed, {missing} missing\n",
        done + failed + missing,
        plan.dir.display()
    );
    if done > 0 && failed + missing > 0 {
        let each_s = wall_s / done as f64;
        let left_s = each_s * (failed + missing) as f64;
        text += &format!(
            "{each_s:.1} s for each of those done: {left_s:.0} s for the others, shared by as many as run at a time\n"
        );
    }
    text
}

/// `I/N` as two numbers.
fn shard(text: &str) -> miette::Result<(usize, usize)> {
    let pair = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    let pair = pair.filter(|(i, n): &(usize, usize)| (1..=*n).contains(i));
    pair.ok_or_else(|| miette::miette!("--shard: found {text}, wanted I/N with I from 1 to N"))
}
