//! The invariants that src/lib.rs states, held against the source text: layers, who may touch sockets, files and clocks,
//! sizes of files and functions, and nothing in the repository that belongs to one machine only.

mod circles;

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// The layer of every module. A module imports only from lower layers; a new module gets a line here and one in src/lib.rs.
const LAYERS: &[(&str, u8)] = &[
    ("plant", 0),
    ("control", 0),
    ("measurement", 0),
    ("reference", 0),
    ("traci", 0),
    ("output", 0),
    ("stats", 0),
    ("figure", 1),
    ("fleet", 1),
    ("sumo_files", 1),
    ("scenario", 2),
    ("page", 2),
    ("cosim", 3),
    ("run", 4),
    ("offline", 4),
    ("study", 5),
    ("doctor", 5),
    ("paper", 5),
    ("report", 5),
    ("map", 6),
    ("tune", 6),
    ("stability", 6),
    ("cli", 7),
    ("main", 8),
];

/// Imported by every module; they import only each other.
const COMMON_GROUND: &[&str] =
    &["columns", "keys", "lanes", "missing", "place", "random", "registry", "stopwatch", "table", "trig"];

/// Modules or files (path below src/ without `.rs`) that may name tokio.
const MAY_USE_TOKIO: &[&str] = &[
    "traci/client",
    "traci/process",
    "traci/tie",
    "cosim",
    "run",
    "doctor",
    "study/local",
    "study/warming",
    "cli",
    "main",
];

/// Modules or files that may touch files and clocks.
const MAY_TOUCH_FILES_AND_CLOCKS: &[&str] = &[
    "output",
    "scenario",
    "sumo_files",
    "reference/table",
    "traci/client",
    "traci/find",
    "traci/process",
    "run",
    "doctor",
    // Looks for names like that of a file that is not there; nothing but the message depends on it.
    "missing",
    // Shows people where time goes; nothing is decided by it.
    "stopwatch",
    "study",
    "paper",
    "map",
    "report",
    "cli",
    "main",
];

/// Modules or files that may print.
const MAY_PRINT: &[&str] = &["cli", "main", "report", "paper", "study"];

const FILE_LINES: usize = 500;
const FUNCTION_LINES: usize = 70;

/// One file of src/ as the checks see it.
struct Source {
    /// Below src/, without `.rs`, parts divided by `/`: `traci/client`.
    name: String,
    /// The lines before the unit tests, without comments; strings are emptied, so that line numbers stay right.
    lines: Vec<String>,
    /// The number of lines before the unit tests, comments included.
    length: usize,
}

impl Source {
    fn module(&self) -> &str {
        self.name.split('/').next().unwrap_or_default()
    }

    /// True if the file is one of `list` or lies below one of it.
    fn is_in(&self, list: &[&str]) -> bool {
        list.iter().any(|l| self.name == *l || self.name.starts_with(&format!("{l}/")))
    }

    /// All lines that contain one of `words`, as messages.
    fn lines_with<'a>(&'a self, words: &'a [&str]) -> impl Iterator<Item = String> + 'a {
        self.lines.iter().enumerate().filter_map(move |(i, line)| {
            let word = words.iter().find(|w| contains_word(line, w))?;
            Some(format!("src/{}.rs:{}: {word}", self.name, i + 1))
        })
    }
}

/// True if `line` has `word` not as the tail or head of a longer name.
fn contains_word(line: &str, word: &str) -> bool {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    line.match_indices(word).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        let after = line[at + word.len()..].chars().next();
        !(before.is_some_and(is_name) || after.is_some_and(is_name) && word.ends_with(is_name))
    })
}

