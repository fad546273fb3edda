//! What can be chosen by name (controllers, plants, targets, ...): one list per kind, from which `list`, help texts,
//! error messages and the contract tests come.

use crate::keys::Key;

/// One choice: its name, one line about it, the keys that it takes and how to build it.
pub struct Entry<B: 'static> {
    /// The name used in scenario files and on the command line.
    pub name: &'static str,
    /// One line for `sumo-mfc list`.
    pub summary: &'static str,
    /// The configuration keys that this choice understands.
    pub keys: &'static [Key],
    /// The constructor.
    pub build: B,
}

/// A name that no registry entry has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown {kind} \"{name}\"{}; known: {}", suggest(.suggestion), .known.join(", "))]
pub struct UnknownName {
    /// What was looked for, e.g. "controller".
    pub kind: &'static str,
    /// What was found.
    pub name: String,
    /// The nearest known name, if one is near.
    pub suggestion: Option<String>,
    /// All known names.
    pub known: Vec<String>,
}

fn suggest(suggestion: &Option<String>) -> String {
    suggestion.as_ref().map(|s| format!(" (did you mean \"{s}\"?)")).unwrap_or_default()
}

/// The entry called `name`.
///
/// # Errors
/// [`UnknownName`] with the nearest name and all known ones.
pub fn find<B>(kind: &'static str, entries: &'static [Entry<B>], name: &str) -> Result<&'static Entry<B>, UnknownName> {
    entries.iter().find(|e| e.name == name).ok_or_else(|| UnknownName {
        kind,
        name: name.to_owned(),
        suggestion: nearest(name, entries.iter().map(|e| e.name)).map(str::to_owned),
        known: entries.iter().map(|e| e.name.to_owned()).collect(),
    })
}

/// The candidate nearest to `name`, if it is near enough to be what was meant.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    candidates
        .into_iter()
        .map(|c| (strsim::damerau_levenshtein(&name.to_lowercase(), &c.to_lowercase()), c))
        .filter(|(d, c)| *d <= (c.len().max(name.len()) / 3).max(1))
        .min_by_key(|(d, _)| *d)
        .map(|(_, c)| c)
}
