//! Entries that can be chosen by name: controllers, targets, plants, bodies. There is one list per kind. `list`, the help
//! texts, the error messages and the contract tests come from these lists.

use std::fmt;

use crate::keys::Key;

/// What can be chosen: a name, one line about it, the keys that it takes and its constructor.
#[derive(Clone)]
pub struct Entry<B> {
    /// The name used in scenario files and on the command line.
    pub name: &'static str,
    /// One line for `sumo-mfc list`.
    pub summary: &'static str,
    /// The configuration keys that this choice understands.
    pub keys: &'static [Key],
    /// The constructor.
    pub build: B,
}

impl<B> Entry<B> {
    /// The entry without its constructor, so that entries of several kinds fit into one list.
    pub fn described(&self) -> Entry<()> {
        Entry { name: self.name, summary: self.summary, keys: self.keys, build: () }
    }
}

impl<B> fmt::Debug for Entry<B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Entry").field(&self.name).finish()
    }
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

impl UnknownName {
    /// The same where these names are known as well.
    #[must_use]
    pub fn or_known(mut self, names: &[&str]) -> Self {
        self.known.extend(names.iter().map(|name| (*name).to_owned()));
        self.suggestion = nearest(&self.name, self.known.iter().map(String::as_str)).map(str::to_owned);
        self
    }
}

fn suggest(suggestion: &Option<String>) -> String {
    suggestion.as_ref().map(|s| format!(" (did you mean \"{s}\"?)")).unwrap_or_default()
}

/// The entry called `name`.
///
/// # Errors
/// [`UnknownName`] with the nearest name and all known ones.
pub fn find<'a, B>(kind: &'static str, entries: &'a [Entry<B>], name: &str) -> Result<&'a Entry<B>, UnknownName> {
    entries.iter().find(|e| e.name == name).ok_or_else(|| UnknownName {
        kind,
        name: name.to_owned(),
        suggestion: nearest(name, entries.iter().map(|e| e.name)).map(str::to_owned),
        known: entries.iter().map(|e| e.name.to_owned()).collect(),
    })
}

/// An entry that cannot be registered.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RegistrationError {
    /// Two entries of one kind would have the same name.
    #[error("there is a {kind} \"{name}\" already")]
    NameTaken {
        /// What was registered, e.g. "controller".
        kind: &'static str,
        /// Its name.
        name: &'static str,
    },
    /// Two keys of the entry have the same name, or one is called as the key of the section that chooses the entry.
    #[error("the key \"{key}\" of the {kind} \"{name}\" is declared twice, or is reserved")]
    KeyTaken {
        /// What was registered.
        kind: &'static str,
        /// Its name.
        name: &'static str,
        /// The key.
        key: &'static str,
    },
}

/// Adds an entry behind the others.
///
/// # Errors
/// [`RegistrationError`] if its name or one of its keys is taken; the keys called `reserved` are.
pub fn register<B>(
    kind: &'static str,
    entries: &mut Vec<Entry<B>>,
    entry: Entry<B>,
    reserved: &str,
) -> Result<(), RegistrationError> {
    let name = entry.name;
    if entries.iter().any(|e| e.name == name) {
        return Err(RegistrationError::NameTaken { kind, name });
    }
    let taken = |i: usize| {
        let key = entry.keys[i].name;
        key == reserved || entry.keys[..i].iter().any(|other| other.name == key)
    };
    if let Some(i) = (0..entry.keys.len()).find(|i| taken(*i)) {
        return Err(RegistrationError::KeyTaken { kind, name, key: entry.keys[i].name });
    }
    entries.push(entry);
    Ok(())
}

/// The candidate nearest to `name`, if it is near enough to be what was meant.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = name.chars().count();
    let is_near = |distance: usize, c: &str| distance <= (c.len().max(name.len()) / 3).max(1);
    candidates
        .into_iter()
        // At least so many letters differ; a long name would be compared with every candidate for seconds.
        .filter(|c| is_near(length.abs_diff(c.chars().count()), c))
        .map(|c| (strsim::damerau_levenshtein(&name.to_lowercase(), &c.to_lowercase()), c))
        .filter(|(d, c)| is_near(*d, c))
        .min_by_key(|(d, _)| *d)
        .map(|(_, c)| c)
}
