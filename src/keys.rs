//! Configuration keys as data: name, kind, unit, range, default and one line of help. The scenario reader checks files
//! against these tables, `check --template` prints them, and a room builds itself from the checked [`Values`].

use std::collections::BTreeMap;

/// What a key takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// A number in `unit` ("-" = none), `min..=max`.
    Number {
        /// SI unit, "-" if none.
        unit: &'static str,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
    },
    /// A whole number, `min..=max`.
    Integer {
        /// Smallest allowed value.
        min: i64,
        /// Largest allowed value.
        max: i64,
    },
    /// `true` or `false`.
    Flag,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// Any text.
    Text,
    /// A file, relative to the scenario file's folder.
    File,
}

/// One configuration key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Name inside its section; the unit comes last (`delay_s`).
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// The default as a TOML literal (`"0.25"`, `"\"updated\""`, `"false"`); empty = not set.
    pub default: &'static str,
    /// One line of help.
    pub help: &'static str,
}

/// A checked value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// From [`Kind::Number`].
    Number(f64),
    /// From [`Kind::Integer`].
    Integer(i64),
    /// From [`Kind::Flag`].
    Flag(bool),
    /// From [`Kind::Choice`], [`Kind::Text`] or [`Kind::File`].
    Text(String),
}

/// The checked values of one section, complete with defaults. Asking for a key that its table does not have, or with
/// another kind, is a programming error and panics.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Values(pub BTreeMap<&'static str, Value>);

impl Values {
    /// All defaults of `keys`.
    ///
    /// # Panics
    /// If a default is not a literal of its key's kind: the table is wrong.
    pub fn defaults(keys: &[Key]) -> Self {
        let mut values = Self::default();
        for key in keys.iter().filter(|k| !k.default.is_empty()) {
            let literal = format!("default of {} is a literal of its kind", key.name);
            let value = match key.kind {
                Kind::Number { .. } => Value::Number(key.default.parse().expect(&literal)),
                Kind::Integer { .. } => Value::Integer(key.default.parse().expect(&literal)),
                Kind::Flag => Value::Flag(key.default.parse().expect(&literal)),
                Kind::Choice(_) | Kind::Text | Kind::File => Value::Text(key.default.trim_matches('"').to_owned()),
            };
            values.0.insert(key.name, value);
        }
        values
    }

    /// The same values with `name` set to `value`.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: Value) -> Self {
        self.0.insert(name, value);
        self
    }

    /// A number, if set.
    pub fn try_number(&self, name: &str) -> Option<f64> {
        self.0.get(name).map(|v| match v {
            Value::Number(x) => *x,
            other => panic!("{name} is {other:?}, not a number"),
        })
    }

    /// A number that has a default.
    pub fn number(&self, name: &str) -> f64 {
        self.try_number(name).unwrap_or_else(|| panic!("{name} has no value and no default"))
    }

    /// A whole number, if set.
    pub fn try_integer(&self, name: &str) -> Option<i64> {
        self.0.get(name).map(|v| match v {
            Value::Integer(x) => *x,
            other => panic!("{name} is {other:?}, not an integer"),
        })
    }

    /// A flag that has a default.
    pub fn flag(&self, name: &str) -> bool {
        match self.0.get(name) {
            Some(Value::Flag(x)) => *x,
            other => panic!("{name} is {other:?}, not a flag"),
        }
    }

    /// A text, if set.
    pub fn try_text(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(|v| match v {
            Value::Text(x) => x.as_str(),
            other => panic!("{name} is {other:?}, not a text"),
        })
    }

    /// A text that has a default.
    pub fn text(&self, name: &str) -> &str {
        self.try_text(name).unwrap_or_else(|| panic!("{name} has no value and no default"))
    }
}
