//! Configuration keys, each declared once: name, type, default, unit, range and one line of help.
//!
//! The macro [`keys!`](crate::keys!) makes a typed struct and its table from one declaration. The scenario reader checks a
//! file against the table, `check --template` and `check --schema` print it, and a module reads its struct from the checked
//! [`Values`]. Reading cannot fail, because table and reader come from the same declaration.
//!
//! ```
//! use sumo_mfc::keys::{Keys, Values};
//!
//! sumo_mfc::choice! {
//!     /// How the filter starts.
//!     pub enum Start {
//!         /// At zero.
//!         Zero = "zero",
//!         /// At the first sample.
//!         First = "first",
//!     }
//! }
//!
//! sumo_mfc::keys! {
//!     /// Keys of a law.
//!     pub struct MyKeys {
//!         /// rate at which the error decays
//!         k_p: f64 = 1.0, "1/s", 0.0..=1000.0;
//!         /// how the filter starts
//!         start: Start = Start::First;
//!         /// largest acceleration; not set = no limit
//!         accel_max_mps2: Option<f64>, "m/s2", 0.0..=100.0;
//!     }
//! }
//!
//! let keys = MyKeys::from_values(&Values::default().with("k_p", 2.0));
//! assert_eq!(keys, MyKeys { k_p: 2.0, ..MyKeys::default() });
//! assert_eq!(MyKeys::keys()[0].help, "rate at which the error decays");
//! ```

use std::{collections::BTreeMap, path::PathBuf};

/// What a key takes.
#[derive(Debug, Clone, Copy)]
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
    /// A number as above, or a word.
    NumberOr {
        /// SI unit, "-" if none.
        unit: &'static str,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
        /// The word.
        word: &'static str,
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
    /// A text of a certain form. The function says what would be right instead.
    Form(fn(&str) -> Result<(), String>),
    /// A file, relative to the scenario file's folder.
    File,
    /// A list of texts, or one text.
    Texts,
    /// A list of files, or one file.
    Files,
}

impl Kind {
    /// The same kind with a unit and a range, if it is one of numbers.
    #[must_use]
    pub fn within(self, unit: &'static str, min: f64, max: f64) -> Self {
        match self {
            Self::Number { .. } => Self::Number { unit, min, max },
            Self::NumberOr { word, .. } => Self::NumberOr { unit, min, max, word },
            Self::Integer { .. } => Self::Integer { min: min as i64, max: max as i64 },
            other => other,
        }
    }
}

/// One configuration key.
#[derive(Debug, Clone)]
pub struct Key {
    /// Name inside its section; the unit comes last (`delay_s`).
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// The default; `None` = not set.
    pub default: Option<Value>,
    /// One line of help.
    pub help: &'static str,
}

/// A checked value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// From [`Kind::Number`] or [`Kind::NumberOr`].
    Number(f64),
    /// From [`Kind::Integer`].
    Integer(i64),
    /// From [`Kind::Flag`].
    Flag(bool),
    /// From [`Kind::NumberOr`], [`Kind::Choice`], [`Kind::Text`], [`Kind::Form`] or [`Kind::File`].
    Text(String),
    /// From [`Kind::Texts`] or [`Kind::Files`].
    Texts(Vec<String>),
}

/// The checked values of one section by the names of their keys. A key that is not set has none.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Values(pub BTreeMap<&'static str, Value>);

impl Values {
    /// All defaults of `keys`.
    pub fn defaults(keys: &[Key]) -> Self {
        Self(keys.iter().filter_map(|key| Some((key.name, key.default.clone()?))).collect())
    }

    /// The same values with `name` set to `value`.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl Setting) -> Self {
        self.0.extend(value.to_value().map(|value| (name, value)));
        self
    }

    /// The value of a key, if it is set and of this type.
    pub fn get<T: Setting>(&self, name: &str) -> Option<T> {
        self.0.get(name).and_then(T::from_value)
    }
}

/// A struct of keys; [`keys!`](crate::keys!) implements it.
pub trait Keys: Default {
    /// The table of the keys, in the order of their declaration.
    fn keys() -> &'static [Key];

    /// Reads the struct. What is not set keeps its default.
    fn from_values(values: &Values) -> Self;

