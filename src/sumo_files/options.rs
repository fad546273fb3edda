//! SUMO's options: their long names, which of them name files, and how their values are written.

use std::{
    collections::{BTreeMap, HashMap},
    ops::Range,
    sync::LazyLock,
};

/// Options that name inputs or settings, one on a line with its synonyms: all that SUMO 1.15 and 1.28 have
/// (`sumo --save-template`) but [`OUTPUTS`] and [`REFUSED`].
const SETTINGS: &str = include_str!("settings.txt");

/// Options with which SUMO writes a file, or prints something, and ends without simulating.
const REFUSED: &[(&str, &[&str])] = &[
    ("save-configuration", &["C", "save-config"]),
    ("save-template", &[]),
    ("save-schema", &[]),
    ("help", &["?"]),
    ("version", &["V"]),
    ("print-options", &[]),
];

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
    ("pedestrian.jupedsim.wkt", &[]),
    ("pedestrian.jupedsim.py", &[]),
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
pub(super) const INPUTS: [&str; 5] = ["net-file", "route-files", "additional-files", "weight-files", "load-state"];

/// What an option does with files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Effect {
    /// It reads a file, or names none.
    Reads,
    /// It names files to write.
    Writes,
    /// With it SUMO does not simulate.
    Refused,
    /// SUMO 1.15 to 1.28 do not have it.
    Unknown,
}

/// The long names of all names that are known.
static LONG_NAMES: LazyLock<HashMap<&str, &str>> = LazyLock::new(|| {
    let settings = SETTINGS.lines().filter_map(|line| {
        let mut names = line.split(' ');
        Some((names.next()?, names.collect::<Vec<_>>()))
    });
    let others = [OUTPUTS, REFUSED].into_iter().flatten().map(|(long, synonyms)| (*long, synonyms.to_vec()));
    settings.chain(others).flat_map(|(long, names)| names.into_iter().chain([long]).map(move |n| (n, long))).collect()
});

/// The long name of an option.
pub(super) fn canonical(name: &str) -> &str {
    LONG_NAMES.get(name).copied().unwrap_or(name)
}

/// Whether an option (by its long name) names files to write.
pub(super) fn writes(name: &str) -> bool {
    [".output", "-output"].iter().any(|end| name.ends_with(end)) || OUTPUTS.iter().any(|(long, _)| *long == name)
}

/// What an option (by its long name) does with files.
pub(super) fn effect(name: &str) -> Effect {
    match LONG_NAMES.contains_key(name) {
        _ if writes(name) => Effect::Writes,
        _ if REFUSED.iter().any(|(long, _)| *long == name) => Effect::Refused,
        true => Effect::Reads,
        false => Effect::Unknown,
    }
}

/// What is wanted of an option (by its long name) of somebody who may write below the results only; `None` if it is fine.
pub(super) fn objection(name: &str, value: &str) -> Option<&'static str> {
    // A number, a switch or a word. A file name has a folder or an ending.
    let plain = value.parse::<f64>().is_ok() || !value.contains(['/', '\\', '.', '$']);
    match effect(name) {
        Effect::Refused => Some("no such option: with it SUMO does not simulate"),
        Effect::Unknown if !plain => Some(
            "an option that SUMO 1.15 to 1.28 have: this one may write the file (behind -- it is the user's to give)",
        ),
        Effect::Writes if list(value).any(is_socket) => Some(A_FILE),
        _ if name == AFFIXES[2] && value.contains(['/', '\\']) => Some("a suffix without folder"),
        _ => None,
    }
}

/// Options that change the names of files to write.
pub(super) const AFFIXES: [&str; 3] = ["output-prefix", "output-suffix", "save-state.suffix"];

/// The items of a list as SUMO writes it.
pub(super) fn list(value: &str) -> impl Iterator<Item = &str> {
    value.split([',', ';']).map(str::trim).filter(|item| !item.is_empty())
}

