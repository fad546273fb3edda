//! Tables held against their keys. Every mistake is noted, and a key with a mistake counts as not given.

use std::path::Path;

use super::{
    document::{Entry, Node, Table},
    error::{Mistake, ScenarioError, Wrong},
    spread::{Distribution, PerVehicle},
};
use crate::{
    keys::{Key, Keys, Kind, Value, Values},
    registry::{self, find, nearest},
    sumo_files::{absolute, environment},
};

/// The mistakes found so far.
#[derive(Default)]
pub(crate) struct Reader {
    mistakes: Vec<Mistake>,
}

impl Reader {
    /// Notes a mistake, unless it is known: a group repeats what it inherits from the file's own sections.
    pub fn note(&mut self, mistake: Mistake) {
        let last = |key: &str| key.rsplit('.').next().map(str::to_owned);
        if !self.mistakes.iter().any(|m| m.place == mistake.place && last(&m.key) == last(&mistake.key)) {
            self.mistakes.push(mistake);
        }
    }

    /// Whether a mistake was noted for an entry.
    pub fn refused(&self, entry: &Entry) -> bool {
        self.mistakes.iter().any(|m| m.place == entry.place)
    }

    /// `value`, if there is no mistake so far.
    ///
    /// # Errors
    /// All mistakes, in the order of the file.
    pub fn whole<T>(&mut self, value: T) -> Result<T, ScenarioError> {
        self.mistakes.sort_by_key(|m| (m.place.origin.argument, m.place.span.start));
        let mut mistakes = std::mem::take(&mut self.mistakes).into_iter();
        match mistakes.next() {
            None => Ok(value),
            Some(first) => Err(ScenarioError::Mistakes { first: Box::new(first), more: mistakes.collect() }),
        }
    }

    /// The table of a section; nothing is an empty one.
    pub fn section(&mut self, root: &Table, name: &str, path: &str) -> Table {
        match root.get(name) {
            None => Table::new(),
            Some(Entry { node: Node::Table(table), .. }) => table.clone(),
            Some(entry) => {
                self.note(entry.wrong(path, format!("a section [{name}]")));
                Table::new()
            }
        }
    }

    /// Notes entries that are not called one of `names`.
    pub fn known(&mut self, path: &str, table: &Table, names: &[&str]) {
        let full = |key: &str| joined(path, key);
        for (key, entry) in table.iter().filter(|(key, _)| !names.contains(&key.as_str())) {
            let suggestion = nearest(key, names.iter().copied()).map(full);
            let known = names.iter().map(|n| (*n).to_owned()).collect();
            let what = Wrong::UnknownKey { suggestion, known };
            self.note(Mistake { place: entry.place.clone(), key: full(key), what });
        }
    }

    /// The keys of a section that takes no others.
    pub fn keys<K: Keys>(&mut self, path: &str, table: &Table) -> K {
        self.known(path, table, &names(&[], K::keys()));
        K::from_values(&self.values(path, table, K::keys(), false).values)
    }

    /// The values of `keys`; what is not there gets its default. If `drawn`, numbers may be distributions.
    pub fn values(&mut self, path: &str, table: &Table, keys: &[Key], drawn: bool) -> PerVehicle {
        let mut read = PerVehicle { values: Values::defaults(keys), spread: Vec::new() };
        for key in keys {
            let Some(entry) = table.get(key.name) else { continue };
            let path = joined(path, key.name);
            match (&entry.node, key.kind) {
                (Node::Table(inner), Kind::Number { min, max, .. }) if drawn => {
                    read.values.0.remove(key.name);
                    read.spread.extend(self.distribution(&path, inner, entry, (min, max)).map(|d| (key.name, d)));
                }
                _ => {
                    let value = self.noted(value(key, entry, &path, drawn));
                    read.values.0.extend(value.map(|value| (key.name, value)));
                }
            }
        }
        read
    }

