//! Values as text.

use crate::table::Cell;
use std::fmt::Write;

/// Appends a value; nothing if there is none.
pub fn append(text: &mut String, cell: Cell<'_>) {
    match cell {
        Cell::Text(None) | Cell::Number(None) => {}
        Cell::Text(Some(value)) => text.push_str(value),
        Cell::Number(Some(value)) => append_number(text, value),
        Cell::Count(value) => text.push_str(&value.to_string()),
        Cell::Flag(value) => text.push_str(if value { "true" } else { "false" }),
    }
}

/// Appends the shortest text that reads back as the same double: digits, and an exponent only for magnitudes below 1e-5
/// or from 1e16 on, as Python and pandas write and read them. Negative zero is written 0.
fn append_number(text: &mut String, value: f64) {
    let magnitude = value.abs();
    let plain = magnitude == 0.0 || (1e-5..1e16).contains(&magnitude);
    let value = if magnitude == 0.0 { 0.0 } else { value };
    let written = if plain { write!(text, "{value}") } else { write!(text, "{value:e}") };
    written.expect("writing to a String cannot fail");
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    fn text(value: f64) -> String {
        let mut text = String::new();
        super::append_number(&mut text, value);
        text
    }

    #[test]
    fn val_as_python_prints_them() {
        // Python: repr(x), without the trailing ".0" and the leading zero of the exponent.
        for (value, wanted) in [
            (0.1, "0.1"),
            (-0.0, "0"),
            (5.0, "5"),
            (1.0 / 3.0, "0.3333333333333333"),
            (25_205.1, "25205.1"),
            (1e-7, "1e-7"),
            (-2.5e300, "-2.5e300"),
        ] {
            assert_eq!(text(value), wanted);
        }
    }

    proptest! {
        #[test]
        fn law_reads_back_as_the_same_double(value in proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL) {
            let text = text(value);
            prop_assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
            prop_assert!(text.len() <= 26);
        }
    }
}
