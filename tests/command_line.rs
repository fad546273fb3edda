//! What the command line offers beside its work: help, completions, manual pages, tables for other programs, silence.

#[path = "live/support.rs"]
#[allow(dead_code)]
mod support;

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::Value;
use support::{Ended, NEW, Running, program, repository, table};

/// The subcommands that `--help` shows.
const SUBCOMMANDS: [&str; 13] = [
    "run",
    "compare",
    "sweep",
    "report",
    "recover",
    "check",
    "paper",
    "tune",
    "stability",
    "list",
    "doctor",
    "completions",
    "man",
];

fn call(args: &[&str]) -> Ended {
    let mut command = program(NEW);
    command.current_dir(repository("")).args(args);
    Running::start(command).wait()
}

/// What a call that must succeed prints.
fn printed(args: &[&str]) -> String {
    let ended = call(args);
    assert_eq!(ended.code, Some(0), "{args:?}: {}", ended.stderr);
    ended.stdout
}

/// Another program, in a folder.
fn shell(program: &str, args: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(program);
    command.args(args).current_dir(folder).output().unwrap_or_else(|error| panic!("{program}: {error}"))
}

#[test]
fn help_is_in_groups_and_has_examples_and_defaults() {
    let main = printed(&["--help"]);
    for name in SUBCOMMANDS {
        assert!(main.lines().any(|line| line.starts_with(&format!("  {name} "))), "no {name}:\n{main}");
        let help = printed(&[name, "--help"]);
        assert_eq!(help, printed(&[name, "-h"]), "{name}");
        assert!(help.contains("\nExamples:\n  sumo-mfc ") || name == "completions", "{name}:\n{help}");
        assert!(!help.contains("\nOptions:\n"), "{name}: options outside a group:\n{help}");
        assert!(help.contains("\nGeneral:\n"), "{name}:\n{help}");
        assert!(help.lines().all(|line| line.chars().count() <= 120), "{name}: long lines:\n{help}");
    }
    assert!(!main.contains("slurm-task"), "{main}");
    let run = printed(&["run", "--help"]);
    let places: Vec<Option<usize>> =
        ["Arguments", "Scenario", "Controller and egos", "SUMO", "Output", "General", "Examples"]
            .iter()
            .map(|group| run.find(&format!("\n{group}:\n")))
            .collect();
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{places:?}\n{run}");
    for default in ["or adaptive]", "[default: vehicles.csv]", "[default: all cores]"] {
        // Long lines are wrapped.
        let words = run.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains(default), "{default}:\n{run}");
    }
}

#[test]
fn bash_completes_subcommands_options_and_values() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("sumo-mfc.bash");
    fs::write(&script, printed(&["completions", "bash"])).unwrap();
    // What readline does: it calls the function that `complete` was told, with the program, the word and the one before.
    let readline = r#"COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); name=$(complete -p sumo-mfc | sed 's/.*-F \([^ ]*\).*/\1/')
        $name sumo-mfc "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"; printf '%s\n' "${COMPREPLY[@]}""#;
    let line = format!("source '{}'; {readline}", script.display());
    let complete = |words: &[&str]| {
        let output = shell("bash", &[&["--norc", "-c", &line, "bash"], words].concat(), folder.path());
        assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        text.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(complete(&["sumo-mfc", "comp"]), ["compare", "completions"]);
    assert_eq!(complete(&["sumo-mfc", "run", "--cont"]), ["--controller"]);
    assert_eq!(complete(&["sumo-mfc", "sweep", "--export", "m"]), ["md"]);
    assert_eq!(complete(&["sumo-mfc", "completions", "el"]), ["elvish"]);
    let all = complete(&["sumo-mfc", ""]);
    assert!(SUBCOMMANDS.iter().all(|name| all.iter().any(|word| word == name)), "{all:?}");
    assert!(!all.iter().any(|word| word.contains("slurm")), "{all:?}");
    for shell in ["zsh", "fish", "elvish", "powershell"] {
        let text = printed(&["completions", shell]);
        assert!(text.contains("compare") && !text.contains("slurm-task"), "{shell}");
    }
}

