//! Code in the pages: commands that the program takes, files that it loads, code that stands in the examples, tests that exist.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use regex::Regex;
use sumo_mfc::scenario::{parameter_keys, parameter_names};

use crate::assert_none;
use crate::page::{Block, Found, Page, pages};
use crate::support::{NEW, Running, program, repository};

/// Lines of shell, those that end with a backslash joined, without comments.
fn lines(block: &Block) -> impl Iterator<Item = Found> {
    let mut lines: Vec<Found> = Vec::new();
    let mut open = false;
    for (i, line) in block.found.text.lines().enumerate() {
        let line = line.split(" # ").next().unwrap_or_default().trim();
        let (text, continues) = line.strip_suffix('\\').map_or((line, false), |text| (text, true));
        match lines.last_mut() {
            Some(last) if open => last.text += text,
            _ => lines.push(Found {
                page: block.found.page.clone(),
                line: block.found.line + 1 + i,
                text: text.to_owned(),
            }),
        }
        open = continues;
    }
    lines.into_iter().filter(|line| !line.text.is_empty() && !line.text.starts_with('#'))
}

/// Every command of the pages: lines of `sh` blocks, and code within lines.
fn commands(pages: &[Page]) -> Vec<Found> {
    let copy = |found: &Found| Found { page: found.page.clone(), line: found.line, text: found.text.clone() };
    let blocks = pages.iter().flat_map(|page| &page.blocks).filter(|block| block.language() == "sh").flat_map(lines);
    blocks.chain(pages.iter().flat_map(|page| &page.inline).map(copy)).collect()
}

/// The arguments of the call of `program` in a command; `None` if it has none.
fn arguments(command: &str, program: &str) -> Option<Vec<String>> {
    let words: Vec<&str> = command.split_whitespace().collect();
    let start = words.iter().position(|word| *word == program)?;
    // Behind `exec`, variables and wrappers a call may stand, but not in the middle of arguments.
    let ends = |word: &&&str| {
        !["|", "||", "&&", ";", "&"].contains(*word) && !word.starts_with(['>', '<']) && !word.starts_with("2>")
    };
    let words = words[start + 1..].iter().take_while(ends);
    Some(words.map(|word| word.trim_matches(['"', '\'']).to_owned()).collect())
}

/// Asks the program whether it takes these arguments: it reads them from the left, and stops at `--help`.
fn refusal(arguments: &[String]) -> Option<String> {
    let own = arguments.iter().take_while(|argument| *argument != "--");
    let mut command = Command::new(env!("CARGO_BIN_EXE_sumo-mfc"));
    let ended = Running::start({
        command.args(own).arg("--help");
        command
    })
    .wait();
    (ended.code != Some(0)).then_some(ended.stderr)
}

#[test]
fn law_every_command_line_is_taken() {
    let pages = pages();
    let commands = commands(&pages);
    let calls = commands.iter().filter_map(|command| Some((command, arguments(&command.text, "sumo-mfc")?)));
    let calls: Vec<_> = calls.filter(|(_, arguments)| !arguments.is_empty()).collect();
    assert!(calls.len() > 50, "only {} command lines are found", calls.len());
    assert_none("refused", calls.iter().filter_map(|(command, arguments)| Some(command.wrong(refusal(arguments)?))));
}

#[test]
fn law_every_target_of_make_exists() {
    let makefile = fs::read_to_string(repository("Makefile")).unwrap();
    let targets: BTreeSet<&str> = makefile.lines().filter_map(|line| Some(line.split_once(':')?.0)).collect();
    let pages = pages();
    let wrong = commands(&pages).into_iter().filter_map(|command| {
        let target = command.text.strip_prefix("make ")?.split_whitespace().find(|word| !word.contains('='))?;
        (!targets.contains(target)).then(|| command.wrong("is no target of the Makefile"))
    });
    assert_none("make", wrong);
}

/// All Rust files below some folders, one text.
static SOURCES: LazyLock<String> = LazyLock::new(|| {
    fn add(path: PathBuf, text: &mut String) {
        if path.is_dir() {
            fs::read_dir(path).unwrap().for_each(|entry| add(entry.unwrap().path(), text));
        } else if path.extension().is_some_and(|e| e == "rs") {
            *text += &fs::read_to_string(path).unwrap();
        }
    }
    let mut text = String::new();
    ["src", "tests", "examples/external/own_law/src"].iter().for_each(|folder| add(repository(folder), &mut text));
    text
});