/// What is wanted in place of a socket.
pub(super) const A_FILE: &str = "a file name: to an address (HOST:PORT) SUMO would send it over the network";

/// Whether SUMO would send an output of this name to a socket, and not just complain of it. To SUMO any name with a colon
/// is one, but for a drive letter (`FileHelpers::isSocket`); what has no port behind the colon becomes a file here.
pub(super) fn is_socket(value: &str) -> bool {
    let has_port = |(host, port): (&str, &str)| host.len() > 1 && port.trim().parse::<u16>().is_ok();
    value.split_once(':').is_some_and(has_port)
        || value.starts_with('[') && value.rsplit_once(':').is_some_and(has_port)
}

/// Standard streams and the void.
pub(super) fn is_no_file(value: &str) -> bool {
    let streams = ["", "-", "stdout", "STDOUT", "stderr", "STDERR", "nul", "NUL"];
    streams.contains(&value) || ["/dev/null", "/dev/stdout", "/dev/stderr"].contains(&value)
}

/// A time as SUMO writes it, in seconds or as `[DAYS:]HOURS:MINUTES:SECONDS` \[s\].
pub(super) fn seconds(value: &str) -> Option<f64> {
    if let Some(positive) = value.strip_prefix('-') {
        return seconds(positive).map(|time_s| -time_s);
    }
    let parts: Vec<f64> = value.split(':').map(|part| part.trim().parse().ok()).collect::<Option<_>>()?;
    match parts[..] {
        [seconds] => Some(seconds),
        [hours, minutes, seconds] => Some(60.0 * (60.0 * hours + minutes) + seconds),
        [days, hours, minutes, seconds] => Some(60.0 * (60.0 * (24.0 * days + hours) + minutes) + seconds),
        _ => None,
    }
}

/// SUMO's booleans.
pub(super) fn is_true(value: &str) -> bool {
    ["1", "yes", "true", "on", "x", "t"].contains(&value.to_lowercase().as_str())
}

/// What a text says as SUMO's boolean.
pub(crate) fn boolean(value: &str) -> Option<bool> {
    let no = ["0", "no", "false", "off", "-", "f"].contains(&value.to_lowercase().as_str());
    if is_true(value) { Some(true) } else { no.then_some(false) }
}

/// The user's options by long name.
pub(super) fn given(options: &[String]) -> BTreeMap<String, String> {
    words(options).map(|(name, value, _)| (name, value)).collect()
}

/// The first of the user's options that says where SUMO writes something.
pub(crate) fn named_output(options: &[String]) -> Option<String> {
    let names = |name: &String| writes(name) || AFFIXES[..2].contains(&name.as_str());
    given(options).into_keys().find(names).map(|name| format!("--{name}"))
}

/// The folder of the results in a value of `sumo.options`.
pub(super) const RESULTS: &str = "${RESULTS}/";

/// What is wrong with options that a scenario brings along, which may write below the results only.
pub(crate) fn refused_of_file(options: &[String]) -> Option<(String, &'static str)> {
    words(options).find_map(|(name, value, range)| {
        let word = &options[range.start];
        // SUMO takes letters behind one dash for as many options.
        let many = !word.starts_with("--") && word.split('=').next().is_some_and(|letters| letters.chars().count() > 2);
        let wanted = match objection(&name, &value) {
            _ if many => "each option in a text of its own, by its long name",
            None if writes(&name) && value.is_empty() => "a file name with it",
            wanted => wanted?,
        };
        Some((options[range].join(" "), wanted))
    })
}

