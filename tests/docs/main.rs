//! The documentation is held to what is there: links and headings, command lines, scenario files, names of tests, the page of
//! keys; and the pages that are followed word for word, on real SUMO.

mod code;
mod command_line;
mod files;
mod follow;
mod keys;
mod links;
mod page;
#[path = "../live/support.rs"]
#[allow(dead_code, reason = "the other tests against SUMO use the rest")]
mod support;

/// Fails with what is wrong, one line each.
fn assert_none(what: &str, wrong: impl IntoIterator<Item = String>) {
    let wrong: Vec<String> = wrong.into_iter().collect();
    assert!(wrong.is_empty(), "{what}:\n{}", wrong.join("\n"));
}

/// Holds a page to what it is made of; `UPDATE=1` writes it anew.
fn assert_up_to_date(path: &str, page: &str, tests: &str) {
    let file = support::repository(path);
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(&file, page).unwrap();
    }
    let written = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(written == page, "{path} is not up to date: UPDATE=1 cargo test --test docs {tests}");
}