/// Empties strings and comments, keeping every line. Rough, but enough for formatted source.
fn without_text(source: &str) -> String {
    let mut out = String::with_capacity(source.len());
    let mut rest = source;
    while let Some(c) = rest.chars().next() {
        let skip = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |i| i + 2)
        } else if let Some(hashes) = raw_string(rest) {
            let end = format!("\"{}", "#".repeat(hashes));
            let body = 2 + hashes;
            rest[body..].find(&end).map_or(rest.len(), |i| body + i + end.len())
        } else if c == '"' {
            string_end(rest)
        } else if rest.starts_with("'\"'") {
            3
        } else if let Some(tail) = rest.strip_prefix(r"'\") {
            2 + tail.char_indices().skip(1).find(|(_, c)| *c == '\'').map_or(0, |(i, _)| i + 1)
        } else if rest.starts_with("'{'") || rest.starts_with("'}'") {
            3
        } else {
            out.push(c);
            rest = &rest[c.len_utf8()..];
            continue;
        };
        out.extend(rest[..skip].chars().filter(|c| *c == '\n'));
        rest = &rest[skip..];
    }
    out
}

/// The number of `#` of the raw string that starts here, if one does.
fn raw_string(text: &str) -> Option<usize> {
    let tail = text.strip_prefix('r')?;
    let hashes = tail.len() - tail.trim_start_matches('#').len();
    tail[hashes..].starts_with('"').then_some(hashes)
}

/// The length of the string literal that starts here.
fn string_end(text: &str) -> usize {
    let mut escaped = false;
    for (i, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return i + 1,
            '\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    text.len()
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
        if entry.is_dir() {
            rust_files(&entry, found);
        } else if entry.extension().is_some_and(|e| e == "rs") {
            found.push(entry);
        }
    }
    found.sort();
}

/// Every file of src/ that is not itself unit tests.
fn sources() -> Vec<Source> {
    let src = root().join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    assert!(files.len() > 8, "src/ was not found");
    let name = |file: &Path| {
        let below = file.strip_prefix(&src).unwrap().with_extension("");
        below.components().map(|c| c.as_os_str().to_str().unwrap().to_owned()).collect::<Vec<_>>().join("/")
    };
    files
        .iter()
        .filter(|f| f.file_stem().is_some_and(|s| s != "tests"))
        .map(|file| {
            let text = fs::read_to_string(file).unwrap();
            let length = text.lines().take_while(|l| !l.starts_with("#[cfg(test)]")).count();
            let lines = without_text(&text).lines().take(length).map(str::to_owned).collect();
            Source { name: name(file), lines, length }
        })
        .collect()
}

#[track_caller]
fn assert_none(what: &str, found: impl IntoIterator<Item = String>) {
    let found: Vec<String> = found.into_iter().collect();
    assert!(found.is_empty(), "{what}:\n  {}", found.join("\n  "));
}

/// The modules that `lines` names through `crate::` (or, in the binary, `sumo_mfc::`), with the line's number.
fn imports(lines: &[String]) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let text = lines.join("\n");
    for start in ["crate::", "sumo_mfc::"] {
        for (at, _) in text.match_indices(start).filter(|(at, _)| !text[..*at].ends_with(['$', '_', ':'])) {
            let line = text[..at].matches('\n').count() + 1;
            let tail = &text[at + start.len()..];
            if let Some(group) = tail.strip_prefix('{') {
                found.extend(first_names(group).into_iter().map(|n| (line, n)));
            } else {
                found.push((line, first_name(tail)));
            }
        }
    }
    found
}

fn first_name(text: &str) -> String {
    text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// The first names of a use group: `a::b, c::{d, e}}` gives a and c.
fn first_names(group: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut depth = 0;
    let mut start = true;
    for (i, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => start = true,
            c if start && !c.is_whitespace() => {
                names.push(first_name(&group[i..]));
                start = false;
            }
            _ => {}
        }
    }
    names
}