/// The options of a scenario so that their outputs go below the results, and a line on each that did not say so.
pub(crate) fn below_results(options: &[String]) -> (Vec<String>, Vec<String>) {
    let (mut kept, mut notes) = (options.to_vec(), Vec::new());
    for (name, value, range) in words(options).filter(|(name, ..)| writes(name) || AFFIXES.contains(&name.as_str())) {
        let last = |file: &str| file.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
        let below = if AFFIXES.contains(&name.as_str()) {
            last(&value)
        } else {
            let place = |file| if is_no_file(file) { file.to_owned() } else { format!("{RESULTS}{}", last(file)) };
            list(&value).map(place).collect::<Vec<_>>().join(",")
        };
        if below != value {
            notes.push(format!("--{name} {value} is written as {below}"));
            // A word of its own, or what follows the sign =.
            let word = &mut kept[range.end - 1];
            *word = format!("{}{below}", word.strip_suffix(value.as_str()).unwrap_or_default());
        }
    }
    let given = given(options);
    let has = |names: [&str; 2]| names.iter().any(|name| given.contains_key(*name));
    if has(["save-state.times", "save-state.period"]) && !has(["save-state.prefix", "save-state.files"]) {
        kept.extend(["--save-state.prefix".to_owned(), format!("{RESULTS}state")]);
    }
    (kept, notes)
}

/// The same options with the names of files below the results that `place` gives.
pub(super) fn placed(options: &[String], mut place: impl FnMut(&str) -> String) -> Vec<String> {
    let mut placed = options.to_vec();
    for (.., value, range) in words(options).filter(|(_, value, _)| value.contains(RESULTS)) {
        let mut file = |file: &str| file.strip_prefix(RESULTS).map_or_else(|| file.to_owned(), &mut place);
        let files = list(&value).map(&mut file).collect::<Vec<_>>().join(",");
        let word = &mut placed[range.end - 1];
        *word = format!("{}{files}", word.strip_suffix(value.as_str()).unwrap_or_default());
    }
    placed
}

/// The user's options but one.
pub(super) fn without(options: &[String], option: &str) -> Vec<String> {
    let dropped: Vec<_> = words(options).filter(|(name, ..)| name == option).map(|(.., range)| range).collect();
    let kept = options.iter().enumerate().filter(|(i, _)| !dropped.iter().any(|range| range.contains(i)));
    kept.map(|(_, word)| word.clone()).collect()
}

