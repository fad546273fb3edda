//! A foreign `.sumocfg`, read as SUMO reads it: every element of whatever section is an option, its `value` (or `v`, or
//! its text) the option's value, file names are relative to the configuration's folder.

use std::{
    ops::Range,
    path::{Path, PathBuf},
    sync::Arc,
};

use quick_xml::{XmlVersion, events::Event};

use super::{
    error::SumoFileError,
    options::{canonical, list},
    path::{absolute, environment},
    xml::{self, Item, Xml, attribute},
};
use crate::place::{Origin, Place};

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
    pub fn read(path: &Path) -> Result<Self, SumoFileError> {
        let text = xml::text(path)?;
        let folder = absolute(Path::new(""), path.parent().unwrap_or(Path::new("")));
        let origin = Arc::new(Origin { name: path.display().to_string(), text, folder, argument: false });
        let settings = settings(path, &origin)?;
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

fn settings(path: &Path, origin: &Arc<Origin>) -> Result<Vec<Setting>, SumoFileError> {
    let mut xml = Xml::of(path, &origin.text);
    let mut settings = Vec::new();
    let mut open: Option<(String, usize, String)> = None;
    let mut add = |name: &str, value: String, span: Range<usize>| {
        let (name, written) = (canonical(name).to_owned(), name.to_owned());
        settings.push(Setting { name, written, value, span });
    };
    let syntax = |error| match error {
        SumoFileError::Content { line, what, .. } => {
            let at = origin.text.split_inclusive('\n').take(line - 1).map(str::len).sum();
            SumoFileError::Syntax { place: Place { origin: origin.clone(), span: at..at }, message: what }
        }
        other => other,
    };
    while let Some(Item { event, span, .. }) = xml.next().map_err(syntax)? {
        match event {
            Event::Start(tag) | Event::Empty(tag) => {
                let name = tag.name().into_inner();
                match attribute(&tag, "value").or_else(|| attribute(&tag, "v")) {
                    Some(value) => add(name, value, span),
                    None => open = Some((name.to_owned(), span.start, String::new())),
                }
            }
            Event::Text(text) => {
                if let Some((_, _, value)) = &mut open {
                    value.push_str(&text.xml_content(XmlVersion::Implicit1_0));
                }
            }
            Event::End(_) => {
                if let Some((name, from, value)) = open.take().filter(|o| !o.2.trim().is_empty()) {
                    add(&name, value.trim().to_owned(), from..span.end);
                }
            }
            _ => {}
        }
    }
    if xml.is_whole() { Ok(settings) } else { Err(syntax(xml.breaks_off())) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Configuration, SumoFileError> {
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
    fn other_encodings_are_read() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.sumocfg");
        let text = "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<configuration>\n<n value=\"m\u{fc}hle.net.xml\"/></configuration>";
        std::fs::write(&path, text.chars().map(|c| c as u8).collect::<Vec<u8>>()).unwrap();
        let configuration = Configuration::read(&path).unwrap();
        assert_eq!(configuration.files("net-file"), [dir.path().join("m\u{fc}hle.net.xml")]);
        assert_eq!(configuration.place(&configuration.settings[0]).line(), 3);
    }

    #[test]
    fn broken_xml_names_the_line() {
        let error = read("<configuration>\n<input>\n<net-file value=\"x\"/>\n</configuration>").unwrap_err();
        assert!(error.to_string().contains("a.sumocfg:4: not XML"), "{error}");
        let error = read("<configuration>\n<input>\n<net-file value=\"x\"/>").unwrap_err();
        assert!(error.to_string().contains("a.sumocfg:3: not XML as SUMO writes it: the file breaks off"), "{error}");
    }
}
