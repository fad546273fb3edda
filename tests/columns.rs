//! `docs/columns.md` is made from the declarations of the columns; `UPDATE=1 cargo test --test columns` writes it anew.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use serde_json::Value;
use sumo_mfc::run::{FileSchema, Schema};
use sumo_mfc::stability::{margin_layout, string_layout, sweep_layout};
use sumo_mfc::study::study_schema;

/// The tables in the order of the page.
const FILES: [&str; 15] = [
    "vehicles.csv",
    "quality.csv",
    "trace.csv",
    "sample.csv",
    "edges.csv",
    "summary.json",
    "cases.csv",
    "comparison.csv",
    "vehicles.parquet",
    "results.csv",
    "counts.csv",
    "tune.csv",
    "margins.csv",
    "strings.csv",
    "sweep.csv",
];

fn page() -> String {
    let run = serde_json::to_value(Schema::of_run("vehicles.csv", true, Some("trace.csv"))).unwrap();
    let study = study_schema(&[], |_| true);
    let study = serde_json::to_value(study).unwrap();
    let tune = Schema::new([("tune.csv", FileSchema::of_table(&sumo_mfc::tune::layout().shape))]);
    let tune = serde_json::to_value(tune).unwrap();
    let shapes = [margin_layout().shape, string_layout().shape, sweep_layout().shape];
    let names = ["margins.csv", "strings.csv", "sweep.csv"];
    let stability = Schema::new(names.into_iter().zip(shapes.each_ref().map(FileSchema::of_table)));
    let stability = serde_json::to_value(stability).unwrap();
    let paper = serde_json::to_value(sumo_mfc::paper::schema()).unwrap();
    let mut page = String::from(
        "# Columns of the result files\n\n\
         `schema.json` in every result folder says the same about the files beside it. An empty field (in JSON `null`) is no\n\
         value. V_x is the body's true speed, y_ref the reference, e = V_x − y_ref, v\\* the speed that SUMO chose.\n\n\
         This page is made by `UPDATE=1 cargo test --test columns`.\n",
    );
    for name in FILES {
        let file = [&run, &study, &paper, &tune, &stability].into_iter().find_map(|schema| schema["files"].get(name));
        let file = file.unwrap_or_else(|| panic!("no {name} in the schemas"));
        let (heading, columns) = if let Value::Array(columns) = &file["columns"] {
            ("column", columns)
        } else {
            ("field", file["fields"].as_array().unwrap())
        };
        let meaning = file["meaning"].as_str().unwrap();
        write!(page, "\n## `{name}`\n\n{meaning}.\n\n| {heading} | type | unit | meaning |\n|---|---|---|---|\n")
            .unwrap();
        for column in columns {
            let text = |key: &str| column[key].as_str().unwrap_or_default().replace('|', "\\|").replace('*', "\\*");
            assert!(!text("meaning").is_empty(), "{column} has no meaning");
            writeln!(page, "| `{}` | {} | {} | {} |", text("name"), text("type"), text("unit"), text("meaning"))
                .unwrap();
        }
    }
    page
}

#[test]
fn the_page_of_columns_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/columns.md");
    if std::env::var_os("UPDATE").is_some() {
        fs::write(&path, page()).unwrap();
    }
    let written = fs::read_to_string(&path).unwrap_or_default();
    assert!(written == page(), "docs/columns.md is not up to date: UPDATE=1 cargo test --test columns");
}