    /// The distribution of a key; its values are held to the range of the key.
    fn distribution(&mut self, path: &str, table: &Table, at: &Entry, range: (f64, f64)) -> Option<Distribution> {
        let kind = table.get("distribution").unwrap_or(at);
        let normal = matches!(&kind.node, Node::Text(kind) if kind == "normal");
        if !normal && !matches!(&kind.node, Node::Text(kind) if kind == "uniform") {
            let wanted = "\"normal\" (mean, std, min, max) or \"uniform\" (min, max)";
            self.note(kind.wrong(&format!("{path}.distribution"), wanted));
            return None;
        }
        let names = ["distribution", "min", "max", "mean", "std"];
        self.known(path, table, if normal { &names } else { &names[..3] });
        let mut number = |name: &str, default: Option<f64>, (low, high): (f64, f64)| {
            let value = match table.get(name).map(|e| &e.node) {
                Some(Node::Number(x)) => Some(*x),
                Some(Node::Integer(x)) => Some(*x as f64),
                Some(_) => None,
                None => default,
            };
            let value = value.filter(|x| (low..=high).contains(x));
            if value.is_none() {
                let mut mistake = table.get(name).unwrap_or(at).wrong(&format!("{path}.{name}"), numbers(low, high));
                if let (Wrong::Value { found, .. }, None) = (&mut mistake.what, table.get(name)) {
                    "nothing".clone_into(found);
                }
                self.note(mistake);
            }
            value
        };
        let min = number("min", normal.then_some(range.0), range);
        let max = number("max", normal.then_some(range.1), (min.unwrap_or(range.0), range.1));
        if !normal {
            return Some(Distribution::Uniform { min: min?, max: max? });
        }
        let mean = number("mean", None, (min.unwrap_or(range.0), max.unwrap_or(range.1)));
        let std = number("std", None, (0.0, f64::MAX));
        Some(Distribution::Normal { mean: mean?, std: std?, min: min?, max: max? })
    }

    /// The entry whose name `table` gives under `key`, if it gives one.
    pub fn named<B: Clone>(
        &mut self,
        kind: &'static str,
        entries: &[registry::Entry<B>],
        table: &Table,
        (path, key): (&str, &str),
    ) -> Option<registry::Entry<B>> {
        let entry = table.get(key)?;
        let path = format!("{path}.{key}");
        let name = self.noted(text(entry, &path))?;
        let found = find(kind, entries, name).cloned();
        let place = entry.place.clone();
        self.noted(found.map_err(|unknown| Mistake { place, key: path, what: Wrong::Name(Box::new(unknown)) }))
    }

    /// What was read, or `None` and its mistake is noted.
    pub fn noted<T>(&mut self, read: Result<T, Mistake>) -> Option<T> {
        read.map_err(|mistake| self.note(mistake)).ok()
    }
}

/// The path of a key in a section; the file itself has no path.
fn joined(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// The names of keys, with others in front.
pub(crate) fn names<'a>(others: &[&'a str], keys: &'a [Key]) -> Vec<&'a str> {
    others.iter().copied().chain(keys.iter().map(|k| k.name)).collect()
}

