//! What a page says of one number: ours, what the paper says, the verdict, and the reason for it.

use super::claims;
use super::published::{Published, Weight};
use super::results::{FACTOR, Results};
use super::row::Row;
use super::verdict::Verdict;
use crate::page::{Cell, Head};

/// How a verdict is shown.
pub fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Reproduced => "yes",
        Verdict::Partly => "part",
        Verdict::NotReproduced => "no",
    }
}

/// What the paper says: a number, a bound, or words.
pub fn published(row: &Row) -> String {
    match row.published() {
        Some(Published::AtMost(bound)) => format!("at most {bound}"),
        Some(Published::Number { value, .. }) => value.to_string(),
        None => claims::about(row).map(|claim| format!("“{}”", claim.words)).unwrap_or_default(),
    }
}

/// The unit in brackets; nothing for a plain number.
pub fn unit(row: &Row) -> String {
    if row.unit == "1" { String::new() } else { format!(" [{}]", row.unit.replace("m/s3", "m/s³")) }
}

/// The value, with its spread.
pub fn value(row: &Row) -> String {
    let digits = if row.unit == "m" || row.value.is_some_and(|v| v.abs() >= 100.0) { 0 } else { 2 };
    let spread = row.spread.map(|s| format!(" ± {s:.digits$}")).unwrap_or_default();
    row.value.map_or("none".to_owned(), |v| format!("{}{spread}", rounded(v, digits)))
}

/// The value in the colour of its verdict.
pub fn cell(row: &Row, results: &Results) -> Cell {
    Cell { text: value(row), class: results.verdict(row).map_or("", class) }
}

/// The columns of [`line`].
pub fn head() -> Vec<Head> {
    vec![
        Head::text("quantity", ""),
        Head::text("published", "what the paper says"),
        Head::number("ours", "mean ± standard deviation over the seeds where there is noise"),
        Head::text("verdict", ""),
        Head::text("why", "the number held against the rule"),
    ]
}

/// A quantity, the published number, ours, the verdict, and why.
pub fn line(words: String, row: &Row, results: &Results) -> Option<Vec<Cell>> {
    let verdict = results.verdict(row)?;
    Some(vec![
        Cell::words(words + &unit(row)),
        Cell::words(published(row)),
        Cell::number(value(row)),
        Cell::text(verdict.to_string()).shown_as(match verdict {
            Verdict::Reproduced => "text yes",
            Verdict::Partly => "text part",
            Verdict::NotReproduced => "text no",
        }),
        Cell::words(why(row, results)),
    ])
}

/// The verdict's reason: the number held against its rule.
pub fn why(row: &Row, results: &Results) -> String {
    if let (None, Some(claim)) = (row.published(), claims::about(row)) {
        return claim.why(row, &results.rows);
    }
    let (Some(ours), Some(published)) = (row.value, row.published()) else {
        return "It never got there.".to_owned();
    };
    let (value, within) = match published {
        Published::AtMost(bound) => {
            let side = if ours <= bound { "not above" } else { "above" };
            return format!("{ours:.1} {} is {side} {bound} {}.", row.unit, row.unit);
        }
        Published::Number { value, within } => (value, within),
    };
    let digits = if row.unit == "m/s" { 3 } else { 2 };
    let (apart, is_near) = ((ours - value).abs(), published.is_within_factor(FACTOR, ours));
    let agrees = published.agrees(ours);
    let ours = rounded(ours, digits);
    let weight = row.weight().filter(|weight| *weight != Weight::Fact);
    let weight = weight.map(|weight| format!(" It {weight}.")).unwrap_or_default();
    if agrees {
        return format!("{ours} is {apart:.digits$} from {value}, within {within:.digits$}.{weight}");
    }
    let far = if is_near { "" } else { ", nor within a factor of 2" };
    format!("{ours} is {apart:.digits$} from {value}, not within {within:.digits$}{far}{}{weight}", gain(row, results))
}

/// What an effect without its size rests on: how much less the adaptive law has, and how much less it would need.
fn gain(row: &Row, results: &Results) -> String {
    let of = |controller: &str| results.get(&row.test, &row.preset, row.noise, controller, row.quantity);
    let (Some(classic), Some(adaptive)) = (of("classic"), of("adaptive")) else {
        return "; there is no other law to compare it with.".to_owned();
    };
    let there = [classic, adaptive].map(|row| row.published().map_or(f64::NAN, Published::number));
    if !(there[0] > 0.0 && there[1].is_finite()) {
        return "; the paper has no gain in it.".to_owned();
    }
    let Some((classic, adaptive)) = classic.value.zip(adaptive.value) else {
        return "; one of the laws never got there.".to_owned();
    };
    let (here, there) = (adaptive / classic, there[1] / there[0]);
    // Half of the published gain, as `Results::verdict` has it.
    let limit = 1.0 - 0.5 * (1.0 - there);
    format!("; adaptive over classic is {here:.2}, published {there:.2}, partly up to {limit:.2}.")
}

/// No "-0.00".
fn rounded(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    if text.bytes().all(|b| b"-0.".contains(&b)) { text.trim_start_matches('-').to_owned() } else { text }
}
