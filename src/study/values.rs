//! The values that a key is varied over: a list, or a range.

use crate::place::Place;
use crate::scenario::{Entry, Mistake, Node, Wrong};

/// Most values of one range: more is a slip of the finger.
const MOST: f64 = 100_000.0;

/// What a key is varied over, as TOML literals.
pub fn values(key: &str, entry: &Entry) -> Result<Vec<String>, Mistake> {
    match &entry.node {
        Node::List(list) if list.is_empty() => {
            let what = Wrong::Value { found: "an empty list".to_owned(), wanted: "at least one value".to_owned() };
            Err(Mistake { place: entry.place.clone(), key: key.to_owned(), what })
        }
        Node::List(list) => Ok(list.iter().map(|value| value.node.literal()).collect()),
        Node::Text(text) => range(text).unwrap_or(Err(())).map_err(|()| entry.wrong(key, WANTED)),
        _ => Err(entry.wrong(key, WANTED)),
    }
}

const WANTED: &str = "a list of values, or a range \"FIRST..LAST\" or \"FIRST..LAST..STEP\" that ascends";

/// The values of an argument `V1,V2,...`: those of a TOML list, or words between commas; or a range.
pub fn argument(text: &str, place: &Place) -> Node {
    if range(text).is_some() {
        return Node::Text(text.to_owned());
    }
    match Node::of_argument(&format!("[{text}]"), place) {
        list @ Node::List(_) => list,
        _ => {
            let words = text.split(',').map(str::trim).filter(|word| !word.is_empty());
            let entry = |word| Entry { node: Node::of_argument(word, place), place: place.clone() };
            Node::List(words.map(entry).collect())
        }
    }
}

/// The numbers of a range, with as many decimals as it is written with; `None` if the text is none.
fn range(text: &str) -> Option<Result<Vec<String>, ()>> {
    let parts: Vec<&str> = text.split("..").map(str::trim).collect();
    let numbers: Vec<f64> = parts.iter().map_while(|part| part.parse().ok()).collect();
    let (&[first, last], step) = (numbers.get(..2)?.first_chunk()?, numbers.get(2).copied().unwrap_or(1.0));
    if numbers.len() != parts.len() || numbers.len() > 3 {
        return None;
    }
    let steps = ((last - first) / step + 1e-9).floor();
    if !(step > 0.0 && (0.0..MOST).contains(&steps)) {
        return Some(Err(()));
    }
    let decimals = parts.iter().map(|part| part.split_once('.').map_or(0, |(_, tail)| tail.len())).max().unwrap_or(0);
    Some(Ok((0..=steps as u64).map(|k| format!("{:.decimals$}", first + k as f64 * step)).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Vec<String>, String> {
        let place = Place::argument(text);
        values("key", &Entry { node: argument(text, &place), place }).map_err(|mistake| mistake.to_string())
    }

    #[test]
    fn lists_and_ranges_become_values() {
        for (text, wanted) in [
            ("plain, ideal", vec!["\"plain\"", "\"ideal\""]),
            ("share:0.25,share:1", vec!["\"share:0.25\"", "\"share:1\""]),
            ("0,0.1,true", vec!["0", "0.1", "true"]),
            ("adaptive,0.5", vec!["\"adaptive\"", "0.5"]),
            ("0..0.3..0.1", vec!["0.0", "0.1", "0.2", "0.3"]),
            ("-2..1", vec!["-2", "-1", "0", "1"]),
            ("0..1..0.4", vec!["0.0", "0.4", "0.8"]),
            ("../a.xml,../b.xml", vec!["\"../a.xml\"", "\"../b.xml\""]),
            ("{ min = 1, max = 2 },1500", vec!["{ \"max\" = 2, \"min\" = 1 }", "1500"]),
        ] {
            assert_eq!(of(text).unwrap(), wanted, "{text}");
        }
    }

    #[test]
    fn what_is_neither_is_refused() {
        for (text, wanted) in [
            ("", "found an empty list"),
            (",", "found an empty list"),
            ("3..1", "that ascends"),
            ("0..1..0", "that ascends"),
            ("0..1..-1", "that ascends"),
            ("0..1e9", "that ascends"),
        ] {
            assert!(of(text).unwrap_err().contains(wanted), "{text}: {:?}", of(text));
        }
    }
}
