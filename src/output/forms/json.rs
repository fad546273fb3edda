//! A JSON array with an object per row; a missing value is null.

use crate::table::{Cell, Column};
use serde::{Serialize, Serializer};

/// A row, its columns in their order.
struct Object<'a>(&'a [Column], &'a [Cell<'a>]);

/// One cell.
struct Value<'a>(Cell<'a>);

impl Serialize for Object<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().zip(self.1).map(|(column, cell)| (&column.name, Value(*cell))))
    }
}

impl Serialize for Value<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            Cell::Text(text) => text.serialize(serializer),
            Cell::Number(number) => number.serialize(serializer),
            Cell::Count(count) => count.serialize(serializer),
            Cell::Flag(flag) => flag.serialize(serializer),
        }
    }
}

/// The array.
pub fn text(columns: &[Column], rows: &[Vec<Cell<'_>>]) -> String {
    let objects: Vec<_> = rows.iter().map(|cells| Object(columns, cells)).collect();
    serde_json::to_string_pretty(&objects).expect("cells are texts and numbers") + "\n"
}
