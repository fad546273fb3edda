//! The lines of a Containerfile, as far as ours uses them.

use std::{fs, path::Path};

/// What a line does.
pub enum Step {
    /// A line for the shell.
    Run(String),
    /// A variable of the environment, from there on.
    Env(String, String),
    /// An archive, by a pattern of its name, and the folder into which it is unpacked.
    Add(String, String),
    /// The working directory, made if it is not there.
    WorkDir(String),
}

pub struct Recipe {
    /// The release of Debian that it begins with.
    pub suite: String,
    /// What follows, in order.
    pub steps: Vec<Step>,
    /// What the container runs.
    pub entry: Vec<String>,
}

impl Recipe {
    /// Reads a Containerfile. A line that is not known here fails, so that nothing of the recipe stays untested.
    pub fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap().replace("\\\n", " ");
        let mut recipe = Self { suite: String::new(), steps: Vec::new(), entry: Vec::new() };
        for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
            let (word, rest) = line.split_once(' ').unwrap_or_else(|| panic!("{line}"));
            let pair = |by: char| rest.split_once(by).map(|(a, b)| (a.to_owned(), b.to_owned())).unwrap();
            match word {
                "FROM" => recipe.suite = image(rest),
                "RUN" => recipe.steps.push(Step::Run(rest.to_owned())),
                "ENV" => recipe.steps.push(Step::Env(pair('=').0, pair('=').1)),
                "ADD" => recipe.steps.push(Step::Add(pair(' ').0, pair(' ').1)),
                "WORKDIR" => recipe.steps.push(Step::WorkDir(rest.to_owned())),
                "ENTRYPOINT" => recipe.entry = serde_json::from_str(rest).unwrap(),
                _ => panic!("{word}: no instruction that this test can follow"),
            }
        }
        recipe
    }
}

/// `bookworm` of `debian:bookworm-slim`.
fn image(name: &str) -> String {
    let suite = name.strip_prefix("debian:").and_then(|tag| tag.strip_suffix("-slim"));
    suite.unwrap_or_else(|| panic!("{name}: not Debian")).to_owned()
}

/// Whether a pattern with one star is that of a file's name.
pub fn matches(pattern: &str, file: &Path) -> bool {
    let name = file.file_name().unwrap().to_str().unwrap();
    let (before, after) = pattern.split_once('*').expect("a star");
    name.starts_with(before) && name.ends_with(after) && name.len() >= before.len() + after.len()
}
