//! The scenario file as a JSON schema (draft 2020-12), for editors and for programs that write scenarios.

use serde_json::{Map, Value as Json, json};

use super::{
    catalog::Catalog,
    layout::{Form, Section, sections},
    reader::wanted,
    sections::{Egos, Named},
};
use crate::keys::{Key, Keys, Kind, Value};

/// The JSON schema of a scenario file that chooses from `catalog`, for the TOML read as JSON. What it cannot say is left
/// to the check: whether files exist, the form of selectors, and how values fit each other.
pub fn schema(catalog: &Catalog) -> String {
    let mut own = properties(Named::keys(), false);
    let mut group = properties(Egos::keys(), false);
    for section in sections(catalog) {
        if section.grouped {
            group.insert(section.name.to_owned(), table(&section, catalog, true));
        }
        own.insert(section.name.to_owned(), table(&section, catalog, false));
    }
    own.insert("group".to_owned(), json!({ "type": "array", "items": object(group, &["select"]) }));
    let mut file = object(own, &[]);
    file["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    file["title"] = json!("Scenario of sumo-mfc");
    format!("{file:#}\n")
}

/// A section. In a group it may leave out its name, and then has the keys of the choice that it inherits.
fn table(section: &Section, catalog: &Catalog, in_group: bool) -> Json {
    match &section.form {
        Form::Keys(keys) => object(properties(keys, false), &[]),
        Form::Drawn(keys) => {
            let mut properties = dotted(keys, properties(keys, true));
            if let Some(preset) = properties.get_mut("preset") {
                preset["enum"] = catalog.bodies.iter().map(|body| body.name).collect();
            }
            object(properties, &[])
        }
        Form::Choice(entries) => {
            let choices = entries.iter().enumerate().map(|(i, entry)| {
                let mut properties = properties(entry.keys, false);
                properties.insert("name".to_owned(), json!({ "const": entry.name, "description": entry.summary }));
                object(properties, if i == 0 || in_group { &[] } else { &["name"] })
            });
            json!({ "anyOf": choices.collect::<Vec<_>>() })
        }
    }
}

fn object(properties: Map<String, Json>, required: &[&str]) -> Json {
    json!({ "type": "object", "properties": properties, "required": required, "additionalProperties": false })
}

fn properties(keys: &[Key], drawn: bool) -> Map<String, Json> {
    keys.iter().map(|key| (key.name.to_owned(), property(key, drawn))).collect()
}

/// Adds the way to write `tyre_curve` as `tyre.curve`, a table of what follows the first underscore.
fn dotted(keys: &[Key], mut properties: Map<String, Json>) -> Map<String, Json> {
    for key in keys {
        let Some((first, rest)) = key.name.split_once('_') else { continue };
        if keys.iter().all(|k| k.name != first) {
            let property = properties[key.name].clone();
            let inner = properties.entry(first).or_insert_with(|| object(Map::new(), &[]));
            inner["properties"][rest] = property;
        }
    }
    properties
}

fn property(key: &Key, drawn: bool) -> Json {
    let mut property = match key.kind {
        Kind::Number { min, max, .. } if drawn => {
            let normal = distribution("normal", &["mean", "std"], &["min", "max"], (min, max));
            let uniform = distribution("uniform", &["min", "max"], &[], (min, max));
            json!({ "anyOf": [number(min, max), normal, uniform] })
        }
        Kind::Number { min, max, .. } => number(min, max),
        Kind::NumberOr { min, max, word, .. } => json!({ "anyOf": [number(min, max), { "const": word }] }),
        Kind::Integer { min, max } => json!({ "type": "integer", "minimum": min, "maximum": max }),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Choice(words) => json!({ "enum": words }),
        Kind::Text | Kind::Form(_) | Kind::File => json!({ "type": "string" }),
        Kind::Texts | Kind::Files => json!({ "type": ["string", "array"], "items": { "type": "string" } }),
    };
    property["description"] = json!(format!("{} ({})", key.help, wanted(key.kind)));
    if let Some(default) = &key.default {
        property["default"] = match default {
            Value::Number(x) => json!(x),
            Value::Integer(x) => json!(x),
            Value::Flag(x) => json!(x),
            Value::Text(x) => json!(x),
            Value::Texts(x) => json!(x),
        };
    }
    property
}

/// The bounds of the type stand for "no bound".
fn number(min: f64, max: f64) -> Json {
    let mut number = json!({ "type": "number" });
    if min > f64::MIN {
        number["minimum"] = json!(min);
    }
    if max < f64::MAX {
        number["maximum"] = json!(max);
    }
    number
}

/// A distribution of a number, with the keys `required` and `others`.
fn distribution(kind: &str, required: &[&str], others: &[&str], (min, max): (f64, f64)) -> Json {
    let keys = required.iter().chain(others).map(|key| {
        let (min, max) = if *key == "std" { (0.0, f64::MAX) } else { (min, max) };
        ((*key).to_owned(), number(min, max))
    });
    let kind = ("distribution".to_owned(), json!({ "const": kind }));
    object(keys.chain([kind]).collect(), &[&["distribution"], required].concat())
}
