//! `docs/reference/command-line.md` is the program's own help; `UPDATE=1 cargo test --test docs command_line` writes it anew.

use std::{fmt::Write, process::Stdio};

use crate::{
    assert_up_to_date,
    support::{NEW, Running, program},
};

const HEAD: &str = "# The command line

What `sumo-mfc run --help` prints, and so on for each command. `sumo-mfc completions bash` and `sumo-mfc man` make completions and manual pages of the same. This
page is made by `UPDATE=1 cargo test --test docs command_line`.
";

fn help(of: &str) -> String {
    let mut command = program(NEW);
    // Without a terminal, clap breaks the lines at 100 columns.
    command.arg("help").args(Some(of).filter(|of| !of.is_empty())).env_remove("COLUMNS").stdin(Stdio::null());
    let ended = Running::start(command).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.stdout
}

fn page() -> String {
    let main = help("");
    let commands =
        main.split("Commands:\n").nth(1).and_then(|list| list.split("\n\n").next()).expect("a list of commands");
    // A line that goes on is indented deeper than a name.
    let names = commands.lines().filter_map(|line| line.strip_prefix("  ").filter(|line| !line.starts_with(' ')));
    let names = names.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    let mut page = format!("{HEAD}\n```text\n{main}```\n");
    for name in names {
        write!(page, "\n## {name}\n\n```text\n{}```\n", help(name)).unwrap();
    }
    page
}

#[test]
fn the_page_of_the_command_line_is_up_to_date() {
    assert_up_to_date("docs/reference/command-line.md", &page(), "command_line");
}
