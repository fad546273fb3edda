//! `docs/reference/files.md` is made from the declarations of the files; `UPDATE=1 cargo test --test docs files` writes it anew.
//! What is in the folders of a real run and a real study is what the page says.

use std::{collections::BTreeSet, fmt::Write, fs, path::Path};

use sumo_mfc::{run::Schema, study::study_schema};

use crate::assert_up_to_date;
use crate::support::{NEW, Running, program, repository, run_command};

const HEAD: &str = "# Files that are written

Everything is written into one folder, `-o DIR`, and nowhere else. What a configuration names as outputs of SUMO goes to `DIR/sumo/`, not into
the folder of the configuration. This page is made by `UPDATE=1 cargo test --test docs files`.

**How a file comes to be.** A file is written as `NAME.part` and gets its name when it is whole: a file with its full name is never cut off.
`run.json` is there from the beginning with `\"status\": \"running\"`; it ends as `complete`, or as `incomplete` with the reason. A finished result in
the folder is refused unless `--force` is given.
`vehicles.csv.part` and `quality.csv.part` grow while the run goes on, by the rows of the vehicles that have left (as CSV, whatever the table's format): they are there
whatever ends the program. `sumo-mfc recover DIR` makes tables of them, and of the trace if it is CSV; what only the end of a run knows (time losses, roads, the sample,
the summary) is lost then. The same scenario, seed, and version give the same bytes in all tables, on any number of threads.

**How to read them.** Tables are CSV: UTF-8, commas, a header, an empty field for no value, `true` and `false`. The suffix of
`--vehicles-output` and `--trace-output` chooses `.csv`, `.parquet` or `.xml`. `schema.json` in the same folder says what every column is;
[Columns](../columns.md) says the same.
";

const ERRORS: &str = "
**How to read the errors.** e = true speed − reference, at every control period; `speed_gap_rms` is true speed − SUMO's v\\*. `error_*` alone can flatter a
controller: where `lead_limited` is not 0, the reference was held near the true speed and large errors were cut. So read both, and `speed_gap_rms`. `timeloss`, `duration`,
and `arrival` are as in SUMO's tripinfo; `reason` says how the row ended; `jerk_rms`, `accel_max`, and `torque_rms` say what the body did for it.
";

const CASES: &str = "
A case counts as done when its `run.json` is complete and its inputs are the same as before. The same command runs what is missing, interrupted,
failed or changed, and makes the tables anew.
";

const OTHERS: &str = "
## Of the other commands

`sumo-mfc report DIR` writes the page and its figures into that folder, or where `-o` says. `sumo-mfc man -o DIR` writes manual pages.
`sumo-mfc tune` writes `tune.csv`, `sumo-mfc stability` writes `margins.csv`, `strings.csv`, and `sweep.csv`. All others print.
";

/// Name, meaning and condition of the files in the folder of a run, and of a study.
fn files() -> [Vec<[String; 3]>; 2] {
    let report = sumo_mfc::report::FILES.map(|[name, meaning]| [name, meaning, "unless `--no-report`"]);
    [Schema::of_run("vehicles.csv", true, Some("trace.csv")), study_schema(&[], |_| true)]
        .map(|schema| schema.files().chain(report).map(|file| file.map(str::to_owned)).collect())
}

fn table<'a>(head: [&str; 3], files: impl IntoIterator<Item = [&'a str; 3]>) -> String {
    let mut table = format!("| {} |\n|---|---|---|\n", head.join(" | "));
    for [name, meaning, when] in files {
        writeln!(table, "| `{name}` | {meaning} | {when} |").unwrap();
    }
    table
}

fn page() -> String {
    let head = ["file", "what", "when"];
    let [run, study] = files();
    let as_text = |files: &[[String; 3]]| table(head, files.iter().map(|file| file.each_ref().map(String::as_str)));
    let mut page = HEAD.to_owned();
    write!(page, "\n## Of a run\n\nDefault folder: `out/SCENARIO-CONTROLLER-SEED`.\n\n{}{ERRORS}", as_text(&run))
        .unwrap();
    let folders =
        "Of `compare` and `sweep`. Default folder: `out/STUDY`, `out/SCENARIO-sweep` or `out/SCENARIO-compare`.";
    write!(page, "\n## Of a study\n\n{folders}\n\n{}{CASES}", as_text(&study)).unwrap();
    let paper = table(head, sumo_mfc::paper::FILES);
    write!(page, "\n## Of `paper`\n\nDefault folder: `out/paper`.\n\n{paper}{OTHERS}").unwrap();
    page
}

#[test]
fn the_page_of_files_is_up_to_date() {
    assert_up_to_date("docs/reference/files.md", &page(), "files");
}

/// The names in a folder, folders with a stroke behind them.
fn names(dir: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(dir).unwrap().map(Result::unwrap);
    entries
        .map(|entry| {
            let stroke = if entry.path().is_dir() { "/" } else { "" };
            format!("{}{stroke}", entry.file_name().to_string_lossy())
        })
        .collect()
}

/// The names of the page's files without these conditions.
fn listed(files: &[[String; 3]], without: &[&str]) -> BTreeSet<String> {
    let kept = files.iter().filter(|[_, _, when]| !without.iter().any(|words| when.contains(words)));
    kept.map(|[name, ..]| name.clone()).collect()
}

#[test]
fn the_folders_of_a_run_a_study_and_the_paper_hold_what_the_page_of_files_says() {
    let folder = tempfile::tempdir().unwrap();
    let straight = repository("scenarios/straight.toml");
    let [run, study] = files();

    let dir = folder.path().join("run");
    let ended = Running::start(run_command(NEW, &straight, &dir, &["--trace", "all", "--end", "5"])).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(names(&dir), listed(&run, &[]));

    let dir = folder.path().join("study");
    let mut command = program(NEW);
    command.arg("compare").arg(&straight).args([
        "--controllers",
        "ideal,pid",
        "--seeds",
        "1",
        "--end",
        "5",
        "-q",
        "-o",
    ]);
    command.arg(&dir);
    let ended = Running::start(command).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(names(&dir), listed(&study, &["warm-up", "slurm"]));
    assert_eq!(names(&dir.join("cases/0001")), listed(&run, &["--trace", "--no-report"]));

    let dir = folder.path().join("paper");
    let paper = sumo_mfc::paper::FILES.map(|file| file.map(str::to_owned));
    let (inside, outside) = (["map", "record", "scenarios/paper"], ["map", "record"]);
    for (working, without) in [(repository("."), &inside[..]), (folder.path().to_owned(), &outside[..])] {
        let mut command = program(NEW);
        command.current_dir(working).args(["paper", "step", "--preset", "default", "-o"]).arg(&dir);
        assert_eq!(Running::start(command).wait().code, Some(0));
        assert_eq!(names(&dir), listed(&paper, without));
    }
}
