//! What a shell and `man` want of the program: completions and manual pages, from the arguments as clap knows them.

use std::{io, path::Path};

use clap::{Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::{
    Man,
    roff::{Roff, roman},
};

use super::{
    arguments::{Cli, PROGRAM},
    help,
};
use crate::output::{OutputError, file_error, write_whole};

/// The completions of a shell.
pub fn completions(shell: Shell) -> String {
    let all = Cli::command();
    // Subcommands that --help hides are no choice here either. Clap takes none away, so the program is put together again.
    let visible = all.get_subcommands().filter(|command| !command.is_hide_set()).cloned();
    let program = Command::new(PROGRAM).disable_version_flag(true).disable_help_flag(true);
    let mut program = program.args(all.get_arguments().cloned()).subcommands(visible);
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut program, PROGRAM, &mut text);
    // clap_complete (4.6) writes the hyphen of a program's name in two ways, so that bash finds no option of a subcommand:
    // https://github.com/clap-rs/clap/issues/6421. Where it does not, nothing is replaced.
    let [wrong, right] = ["__subcmd__", "__"].map(|hyphen| PROGRAM.replace('-', hyphen));
    String::from_utf8_lossy(&text).replace(&wrong, &right)
}

/// The manual page of the program.
///
/// # Errors
/// None that is known: it is written to memory.
pub fn manual() -> io::Result<String> {
    page(&built())
}

/// Writes the manual page of the program and one for each of its subcommands into a folder.
///
/// # Errors
/// [`OutputError::File`] naming the file.
pub fn write_manuals(dir: &Path) -> Result<(), OutputError> {
    let program = built();
    for command in program.get_subcommands().filter(|command| !command.is_hide_set()).chain([&program]) {
        let path = dir.join(Man::new(command.clone()).get_filename());
        write_whole(&path, &page(command).map_err(file_error("write", &path))?)?;
    }
    Ok(())
}

/// The program, its subcommands knowing that they are its own.
fn built() -> Command {
    let mut program = Cli::command().disable_help_subcommand(true);
    program.build();
    program
}

/// One page. The examples keep their lines, which clap_mangen would fill as a paragraph.
fn page(command: &Command) -> io::Result<String> {
    let mut page = Vec::new();
    let man = Man::new(command.clone()).source(format!("{PROGRAM} {}", env!("CARGO_PKG_VERSION"))).manual(PROGRAM);
    man.render_title(&mut page)?;
    man.render_name_section(&mut page)?;
    man.render_synopsis_section(&mut page)?;
    man.render_description_section(&mut page)?;
    man.render_options_section(&mut page)?;
    if command.has_subcommands() {
        man.render_subcommands_section(&mut page)?;
    }
    if let Some(text) = command.get_after_help() {
        let text = text.to_string();
        let mut roff = Roff::new();
        roff.control("SH", ["EXAMPLES"]).control("nf", []);
        for line in text.strip_prefix(help::HEAD).unwrap_or(&text).lines() {
            roff.text([roman(line)]);
        }
        roff.control("fi", []).to_writer(&mut page)?;
    }
    String::from_utf8(page).map_err(io::Error::other)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[test]
    fn every_example_is_understood_and_names_files_that_are_there() {
        let mut examples = 0;
        for command in Cli::command().get_subcommands().chain([&Cli::command()]) {
            let text = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            assert!(command.is_hide_set() || text.starts_with(help::HEAD), "{}: no examples", command.get_name());
            // What is wider would be wrapped where the terminal is not known.
            assert!(text.lines().all(|line| line.chars().count() <= 98), "{text}");
            for line in text.lines().filter_map(|line| line.strip_prefix("  ")) {
                // What is said about an example stands behind two spaces; a shell's own part is the shell's.
                let typed =
                    line.split("  ").next().unwrap_or(line).trim_start_matches("source <(").trim_end_matches(')');
                let typed = typed.split(['|', '>']).next().unwrap_or(typed);
                let words: Vec<&str> = typed.split_whitespace().collect();
                let parsed = Cli::try_parse_from(&words);
                assert!(parsed.is_ok(), "{line}: {}", parsed.err().unwrap());
                for file in words.iter().filter(|word| word.starts_with("scenarios/")) {
                    assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join(file).is_file(), "{line}");
                }
                examples += 1;
            }
        }
        assert!(examples > 25, "{examples}");
    }
}
