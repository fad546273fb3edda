//! What a table is: a row is a struct, and each of its fields is declared once, with column, unit and meaning.
//!
//! The macro `record!` makes the struct from that list. Every file format, `schema.json`, the fleet's summary and
//! `docs/columns.md` are written from the same list, through [`Layout`].

use serde::Serialize;
use std::sync::Arc;

/// A number to four significant digits, which is what a reader takes in.
pub fn rounded(number: f64) -> f64 {
    format!("{number:.3e}").parse().unwrap_or(number)
}

/// One value of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell<'a> {
    /// A text.
    Text(Option<&'a str>),
    /// A finite number.
    Number(Option<f64>),
    /// A count.
    Count(u64),
    /// `true` or `false`.
    Flag(bool),
}

impl Cell<'_> {
    /// The value as a number, if it is one.
    pub fn number(self) -> Option<f64> {
        match self {
            Cell::Number(value) => value,
            Cell::Count(value) => Some(value as f64),
            Cell::Text(_) | Cell::Flag(_) => None,
        }
    }
}

/// What the values of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// [`Cell::Text`].
    #[serde(rename = "string")]
    Text,
    /// [`Cell::Number`].
    Number,
    /// [`Cell::Count`].
    #[serde(rename = "integer")]
    Count,
    /// [`Cell::Flag`].
    #[serde(rename = "boolean")]
    Flag,
}

/// What is known of a column before the first row.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Column {
    /// Its header.
    pub name: String,
    /// What its values are.
    #[serde(rename = "type")]
    pub kind: Kind,
    /// Their unit; none for texts, counts and ratios.
    pub unit: Option<&'static str>,
    /// What they say.
    pub meaning: String,
    /// True if the summary of a fleet has the mean and the quantiles of this column.
    #[serde(skip)]
    pub in_summary: bool,
}

impl Column {
    /// A column that the summary of a fleet has, if it has numbers.
    pub fn new(name: impl Into<String>, kind: Kind, unit: Option<&'static str>, meaning: impl Into<String>) -> Self {
        Self { name: name.into(), kind, unit, meaning: meaning.into(), in_summary: true }
    }

    /// The same column, but the summary of a fleet leaves it out.
    #[must_use]
    pub fn not_in_summary(self) -> Self {
        Self { in_summary: false, ..self }
    }
}

/// Reads the value of a column off a row.
pub type Read<R> = Box<dyn Fn(&R) -> Cell<'_> + Send + Sync>;

/// Columns, each with how it is read off a row `R`.
pub type Columns<R> = Vec<(Column, Read<R>)>;

/// A field of a row: a value with its own column, or a struct of fields with a column each.
pub trait Field: Sized + 'static {
    /// The columns of the field, and how they are read off a row `R` in which `find` finds it. `declared` is what the
    /// row says about the field.
    fn columns<R: 'static>(declared: Column, find: impl Fn(&R) -> &Self + Clone + Send + Sync + 'static) -> Columns<R>;
}

macro_rules! values {
    ($($type:ty: $kind:ident = $cell:expr;)*) => {$(
        impl Field for $type {
            fn columns<R: 'static>(
                declared: Column,
                find: impl Fn(&R) -> &Self + Clone + Send + Sync + 'static,
            ) -> Columns<R> {
                let cell: fn(&Self) -> Cell<'_> = $cell;
                vec![(Column { kind: Kind::$kind, ..declared }, Box::new(move |row| cell(find(row))))]
            }
        }
    )*};
}

values! {
    String: Text = |text| Cell::Text(Some(text));
    Option<String>: Text = |text| Cell::Text(text.as_deref());
    &'static str: Text = |text| Cell::Text(Some(text));
    Arc<str>: Text = |text| Cell::Text(Some(text));
    u64: Count = |count| Cell::Count(*count);
    bool: Flag = |flag| Cell::Flag(*flag);
    f64: Number = |number| Cell::Number(Some(*number).filter(|x| x.is_finite()));
    Option<f64>: Number = |number| Cell::Number(number.filter(|x| x.is_finite()));
}

