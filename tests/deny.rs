//! `deny.toml` against Cargo.lock: licences, bans and sources, as cargo-deny checks them.

use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use toml_edit::{DocumentMut, Item};

fn rules() -> DocumentMut {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("deny.toml");
    std::fs::read_to_string(path).unwrap().parse().unwrap()
}

/// All packages that any feature and any platform can pull in. Cargo fetches those that this platform does not build.
fn packages() -> Vec<Value> {
    let arguments = ["metadata", "--format-version", "1", "--all-features", "--locked"];
    let output = Command::new(env!("CARGO")).args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

fn text<'a>(package: &'a Value, field: &str) -> &'a str {
    package[field].as_str().unwrap_or_default()
}

fn texts(list: &Item) -> BTreeSet<String> {
    list.as_array().unwrap().iter().map(|entry| entry.as_str().unwrap().to_owned()).collect()
}

/// True if an SPDX expression can be met with the allowed licences. AND binds closer than OR; `/` is an old OR.
fn is_met(expression: &str, allowed: &BTreeSet<String>) -> bool {
    let spaced = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
    let mut words: Vec<&str> = spaced.split_whitespace().rev().collect();
    let met = any_of(&mut words, allowed);
    met && words.is_empty()
}

fn any_of(words: &mut Vec<&str>, allowed: &BTreeSet<String>) -> bool {
    let mut met = all_of(words, allowed);
    while words.pop_if(|word| *word == "OR").is_some() {
        met |= all_of(words, allowed);
    }
    met
}

fn all_of(words: &mut Vec<&str>, allowed: &BTreeSet<String>) -> bool {
    let mut met = one(words, allowed);
    while words.pop_if(|word| *word == "AND").is_some() {
        met &= one(words, allowed);
    }
    met
}

fn one(words: &mut Vec<&str>, allowed: &BTreeSet<String>) -> bool {
    match words.pop() {
        Some("(") => {
            let met = any_of(words, allowed);
            met && words.pop() == Some(")")
        }
        Some(licence) => match words.pop_if(|word| *word == "WITH") {
            Some(_) => allowed.contains(&format!("{licence} WITH {}", words.pop().unwrap_or_default())),
            None => allowed.contains(licence),
        },
        None => false,
    }
}

#[test]
fn law_expressions_are_read_as_spdx_says() {
    let allowed = BTreeSet::from(["MIT", "Zlib", "Apache-2.0 WITH LLVM-exception"].map(String::from));
    for met in
        ["MIT", "MIT/GPL-3.0", "GPL-3.0 OR MIT AND Zlib", "(GPL-3.0 OR MIT) AND Zlib", "Apache-2.0 WITH LLVM-exception"]
    {
        assert!(is_met(met, &allowed), "{met}");
    }
    for unmet in
        ["", "GPL-3.0", "MIT AND GPL-3.0", "(GPL-3.0 OR MIT) AND BSD-3-Clause", "Apache-2.0", "MIT MIT", "(MIT"]
    {
        assert!(!is_met(unmet, &allowed), "{unmet}");
    }
}

#[test]
fn every_licence_is_allowed() {
    let rules = rules();
    let allowed = texts(&rules["licenses"]["allow"]);
    let exceptions = rules["licenses"]["exceptions"].as_array().unwrap();
    let mut refused = Vec::new();
    for package in packages() {
        let name = text(&package, "name");
        let its = exceptions.iter().map(|entry| entry.as_inline_table().unwrap());
        let its = its.filter(|entry| entry["crate"].as_str() == Some(name));
        let more = its.flat_map(|entry| entry["allow"].as_array().unwrap().iter());
        let allowed = allowed.iter().cloned().chain(more.map(|entry| entry.as_str().unwrap().to_owned())).collect();
        if !is_met(text(&package, "license"), &allowed) {
            refused.push(format!("{name}: \"{}\"", text(&package, "license")));
        }
    }
    assert!(refused.is_empty(), "not allowed by deny.toml: {refused:#?}");
}

#[test]
fn nothing_banned_and_no_foreign_source_is_in_the_lock_file() {
    let rules = rules();
    let banned = rules["bans"]["deny"].as_array().unwrap().iter();
    let banned: BTreeSet<&str> =
        banned.map(|entry| entry.as_inline_table().unwrap()["crate"].as_str().unwrap()).collect();
    let registries: BTreeSet<String> =
        texts(&rules["sources"]["allow-registry"]).iter().map(|url| format!("registry+{url}")).collect();
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
    for package in packages() {
        let name = text(&package, "name");
        assert!(!banned.contains(name), "{name} is banned by deny.toml");
        let is_ours = Path::new(text(&package, "manifest_path")) == own;
        assert!(is_ours || registries.contains(text(&package, "source")), "{name} is from {}", package["source"]);
        for dependency in package["dependencies"].as_array().unwrap().iter().filter(|_| is_ours) {
            assert_ne!(text(dependency, "req"), "*", "{}: any version", dependency["name"]);
        }
    }
}
