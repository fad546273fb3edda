//! Tables as text on stdout, for `--export`: a form is one file with one function, and one line in [`FORMS`].

mod csv;
mod json;
mod markdown;

use crate::registry::Entry;
use crate::table::{Cell, Column, Layout};

/// How a table is written as text.
#[derive(Debug, Clone, Copy)]
pub struct Form {
    /// The whole text, from the columns and the cells of each row.
    write: fn(&[Column], &[Vec<Cell<'_>>]) -> String,
    /// Whether people read it rather than programs: numbers are rounded, and what belongs together stands side by side.
    pub for_people: bool,
}

/// The forms by name.
pub static FORMS: &[Entry<Form>] = &[
    Entry {
        name: "md",
        summary: "a table of GitHub's Markdown",
        keys: &[],
        build: Form { write: markdown::text, for_people: true },
    },
    Entry {
        name: "json",
        summary: "an array of objects",
        keys: &[],
        build: Form { write: json::text, for_people: false },
    },
    Entry {
        name: "csv",
        summary: "comma-separated text, one header line, empty field = no value",
        keys: &[],
        build: Form { write: csv::text, for_people: false },
    },
];

impl Form {
    /// A table as text, which ends with a line break.
    pub fn text<'r, R: 'static>(&self, layout: &Layout<R>, rows: impl IntoIterator<Item = &'r R>) -> String {
        let cells: Vec<Vec<Cell<'_>>> = rows.into_iter().map(|row| layout.cells(row).collect()).collect();
        (self.write)(&layout.shape.columns, &cells)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::find;
    use crate::table::record;

    record! {
        /// A row with all kinds of values.
        #[derive(Debug)]
        pub struct Line {
            id: String = "An id";
            speed: Option<f64> = "A speed" ["m/s"];
            steps: u64 = "A count";
            whole: bool = "A flag";
        }
    }

    fn text(form: &str) -> String {
        let rows = [("a|b\n<c>", Some(12.345678), 3, true), ("d,\"e\"", None, 0, false)];
        let rows = rows.map(|(id, speed, steps, whole)| Line { id: id.to_owned(), speed, steps, whole });
        find("form", FORMS, form).unwrap().build.text(&Layout::of_record(["lines", "line"], "Lines"), &rows)
    }

    #[test]
    fn markdown_escapes_what_would_end_a_cell() {
        insta::assert_snapshot!(text("md"), @r#"
        | id | speed [m/s] | steps | whole |
        | :-- | --: | --: | --: |
        | a\|b<br>&lt;c> | 12.35 | 3 | true |
        | d,"e" |  | 0 | false |
        "#);
    }

    #[test]
    fn json_has_numbers_as_numbers_in_the_order_of_the_columns() {
        insta::assert_snapshot!(text("json"), @r#"
        [
          {
            "id": "a|b\n<c>",
            "speed": 12.345678,
            "steps": 3,
            "whole": true
          },
          {
            "id": "d,\"e\"",
            "speed": null,
            "steps": 0,
            "whole": false
          }
        ]
        "#);
    }

    #[test]
    fn csv_reads_back() {
        let text = text("csv");
        let rows: Vec<_> = ::csv::Reader::from_reader(text.as_bytes()).into_records().map(Result::unwrap).collect();
        assert_eq!(rows[0], vec!["a|b\n<c>", "12.345678", "3", "true"]);
        assert_eq!(rows[1], vec!["d,\"e\"", "", "0", "false"]);
        assert!(text.starts_with("id,speed,steps,whole\n"), "{text}");
    }
}
