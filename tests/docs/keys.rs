//! `docs/reference/keys.md` is made from the declarations of the keys; `UPDATE=1 cargo test --test docs keys` writes it anew.

use std::fmt::Write;

use sumo_mfc::keys::{Key, Kind, Value};
use sumo_mfc::registry::Entry;
use sumo_mfc::scenario::{Catalog, Form, parameter_keys, parameter_names, sections};
use sumo_mfc::study::file_keys;

use crate::assert_up_to_date;

const HEAD: &str = "# Keys of the files

Every key of a scenario file, of a study file, and of the `<param>` elements in SUMO's own files. A key that is wrong, or has a
wrong value, is refused before SUMO starts, with file, line, and what was wanted.

- `sumo-mfc check --template > my.toml` writes a scenario file with all of these keys.
- `sumo-mfc check --schema > scenario.schema.json` writes the same as a JSON schema, for editors.
- `sumo-mfc check SCENARIO` prints the scenario as it will run, in SI units.
- On the command line, `--set actuator.delay_s=0.2` sets the key `delay_s` of the section `[actuator]`.

File names are relative to the file that names them. A key without default is not set. This page is made by
`UPDATE=1 cargo test --test docs keys`.
";

const GROUPS: &str = "
## `[[group]]`

Groups of vehicles with settings of their own. The first group that matches a vehicle counts, `select` takes what
[`egos.select`](#egos) takes, and keys that are left out are those of the sections above.

```toml
[[group]]
select = \"type:truck*\"
[group.vehicle]
mass_factor = { distribution = \"normal\", mean = 1.0, std = 0.2 }
[group.controller]
name = \"pid\"
```
";

const STUDIES: &str = "
## Study files

A study file names a scenario and what varies ([Studies](../studies.md)). Beside the keys below it has `[[vary]]`, a table of lists
for any keys of the scenario that vary together, and `reference`, a table with the values that the differences are taken to.
";

const PARAMETERS: &str = "
## Parameters of vehicles and vTypes

SUMO's own files may carry these as `<param key=\"mfc.mass\" value=\"1719\"/>` in a `<vType>` or `<vehicle>`; a vehicle's own value goes
before that of its type. A number may be drawn per vehicle: `normal(mean, std)`, `normal(mean, std, min, max)`, `uniform(min, max)`.
Units, ranges and meanings are those of `[vehicle]` and `[actuator]` above. `has.mfc.device` (true or false) and `device.mfc.probability` (0 to 1)
choose egos, with `--egos param`.

";

/// A cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('*', "\\*").replace('<', "&lt;")
}

/// A number as it is written by hand.
fn short(x: f64) -> String {
    if x != 0.0 && !(1e-4..1e7).contains(&x.abs()) { format!("{x:e}") } else { format!("{x}") }
}

/// Unit, and what a key takes.
fn takes(kind: Kind) -> (&'static str, String) {
    let unit = |unit| if unit == "-" { "" } else { unit };
    let range = |min: f64, max: f64| format!("{} to {}", short(min), short(max));
    match kind {
        Kind::Number { unit: name, min, max } => (unit(name), range(min, max)),
        Kind::NumberOr { unit: name, min, max, word } => (unit(name), format!("{} or `\"{word}\"`", range(min, max))),
        Kind::Integer { min, max } => ("", format!("{min} to {max}, whole")),
        Kind::Flag => ("", "`true`, `false`".to_owned()),
        Kind::Choice(words) => ("", words.iter().map(|w| format!("`\"{w}\"`")).collect::<Vec<_>>().join(", ")),
        Kind::Text => ("", "text".to_owned()),
        Kind::Form(form) => ("", form("").err().unwrap_or_else(|| "text".to_owned())),
        Kind::File => ("", "file name".to_owned()),
        Kind::Texts => ("", "list of texts".to_owned()),
        Kind::Files => ("", "list of file names".to_owned()),
    }
}

fn default(key: &Key) -> String {
    match &key.default {
        None => String::new(),
        Some(Value::Number(x)) => format!("`{x:?}`"),
        Some(Value::Integer(x)) => format!("`{x}`"),
        Some(Value::Flag(x)) => format!("`{x}`"),
        Some(Value::Text(x)) => format!("`{x:?}`"),
        Some(Value::Texts(x)) => format!("`{x:?}`"),
    }
}

fn table(keys: &[Key]) -> String {
    let mut table = String::from("| key | unit | takes | default | meaning |\n|---|---|---|---|---|\n");
    for key in keys {
        let (unit, takes) = takes(key.kind);
        let (takes, meaning) = (cell(&takes), cell(key.help));
        writeln!(table, "| `{}` | {unit} | {takes} | {} | {meaning} |", key.name, default(key)).unwrap();
    }
    table
}

/// The entries of a section that chooses by name; the first is the default.
fn choice(section: &str, entries: &[Entry<()>]) -> String {
    let mut text = String::from("| `name` | meaning |\n|---|---|\n");
    for (i, entry) in entries.iter().enumerate() {
        let default = if i == 0 { " (default)" } else { "" };
        writeln!(text, "| `\"{}\"`{default} | {} |", entry.name, cell(entry.summary)).unwrap();
    }
    for entry in entries.iter().filter(|entry| !entry.keys.is_empty()) {
        write!(text, "\n### `[{section}]` with `name = \"{}\"`\n\n{}", entry.name, table(entry.keys)).unwrap();
    }
    text
}

fn page() -> String {
    let catalog = Catalog::installed();
    let mut page =
        format!("{HEAD}\nOutside of all sections, `name` names the folder of the results; default: the file's name.\n");
    for section in sections(&catalog) {
        write!(page, "\n## `[{}]`\n\n", section.name).unwrap();
        if section.name == "vehicle" {
            page.push_str("| `preset` | body |\n|---|---|\n");
            for body in &catalog.registries()[3].1 {
                writeln!(page, "| `\"{}\"` | {} |", body.name, cell(body.summary)).unwrap();
            }
            page.push('\n');
        }
        page.push_str(&match &section.form {
            Form::Keys(keys) | Form::Drawn(keys) => table(keys),
            Form::Choice(entries) => choice(section.name, entries),
        });
        if matches!(section.form, Form::Drawn(_)) {
            page.push_str(
                "\nAny number of this section can be drawn per vehicle: `{ distribution = \"normal\", mean = 1.0, std = 0.1, min = 0.5, \
                 max = 1.5 }` (`min` and `max` default to the range), or `{ distribution = \"uniform\", min = 0.5, max = 1.5 }`.\n",
            );
        }
    }
    page.push_str(GROUPS);
    page.push_str(STUDIES);
    for (section, keys) in file_keys() {
        if !section.is_empty() {
            write!(page, "\n### `[{section}]`\n").unwrap();
        }
        write!(page, "\n{}", table(keys)).unwrap();
    }
    page.push_str(PARAMETERS);
    let names = parameter_keys()
        .map(|key| parameter_names(key).iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(" or "));
    page.extend(names.map(|names| format!("- {names}\n")));
    page
}

#[test]
fn the_page_of_keys_is_up_to_date() {
    assert_up_to_date("docs/reference/keys.md", &page(), "keys");
}