#[test]
fn manual_pages_are_clean_roff() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("man1");
    assert_eq!(printed(&["man", "-o", dir.to_str().unwrap()]), "");
    let mut names: Vec<String> =
        fs::read_dir(&dir).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let mut wanted: Vec<String> = SUBCOMMANDS.iter().map(|name| format!("sumo-mfc-{name}.1")).collect();
    wanted.push("sumo-mfc.1".to_owned());
    wanted.sort();
    assert_eq!(names, wanted);
    assert_eq!(printed(&["man"]), fs::read_to_string(dir.join("sumo-mfc.1")).unwrap());
    if Command::new("groff").arg("--version").output().is_err() {
        assert!(std::env::var_os("SUMO_MFC_DIST").is_none(), "groff is missing");
        return eprintln!("groff is missing: the pages are not rendered");
    }
    let mut pages = Vec::new();
    for name in &names {
        // -P: grotty without bold and underlined letters, whose escapes would stand between those that are looked for.
        let plain = ["-P-c", "-P-b", "-P-o", "-P-u"];
        let output =
            shell("groff", &[&["-man", "-Tutf8", "-Kutf8", "-ww", "-rLL=140n", name], &plain[..]].concat(), &dir);
        assert!(
            output.status.success() && output.stderr.is_empty(),
            "{name}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
        pages.push(String::from_utf8(output.stdout).unwrap());
    }
    let page = &pages[names.iter().position(|name| name == "sumo-mfc-run.1").unwrap()];
    for part in ["NAME", "CONTROLLER AND EGOS", "EXAMPLES", "-- --scale 1.5", "--trace-period"] {
        assert!(page.contains(part), "no {part}:\n{page}");
    }
    // An example is a line of its own, as in --help.
    assert!(page.lines().filter(|line| line.trim_start().starts_with("sumo-mfc run ")).count() >= 4, "{page}");
}

/// A table of GitHub's Markdown: its cells.
fn cells(markdown: &str) -> Vec<Vec<String>> {
    let rows: Vec<Vec<String>> = markdown
        .lines()
        .map(|line| {
            let inside = line.strip_prefix("| ").and_then(|line| line.strip_suffix(" |"));
            inside.unwrap_or_else(|| panic!("no row: {line}")).split(" | ").map(str::to_owned).collect()
        })
        .collect();
    assert!(rows[1].iter().all(|cell| [":--", "--:"].contains(&cell.as_str())), "{markdown}");
    assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{markdown}");
    rows
}

fn csv_rows(text: &str) -> Vec<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
    reader.records().map(|row| row.unwrap().iter().map(str::to_owned).collect()).collect()
}

fn objects(text: &str) -> Vec<Value> {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}:\n{text}"))
}

#[test]
fn a_list_in_every_form() {
    let lines = printed(&["list"]);
    let plain: Vec<Vec<&str>> = lines.lines().map(|line| line.splitn(3, '\t').collect()).collect();
    let csv = csv_rows(&printed(&["list", "--export", "csv"]));
    assert_eq!(csv[0], ["kind", "name", "summary"]);
    assert_eq!(csv[1..], plain);
    let json = objects(&printed(&["list", "--export", "json"]));
    assert_eq!(json.len(), plain.len());
    assert_eq!(json[0]["name"], plain[0][1]);
    assert_eq!(cells(&printed(&["list", "--export", "md"])).len(), 2 + plain.len());
    let refused = call(&["list", "--export", "jsn"]);
    assert_eq!(refused.code, Some(1));
    assert!(refused.stderr.contains("json") && refused.stderr.contains("similar"), "{}", refused.stderr);
}

#[test]
fn a_run_sums_up_what_matters_and_where_to_look() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("result");
    let shown = dir.to_str().unwrap();
    let text = printed(&["run", "scenarios/straight.toml", "--end", "20", "-o", shown]);
    let names: Vec<&str> = text.lines().map(|line| line[..14].trim_end()).collect();
    let wanted = ["vehicles", "error RMS", "speed gap RMS", "lead limited", "SUMO", "clamps", "collisions", "speed"];
    assert_eq!(names, [&wanted[..], &["worst", "written", "look at"]].concat(), "{text}");
    let rows = table(&dir.join("vehicles.csv"));
    let rms = support::number(&rows[0], "error_rms");
    let worst = format!("worst          {} {rms:.3} m/s error RMS\n", rows[0]["id"]);
    assert!(text.contains(&worst), "{worst}{text}");
    assert!(text.ends_with(&format!("look at        {}\n", dir.join("report.html").display())), "{text}");
    assert!(dir.join("report.html").is_file());

    let again = ["run", "scenarios/straight.toml", "--end", "20", "--force", "-o", shown];
    let json = objects(&printed(&[&again[..], &["--export", "json"]].concat()));
    assert_eq!((json.len(), json[0]["vehicles"].as_u64(), json[0]["folder"].as_str()), (1, Some(1), Some(shown)));
    assert!((json[0]["error_rms_p50"].as_f64().unwrap() - rms).abs() < 1e-12, "{json:?}");
    let csv = csv_rows(&printed(&[&again[..], &["--export", "csv", "--profile"]].concat()));
    assert_eq!((csv.len(), csv[0].len()), (2, csv[1].len()), "the profile is elsewhere");
    assert_eq!(cells(&printed(&[&again[..], &["--export", "md"]].concat())).len(), 3);
}

