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
