//! Links lead to files and headings that exist, and every page is in the table of contents.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use crate::assert_none;
use crate::page::{Page, book, pages};
use crate::support::repository;

/// A path without `.` and `..`; `None` if it leaves the repository.
fn tidied(path: &Path) -> Option<PathBuf> {
    let mut tidied = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => tidied.pop().then_some(())?,
            Component::Normal(name) => tidied.push(name),
            _ => {}
        }
    }
    Some(tidied)
}

/// What is wrong with a link of a page.
fn wrong_link(page: &Page, link: &str, anchors: &BTreeMap<String, Vec<String>>) -> Option<String> {
    if link.contains("://") || link.starts_with("mailto:") {
        return None;
    }
    let (file, heading) = link.split_once('#').map_or((link, None), |(file, heading)| (file, Some(heading)));
    let folder = Path::new(&page.path).parent().unwrap();
    let target = if file.is_empty() {
        page.path.clone()
    } else {
        let Some(target) = tidied(&folder.join(file)) else { return Some("leads out of the repository".to_owned()) };
        target.to_str().unwrap().replace('\\', "/")
    };
    if !repository(&target).exists() {
        return Some(format!("leads to {target}, which does not exist"));
    }
    // The book has no page of what lies outside; mdBook would link a page that it does not make.
    if page.path.starts_with("docs/") && target.ends_with(".md") && !target.starts_with("docs/") {
        return Some("leads from the book to a page that is not in it".to_owned());
    }
    let heading = heading?;
    let known = anchors.get(&target).is_some_and(|anchors| anchors.iter().any(|anchor| anchor == heading));
    (!known).then(|| format!("names a heading that {target} does not have"))
}

#[test]
fn law_every_link_leads_somewhere() {
    let pages = pages();
    let anchors = pages.iter().map(|page| (page.path.clone(), page.anchors.clone())).collect();
    let links = pages.iter().flat_map(|page| page.links.iter().map(move |link| (page, link)));
    let wrong = links.filter_map(|(page, link)| Some(link.wrong(wrong_link(page, &link.text, &anchors)?)));
    assert_none("links", wrong);
}

#[test]
fn law_every_page_is_in_the_table_of_contents() {
    let contents = Page::read("docs/SUMMARY.md");
    let listed: BTreeSet<String> = contents.links.iter().map(|link| format!("docs/{}", link.text)).collect();
    let missing = book().into_iter().filter(|path| path != "docs/SUMMARY.md" && !listed.contains(path));
    assert_none("pages that are not in docs/SUMMARY.md", missing);
    assert_eq!(listed.len(), contents.links.len(), "a page stands twice in docs/SUMMARY.md");
}
