//! Which file of src/ uses which other one, and the circles among them.
//!
//! A name belongs to the file that defines it: a `use` of a re-export is followed to its origin. A parent that only
//! declares or re-exports its children does not use them; one that names a child's item in its own code does.

use crate::Source;
use regex::Regex;
use std::collections::{BTreeMap, BTreeSet};

/// One name that a `use` brings into a file.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Import {
    /// The path as written: `["super", "table", "Cell"]`.
    path: Vec<String>,
    /// The name in this file; `*` for a glob.
    name: String,
    /// True if other files can take the name from here.
    public: bool,
}

/// What one file says about others.
struct Module {
    /// Below src/, parts divided by `/`; empty for lib.rs.
    parts: Vec<String>,
    imports: Vec<Import>,
    /// The text without `use` and `mod` items.
    code: String,
}

/// The files of src/ with their imports.
pub struct Imports(BTreeMap<Vec<String>, Module>);

/// `from` uses `name`, which `to` defines.
pub type Arrows = BTreeMap<(String, String), BTreeSet<String>>;

impl Imports {
    /// Reads the imports of all files.
    pub fn of(sources: &[Source]) -> Self {
        let modules = sources.iter().filter(|s| s.name != "main" && s.name != "cli").map(|source| {
            let parts = match source.name.as_str() {
                "lib" => Vec::new(),
                name => name.split('/').map(str::to_owned).collect(),
            };
            let (imports, code) = split(&source.lines.join("\n"));
            (parts.clone(), Module { parts, imports, code })
        });
        Self(modules.collect())
    }

    /// Who uses whom, and for which names.
    pub fn arrows(&self) -> Arrows {
        let mut arrows = Arrows::new();
        let inline = Regex::new(r"\b(?:(?:crate|super|self)(?:::\w+)+|[a-z_]\w*(?:::\w+)+)").unwrap();
        for module in self.0.values() {
            let is_used = |name: &str| Regex::new(&format!(r"\b{name}\b")).unwrap().is_match(&module.code);
            let imported = module.imports.iter().filter(|i| !i.public || is_used(&i.name)).map(|i| i.path.clone());
            let named = inline.find_iter(&module.code).map(|m| m.as_str().split("::").map(str::to_owned).collect());
            for path in imported.chain(named) {
                if let Some((file, name)) = self.origin(&module.parts, &path, 0)
                    && file != module.parts
                {
                    arrows.entry((module.parts.join("/"), file.join("/"))).or_default().insert(name);
                }
            }
        }
        arrows
    }

    /// The file that defines what `path` names in the file `from`, and the name; `None` if it is not in this crate.
    fn origin(&self, from: &[String], path: &[String], depth: usize) -> Option<(Vec<String>, String)> {
        let mut place = from.to_vec();
        let mut rest = path;
        match path.first()?.as_str() {
            "crate" => (place, rest) = (Vec::new(), &path[1..]),
            "self" => rest = &path[1..],
            "super" => {}
            first if self.is_file(from, first) => {}
            _ => return None,
        }
        while let Some((first, tail)) = rest.split_first() {
            if first == "super" {
                place.pop();
            } else if self.is_file(&place, first) {
                place.push(first.clone());
            } else {
                return Some(self.follow(&place, first, depth).unwrap_or_else(|| (place.clone(), first.clone())));
            }
            rest = tail;
        }
        let name = place.last().cloned().unwrap_or_default();
        Some((place, name))
    }

    /// Where a name that `place` only hands on comes from.
    fn follow(&self, place: &[String], name: &str, depth: usize) -> Option<(Vec<String>, String)> {
        let module = self.0.get(place)?;
        let import = module.imports.iter().find(|i| i.name == name);
        let globs = module.imports.iter().filter(|i| i.name == "*");
        let found = import.into_iter().chain(globs).filter(|_| depth < 8);
        found.into_iter().find_map(|i| {
            let mut path = i.path.clone();
            if i.name == "*" {
                path.push(name.to_owned());
            }
            self.origin(place, &path, depth + 1)
        })
    }

    fn is_file(&self, place: &[String], name: &str) -> bool {
        let mut parts = place.to_vec();
        parts.push(name.to_owned());
        self.0.contains_key(&parts)
    }
}