#[test]
fn law_every_test_that_is_named_exists() {
    let name = Regex::new(r"^(?:(?:law|val|regress)_\w+|[a-z]+(?:_[a-z0-9]+){3,})$").unwrap();
    let functions: BTreeSet<&str> =
        Regex::new(r"fn (\w+)").unwrap().captures_iter(&SOURCES).map(|c| c.get(1).unwrap().as_str()).collect();
    let names = |text: &str| SOURCES.contains(text);
    let pages = pages();
    let mut seen = 0;
    let wrong: Vec<String> = pages
        .iter()
        .filter(|page| page.path != "CHANGELOG.md")
        .flat_map(|page| &page.inline)
        .filter(|found| name.is_match(&found.text))
        .inspect(|_| seen += 1)
        .filter(|found| !functions.iter().any(|function| function.starts_with(&found.text)) && !names(&found.text))
        .map(|found| found.wrong("is no test"))
        .collect();
    assert!(seen > 100, "only {seen} names are found");
    assert_none("tests", wrong);
}

/// `--test NAME`, `--bench NAME` and `--example NAME` of cargo, and what they filter by.
#[test]
fn law_every_target_of_cargo_exists() {
    let manifest = fs::read_to_string(repository("Cargo.toml")).unwrap();
    let exists = |kind: &str, name: &str| match kind {
        "--test" => {
            repository(&format!("tests/{name}.rs")).is_file() || repository(&format!("tests/{name}/main.rs")).is_file()
        }
        _ => manifest.contains(&format!("name = \"{name}\"")),
    };
    let pages = pages();
    let wrong = commands(&pages).into_iter().flat_map(|command| {
        let words: Vec<String> = arguments(&command.text, "cargo").unwrap_or_default();
        let own: Vec<&String> = words.iter().take_while(|word| *word != "--").collect();
        let pairs = own.windows(2).filter(|pair| ["--test", "--bench", "--example"].contains(&pair[0].as_str()));
        let mut wrong: Vec<String> = pairs
            .filter(|pair| pair[1] != "NAME" && !exists(pair[0], pair[1]))
            .map(|pair| command.wrong(format!("has no {} {}", pair[0], pair[1])))
            .collect();
        // What is left in front of `--` is a filter: part of the name of a module or a test.
        let valued = ["--test", "--bench", "--example", "--manifest-path", "--features"];
        let filters =
            own.iter().enumerate().skip(1).filter(|(i, word)| {
                !word.starts_with('-') && !valued.contains(&own[i - 1].as_str()) && own[0] == "test"
            });
        for (_, filter) in filters {
            let part = filter.trim_end_matches("::").rsplit("::").next().unwrap_or_default();
            if part != "NAME" && !SOURCES.contains(part) {
                wrong.push(command.wrong(format!("filters by {part}, which no test or module is called")));
            }
        }
        wrong
    });
    assert_none("cargo", wrong);
}

/// The blocks in a language.
fn blocks(language: &str) -> Vec<Block> {
    pages().into_iter().flat_map(|page| page.blocks).filter(|block| block.language() == language).collect()
}

/// A folder in which the files that blocks name exist.
fn surroundings() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let config = repository("sumo_nets/city/city.sumocfg");
    let scenario = format!("[sumo]\nconfig = {:?}\nend_s = 600.0\n", config.to_str().unwrap());
    ["city.toml", "my.toml"].iter().for_each(|name| write(name, &scenario));
    write(
        "my.sumocfg",
        &fs::read_to_string(&config).unwrap().replace("city.", &repository("sumo_nets/city/city.").to_string_lossy()),
    );
    write("trip.csv", "t_s,v_mps\n0,0\n10,10\n20,10\n");
    folder
}

