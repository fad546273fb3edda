//! A foreign `.sumocfg`, read as SUMO reads it: every element of whatever section is an option, its `value` (or `v`, or
//! its text) the option's value, file names are relative to the configuration's folder.

use std::{
    ops::Range,
    path::{Path, PathBuf},
    sync::Arc,
};

use quick_xml::{
    XmlVersion,
    escape::resolve_predefined_entity,
    events::{BytesRef, BytesStart, Event},
};

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
        let text = xml::short_text(path)?;
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
    let syntax = |error| match error {
        SumoFileError::Content { line, what, .. } => {
            let at = origin.text.split_inclusive('\n').take(line - 1).map(str::len).sum();
            SumoFileError::Syntax { place: Place { origin: origin.clone(), span: at..at }, message: what }
        }
        other => other,
    };
    let mut loader = Loader::default();
    while let Some(Item { event, span, .. }) = xml.next().map_err(syntax)? {
        match event {
            Event::Start(tag) => loader.begin(&tag, span),
            Event::Empty(tag) => {
                loader.begin(&tag, span.clone());
                loader.end(span.end);
            }
            Event::Text(text) => loader.text.push_str(&text.xml_content(XmlVersion::Implicit1_0)),
            Event::CData(text) => loader.text.push_str(&text),
            Event::GeneralRef(name) => loader.text.extend(referred(&name)),
            Event::End(_) => loader.end(span.end),
            _ => {}
        }
    }
    if xml.is_whole() { Ok(loader.settings) } else { Err(syntax(xml.breaks_off())) }
}

/// What SUMO makes of a configuration (`OptionsLoader.cpp`): of an element every attribute `value` or `v` that is not
/// empty, then the text until an element ends, if it says anything. The name stays until a text was taken.
#[derive(Default)]
struct Loader {
    settings: Vec<Setting>,
    name: String,
    text: String,
    from: usize,
}

impl Loader {
    fn begin(&mut self, tag: &BytesStart<'_>, span: Range<usize>) {
        tag.name().into_inner().clone_into(&mut self.name);
        self.text.clear();
        self.from = span.start;
        for name in tag.attributes().with_checks(false).flatten().map(|found| found.key) {
            let name = name.into_inner();
            let value = attribute(tag, name).filter(|value| ["value", "v"].contains(&name) && !value.is_empty());
            self.settings.extend(value.map(|value| setting(&self.name, value, span.clone())));
        }
    }

    fn end(&mut self, at: usize) {
        if !self.name.is_empty() && !self.text.trim().is_empty() {
            let text = std::mem::take(&mut self.text);
            self.settings.push(setting(&self.name, text.trim().to_owned(), self.from..at));
            self.name.clear();
        }
    }
}

fn setting(written: &str, value: String, span: Range<usize>) -> Setting {
    Setting { name: canonical(written).to_owned(), written: written.to_owned(), value, span }
}

/// The character that a reference stands for: a number, or one of the five names of XML.
fn referred(reference: &BytesRef<'_>) -> Option<char> {
    let named = || resolve_predefined_entity(reference)?.chars().next();
    reference.resolve_char_ref().ok().flatten().or_else(named)
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
    fn law_settings_are_found_wherever_sumo_finds_them() {
        for body in [
            "<o v=\"x\" value=\"\"/>",
            "<o value=\"\">x</o>",
            "<o></o>x",
            "<o><![CDATA[x]]></o>",
            "<o>&#120;</o>",
            "<o v='x' value='y'/>",
        ] {
            let configuration = read(&format!("<configuration>{body}</configuration>")).unwrap();
            assert_eq!(configuration.value("o"), Some("x"), "{body}");
        }
        assert!(read("<!DOCTYPE c [<!ATTLIST o value CDATA \"x\">]><c><o/></c>").is_err());
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
