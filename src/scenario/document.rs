//! A scenario as written: TOML tables in which every entry has its place. A file and `--set` are read in the same way, and
//! their errors name the line or the argument.

use std::{collections::BTreeMap, ops::Range, path::PathBuf, sync::Arc};

use toml_edit::{Item, TableLike, Value};

use super::error::{Mistake, Wrong};
use crate::place::{Origin, Place};

/// Entries by key.
pub(crate) type Table = BTreeMap<String, Entry>;

/// A value and the place of its `key = value`.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub node: Node,
    pub place: Place,
}

/// A TOML value.
#[derive(Debug, Clone)]
pub(crate) enum Node {
    Table(Table),
    List(Vec<Entry>),
    Integer(i64),
    Number(f64),
    Flag(bool),
    Text(String),
    Time(String),
}

impl Node {
    /// An argument of the command line. What is not a TOML literal (a bare word, `type:bus*`) is meant as text.
    pub fn of_argument(text: &str, place: &Place) -> Self {
        text.parse::<Value>().map_or_else(|_| Self::Text(text.to_owned()), |value| node(&value, place))
    }

    /// The TOML literal that reads back as this value.
    pub fn literal(&self) -> String {
        match self {
            Self::Table(table) => {
                let pairs: Vec<String> =
                    table.iter().map(|(key, entry)| format!("{key:?} = {}", entry.node.literal())).collect();
                format!("{{ {} }}", pairs.join(", "))
            }
            Self::List(list) => format!("[{}]", list.iter().map(|e| e.node.literal()).collect::<Vec<_>>().join(", ")),
            Self::Text(text) => Value::from(text.as_str()).to_string(),
            other => other.shown(),
        }
    }

    /// How an error message shows the value.
    pub fn shown(&self) -> String {
        match self {
            Self::Table(_) => "a table".to_owned(),
            Self::List(_) => "a list".to_owned(),
            Self::Integer(x) => x.to_string(),
            Self::Number(x) => format!("{x:?}"),
            Self::Flag(x) => x.to_string(),
            Self::Text(x) => format!("{x:?}"),
            Self::Time(x) => x.clone(),
        }
    }
}

impl Entry {
    /// The mistake that something else is `wanted` here.
    pub fn wrong(&self, key: &str, wanted: impl Into<String>) -> Mistake {
        let what = Wrong::Value { found: self.node.shown(), wanted: wanted.into() };
        Mistake { place: self.place.clone(), key: key.to_owned(), what }
    }
}

/// Parses a TOML file.
pub(crate) fn parse(name: String, text: String, folder: PathBuf) -> Result<Table, Mistake> {
    let origin = Arc::new(Origin { name, text, folder, argument: false });
    let whole = Place { origin: origin.clone(), span: 0..0 };
    let document = toml_edit::Document::parse(origin.text.as_str()).map_err(|e| Mistake {
        place: Place { origin: origin.clone(), span: e.span().unwrap_or(0..0) },
        key: String::new(),
        what: Wrong::Syntax(e.message().trim().to_owned()),
    })?;
    Ok(table(document.as_table(), &whole))
}

fn table(source: &dyn TableLike, parent: &Place) -> Table {
    let keys: Vec<&str> = source.iter().map(|(k, _)| k).collect();
    let entries = keys.into_iter().filter_map(|key| {
        let item = source.get(key)?;
        let key_span = source.key(key).and_then(|k| k.span());
        Some((key.to_owned(), entry(item, key_span, parent)))
    });
    entries.collect()
}

fn entry(item: &Item, key: Option<Range<usize>>, parent: &Place) -> Entry {
    let span = match (key, item.span()) {
        // A [section] spans its header; a `key = value` reaches from the key to the end of the value.
        (Some(key), Some(value)) if value.start >= key.end => key.start..value.end,
        (_, Some(value)) => value,
        (Some(key), None) => key,
        (None, None) => parent.span.clone(),
    };
    let place = Place { origin: parent.origin.clone(), span };
    let node = match item {
        Item::Table(t) => Node::Table(table(t, &place)),
        Item::ArrayOfTables(tables) => {
            let list = tables.iter().map(|t| {
                let own = Place { span: t.span().unwrap_or_else(|| place.span.clone()), ..place.clone() };
                Entry { node: Node::Table(table(t, &own)), place: own }
            });
            Node::List(list.collect())
        }
        Item::Value(value) => node(value, &place),
        Item::None => Node::Table(Table::new()),
    };
    Entry { node, place }
}

