//! Columns as JSON that is small: numbers as whole multiples of a power of ten, repeated words as places in a list.

use super::table::{Column, Values};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Digits that are kept of the largest number of a column, unless a typical one has enough with less.
const LARGEST: f64 = 5.0;
/// Digits that are kept of the median.
const TYPICAL: f64 = 4.0;
/// Decimals that a time keeps: SUMO's are whole milliseconds.
const TIME_DECIMALS: i32 = 3;

/// These rows of a column: `values` are numbers times 10^`decimals` (`null` = none), places in `words`, or texts.
pub fn packed(column: &Column, rows: &[usize]) -> Value {
    let info = &column.info;
    let (name, unit, meaning) = (&info.name, info.unit.as_deref().unwrap_or(""), &info.meaning);
    match &column.values {
        Values::Numbers(numbers) => {
            let decimals = decimals(rows.iter().map(|row| numbers[*row]), unit == "s");
            let values: Vec<Value> = rows.iter().map(|row| whole(numbers[*row], decimals)).collect();
            json!({ "name": name, "unit": unit, "meaning": meaning, "decimals": decimals, "values": values })
        }
        Values::Texts(texts) => {
            let mut places = BTreeMap::new();
            for row in rows {
                places.entry(texts[*row].as_str()).or_insert(0);
            }
            if places.len() * 2 > rows.len() {
                let values: Vec<&str> = rows.iter().map(|row| texts[*row].as_str()).collect();
                return json!({ "name": name, "unit": unit, "meaning": meaning, "values": values });
            }
            places.values_mut().enumerate().for_each(|(place, value)| *value = place);
            let words: Vec<&str> = places.keys().copied().collect();
            let values: Vec<usize> = rows.iter().map(|row| places[texts[*row].as_str()]).collect();
            json!({ "name": name, "unit": unit, "meaning": meaning, "words": words, "values": values })
        }
    }
}

/// The decimals that show all of these numbers exactly, but no more than their largest needs for five digits or their
/// median for four.
fn decimals(numbers: impl Iterator<Item = f64> + Clone, time: bool) -> i32 {
    let numbers = numbers.filter(|x| x.is_finite());
    let mut sizes: Vec<f64> = numbers.clone().map(f64::abs).filter(|size| *size > 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    let decimals = |size: Option<&f64>, digits: f64| {
        digits - 1.0 - libm::floor(libm::log10(size.map_or(1.0, |size| size.max(1e-9))))
    };
    let enough = decimals(sizes.last(), LARGEST).min(decimals(sizes.get(sizes.len() / 2), TYPICAL));
    let enough = (enough as i32).clamp(if time { TIME_DECIMALS } else { 0 }, 9);
    let exact = |decimals: &i32| {
        let factor = libm::pow(10.0, f64::from(*decimals));
        numbers.clone().all(|x| (x * factor - (x * factor).round()).abs() < 1e-6)
    };
    (0..enough).find(exact).unwrap_or(enough)
}

fn whole(number: f64, decimals: i32) -> Value {
    if !number.is_finite() {
        return Value::Null;
    }
    json!((number * libm::pow(10.0, f64::from(decimals))).round() as i64)
}

#[cfg(test)]
mod tests {
    use super::super::table::ColumnInfo;
    use super::*;

    fn column(unit: &str, values: Values) -> Column {
        let info =
            ColumnInfo { name: "x".into(), kind: "number".into(), unit: Some(unit.into()), meaning: String::new() };
        Column { info, values }
    }

    #[test]
    fn numbers_keep_four_digits_and_times_their_milliseconds() {
        let of = |unit: &str, values: &[f64]| packed(&column(unit, Values::Numbers(values.to_vec())), &[0, 1]);
        let errors = of("m/s", &[0.123_456_78, f64::NAN]);
        assert_eq!((&errors["decimals"], &errors["values"]), (&json!(4), &json!([1235, null])));
        let times = of("s", &[1234.1, 99_999.123]);
        assert_eq!((&times["decimals"], &times["values"]), (&json!(3), &json!([1_234_100, 99_999_123])));
        let counts = of("", &[3.0, 40.0]);
        assert_eq!((&counts["decimals"], &counts["values"]), (&json!(0), &json!([3, 40])));
    }

    #[test]
    fn repeated_words_are_written_once() {
        let texts = Values::Texts(["car", "bus", "car", "car"].map(String::from).to_vec());
        let packed = packed(&column("", texts), &[0, 1, 2, 3]);
        assert_eq!((&packed["words"], &packed["values"]), (&json!(["bus", "car"]), &json!([1, 0, 1, 1])));
    }
}
