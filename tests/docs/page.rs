//! A page of Markdown: its headings, links and pieces of code, each with its line.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};

use crate::support::repository;

/// Something of a page.
pub struct Found {
    /// The page, relative to the repository.
    pub page: String,
    /// Its line, counted from 1.
    pub line: usize,
    /// What stands there.
    pub text: String,
}

impl Found {
    /// `page:line: text`, and what is wrong with it.
    pub fn wrong(&self, what: impl std::fmt::Display) -> String {
        format!("{}:{}: {} {what}", self.page, self.line, self.text.trim())
    }
}

/// A block of code.
pub struct Block {
    /// The words behind the fence: the language, and for a file its name.
    pub info: Vec<String>,
    /// Where it is, and what it holds.
    pub found: Found,
}

impl Block {
    /// The language.
    pub fn language(&self) -> &str {
        self.info.first().map_or("", String::as_str)
    }
}

/// One page.
pub struct Page {
    /// Relative to the repository, with `/`.
    pub path: String,
    /// The anchors of its headings.
    pub anchors: Vec<String>,
    /// Targets of links and pictures.
    pub links: Vec<Found>,
    /// Blocks of code.
    pub blocks: Vec<Block>,
    /// Code within lines.
    pub inline: Vec<Found>,
}

/// The anchor of a heading, as GitHub and mdBook make it: small letters, no punctuation, hyphens for blanks.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect::<String>().to_lowercase()
}

impl Page {
    /// Reads a page.
    pub fn read(path: &str) -> Self {
        let text = fs::read_to_string(repository(path)).unwrap_or_else(|error| panic!("{path}: {error}"));
        Self::parse(path, &text)
    }

    /// Takes a text apart.
    pub fn parse(path: &str, text: &str) -> Self {
        let mut page = Self { path: path.to_owned(), anchors: vec![], links: vec![], blocks: vec![], inline: vec![] };
        let (mut heading, mut same) = (None::<String>, BTreeMap::<String, usize>::new());
        let mut block = None::<Block>;
        for (event, range) in Parser::new_ext(text, Options::ENABLE_TABLES).into_offset_iter() {
            let line = 1 + text[..range.start].matches('\n').count();
            let found = |text: &str| Found { page: path.to_owned(), line, text: text.to_owned() };
            match event {
                Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
                Event::End(TagEnd::Heading(_)) => {
                    let name = anchor(&heading.take().unwrap_or_default());
                    let count = same.entry(name.clone()).or_default();
                    page.anchors.push(if *count == 0 { name } else { format!("{name}-{count}") });
                    *count += 1;
                }
                Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                    page.links.push(found(&dest_url));
                }
                Event::Start(Tag::CodeBlock(kind)) => {
                    let CodeBlockKind::Fenced(info) = kind else { continue };
                    let info = info.split_whitespace().map(str::to_owned).collect();
                    block = Some(Block { info, found: found("") });
                }
                Event::End(TagEnd::CodeBlock) => page.blocks.extend(block.take()),
                Event::Code(code) => {
                    if let Some(heading) = &mut heading {
                        heading.push_str(&code);
                    }
                    page.inline.push(found(&code));
                }
                Event::Text(text) => {
                    if let Some(block) = &mut block {
                        block.found.text.push_str(&text);
                    } else if let Some(heading) = &mut heading {
                        heading.push_str(&text);
                    }
                }
                _ => {}
            }
        }
        page
    }
}

/// The pages of the book, below `docs/`.
pub fn book() -> Vec<String> {
    fn add(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                add(&path, found);
            } else if path.extension().is_some_and(|e| e == "md") {
                found.push(path);
            }
        }
    }
    let (root, mut found) = (repository(""), Vec::new());
    add(&root.join("docs"), &mut found);
    found.sort();
    found.iter().map(|path| path.strip_prefix(&root).unwrap().to_str().unwrap().replace('\\', "/")).collect()
}

/// All pages: those of the book and those outside.
pub fn pages() -> Vec<Page> {
    let others =
        ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "sumo_nets/README.md", "scenarios/paper/data/README.md"];
    others.iter().map(|path| (*path).to_owned()).chain(book()).map(|path| Page::read(&path)).collect()
}

#[test]
fn a_page_is_taken_apart() {
    let text = "# A `b`, c!\n\n## Same\n\n## Same\n\nSee [x](y.md#z) and `make test`.\n\n```sh\nls\n```\n\n```xml a.xml\n<a/>\n```\n";
    let page = Page::parse("page.md", text);
    assert_eq!(page.anchors, ["a-b-c", "same", "same-1"]);
    assert_eq!((page.links[0].line, page.links[0].text.as_str()), (7, "y.md#z"));
    assert_eq!(page.blocks[0].found.text, "ls\n");
    assert_eq!(page.blocks[1].info, ["xml", "a.xml"]);
    assert!(page.inline.iter().any(|found| found.text == "make test"));
}
