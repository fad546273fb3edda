//! A file rewritten so that it holds all its changes at once, each behind a question to the switch (mutant schemata).
//!
//! `a < b` becomes `match (&(a), &(b)) { (x, y) => if on(7) { *x <= *y } else { *x < *y } }`: operands stand once, however
//! many changes there are, and are evaluated as before. Comments name the changes of a stretch, so that a message of the
//! compiler tells which change does not compile.

use crate::list::Mutant;
use crate::sites::{Bytes, Kind, Site, Text, numbers, sites};
use std::collections::HashSet;

/// The switch, as the rewritten files call it.
const ON: &str = "crate::mutant_switch::on";

/// Rewrites a file for the changes `wanted` (number and change); gives the numbers of those that have found a place.
///
/// # Errors
/// When the file is not Rust.
pub fn rewrite(text: &str, wanted: &[(u32, &Mutant)]) -> Result<(String, HashSet<u32>), String> {
    let text = Text::new(text);
    let mut sites = sites(&text, wanted).map_err(|error| error.to_string())?;
    // Outer ones first; what is only put in comes before what begins there.
    sites.sort_by_key(|site| {
        let inner = !matches!(site.kind, Kind::Guard { .. });
        (site.bytes.start, !site.bytes.is_empty(), std::cmp::Reverse(site.bytes.end), inner)
    });
    let all: Vec<&Site> = sites.iter().collect();
    Ok((render(text.text, &all, 0..text.text.len()), numbers(&sites)))
}

/// The stretches of a rewritten file with the numbers of the changes that each holds, the innermost last.
pub fn marks(rewritten: &str) -> Vec<(Bytes, Vec<u32>)> {
    let (mut open, mut found) = (Vec::new(), Vec::new());
    let mut at = 0;
    while let Some(next) = rewritten[at..].find("/*m") {
        let start = at + next;
        let end = start + rewritten[start..].find("*/").map_or(2, |length| length + 2);
        if let Some(list) = rewritten[start..end].strip_prefix("/*m<") {
            let list = list.trim_end_matches("*/").split(',').filter_map(|number| number.parse().ok()).collect();
            open.push((start, list));
        } else if let Some((start, list)) = open.pop() {
            found.push((start..end, list));
        }
        at = end;
    }
    found.sort_by_key(|(bytes, _): &(Bytes, Vec<u32>)| std::cmp::Reverse(bytes.len()));
    found
}

/// The bytes of the text with the sites within them rewritten.
fn render(text: &str, sites: &[&Site], bytes: Bytes) -> String {
    let (mut written, mut at) = (String::new(), bytes.start);
    let mut rest: Vec<&Site> = sites.iter().copied().filter(|site| is_within(&site.bytes, &bytes)).collect();
    while !rest.is_empty() {
        let site = rest.remove(0);
        let inside = rest.iter().take_while(|other| is_within(&other.bytes, &site.bytes)).count();
        let inside: Vec<&Site> = if site.bytes.is_empty() { Vec::new() } else { rest.drain(..inside).collect() };
        written.push_str(&text[at..site.bytes.start]);
        written.push_str(&switched(text, site, &inside));
        at = site.bytes.end;
    }
    written + &text[at..bytes.end]
}

fn is_within(inner: &Bytes, outer: &Bytes) -> bool {
    inner.start >= outer.start && inner.end <= outer.end
}

fn marked(numbers: &[u32], code: &str) -> String {
    let list: Vec<String> = numbers.iter().map(u32::to_string).collect();
    format!("/*m<{}*/{code}/*m>*/", list.join(","))
}

/// `if on(7) { first } else if on(8) { second } else { otherwise }`
fn choice(changes: &[(u32, String)], changed: impl Fn(&str) -> String, otherwise: &str) -> String {
    let branch = |(number, replacement): &(u32, String)| {
        format!("if {ON}({number}) {{ {} }} else ", marked(&[*number], &changed(replacement)))
    };
    changes.iter().map(branch).collect::<String>() + &format!("{{ {otherwise} }}")
}

/// The code of one site, which chooses between what stands there and its changes.
fn switched(text: &str, site: &Site, inside: &[&Site]) -> String {
    let part = |bytes: &Bytes| render(text, inside, bytes.clone());
    let changes = &site.changes;
    let code = match &site.kind {
        Kind::Body => {
            let early = |(number, value): &(u32, String)| {
                marked(&[*number], &format!("if {ON}({number}) {{ return {value}; }}"))
            };
            return changes.iter().map(early).collect::<String>() + " ";
        }
        Kind::Arm => return format!(" if {}", marked(&[changes[0].0], &format!("!{ON}({})", changes[0].0))),
        Kind::Unary { operator, operand } => {
            let chosen = choice(changes, |_| "mm_a".into(), &format!("{operator}mm_a"));
            format!("(match ({}) {{ mm_a => {chosen} }})", part(operand))
        }
        Kind::Guard { delete } => {
            let chosen = choice(changes, str::to_string, &part(&site.bytes));
            let kept = delete.map(|number| format!("!{ON}({number}) && ")).unwrap_or_default();
            format!("{kept}({chosen})")
        }
        Kind::Field { name, value, base } => {
            let base = format!("({}).{name}", &text[base.clone()]);
            let value = value.as_ref().map_or(name.clone(), part);
            format!("{name}: ({})", choice(changes, |_| base.clone(), &value))
        }
        Kind::Binary { left, operator, right } => binary(operator, changes, &part(left), &part(right)),
    };
    let mut held: Vec<u32> = changes.iter().map(|change| change.0).collect();
    held.extend(if let Kind::Guard { delete } = site.kind { delete } else { None });
    marked(&held, &code)
}

/// An operator with its changes. Operands are evaluated as often and in the order as without changes.
fn binary(operator: &str, changes: &[(u32, String)], left: &str, right: &str) -> String {
    match operator {
        // && and || go on for one answer of the left side and stop for the other; the change swaps them.
        "&&" | "||" => {
            let stop = if operator == "&&" { "!=" } else { "==" };
            format!(
                "(match ({left}) {{ mm_a => if mm_a {stop} {ON}({}) {{ {right} }} else {{ mm_a }} }})",
                changes[0].0
            )
        }
        "==" | "!=" | "<" | "<=" | ">" | ">=" => {
            let chosen = choice(changes, |other| format!("*mm_a {other} *mm_b"), &format!("*mm_a {operator} *mm_b"));
            format!("(match (&({left}), &({right})) {{ (mm_a, mm_b) => {chosen} }})")
        }
        _ if operator.ends_with('=') => {
            let chosen = choice(changes, |other| format!("*mm_a {other} mm_b"), &format!("*mm_a {operator} mm_b"));
            format!("({{ let mm_b = {right}; match &mut ({left}) {{ mm_a => {chosen} }} }})")
        }
        _ => {
            let chosen = choice(changes, |other| format!("mm_a {other} mm_b"), &format!("mm_a {operator} mm_b"));
            format!("(match ({left}, {right}) {{ (mm_a, mm_b) => {chosen} }})")
        }
    }
}