/// What the program says against a file that a block holds: a study, or a scenario, also a part of one.
fn refused(block: &Block) -> Option<String> {
    let folder = surroundings();
    let (text, file) = (&block.found.text, folder.path().join("block.toml"));
    let study = text.contains("[[vary]]") || text.contains("scenario =");
    let scenario = format!("[sumo]\nconfig = {:?}\n", repository("sumo_nets/city/city.sumocfg").to_str().unwrap());
    let text = if study || text.contains("[sumo]") { text.clone() } else { format!("{text}\n{scenario}") };
    fs::write(&file, text).unwrap();
    let mut command = program(NEW);
    command.current_dir(folder.path());
    if study {
        command.args(["sweep", "block.toml", "--plan"]).arg("-o").arg(Path::new("out"));
    } else {
        command.args(["check", "block.toml"]);
    }
    let ended = Running::start(command).wait();
    (ended.code != Some(0)).then_some(ended.stderr)
}

#[test]
fn law_every_scenario_and_study_is_loaded() {
    // Those with a name are parts of pages that are followed, and loaded there.
    let blocks: Vec<Block> = blocks("toml").into_iter().filter(|block| block.info.len() == 1).collect();
    assert!(blocks.len() >= 4, "only {} blocks are found", blocks.len());
    let place = |block: &Block| format!("{}:{}", block.found.page, block.found.line);
    assert_none("refused", blocks.iter().filter_map(|block| Some(format!("{}: {}", place(block), refused(block)?))));
}

/// Rust and Python are parts of examples that other tests build and run.
#[test]
fn law_code_stands_in_an_example() {
    let examples = [
        "examples/external/own_law/src/main.rs",
        "examples/session.rs",
        "examples/clients/second_client.py",
        "examples/python/controller.py",
        "examples/python/environment.py",
        "examples/python/first.py",
        "examples/python/offline.py",
        "examples/python/run.py",
        "examples/python/stepping.py",
        "examples/python/studies.py",
    ];
    let examples: String = examples.iter().map(|path| fs::read_to_string(repository(path)).unwrap()).collect();
    let code = ["rust", "python"].into_iter().flat_map(blocks);
    let wrong = code.filter(|block| !examples.contains(&block.found.text));
    assert_none("not part of an example", wrong.map(|block| block.found.wrong("")));
}

/// The `mfc.*` parameters in SUMO's files are ours.
#[test]
fn law_parameters_in_xml_exist() {
    let known: BTreeSet<String> = parameter_keys().flat_map(parameter_names).collect();
    let key = Regex::new(r#"<param key="(mfc\.[^"*]*)""#).unwrap();
    let wrong = pages().into_iter().flat_map(|page| {
        let blocks = page.blocks.into_iter().filter(|block| block.language() == "xml").map(|block| block.found);
        blocks.chain(page.inline).collect::<Vec<_>>()
    });
    let wrong = wrong.flat_map(|found| {
        let keys = key.captures_iter(&found.text).map(|c| c[1].to_owned()).filter(|name| !known.contains(name));
        keys.map(|name| format!("{}:{}: {name}", found.page, found.line)).collect::<Vec<_>>()
    });
    assert_none("parameters that are not known", wrong);
}

/// A block without a language is shown to nobody as what it is, and is checked by nobody.
#[test]
fn law_every_block_says_its_language() {
    let known = ["sh", "text", "toml", "rust", "python", "xml"];
    let wrong = pages().into_iter().flat_map(|page| page.blocks).filter(|block| !known.contains(&block.language()));
    assert_none("blocks in no known language", wrong.map(|block| block.found.wrong(block.language())));
}

#[test]
fn what_is_wrong_is_found() {
    let call = |text: &str| refusal(&arguments(text, "sumo-mfc").unwrap());
    assert_eq!(call("sumo-mfc run city.toml --seed 3 > log.txt"), None);
    assert!(call("sumo-mfc run city.toml --sede 3").is_some());
    assert!(call("sumo-mfc walk city.toml").is_some());
    assert!(call("sumo-mfc run city.toml --threads many").is_some());
    let wrong = Page::parse("page.md", "```toml\n[actuator]\ndelay_ms = 250\n```\n");
    assert!(refused(&wrong.blocks[0]).unwrap().contains("delay_ms"));
    let wrong =
        Page::parse("page.md", "```toml\nscenario = \"city.toml\"\n[[vary]]\n\"controller.name\" = [\"pod\"]\n```\n");
    assert!(refused(&wrong.blocks[0]).unwrap().contains("pod"));
}