    /// The values that give this struct when they are read.
    fn to_values(&self) -> Values;
}

/// A type that the value of a key can have.
pub trait Setting: Sized {
    /// How a default of this type is written in a declaration.
    type Literal: Into<Self>;

    /// What a key of this type takes, before a unit and a range are set.
    const KIND: Kind;

    /// Reads a value; `None` if it is one of another kind.
    fn from_value(value: &Value) -> Option<Self>;

    /// The value; `None` = not set.
    fn to_value(&self) -> Option<Value>;
}

/// A type whose keys need no default: the value may be missing.
pub trait Optional: Setting + Default {}

impl<T: Setting> Optional for Option<T> {}
impl<T> Optional for Vec<T> where Self: Setting {}

/// Implements [`Setting`] for a type that one variant of [`Value`] holds.
macro_rules! setting {
    ($($type:ty: $literal:ty = $kind:expr, $variant:ident, $read:expr, $write:expr;)*) => {$(
        impl Setting for $type {
            type Literal = $literal;
            const KIND: Kind = $kind;

            fn from_value(value: &Value) -> Option<Self> {
                let read: fn(&_) -> Option<Self> = $read;
                if let Value::$variant(value) = value { read(value) } else { None }
            }

            fn to_value(&self) -> Option<Value> {
                let write: fn(&Self) -> Option<_> = $write;
                write(self).map(Value::$variant)
            }
        }
    )*};
}

setting! {
    f64: f64 = Kind::Number { unit: "-", min: f64::MIN, max: f64::MAX }, Number, |x| Some(*x), |x| Some(*x);
    bool: bool = Kind::Flag, Flag, |x| Some(*x), |x| Some(*x);
    u16: u16 = Kind::Integer { min: 0, max: u16::MAX as i64 }, Integer, |x| Self::try_from(*x).ok(), |x| Some((*x).into());
    u32: u32 = Kind::Integer { min: 0, max: u32::MAX as i64 }, Integer, |x| Self::try_from(*x).ok(), |x| Some((*x).into());
    u64: u64 = Kind::Integer { min: 0, max: i64::MAX }, Integer, |x| Self::try_from(*x).ok(), |x| i64::try_from(*x).ok();
    i64: i64 = Kind::Integer { min: i64::MIN, max: i64::MAX }, Integer, |x| Some(*x), |x| Some(*x);
    String: &'static str = Kind::Text, Text, |x: &String| Some(x.clone()), |x| Some(x.clone());
    PathBuf: &'static str = Kind::File, Text, |x: &String| Some(x.into()), |x| Some(x.to_string_lossy().into_owned());
    // An empty list is not set.
    Vec<String>: Self = Kind::Texts, Texts, |x: &Vec<String>| Some(x.clone()), |x| (!x.is_empty()).then(|| x.clone());
    Vec<PathBuf>: Self = Kind::Files, Texts, |x: &Vec<String>| Some(x.iter().map(PathBuf::from).collect()),
        |x| (!x.is_empty()).then(|| x.iter().map(|path| path.to_string_lossy().into_owned()).collect());
}

impl<T: Setting> Setting for Option<T> {
    type Literal = T;
    const KIND: Kind = T::KIND;

    fn from_value(value: &Value) -> Option<Self> {
        T::from_value(value).map(Some)
    }

    fn to_value(&self) -> Option<Value> {
        self.as_ref().and_then(T::to_value)
    }
}