/// The user's options with the words that they take. A word that starts with a dash and is no number begins an option.
pub(super) fn words(options: &[String]) -> impl Iterator<Item = (String, String, Range<usize>)> {
    let begins = |i: usize| options[i].starts_with('-') && options[i].parse::<f64>().is_err();
    (0..options.len()).filter(move |i| begins(*i)).map(move |i| {
        let name = options[i].trim_start_matches('-');
        let (name, value, end) = match name.split_once('=') {
            Some((name, value)) => (name, value.to_owned(), i + 1),
            None if i + 1 < options.len() && !begins(i + 1) => (name, options[i + 1].clone(), i + 2),
            None => (name, String::new(), i + 1),
        };
        (canonical(name).to_owned(), value, i..end)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_are_known_by_any_name() {
        for name in ["tripinfo", "fcd-output", "l", "device.ssm.file", "a-new-output", "save-state.prefix"] {
            assert!(writes(canonical(name)), "{name}");
        }
        for name in ["C", "save-schema", "?"] {
            assert_eq!(effect(canonical(name)), Effect::Refused, "{name}");
        }
        for name in ["r", "seed", "device.fcd-replay.files", "output-prefix"] {
            assert_eq!(effect(canonical(name)), Effect::Reads, "{name}");
        }
        for name in ["net-file", "tripinfo-output.write-unfinished", "output-prefix", "precision"] {
            assert!(!writes(canonical(name)), "{name}");
        }
    }

    #[test]
    fn law_every_option_is_on_one_list_once() {
        let names: Vec<&str> = SETTINGS.split_whitespace().collect();
        let others = [OUTPUTS, REFUSED].into_iter().flatten().flat_map(|(long, more)| more.iter().chain([long]));
        let all: std::collections::BTreeSet<&str> = names.iter().chain(others.clone()).copied().collect();
        assert_eq!(all.len(), names.len() + others.count());
        let long = SETTINGS.lines().map(|line| line.split(' ').next().unwrap());
        assert!(long.clone().is_sorted() && long.count() > 400);
        assert!(INPUTS.iter().all(|option| effect(option) == Effect::Reads));
    }

    #[test]
    fn options_of_a_newer_sumo_pass_unless_they_may_write() {
        for (value, passes) in [("0.5", true), ("true", true), ("greedy", true), ("x.xml", false), ("/a/b", false)] {
            assert_eq!(objection("brand-new", value).is_none(), passes, "{value}");
            assert!(objection("net-file", value).is_none());
        }
        assert!(objection("save-template", "x").is_some() && objection("save-state.suffix", "/x").is_some());
        assert!(objection("fcd-output", "/a/b.xml").is_none(), "it is redirected");
    }

    #[test]
    fn a_socket_is_what_sumo_takes_for_one() {
        for value in ["localhost:9", "127.0.0.1:65535", "[::1]:9", "out/x:9"] {
            assert!(is_socket(value) && objection("fcd-output", value).is_some(), "{value}");
            assert!(objection("log", &format!("a.xml,{value}")).is_some(), "{value}");
            assert!(objection("begin", value).is_none(), "{value} is no output");
        }
        for value in ["x.xml", "c:9", ":9", "a:99999", "out/12:00.xml", "a:b:9", "stdout"] {
            assert!(!is_socket(value), "{value}");
        }
    }

    #[test]
    fn the_users_words_are_taken_apart_and_one_option_is_left_out() {
        let options =
            ["-a", "x.xml,y.xml", "--time-to-teleport", "-1", "--ignore-route-errors", "--seed=3"].map(str::to_owned);
        let expected = [
            ("additional-files", "x.xml,y.xml"),
            ("ignore-route-errors", ""),
            ("seed", "3"),
            ("time-to-teleport", "-1"),
        ];
        assert_eq!(given(&options), expected.map(|(a, b)| (a.to_owned(), b.to_owned())).into());
        assert_eq!(without(&options, "additional-files"), options[2..]);
        assert_eq!(without(&options, "ignore-route-errors"), [&options[..4], &options[5..]].concat());
    }

    #[test]
    fn what_a_scenario_writes_goes_below_the_results() {
        let options = ["--fcd-output", "/abs/x.xml", "--log=../y", "--output-prefix", "../z_", "-l", "NUL"];
        let (kept, notes) = below_results(&options.map(str::to_owned));
        let below = ["--fcd-output", "${RESULTS}/x.xml", "--log=${RESULTS}/y", "--output-prefix", "z_", "-l", "NUL"];
        assert_eq!(kept, below);
        assert_eq!(notes.len(), 3);
        assert_eq!(below_results(&kept), (kept.clone(), Vec::new()));
        let placed = placed(&kept, |name| format!("/r/{name}"));
        assert_eq!(placed[1..3], ["/r/x.xml", "--log=/r/y"]);
        for (options, refused) in [
            (&["--scale", "2", "-b", "3", "-v"][..], false),
            (&["--save-template", "x"], true),
            (&["-vl", "x"], true),
            (&["--fcd-output", "-x.xml"], true),
            (&["--fcd-output", "--x.xml"], true),
            (&["--brand-new=/x"], true),
        ] {
            let options: Vec<String> = options.iter().map(|word| (*word).to_owned()).collect();
            assert_eq!(refused_of_file(&options).is_some(), refused, "{options:?}");
        }
    }

    #[test]
    fn times_are_read_as_sumo_writes_them() {
        assert_eq!(
            ["90.5", "0:05:00", "1:00:00:01", "-1", "-00:00:01", "x", "1:2"].map(seconds),
            [Some(90.5), Some(300.0), Some(86401.0), Some(-1.0), Some(-1.0), None, None]
        );
    }
}
