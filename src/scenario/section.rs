//! A section held against its table of keys.

use std::path::{Path, PathBuf};

use super::{
    document::{Entry, Node, Table},
    error::ScenarioError,
    spread::{Distribution, PerVehicle},
};
use crate::{
    keys::{Key, Kind, Value, Values},
    registry::nearest,
    sumo_files::{absolute, environment},
};

/// What a section takes.
pub(crate) struct Section<'a> {
    /// The path for messages, e.g. "group.0.controller".
    pub path: &'a str,
    /// Its keys.
    pub keys: &'a [Key],
    /// Names that somebody else reads.
    pub others: &'a [&'a str],
    /// Whether its numbers may be distributions.
    pub spread: bool,
}

impl Section<'_> {
    /// Checks every entry of `table`; what is not there gets its default.
    pub fn check(&self, table: &Table) -> Result<PerVehicle, ScenarioError> {
        let names: Vec<&str> = self.others.iter().copied().chain(self.keys.iter().map(|k| k.name)).collect();
        known(self.path, table, &names)?;
        let mut checked = PerVehicle { values: Values::defaults(self.keys), spread: Vec::new() };
        for key in self.keys {
            let Some(entry) = table.get(key.name) else { continue };
            let path = format!("{}.{}", self.path, key.name);
            match (&entry.node, key.kind) {
                (Node::Table(inner), Kind::Number { min, max, .. }) if self.spread => {
                    checked.values.0.remove(key.name);
                    checked.spread.push((key.name, Distribution::read(&path, inner, entry, (min, max))?));
                }
                _ => {
                    let value = value(key, entry, &path, self.spread)?;
                    checked.values.0.insert(key.name, value);
                }
            }
        }
        Ok(checked)
    }
}

/// Refuses entries that are not called one of `names`.
pub(crate) fn known(path: &str, table: &Table, names: &[&str]) -> Result<(), ScenarioError> {
    let full = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match table.iter().find(|(key, _)| !names.contains(&key.as_str())) {
        None => Ok(()),
        Some((key, entry)) => Err(ScenarioError::UnknownKey {
            place: entry.place.clone(),
            key: full(key),
            suggestion: nearest(key, names.iter().copied()).map(full),
            known: names.iter().map(|n| (*n).to_owned()).collect(),
        }),
    }
}

/// The value of `key`, if it is one that the key takes.
fn value(key: &Key, entry: &Entry, path: &str, spread: bool) -> Result<Value, ScenarioError> {
    let value = match (&entry.node, key.kind) {
        (Node::Number(x), Kind::Number { min, max, .. }) if (min..=max).contains(x) => Some(Value::Number(*x)),
        (Node::Integer(x), Kind::Number { min, max, .. }) if (min..=max).contains(&(*x as f64)) => {
            Some(Value::Number(*x as f64))
        }
        (Node::Integer(x), Kind::Integer { min, max }) if (min..=max).contains(x) => Some(Value::Integer(*x)),
        (Node::Flag(x), Kind::Flag) => Some(Value::Flag(*x)),
        (Node::Text(x), Kind::Choice(words)) if words.contains(&x.as_str()) => Some(Value::Text(x.clone())),
        (Node::Text(x), Kind::Text) => Some(Value::Text(x.clone())),
        (Node::List(_) | Node::Text(_), Kind::Texts) => Some(Value::Texts(texts(entry, path)?)),
        (Node::List(_) | Node::Text(_), Kind::Files) => {
            let file = |name: &String| existing(entry, path, name).map(|file| file.to_string_lossy().into_owned());
            Some(Value::Texts(texts(entry, path)?.iter().map(file).collect::<Result<_, _>>()?))
        }
        (Node::Text(x), Kind::File) => Some(Value::Text(existing(entry, path, x)?.to_string_lossy().into_owned())),
        _ => None,
    };
    value.ok_or_else(|| {
        let mut wanted = wanted(key.kind);
        if let (Kind::Choice(words), Node::Text(found)) = (key.kind, &entry.node)
            && let Some(near) = nearest(found, words.iter().copied())
        {
            wanted.push_str(&format!("; did you mean \"{near}\"?"));
        }
        if spread && matches!(key.kind, Kind::Number { .. }) {
            wanted.push_str(" or a distribution");
        }
        ScenarioError::WrongValue {
            place: entry.place.clone(),
            key: path.to_owned(),
            found: entry.node.shown(),
            wanted,
        }
    })
}

/// What a kind takes, in words.
pub(crate) fn wanted(kind: Kind) -> String {
    match kind {
        Kind::Number { unit: "-", min, max } => format!("a number{}", range(min, max)),
        Kind::Number { unit, min, max } => format!("a number in {unit}{}", range(min, max)),
        Kind::Integer { min, max } => format!("a whole number from {min} to {max}"),
        Kind::Flag => "true or false".to_owned(),
        Kind::Choice(words) => words.iter().map(|w| format!("\"{w}\"")).collect::<Vec<_>>().join(" or "),
        Kind::Text => "a text".to_owned(),
        Kind::File => "a file name".to_owned(),
        Kind::Texts | Kind::Files => "list of texts".to_owned(),
    }
}

pub(super) fn range(min: f64, max: f64) -> String {
    // The bounds of a type stand for "no bound".
    match (min > f64::MIN, max < f64::MAX) {
        (true, true) => format!(" from {} to {}", short(min), short(max)),
        (true, false) => format!(" from {}", short(min)),
        (false, true) => format!(" up to {}", short(max)),
        (false, false) => String::new(),
    }
}

/// A number without a train of zeros.
pub(crate) fn short(x: f64) -> String {
    if x != 0.0 && !(1e-4..1e7).contains(&x.abs()) { format!("{x:e}") } else { format!("{x}") }
}

/// A text, if the entry is one.
pub(crate) fn text<'a>(entry: &'a Entry, path: &str) -> Result<&'a str, ScenarioError> {
    match &entry.node {
        Node::Text(text) => Ok(text),
        other => Err(ScenarioError::WrongValue {
            place: entry.place.clone(),
            key: path.to_owned(),
            found: other.shown(),
            wanted: wanted(Kind::Text),
        }),
    }
}

/// A list of texts; a single text is a list of one.
pub(crate) fn texts(entry: &Entry, path: &str) -> Result<Vec<String>, ScenarioError> {
    match &entry.node {
        Node::List(list) => list.iter().map(|e| text(e, path).map(str::to_owned)).collect(),
        _ => text(entry, path).map(|t| vec![t.to_owned()]),
    }
}

/// The absolute path of a file that is named in `entry` and must be there.
pub(crate) fn existing(entry: &Entry, path: &str, name: &str) -> Result<PathBuf, ScenarioError> {
    let file = absolute(&entry.place.origin.folder, Path::new(&environment(name)));
    if file.is_file() {
        return Ok(file);
    }
    Err(ScenarioError::MissingFile { place: entry.place.clone(), key: path.to_owned(), path: file })
}