/// Declares a struct of configuration keys ([`Keys`](crate::keys::Keys)); [`mod@crate::keys`] has an example.
///
/// Each key is `/// help`, then `name: type = default, "unit", min..=max;`. The doc comment is the key's help, of one line.
/// Numbers have a unit ("-" = none) and a range; a text may have `form FUNCTION` ([`Kind::Form`](crate::keys::Kind::Form)).
/// Keys of type `Option` and lists need no default. `..shared: OtherKeys,` in front takes over the keys of another struct,
/// and so does `and ..shared: OtherKeys,` at the end.
#[macro_export]
macro_rules! keys {
    ($(#[$meta:meta])* $vis:vis struct $name:ident {
        $(..$base:ident: $base_type:ty,)?
        $(#[doc = $help:literal] $field:ident: $type:ty $(= $default:expr)? $(, $unit:literal, $range:expr)? $(, form $form:expr)?;)*
        $(and ..$tail:ident: $tail_type:ty,)?
    }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq)]
        #[allow(rustdoc::broken_intra_doc_links)]
        $vis struct $name {
            $(#[doc = "Keys that are declared elsewhere."] pub $base: $base_type,)?
            $(#[doc = $help] pub $field: $type,)*
            $(#[doc = "Keys that are declared elsewhere."] pub $tail: $tail_type,)?
        }

        impl Default for $name {
            fn default() -> Self {
                Self {
                    $($base: Default::default(),)?
                    $($field: $crate::keys!(@default $type $(, $default)?),)*
                    $($tail: Default::default(),)?
                }
            }
        }

        impl $crate::keys::Keys for $name {
            fn keys() -> &'static [$crate::keys::Key] {
                static TABLE: std::sync::LazyLock<Vec<$crate::keys::Key>> = std::sync::LazyLock::new(|| {
                    let _values = $crate::keys::Keys::to_values(&$name::default());
                    [
                        $(<$base_type as $crate::keys::Keys>::keys().to_vec(),)?
                        vec![$($crate::keys::Key {
                            name: stringify!($field),
                            kind: $crate::keys!(@kind $type $(, $unit, $range)? $(, form $form)?),
                            default: _values.0.get(stringify!($field)).cloned(),
                            help: $help.trim_ascii(),
                        }),*],
                        $(<$tail_type as $crate::keys::Keys>::keys().to_vec(),)?
                    ]
                    .concat()
                });
                &TABLE
            }

            fn from_values(values: &$crate::keys::Values) -> Self {
                let _defaults = Self::default();
                let _ = values;
                Self {
                    $($base: $crate::keys::Keys::from_values(values),)?
                    $($field: values.get(stringify!($field)).unwrap_or(_defaults.$field),)*
                    $($tail: $crate::keys::Keys::from_values(values),)?
                }
            }

            fn to_values(&self) -> $crate::keys::Values {
                let mut _values = $crate::keys::Values::default();
                $(_values.0.append(&mut $crate::keys::Keys::to_values(&self.$base).0);)?
                $(_values.0.extend($crate::keys::Setting::to_value(&self.$field).map(|value| (stringify!($field), value)));)*
                $(_values.0.append(&mut $crate::keys::Keys::to_values(&self.$tail).0);)?
                _values
            }
        }
    };
    (@default $type:ty) => { $crate::keys::not_set::<$type>() };
    (@default $type:ty, $default:expr) => {{
        let literal: <$type as $crate::keys::Setting>::Literal = $default;
        literal.into()
    }};
    (@kind $type:ty) => { <$type as $crate::keys::Setting>::KIND };
    (@kind $type:ty, form $form:expr) => { $crate::keys::Kind::Form($form) };
    (@kind $type:ty, $unit:literal, $range:expr) => {
        <$type as $crate::keys::Setting>::KIND.within($unit, f64::from(*$range.start()), f64::from(*$range.end()))
    };
}

/// The default of a key that is declared without one.
#[doc(hidden)]
pub fn not_set<T: Optional>() -> T {
    T::default()
}

/// Declares an enum whose variants are the words that a key takes; [`mod@crate::keys`] has an example.
#[macro_export]
macro_rules! choice {
    ($(#[$meta:meta])* $vis:vis enum $name:ident { $($(#[$about:meta])* $variant:ident = $word:literal),+ $(,)? }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        $vis enum $name { $($(#[$about])* $variant),+ }

        impl $crate::keys::Setting for $name {
            type Literal = Self;
            const KIND: $crate::keys::Kind = $crate::keys::Kind::Choice(&[$($word),+]);

            fn from_value(value: &$crate::keys::Value) -> Option<Self> {
                let $crate::keys::Value::Text(word) = value else { return None };
                match word.as_str() {
                    $($word => Some(Self::$variant),)+
                    _ => None,
                }
            }

            fn to_value(&self) -> Option<$crate::keys::Value> {
                Some($crate::keys::Value::Text(match self { $(Self::$variant => $word),+ }.to_owned()))
            }
        }
    };
}

keys! {
    /// For what takes no keys.
    pub struct NoKeys {}
}