#[test]
fn a_comparison_in_every_form_and_in_silence() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("study");
    let compare =
        ["compare", "scenarios/straight.toml", "--controllers", "ideal,pid", "--seeds", "1,2", "--end", "20", "-o"];
    let compare = [&compare[..], &[dir.to_str().unwrap()]].concat();
    let call_with = |more: &[&str]| printed(&[&compare[..], more].concat());

    let plan = objects(&call_with(&["--plan", "--export", "json"]));
    assert_eq!(plan.len(), 4);
    assert_eq!((plan[1]["controller.name"].as_str(), plan[1]["status"].as_str()), (Some("pid"), Some("missing")));
    let silent = call(&[&compare[..], &["-q"]].concat());
    assert_eq!((silent.code, silent.stdout.as_str(), silent.stderr.as_str()), (Some(0), "", ""));

    let markdown = cells(&call_with(&["--collect", "--export", "md"]));
    assert_eq!(markdown[0], ["controller.name", "ideal", "pid"]);
    let rms = markdown.iter().find(|row| row[0].starts_with("error RMS, mean")).unwrap();
    assert!(rms[2].contains("<br>+"), "{rms:?}");
    let csv = call_with(&["--export", "csv"]);
    assert_eq!(csv, fs::read_to_string(dir.join("comparison.csv")).unwrap());
    let json = objects(&call_with(&["--collect", "--export", "json"]));
    assert_eq!(json.len(), csv.lines().count() - 1);
    assert!(
        json.iter().all(|row| row["seeds"].is_u64() && (row["mean"].is_f64() || row["mean"].is_null())),
        "{json:?}"
    );
    assert_eq!(call_with(&["--status", "--export", "csv"]).lines().count(), 1, "nothing is left to do");
}

#[test]
fn quiet_is_quiet() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    for args in [
        &["run", "scenarios/straight.toml", "--end", "20", "-q", "-o", &path("run")][..],
        &["sweep", "scenarios/straight.toml", "--end", "20", "--seeds", "1", "-q", "-o", &path("sweep")],
        &["report", &path("run"), "-q"],
        &["paper", "sine", "--preset", "default", "-q", "-o", &path("paper")],
    ] {
        let ended = call(args);
        assert_eq!((ended.code, ended.stdout.as_str(), ended.stderr.as_str()), (Some(0), "", ""), "{args:?}");
    }
    assert!(folder.path().join("run/report.html").is_file() && folder.path().join("paper/results.csv").is_file());
    let wrong = call(&["report", &path("nothing"), "-q"]);
    assert!(wrong.code == Some(1) && !wrong.stderr.is_empty(), "errors are told");
}

#[test]
fn the_table_of_the_paper_in_every_form() {
    let folder = tempfile::tempdir().unwrap();
    let paper = ["paper", "step", "--preset", "default", "-o", folder.path().to_str().unwrap()];
    let lines = printed(&paper).lines().filter(|line| line.contains(" published ")).count();
    let json = objects(&printed(&[&paper[..], &["--export", "json"]].concat()));
    assert!(lines > 0 && json.len() == lines, "{lines} {json:?}");
    assert!(json.iter().all(|row| row["published"].is_f64() && row["test"] == "step"), "{json:?}");
    let csv = csv_rows(&printed(&[&paper[..], &["--export", "csv"]].concat()));
    assert_eq!(csv.len(), 1 + lines);
    assert_eq!(csv[1][4].parse::<f64>().ok(), json[0]["value"].as_f64());
    assert_eq!(cells(&printed(&[&paper[..], &["--export", "md"]].concat())).len(), 2 + lines);
}
