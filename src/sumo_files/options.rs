//! SUMO's options: their long names, which of them name files, and how their values are written.

use std::collections::BTreeMap;

/// Options that name files to write, with their synonyms (SUMO 1.15 to 1.28). Newer options that end in `-output` are
/// recognised by that.
pub(super) const OUTPUTS: &[(&str, &[&str])] = &[
    ("netstate-dump", &["ndump", "netstate", "netstate-output"]),
    ("person-fcd-output", &["person-fcd"]),
    ("summary-output", &["summary"]),
    ("tripinfo-output", &["tripinfo"]),
    ("personinfo-output", &["personinfo"]),
    ("vehroute-output", &["vehroutes"]),
    ("personroute-output", &["personroutes"]),
    ("statistic-output", &["statistics-output"]),
    ("save-state.prefix", &[]),
    ("save-state.files", &[]),
    ("device.rerouting.output", &[]),
    ("device.taxi.dispatch-algorithm.output", &[]),
    ("device.taxi.idle-algorithm.output", &[]),
    ("device.ssm.file", &[]),
    ("device.toc.file", &[]),
    ("gui-testing.setting-output", &[]),
    ("log", &["l", "log-file"]),
    ("message-log", &[]),
    ("error-log", &[]),
];

/// Options that name files to read on which the results depend.
pub(super) const INPUTS: &[(&str, &[&str])] = &[
    ("net-file", &["n", "net"]),
    ("route-files", &["r", "routes"]),
    ("additional-files", &["a", "additional"]),
    ("weight-files", &["w", "weights"]),
    ("load-state", &[]),
];

/// Other options that matter here.
const OTHERS: &[(&str, &[&str])] = &[
    ("configuration-file", &["c", "configuration"]),
    ("begin", &["b"]),
    ("end", &["e"]),
    ("seed", &["srand"]),
    ("random", &["abs-rand"]),
    ("step-length", &[]),
    ("step-method.ballistic", &[]),
    ("output-prefix", &[]),
    ("output-suffix", &[]),
    ("no-step-log", &[]),
    ("start", &["S"]),
    ("quit-on-end", &["Q"]),
];

/// The long name of an option.
pub(super) fn canonical(name: &str) -> &str {
    [OUTPUTS, INPUTS, OTHERS]
        .into_iter()
        .flatten()
        .find(|(long, synonyms)| *long == name || synonyms.contains(&name))
        .map_or(name, |(long, _)| long)
}

/// Whether an option (by its long name) names files to write.
pub(super) fn writes(name: &str) -> bool {
    name.ends_with("-output") || OUTPUTS.iter().any(|(long, _)| *long == name)
}

/// The items of a list as SUMO writes it.
pub(super) fn list(value: &str) -> impl Iterator<Item = &str> {
    value.split([',', ';']).map(str::trim).filter(|item| !item.is_empty())
}

/// SUMO's booleans.
pub(super) fn is_true(value: &str) -> bool {
    ["1", "yes", "true", "on", "x", "t"].contains(&value.to_lowercase().as_str())
}

/// The user's options by long name. A word that starts with a dash and is no number begins an option.
pub(super) fn given(options: &[String]) -> BTreeMap<String, String> {
    let mut given = BTreeMap::new();
    let mut words = options.iter().peekable();
    while let Some(word) = words.next() {
        let Some(name) = word.strip_prefix("--").or_else(|| word.strip_prefix('-')) else { continue };
        let (name, value) = match name.split_once('=') {
            Some((name, value)) => (name, value.to_owned()),
            None => {
                let is_value = |w: &&String| !w.starts_with('-') || w.parse::<f64>().is_ok();
                (name, words.next_if(is_value).cloned().unwrap_or_default())
            }
        };
        given.insert(canonical(name).to_owned(), value);
    }
    given
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_are_known_by_any_name() {
        for name in ["tripinfo", "fcd-output", "l", "device.ssm.file", "a-new-output", "save-state.prefix"] {
            assert!(writes(canonical(name)), "{name}");
        }
        for name in ["net-file", "tripinfo-output.write-unfinished", "output-prefix", "precision"] {
            assert!(!writes(canonical(name)), "{name}");
        }
    }
}