#[test]
fn law_a_module_imports_only_from_lower_layers() {
    let layers: BTreeMap<&str, u8> = LAYERS.iter().copied().collect();
    let mut wrong = Vec::new();
    for source in sources() {
        let module = source.module();
        if module == "lib" {
            continue;
        }
        let own = layers.get(module).copied();
        if own.is_none() && !COMMON_GROUND.contains(&module) {
            wrong.push(format!("src/{}.rs: module {module} has no layer in tests/tidy.rs", source.name));
            continue;
        }
        for (line, other) in imports(&source.lines) {
            let allowed = other == module
                || COMMON_GROUND.contains(&other.as_str())
                || match (own, layers.get(other.as_str())) {
                    (Some(own), Some(layer)) => *layer < own,
                    // Not a module: a macro or something that lib.rs exports.
                    (_, None) => true,
                    (None, Some(_)) => false,
                };
            if !allowed {
                wrong.push(format!("src/{}.rs:{line}: {module} imports {other}", source.name));
            }
        }
    }
    assert_none("imports from the same or a higher layer", wrong);
}

#[test]
fn law_no_files_use_each_other_in_a_circle() {
    let arrows = circles::Imports::of(&sources()).arrows();
    assert!(arrows.len() > 100, "the imports were not found");
    assert_none("files that use each other in a circle", circles::circles(&arrows));
}

#[test]
fn law_only_the_outer_modules_name_tokio() {
    let wrong = sources();
    let wrong = wrong.iter().filter(|s| !s.is_in(MAY_USE_TOKIO)).flat_map(|s| s.lines_with(&["tokio"]));
    assert_none("tokio outside the modules that may use it", wrong);
}

#[test]
fn law_only_some_rooms_touch_files_and_clocks() {
    let words = ["std::fs", "fs::", "File::", "OpenOptions", "Instant", "SystemTime", "tempfile"];
    let wrong = sources();
    let wrong = wrong.iter().filter(|s| !s.is_in(MAY_TOUCH_FILES_AND_CLOCKS)).flat_map(|s| s.lines_with(&words));
    assert_none("files or clocks outside the modules that may use them", wrong);
}

#[test]
fn law_only_the_command_line_prints() {
    let words = ["println!", "eprintln!", "print!", "eprint!", "dbg!"];
    let wrong = sources();
    let wrong = wrong.iter().filter(|s| !s.is_in(MAY_PRINT)).flat_map(|s| s.lines_with(&words));
    assert_none("printing outside the modules that may", wrong);
}

/// Platform mathematics differs from machine to machine in the last bit; the crate `libm` and the polynomial kernels do not.
#[test]
fn law_results_use_no_platform_mathematics() {
    let words = [
        "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "exp2", "ln", "log10",
        "log2", "powf", "powi", "hypot", "cbrt", "sin_cos", "mul_add", "ln_1p", "exp_m1",
    ];
    let calls: Vec<String> = words.iter().flat_map(|w| [format!(".{w}("), format!("f64::{w}")]).collect();
    let calls: Vec<&str> = calls.iter().map(String::as_str).collect();
    let modules =
        ["plant", "control", "measurement", "reference", "stats", "fleet", "cosim", "random", "lanes", "paper", "trig"];
    let wrong = sources();
    let wrong: Vec<String> = wrong
        .iter()
        .filter(|s| modules.contains(&s.module()))
        .flat_map(|s| {
            s.lines.iter().enumerate().filter_map(|(i, line)| {
                let call = calls.iter().find(|c| line.contains(**c))?;
                Some(format!("src/{}.rs:{}: {call}", s.name, i + 1))
            })
        })
        .collect();
    assert_none("platform mathematics where results are made (use the crate libm)", wrong);
}

#[test]
fn law_files_and_functions_stay_short() {
    let mut wrong = Vec::new();
    for source in sources() {
        if source.length > FILE_LINES {
            wrong.push(format!("src/{}.rs has {} lines, more than {FILE_LINES}", source.name, source.length));
        }
        for (line, length) in functions(&source.lines) {
            if length > FUNCTION_LINES {
                wrong.push(format!(
                    "src/{}.rs:{line}: a function of {length} lines, more than {FUNCTION_LINES}",
                    source.name
                ));
            }
        }
    }
    assert_none("too long", wrong);
}

