//! A foreign `.sumocfg`, read as SUMO reads it: every element of whatever section is an option, its `value` (or `v`, or
//! its text) the option's value, file names are relative to the configuration's folder.

use std::{
    ops::Range,
    path::{Path, PathBuf},
    sync::Arc,
};

use quick_xml::{
    Reader, XmlVersion,
    events::{BytesStart, Event},
};

use super::{
    error::{Origin, Place, ScenarioError},
    section::absolute,
};
use crate::traci::find_sumo;

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

/// One option of a configuration.
#[derive(Debug)]
pub(super) struct Setting {
    /// The option's long name.
    pub name: String,
    /// Its name in the file.
    pub written: String,
    /// Its value.
    pub value: String,
    /// Where it stands.
    pub span: Range<usize>,
}

/// A configuration.
#[derive(Debug)]
pub(super) struct Configuration {
    pub origin: Arc<Origin>,
    pub settings: Vec<Setting>,
}

impl Configuration {
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let text = read_text(path)?;
        let folder = absolute(Path::new(""), path.parent().unwrap_or(Path::new("")));
        let origin = Arc::new(Origin { name: path.display().to_string(), text, folder, argument: false });
        let settings = settings(&origin)?;
        Ok(Self { origin, settings })
    }

    /// The setting of an option, by its long name. The first one holds, as in SUMO.
    pub fn get(&self, name: &str) -> Option<&Setting> {
        self.settings.iter().find(|s| s.name == name)
    }

    /// The value of an option, by its long name.
    pub fn value(&self, name: &str) -> Option<&str> {
        self.get(name).map(|s| s.value.as_str())
    }

    /// Where a setting stands.
    pub fn place(&self, setting: &Setting) -> Place {
        Place { origin: self.origin.clone(), span: setting.span.clone() }
    }

    /// The files that an option names, absolute.
    pub fn files(&self, name: &str) -> Vec<PathBuf> {
        let value = self.value(name).unwrap_or_default();
        list(value).map(|f| absolute(&self.origin.folder, Path::new(&environment(f)))).collect()
    }
}

/// The items of a list as SUMO writes it.
pub(super) fn list(value: &str) -> impl Iterator<Item = &str> {
    value.split([',', ';']).map(str::trim).filter(|item| !item.is_empty())
}

/// SUMO's booleans.
pub(super) fn is_true(value: &str) -> bool {
    ["1", "yes", "true", "on", "x", "t"].contains(&value.to_lowercase().as_str())
}

/// Puts environment variables in place of `${NAME}`, as SUMO does. Unknown ones stay. `${SUMO_HOME}` is where SUMO was
/// found, if the variable is not set.
pub(super) fn environment(text: &str) -> String {
    let value = |name: &str| match std::env::var(name).ok().filter(|v| !v.is_empty()) {
        None if name == "SUMO_HOME" => {
            let home = find_sumo(None).ok()?.home?;
            Some(absolute(Path::new(""), &home).to_string_lossy().into_owned())
        }
        value => value,
    };
    let mut parts = text.split("${");
    let mut whole = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        match part.split_once('}').and_then(|(name, rest)| Some((value(name)?, rest))) {
            Some((value, rest)) => whole.extend([value.as_str(), rest]),
            None => whole.extend(["${", part]),
        }
    }
    whole
}

/// A text file in UTF-8 or, failing that, Latin-1, in which older SUMO tools wrote.
pub(super) fn read_text(path: &Path) -> Result<String, ScenarioError> {
    let bytes = std::fs::read(path).map_err(|reason| ScenarioError::Unreadable { path: path.to_owned(), reason })?;
    Ok(String::from_utf8(bytes).unwrap_or_else(|e| e.into_bytes().into_iter().map(char::from).collect()))
}

/// An attribute of an element.
pub(super) fn attribute(tag: &BytesStart<'_>, name: &str) -> Option<String> {
    let found = tag.attributes().with_checks(false).flatten().find(|a| a.key.as_ref() == name)?;
    Some(found.normalized_value(XmlVersion::Implicit1_0).map_or_else(|_| found.value.to_string(), |v| v.to_string()))
}

fn settings(origin: &Arc<Origin>) -> Result<Vec<Setting>, ScenarioError> {
    let mut reader = Reader::from_str(&origin.text);
    let mut settings = Vec::new();
    let mut open: Option<(String, usize, String)> = None;
    loop {
        let start = reader.buffer_position() as usize;
        let event = reader.read_event().map_err(|e| {
            let at = reader.error_position() as usize;
            ScenarioError::Syntax {
                place: Place { origin: origin.clone(), span: at..at },
                message: format!("not XML as SUMO writes it: {e}"),
            }
        })?;
        let end = reader.buffer_position() as usize;
        let mut add = |name: &str, value: String, span: Range<usize>| {
            let (name, written) = (canonical(name).to_owned(), name.to_owned());
            settings.push(Setting { name, written, value, span });
        };
        match event {
            Event::Start(tag) | Event::Empty(tag) => {
                let name = tag.name().as_ref().to_owned();
                match attribute(&tag, "value").or_else(|| attribute(&tag, "v")) {
                    Some(value) => add(&name, value, start..end),
                    None => open = Some((name, start, String::new())),
                }
            }
            Event::Text(text) => {
                if let Some((_, _, value)) = &mut open {
                    value.push_str(&text.xml_content(XmlVersion::Implicit1_0));
                }
            }
            Event::End(_) => {
                if let Some((name, from, value)) = open.take().filter(|o| !o.2.trim().is_empty()) {
                    add(&name, value.trim().to_owned(), from..end);
                }
            }
            Event::Eof => return Ok(settings),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Configuration, ScenarioError> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.sumocfg");
        std::fs::write(&path, text).unwrap();
        Configuration::read(&path)
    }

    #[test]
    fn options_are_found_by_any_name_and_in_any_form() {
        let configuration = read(
            "<?xml version=\"1.0\"?>\n<configuration>\n<!-- <seed value=\"1\"/> -->\n<input><n value=\"a&amp;b.net.xml\"/>\n\
             <routes v='x.xml, y.xml'/></input><b>10</b>\n<srand value=\"7\"/>\n</configuration>",
        )
        .unwrap();
        assert_eq!(configuration.value("net-file"), Some("a&b.net.xml"));
        assert_eq!(configuration.value("begin"), Some("10"));
        assert_eq!(configuration.value("seed"), Some("7"));
        let routes = configuration.files("route-files");
        assert_eq!(
            routes.iter().map(|p| p.file_name().unwrap().to_str().unwrap()).collect::<Vec<_>>(),
            ["x.xml", "y.xml"]
        );
        assert!(routes.iter().all(|p| p.is_absolute()));
        let setting = configuration.get("route-files").unwrap();
        assert_eq!((configuration.place(setting).line(), setting.written.as_str()), (5, "routes"));
    }

    #[test]
    fn broken_xml_names_the_line() {
        let error = read("<configuration>\n<input>\n<net-file value=\"x\"/>\n</configuration>").unwrap_err();
        assert!(error.to_string().contains("a.sumocfg:4: not XML"), "{error}");
    }

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