/// Groups of files that use each other in a loop, each with the arrows that tie it.
pub fn circles(arrows: &Arrows) -> Vec<String> {
    let mut next: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (from, to) in arrows.keys() {
        next.entry(from).or_default().insert(to);
    }
    let reached: BTreeMap<&str, BTreeSet<&str>> = next.keys().map(|file| (*file, reach(&next, file))).collect();
    let returns = |from: &str, to: &str| reached.get(to).is_some_and(|there| there.contains(from));
    arrows
        .iter()
        .filter(|((from, to), _)| returns(from, to))
        .map(|((from, to), names)| {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            format!("src/{from}.rs -> src/{to}.rs: {}", names.join(", "))
        })
        .collect()
}

/// All files that `start` uses, straight or through others.
fn reach<'a>(next: &BTreeMap<&'a str, BTreeSet<&'a str>>, start: &str) -> BTreeSet<&'a str> {
    let mut seen: BTreeSet<&str> = BTreeSet::new();
    let mut open: Vec<&str> = next[start].iter().copied().collect();
    while let Some(file) = open.pop() {
        if seen.insert(file) {
            open.extend(next.get(file).into_iter().flatten());
        }
    }
    seen
}

/// The imports of a text, and the text without its `use` and `mod` items.
fn split(text: &str) -> (Vec<Import>, String) {
    let item = Regex::new(r"(?m)^[ \t]*(?:#\[[^\]]*\]\s*)*(pub(?:\([^)]*\))?\s+)?(use\s+([^;]+)|mod\s+\w+);").unwrap();
    let mut imports = Vec::new();
    for found in item.captures_iter(text) {
        if let Some(tree) = found.get(3) {
            expand(&[], tree.as_str(), found.get(1).is_some(), &mut imports);
        }
    }
    (imports, item.replace_all(text, "").into_owned())
}

/// Writes out a use tree: `a::{b, c as d}` gives a::b under b and a::c under d.
fn expand(prefix: &[String], tree: &str, public: bool, found: &mut Vec<Import>) {
    let tree = tree.trim();
    if let Some(open) = tree.find('{') {
        let mut path = prefix.to_vec();
        path.extend(tree[..open].split("::").map(str::trim).filter(|p| !p.is_empty()).map(str::to_owned));
        let inner = tree[open + 1..].strip_suffix('}').unwrap_or_default();
        let (mut depth, mut start) = (0, 0);
        for (at, c) in inner.char_indices().chain([(inner.len(), ',')]) {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 || at == inner.len() => {
                    expand(&path, &inner[start..at], public, found);
                    start = at + 1;
                }
                _ => {}
            }
        }
        return;
    }
    let (written, alias) = tree.split_once(" as ").map_or((tree, None), |(path, name)| (path, Some(name.trim())));
    let mut path = prefix.to_vec();
    path.extend(written.split("::").map(str::trim).filter(|p| !p.is_empty() && *p != "*").map(str::to_owned));
    if path.last().is_some_and(|p| p == "self") && path.len() > 1 {
        path.pop();
    }
    let glob = written.trim_end().ends_with('*');
    let last = if glob { "*" } else { path.last().map_or("", String::as_str) };
    let name = alias.unwrap_or(last).to_owned();
    if !written.trim().is_empty() {
        found.push(Import { path, name, public });
    }
}

#[test]
fn imports_are_written_out_and_followed_to_their_origin() {
    let source = |name: &str, text: &str| Source {
        name: name.to_owned(),
        lines: text.lines().map(str::to_owned).collect(),
        length: 0,
    };
    let sources = [
        source("lib", "pub mod a;\npub mod b;"),
        source("a", "mod one;\nmod two;\npub use one::{One, Other as Another};\nfn door() { two::deep(); }"),
        source("a/one", "use super::two::{self, deep};\npub struct One;"),
        source("a/two", "pub fn deep() { let _ = super::One; }"),
        source("b", "use crate::{\n    a::{Another, One},\n    b,\n};\nuse std::fmt;"),
    ];
    let arrows = Imports::of(&sources).arrows();
    let shown: Vec<String> = arrows
        .iter()
        .map(|((from, to), names)| format!("{from}>{to}:{}", names.iter().cloned().collect::<Vec<_>>().join(",")))
        .collect();
    assert_eq!(shown, ["a>a/two:deep", "a/one>a/two:deep,two", "a/two>a/one:One", "b>a/one:One,Other"]);
    assert_eq!(circles(&arrows), ["src/a/one.rs -> src/a/two.rs: deep, two", "src/a/two.rs -> src/a/one.rs: One"]);
}