/// First line and length of every function that has a body, by counting braces.
fn functions(lines: &[String]) -> Vec<(usize, usize)> {
    let is_start = |l: &str| {
        let l = l.trim_start();
        (l.starts_with("fn ") || l.contains(" fn ")) && l.contains('(') || l.ends_with("fn")
    };
    let mut found = Vec::new();
    for (first, _) in lines.iter().enumerate().filter(|(_, l)| is_start(l)) {
        let mut depth = 0_i64;
        let mut opened = false;
        'body: for (offset, line) in lines[first..].iter().enumerate() {
            for c in line.chars() {
                match c {
                    '{' => (depth, opened) = (depth + 1, true),
                    '}' => depth -= 1,
                    ';' if !opened && depth == 0 && !line.contains('[') => break 'body,
                    _ => {}
                }
                if opened && depth == 0 {
                    found.push((first + 1, offset + 1));
                    break 'body;
                }
            }
        }
    }
    found
}

/// The files that git tracks; all files of a packaged crate, which has no git.
fn tracked() -> Vec<PathBuf> {
    let listed = Command::new("git").args(["ls-files", "-z"]).current_dir(root()).output();
    match listed {
        Ok(output) if output.status.success() => String::from_utf8(output.stdout)
            .unwrap()
            .split_terminator('\0')
            .map(|f| root().join(f))
            .filter(|f| f.is_file())
            .collect(),
        _ => Vec::new(),
    }
}

#[test]
fn law_nothing_tracked_names_a_machine() {
    // Written in two parts, so that this file does not find itself.
    let words = ["/wor|k/", "/ho|me/", "/Use|rs/", "/ro|ot/", "C|:\\", "/tm|p/bash"].map(|w| w.replace('|', ""));
    let mut wrong = Vec::new();
    for file in tracked() {
        let Ok(text) = fs::read_to_string(&file) else { continue };
        for (i, line) in text.lines().enumerate() {
            if let Some(word) = words.iter().find(|w| line.contains(w.as_str())) {
                wrong.push(format!("{}:{}: {word}", file.display(), i + 1));
            }
        }
    }
    assert_none("paths of one machine", wrong);
}

#[test]
fn law_addresses_are_public_ones() {
    const KNOWN: &[&str] = &[
        "127.0.0.1",
        "localhost",
        "crates.io",
        "creativecommons.org",
        "doc.rust-lang.org",
        "docs.rs",
        "doi.org",
        "eclipse.dev",
        "github.com",
        "json-schema.org",
        "keepachangelog.com",
        "pypi.org",
        "rustup.rs",
        "semver.org",
        "sh.rustup.rs",
        "sumo.dlr.de",
        "www.apache.org",
        "www.rust-lang.org",
        "www.w3.org",
        "arxiv.org",
        "hal.science",
        "www.epa.gov",
    ];
    let mut wrong = Vec::new();
    for file in tracked().into_iter().filter(|f| f.file_name().is_some_and(|n| n != "Cargo.lock")) {
        let Ok(text) = fs::read_to_string(&file) else { continue };
        for (i, line) in text.lines().enumerate() {
            for tail in line.split("://").skip(1) {
                let host: String = tail.chars().take_while(|c| c.is_alphanumeric() || "-.".contains(*c)).collect();
                let host = host.trim_end_matches('.');
                if host.contains('.') && !KNOWN.contains(&host) {
                    wrong.push(format!("{}:{}: {host}", file.display(), i + 1));
                }
            }
        }
    }
    assert_none("addresses that are not known here", wrong);
}

