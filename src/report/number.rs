//! Numbers for readers.

/// Four significant digits, without an exponent where the number can be read without; whole numbers whole.
pub fn sensible(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let size = value.abs();
    if value == value.round() && size < 1e9 {
        return format!("{:.0}", value + 0.0);
    }
    if !(1e-6..1e9).contains(&size) {
        return format!("{value:.3e}");
    }
    let digits = (3.0 - libm::floor(libm::log10(size))).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

/// The same with a sign, for differences.
pub fn signed(value: f64) -> String {
    let text = sensible(value);
    if value > 0.0 { format!("+{text}") } else { text }
}

/// A value, or a dash.
pub fn or_dash(value: Option<f64>) -> String {
    value.map_or("–".to_owned(), sensible)
}

/// A count with its noun.
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_a_reader_needs() {
        let shown = [0.0, -0.0, 3.0, 0.008896362, 1362.129174, 0.1 + 0.2, 123456.7, 2.5e-9, f64::NAN].map(sensible);
        assert_eq!(shown, ["0", "0", "3", "0.008896", "1362", "0.3000", "123457", "2.500e-9", "–"]);
        assert_eq!([0.5, -0.5, 0.0].map(signed), ["+0.5000", "-0.5000", "0"]);
    }
}
