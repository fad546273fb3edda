//! Pages that are followed word for word, as a reader would: in an empty folder, with the program and SUMO on the `PATH`.
//!
//! - A block `sh` is run by bash, one after the other; each must succeed.
//! - A block `text` right behind it is what it prints. `…` stands for what may differ (times, folders); a line that is only `…`
//!   stands for any lines.
//! - A block with a file name behind its language (```` ```xml fleet.add.xml ````) is saved under that name.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use crate::page::{Block, Found, Page};
use crate::support::{NEW, Running, repository, sumo_home};

/// No block of a page takes this long.
const LIMIT: Duration = Duration::from_secs(240);

/// Runs a block of commands as if typed in `folder`: what appears on the terminal.
fn typed(folder: &Path, block: &Block) -> String {
    let (home, program) = (sumo_home(NEW), Path::new(env!("CARGO_BIN_EXE_sumo-mfc")));
    let path = format!(
        "{}:{}:{}",
        program.parent().unwrap().display(),
        home.join("bin").display(),
        std::env::var("PATH").unwrap_or_default()
    );
    let mut command = Command::new("bash");
    command.arg("-euc").arg(format!("exec 2>&1\n{}", block.found.text)).current_dir(folder);
    command.env("PATH", path).env("SUMO_HOME", home).env_remove("SUMO_BINARY");
    let ended = Running::start_for(command, LIMIT).wait();
    assert_eq!(ended.code, Some(0), "{}\n{}", block.found.wrong("failed:"), ended.stdout);
    ended.stdout
}

/// The pattern of what a block shows.
fn pattern(shown: &str) -> regex::Regex {
    let line = |line: &str| match line.trim_end() {
        "…" => "(?:.*\n)*?".to_owned(),
        line => line.split('…').map(regex::escape).collect::<Vec<_>>().join(".*") + "[ \t]*\n",
    };
    regex::Regex::new(&format!(r"\A{}\s*\z", shown.lines().map(line).collect::<String>())).unwrap()
}

/// Follows a page from its first block to its last.
fn follow(page: &str) {
    let (page, folder) = (Page::read(page), tempfile::tempdir().unwrap());
    let (mut printed, mut commands, mut compared) = (None::<String>, 0, 0);
    for block in &page.blocks {
        match (block.language(), block.info.get(1)) {
            ("sh", None) => {
                commands += 1;
                printed = Some(typed(folder.path(), block));
            }
            ("text", None) => {
                let Some(printed) = printed.take() else { continue };
                compared += 1;
                assert!(
                    pattern(&block.found.text).is_match(&printed),
                    "{}:{} shows\n{}\nbut this is printed:\n{printed}",
                    block.found.page,
                    block.found.line,
                    block.found.text
                );
            }
            (_, Some(name)) => {
                fs::write(folder.path().join(name), &block.found.text).unwrap();
                printed = None;
            }
            _ => printed = None,
        }
    }
    assert!(commands > 0 && compared > 0, "{}: nothing is run, or nothing is compared", page.path);
}

#[test]
fn val_the_tutorial_is_followed_word_for_word() {
    follow("docs/tutorial.md");
}

#[test]
fn val_several_clients_are_followed_word_for_word() {
    follow("docs/how-to/clients.md");
}

#[test]
fn val_fleets_are_followed_word_for_word() {
    follow("docs/how-to/fleets.md");
}

#[test]
fn val_recordings_are_followed_word_for_word() {
    follow("docs/how-to/recordings.md");
}

/// README shows what a run of the city prints, but for its speed.
#[test]
fn val_the_summary_in_readme_is_what_is_printed() {
    let page = Page::read("README.md");
    let shown = page.blocks.iter().find(|block| block.found.text.starts_with("vehicles ")).expect("a summary");
    let lines = shown.found.text.lines().map(|line| if line.starts_with("speed ") { "speed …" } else { line });
    let shown = pattern(&format!("note: …\n{}", lines.map(|line| format!("{line}\n")).collect::<String>()));
    let folder = tempfile::tempdir().unwrap();
    let config = repository("sumo_nets/city/city.sumocfg");
    let run = format!("sumo-mfc run {} -o out/first", config.display());
    let command = Found { page: page.path.clone(), line: 0, text: run };
    let printed = typed(folder.path(), &Block { info: Vec::new(), found: command });
    assert!(shown.is_match(&printed), "{printed}");
}

#[test]
fn what_may_differ_is_marked() {
    let shown = pattern("vehicles  3\nspeed  … x real time, … s\n…\nend\n");
    assert!(shown.is_match("vehicles  3\nspeed  12.5 x real time, 3 s\nnote: a\nnote: b\nend\n"));
    assert!(shown.is_match("vehicles  3\nspeed  1 x real time, 3 s\nend\n"));
    assert!(!shown.is_match("vehicles  4\nspeed  12.5 x real time, 3 s\nend\n"));
    assert!(!shown.is_match("vehicles  3\nspeed  12.5 x real time, 3 s\nend\nmore\n"));
}