#[test]
fn law_the_lock_file_and_the_licences_are_committed() {
    let tracked = tracked();
    if tracked.is_empty() {
        return;
    }
    for name in ["Cargo.lock", "LICENSE-MIT", "LICENSE-APACHE", "CHANGELOG.md", "README.md"] {
        assert!(tracked.contains(&root().join(name)), "{name} is not tracked");
    }
}

/// Every module of src/lib.rs has a layer here, and every module here that exists is in the table of src/lib.rs.
#[test]
fn law_the_layers_are_those_of_lib_rs() {
    let lib = fs::read_to_string(root().join("src/lib.rs")).unwrap();
    let table: BTreeSet<&str> = lib
        .lines()
        .filter(|l| l.starts_with("//!"))
        .flat_map(|l| l.split(|c: char| !c.is_alphanumeric() && c != '_'))
        .collect();
    let known: Vec<&str> = LAYERS.iter().map(|(module, _)| *module).chain(COMMON_GROUND.iter().copied()).collect();
    let modules: BTreeSet<String> = sources().iter().map(|s| s.module().to_owned()).filter(|r| r != "lib").collect();
    let wrong = modules.iter().filter(|r| !known.contains(&r.as_str()) || !table.contains(r.as_str()) && *r != "cli");
    assert_none("modules that are not in the table of src/lib.rs or in tests/tidy.rs", wrong.cloned());
}

/// The names that registries in `source` offer.
fn registered(source: &str) -> Vec<String> {
    let entry = regex::Regex::new(r#"\bEntry\s*\{\s*name:\s*"([^"]+)""#).unwrap();
    entry.captures_iter(source).map(|c| c[1].to_owned()).collect()
}

#[test]
fn law_every_choice_is_documented() {
    let mut pages = fs::read_to_string(root().join("README.md")).unwrap();
    for page in fs::read_dir(root().join("docs")).unwrap().map(|e| e.unwrap().path()) {
        if page.extension().is_some_and(|e| e == "md") {
            pages += &fs::read_to_string(page).unwrap();
        }
    }
    let mut files = Vec::new();
    rust_files(&root().join("src"), &mut files);
    let names = files.iter().flat_map(|file| {
        let text = fs::read_to_string(file).unwrap();
        registered(text.split("#[cfg(test)]").next().unwrap())
    });
    let missing: BTreeSet<String> = names.filter(|n| !contains_word(&pages, n)).collect();
    assert_none("registered, but neither in README.md nor in docs/", missing);
}

/// The checks above find what they are for.
#[test]
fn the_parser_finds_what_it_looks_for() {
    let text =
        "use crate::{keys::Key, traci::{A, B}};\nlet a = \"crate::fleet\"; // crate::run\nuse crate::plant::x;\n";
    let lines: Vec<String> = without_text(text).lines().map(str::to_owned).collect();
    let found: Vec<(usize, String)> = imports(&lines);
    let expected = [(1, "keys"), (1, "traci"), (3, "plant")].map(|(l, n)| (l, n.to_owned()));
    assert_eq!(found, expected);

    let text = "fn a() {\n    b('{', \"}\", '\\'', r#\"{\"#);\n}\n\nfn c(x: [u8; 3])\nwhere\n    X: Y,\n{\n    if x { y }\n}\nfn d();\n";
    let lines: Vec<String> = without_text(text).lines().map(str::to_owned).collect();
    assert_eq!(functions(&lines), [(1, 3), (5, 6)]);

    let text = "static A: &[Entry<B>] = &[Entry { name: \"one\" }, Entry {\n    name: \"two\",\n}];";
    assert_eq!(registered(text), ["one", "two"]);

    assert!(contains_word("let t = Instant::now();", "Instant"));
    assert!(contains_word("use std::fs;", "std::fs"));
    assert!(!contains_word("let t = Instantly::now();", "Instant"));
    assert!(!contains_word("prefs::get()", "fs::"));
    assert!(contains_word("fs::read()", "fs::"));
}