/// Declares the struct of a row (or of a part of one), public and field by field:
/// `field: type = "meaning" ["unit"];`, where the unit may be missing. `field as "column"` names the column,
/// `not_in_summary` after the unit keeps it out of the summary. A field that is itself a record has no meaning of its
/// own: its columns stand in its place.
macro_rules! record {
    (@name $field:ident) => { stringify!($field) };
    (@name $field:ident $column:literal) => { $column };
    (@unit) => { None };
    (@unit $unit:literal) => { Some($unit) };
    (@meaning) => { "" };
    (@meaning $meaning:literal) => { $meaning };
    (
        $(#[$about:meta])*
        pub struct $record:ident {
            $(
                $(#[$field_about:meta])*
                $field:ident $(as $column:literal)?: $type:ty $(= $meaning:literal $([$unit:literal])? $($outside:ident)?)?;
            )*
        }
    ) => {
        $(#[$about])*
        pub struct $record {
            $($(#[$field_about])* $(#[doc = concat!($meaning, $(" \\[", $unit, "\\]",)? ".")])? pub $field: $type,)*
        }

        impl $crate::table::Field for $record {
            fn columns<R: 'static>(
                _: $crate::table::Column,
                find: impl Fn(&R) -> &Self + Clone + Send + Sync + 'static,
            ) -> $crate::table::Columns<R> {
                let mut columns = Vec::new();
                $({
                    let find = find.clone();
                    let declared = $crate::table::Column::new(
                        $crate::table::record!(@name $field $($column)?),
                        $crate::table::Kind::Number,
                        $crate::table::record!(@unit $($($unit)?)?),
                        $crate::table::record!(@meaning $($meaning)?),
                    )$($(.$outside())?)?;
                    columns.extend(<$type as $crate::table::Field>::columns(declared, move |row: &R| &find(row).$field));
                })*
                columns
            }
        }
    };
}
pub(crate) use record;

/// What a format needs to know of a table before the first row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shape {
    /// The table, e.g. "vehicles": the root element of XML.
    pub table: &'static str,
    /// One row, e.g. "vehicle": the row element of XML.
    pub row: &'static str,
    /// Whether consecutive rows of the same time, the first column, share one `<timestep>` in XML as in SUMO's FCD output.
    pub by_time: bool,
    /// What a row is.
    pub meaning: &'static str,
    /// The columns in order.
    pub columns: Vec<Column>,
}

/// A table of rows `R`.
pub struct Layout<R> {
    /// What is known of it before the first row.
    pub shape: Shape,
    reads: Vec<Read<R>>,
}

impl Layout<Vec<String>> {
    /// A table read back, each row the texts of its values.
    pub fn of_texts(shape: &Shape) -> Self {
        let read = |(place, column): (usize, &Column)| -> Read<Vec<String>> {
            let kind = column.kind;
            Box::new(move |row| {
                let text = row[place].as_str();
                match kind {
                    Kind::Text => Cell::Text((!text.is_empty()).then_some(text)),
                    Kind::Number => Cell::Number(text.parse().ok()),
                    Kind::Count => text.parse().map_or(Cell::Number(None), Cell::Count),
                    Kind::Flag => Cell::Flag(text == "true"),
                }
            })
        };
        Self { shape: shape.clone(), reads: shape.columns.iter().enumerate().map(read).collect() }
    }
}

impl<R: 'static> Layout<R> {
    /// A table with these columns; `names` are those of the table and of a row.
    pub fn new(names: [&'static str; 2], meaning: &'static str, columns: Columns<R>) -> Self {
        let [table, row] = names;
        let (columns, reads) = columns.into_iter().unzip();
        Self { shape: Shape { table, row, by_time: false, meaning, columns }, reads }
    }

    /// A table of the record `R`.
    pub fn of_record(names: [&'static str; 2], meaning: &'static str) -> Self
    where
        R: Field,
    {
        Self::new(names, meaning, R::columns(Column::new("", Kind::Number, None, ""), |row| row))
    }

    /// The same table, with rows of one time together in XML.
    #[must_use]
    pub fn by_time(mut self) -> Self {
        self.shape.by_time = true;
        self
    }

    /// The values of a row, in the order of the columns.
    pub fn cells<'r>(&self, row: &'r R) -> impl Iterator<Item = Cell<'r>> {
        self.reads.iter().map(move |read| read(row))
    }

    /// The value of a row in a column.
    pub fn cell<'r>(&self, row: &'r R, column: usize) -> Cell<'r> {
        (self.reads[column])(row)
    }

    /// The place of a column.
    pub fn place(&self, column: &str) -> Option<usize> {
        self.shape.columns.iter().position(|c| c.name == column)
    }
}