fn node(value: &Value, place: &Place) -> Node {
    match value {
        Value::String(x) => Node::Text(x.value().clone()),
        Value::Integer(x) => Node::Integer(*x.value()),
        Value::Float(x) => Node::Number(*x.value()),
        Value::Boolean(x) => Node::Flag(*x.value()),
        Value::Datetime(x) => Node::Time(x.value().to_string()),
        Value::InlineTable(x) => Node::Table(table(x, place)),
        Value::Array(list) => Node::List(
            list.iter()
                .map(|v| {
                    let own = Place { span: v.span().unwrap_or_else(|| place.span.clone()), ..place.clone() };
                    Entry { node: node(v, &own), place: own }
                })
                .collect(),
        ),
    }
}

/// The parts of a key, as many as a TOML file may nest tables.
const PARTS_MAX: usize = 80;

/// A value given on the command line: `shown` is the argument as typed, `path` a dotted TOML path.
#[derive(Debug, Clone)]
pub struct Override {
    /// The argument for messages, e.g. `--seed 3` or `--set controller.k_p=1.2`.
    pub shown: String,
    /// The dotted path, e.g. `sumo.seed`; a number picks a `[[group]]`, counted from 0.
    pub path: String,
    /// The value as a TOML literal; what is none is taken as text.
    pub value: String,
}

impl Override {
    /// The override of `flag VALUE`; the value is text whatever it looks like.
    pub fn text(flag: &str, path: &str, value: &str) -> Self {
        Self { shown: format!("{flag} {value}"), path: path.to_owned(), value: Value::from(value).to_string() }
    }

    /// The override of `flag VALUE`, where the value is a number, a flag or a list.
    pub fn literal(flag: &str, path: &str, value: impl std::fmt::Display) -> Self {
        Self { shown: format!("{flag} {value}"), path: path.to_owned(), value: value.to_string() }
    }

    /// The override of `flag VALUES...`.
    pub fn texts(flag: &str, path: &str, values: &[String]) -> Self {
        let shown = format!("{flag} {}", values.join(" "));
        Self { shown, path: path.to_owned(), value: Value::from_iter(values).to_string() }
    }

    /// The override of `--set key=value`; `None` if there is no `=` or no key.
    pub fn set(argument: &str) -> Option<Self> {
        let (path, value) = argument.split_once('=')?;
        let path = path.trim().to_owned();
        let shown = format!("--set {argument}");
        (!path.is_empty()).then(|| Self { shown, path, value: value.trim().to_owned() })
    }

    /// Puts the value into `root`, making the tables on the way.
    pub(crate) fn apply(&self, root: &mut Table) -> Result<(), Mistake> {
        let place = Place::argument(&self.shown);
        let node = Node::of_argument(&self.value, &place);
        let parts: Vec<&str> = self.path.split('.').map(str::trim).collect();
        if parts.len() > PARTS_MAX {
            let wanted = format!("a key of at most {PARTS_MAX} parts");
            let what = Wrong::Value { found: format!("{} parts", parts.len()), wanted };
            return Err(Mistake { place, key: format!("{}. ...", parts[0]), what });
        }
        put(root, &parts, &self.path, Entry { node, place })
    }
}

fn put(table: &mut Table, parts: &[&str], path: &str, entry: Entry) -> Result<(), Mistake> {
    let [first, rest @ ..] = parts else { return Ok(()) };
    if rest.is_empty() {
        table.insert((*first).to_owned(), entry);
        return Ok(());
    }
    let place = entry.place.clone();
    let next = table
        .entry((*first).to_owned())
        .or_insert_with(|| Entry { node: Node::Table(Table::new()), place: place.clone() });
    let (found, wanted) = match &mut next.node {
        Node::Table(inner) => return put(inner, rest, path, entry),
        Node::List(list) => {
            let count = list.len();
            let chosen = rest[0].parse::<usize>().ok().and_then(|i| list.get_mut(i));
            match (chosen.map(|e| &mut e.node), &rest[1..]) {
                (Some(Node::Table(inner)), more) if !more.is_empty() => return put(inner, more, path, entry),
                _ => (path.to_owned(), format!("{first}.N with N below {count}")),
            }
        }
        // `vehicle.mass_kg.std` where the file has a plain number: say so instead of replacing it.
        other => (format!("{first} = {}", other.shown()), format!("{first} to be a table")),
    };
    Err(Mistake { place, key: path.to_owned(), what: Wrong::Value { found, wanted } })
}