/// The value of `key`, if it is one that the key takes; `drawn` adds that it may be a distribution.
fn value(key: &Key, entry: &Entry, path: &str, drawn: bool) -> Result<Value, Mistake> {
    let file = |name: &str| existing(entry, path, name);
    Ok(match (&entry.node, key.kind) {
        (Node::Number(x), Kind::Number { min, max, .. } | Kind::NumberOr { min, max, .. })
            if (min..=max).contains(x) =>
        {
            Value::Number(*x)
        }
        (Node::Integer(x), Kind::Number { min, max, .. } | Kind::NumberOr { min, max, .. })
            if (min..=max).contains(&(*x as f64)) =>
        {
            Value::Number(*x as f64)
        }
        (Node::Text(x), Kind::NumberOr { word, .. }) if x == word => Value::Text(x.clone()),
        (Node::Integer(x), Kind::Integer { min, max }) if (min..=max).contains(x) => Value::Integer(*x),
        (Node::Flag(x), Kind::Flag) => Value::Flag(*x),
        (Node::Text(x), Kind::Choice(words)) if words.contains(&x.as_str()) => Value::Text(x.clone()),
        (Node::Text(x), Kind::Choice(words)) => {
            let near = nearest(x, words.iter().copied()).map(|n| format!("; did you mean \"{n}\"?"));
            return Err(entry.wrong(path, wanted(key.kind) + &near.unwrap_or_default()));
        }
        (Node::Text(x), Kind::Text) => Value::Text(x.clone()),
        (Node::Text(x), Kind::Form(form)) => {
            form(x).map(|()| Value::Text(x.clone())).map_err(|wanted| entry.wrong(path, wanted))?
        }
        (Node::Text(x), Kind::File) => Value::Text(file(x)?),
        (_, Kind::Texts) => Value::Texts(texts(entry, path)?),
        (_, Kind::Files) => Value::Texts(texts(entry, path)?.iter().map(|x| file(x)).collect::<Result<_, _>>()?),
        (_, Kind::Number { .. }) if drawn => return Err(entry.wrong(path, wanted(key.kind) + " or a distribution")),
        _ => return Err(entry.wrong(path, wanted(key.kind))),
    })
}

/// What a kind takes, in words.
pub(super) fn wanted(kind: Kind) -> String {
    match kind {
        Kind::Number { unit: "-", min, max } => numbers(min, max),
        Kind::Number { unit, min, max } => numbers(min, max).replacen("number", &format!("number in {unit}"), 1),
        Kind::NumberOr { unit, min, max, word } => wanted(Kind::Number { unit, min, max }) + &format!(" or \"{word}\""),
        Kind::Integer { min, max } => format!("a whole number from {min} to {max}"),
        Kind::Flag => "true or false".to_owned(),
        Kind::Choice(words) => words.iter().map(|w| format!("\"{w}\"")).collect::<Vec<_>>().join(" or "),
        Kind::Text => "a text".to_owned(),
        Kind::Form(form) => form("").err().unwrap_or_else(|| "a text".to_owned()),
        Kind::File => "a file name".to_owned(),
        Kind::Texts | Kind::Files => "list of texts".to_owned(),
    }
}

fn numbers(min: f64, max: f64) -> String {
    // The bounds of a type stand for "no bound".
    match (min > f64::MIN, max < f64::MAX) {
        (true, true) => format!("a number from {} to {}", short(min), short(max)),
        (true, false) => format!("a number from {}", short(min)),
        (false, true) => format!("a number up to {}", short(max)),
        (false, false) => "a number".to_owned(),
    }
}

/// A number without a train of zeros.
fn short(x: f64) -> String {
    if x != 0.0 && !(1e-4..1e7).contains(&x.abs()) { format!("{x:e}") } else { format!("{x}") }
}

/// A text, if the entry is one.
fn text<'a>(entry: &'a Entry, path: &str) -> Result<&'a str, Mistake> {
    match &entry.node {
        Node::Text(text) => Ok(text),
        _ => Err(entry.wrong(path, wanted(Kind::Text))),
    }
}

/// A list of texts; a single text is a list of one.
fn texts(entry: &Entry, path: &str) -> Result<Vec<String>, Mistake> {
    match &entry.node {
        Node::List(list) => list.iter().map(|e| text(e, path).map(str::to_owned)).collect(),
        _ => text(entry, path).map(|t| vec![t.to_owned()]),
    }
}

/// The absolute path of a file that is named in `entry` and must be there.
fn existing(entry: &Entry, path: &str, name: &str) -> Result<String, Mistake> {
    let file = absolute(&entry.place.origin.folder, Path::new(&environment(name)));
    if file.is_file() {
        return Ok(file.to_string_lossy().into_owned());
    }
    Err(Mistake { place: entry.place.clone(), key: path.to_owned(), what: Wrong::MissingFile(file) })
}
