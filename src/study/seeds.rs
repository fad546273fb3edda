//! Seeds on the command line.

/// Most seeds of one comparison: more is a slip of the finger.
const MOST: u64 = 100_000;

/// A list of seeds that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("seeds \"{text}\": {what}; write 1..5 (five seeds) or 3,8,12")]
pub struct SeedsError {
    text: String,
    what: String,
}

/// Reads `1..5` (both ends included), `3,8,12`, or a mixture.
///
/// # Errors
/// [`SeedsError`] if a part is no number or range, a range runs backwards, or a seed comes twice: the same run counted
/// twice would make the spread look smaller than it is.
pub fn parse_seeds(text: &str) -> Result<Vec<u64>, SeedsError> {
    let error = |what: String| SeedsError { text: text.to_owned(), what };
    let number = |part: &str| part.trim().parse::<u64>().map_err(|_| error(format!("\"{part}\" is not a seed")));
    let mut seeds = Vec::new();
    for part in text.split(',') {
        let (first, last) = part.split_once("..").unwrap_or((part, part));
        let (first, last) = (number(first)?, number(last)?);
        if first > last {
            return Err(error(format!("{first} comes after {last}")));
        }
        if last - first >= MOST {
            return Err(error(format!("more than {MOST} seeds")));
        }
        seeds.extend(first..=last);
    }
    let mut sorted = seeds.clone();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(error(format!("{} comes twice", pair[0]))),
        None => Ok(seeds),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_include_both_ends() {
        assert_eq!(parse_seeds("1..5").unwrap(), [1, 2, 3, 4, 5]);
        assert_eq!(parse_seeds("42").unwrap(), [42]);
        assert_eq!(parse_seeds("8, 3,10..11").unwrap(), [8, 3, 10, 11]);
    }

    #[test]
    fn what_is_no_list_of_seeds_is_refused() {
        for (text, what) in [
            ("", "is not a seed"),
            ("1..", "is not a seed"),
            ("a", "\"a\" is not a seed"),
            ("-1", "is not a seed"),
            ("5..1", "5 comes after 1"),
            ("1,2,1..3", "1 comes twice"),
            ("0..18446744073709551615", "more than 100000"),
        ] {
            let error = parse_seeds(text).unwrap_err().to_string();
            assert!(error.contains(what), "{text}: {error}");
        }
    }
}
