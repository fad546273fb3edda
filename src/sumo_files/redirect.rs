//! Everything that SUMO would write next to a foreign configuration goes below the run's own folder instead: options by
//! other values on the command line, detectors and the like by rewritten copies of their additional files.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use quick_xml::{
    Reader, Writer, XmlVersion,
    events::{BytesStart, Event},
};

use super::{
    configuration::{attribute, read_text},
    error::SumoFileError,
    path::absolute,
};

/// Attributes of additional files that name a file to write: element, attribute.
const WRITTEN: &[(&str, &str)] = &[
    ("edgeData", "file"),
    ("laneData", "file"),
    ("inductionLoop", "file"),
    ("e1Detector", "file"),
    ("instantInductionLoop", "file"),
    ("laneAreaDetector", "file"),
    ("e2Detector", "file"),
    ("entryExitDetector", "file"),
    ("e3Detector", "file"),
    ("routeProbe", "file"),
    ("vTypeProbe", "file"),
    ("timedEvent", "dest"),
    ("calibrator", "output"),
];

/// Attributes of any element that name a file to read.
const READ: &[&str] = &["href", "file", "imgFile", "osgFile", "shapeFile"];

/// Gives every file that SUMO would write a name of its own below `folder`.
#[derive(Debug)]
pub(super) struct Redirect {
    folder: PathBuf,
    prefix: String,
    taken: BTreeMap<String, PathBuf>,
}

impl Redirect {
    pub fn new(folder: &Path) -> Self {
        // What SUMO prints is kept under this name.
        let taken = BTreeMap::from([("console.log".to_owned(), PathBuf::new())]);
        Self { folder: folder.to_owned(), prefix: String::new(), taken }
    }

    /// Puts a configuration's output prefix before all names to come: its last component, without the time.
    pub fn take_prefix(&mut self, prefix: &str) {
        self.prefix = prefix.rsplit(['/', '\\']).next().unwrap_or_default().replace("TIME", "");
    }

    /// A file of our own beside the redirected ones.
    pub fn own(&mut self, name: &str) -> PathBuf {
        self.free(name, PathBuf::new())
    }

    /// The first free name like `name` for what was to be `original`; the same original keeps its name.
    fn free(&mut self, name: &str, original: PathBuf) -> PathBuf {
        let is_free = |name: &String| {
            let holder = self.taken.get(name);
            holder.is_none() || holder == Some(&original) && original != Path::new("")
        };
        let numbered = (2..).map(|n: u64| format!("{n}_{name}"));
        let name = std::iter::once(name.to_owned()).chain(numbered).find(is_free).unwrap_or_default();
        let target = self.folder.join(&name);
        self.taken.insert(name, original);
        target
    }

    /// Where `value`, named in a file in `from`, is written now. Names that are no files stay.
    pub fn target(&mut self, from: &Path, value: &str) -> String {
        if is_no_file(value) {
            return value.to_owned();
        }
        let original = absolute(from, Path::new(value));
        let name = original.file_name().map_or("output".to_owned(), |n| n.to_string_lossy().into_owned());
        self.free(&format!("{}{name}", self.prefix), original).to_string_lossy().into_owned()
    }

    /// The file to load in place of an additional file: itself, or its rewritten copy if it names files to write.
    pub fn additional(&mut self, file: &Path) -> Result<PathBuf, SumoFileError> {
        if is_compressed(file) || !names_outputs(file)? {
            return Ok(file.to_owned());
        }
        let text = self.rewritten(file, &read_text(file)?)?;
        let copy = self.folder.join(format!("additional-{}", self.taken.len()));
        let copy = PathBuf::from(self.target(&copy, &file.file_name().unwrap_or_default().to_string_lossy()));
        std::fs::create_dir_all(&self.folder)
            .and_then(|()| std::fs::write(&copy, text))
            .map_err(|reason| SumoFileError::Unwritable { path: copy.clone(), reason })?;
        Ok(copy)
    }

    fn rewritten(&mut self, file: &Path, text: &str) -> Result<Vec<u8>, SumoFileError> {
        let folder = file.parent().unwrap_or(Path::new("")).to_owned();
        let mut reader = Reader::from_str(text);
        let mut writer = Writer::new(Vec::new());
        let mut inside_light = false;
        let mut write = |event: Event<'_>| writer.write_event(event).map_err(|reason| unwritable(file, reason));
        loop {
            let event = reader.read_event().map_err(|e| broken(file, &e))?;
            match event {
                Event::Start(tag) => {
                    inside_light |= tag.name().as_ref() == "tlLogic";
                    write(Event::Start(self.tag(&tag, &folder, inside_light)?))?;
                }
                Event::Empty(tag) => write(Event::Empty(self.tag(&tag, &folder, inside_light)?))?,
                Event::End(tag) => {
                    inside_light &= tag.name().as_ref() != "tlLogic";
                    write(Event::End(tag))?;
                }
                // The copy is UTF-8, whatever the original says.
                Event::Decl(_) => {}
                Event::Eof => return Ok(writer.into_inner()),
                other => write(other)?,
            }
        }
    }

    /// The element with its files where they belong: written ones below our folder, read ones absolute.
    fn tag(
        &mut self,
        tag: &BytesStart<'_>,
        folder: &Path,
        inside_light: bool,
    ) -> Result<BytesStart<'static>, SumoFileError> {
        let element = tag.name().as_ref().to_owned();
        let light_output = inside_light && element == "param" && attribute(tag, "key").as_deref() == Some("file");
        let mut copy = BytesStart::new(element.clone());
        for found in tag.attributes().with_checks(false).flatten() {
            let name = found.key.as_ref();
            let value = found
                .normalized_value(XmlVersion::Implicit1_0)
                .map_or_else(|_| found.value.to_string(), |v| v.to_string());
            let value = if WRITTEN.contains(&(element.as_str(), name)) || (light_output && name == "value") {
                self.target(folder, &value)
            } else if element == "include" && name == "href" {
                self.additional(&absolute(folder, Path::new(&value)))?.to_string_lossy().into_owned()
            } else if READ.contains(&name) && absolute(folder, Path::new(&value)).is_file() {
                absolute(folder, Path::new(&value)).to_string_lossy().into_owned()
            } else {
                value
            };
            copy.push_attribute((name, value.as_str()));
        }
        Ok(copy)
    }
}

/// SUMO reads compressed files, we do not look into them.
pub(super) fn is_compressed(file: &Path) -> bool {
    file.extension().is_some_and(|e| e == "gz")
}

/// Standard streams, the void and network sockets (`host:port`).
pub(super) fn is_no_file(value: &str) -> bool {
    let socket = value.rsplit_once(':').is_some_and(|(host, port)| !host.contains('/') && port.parse::<u16>().is_ok());
    ["", "-", "stdout", "stderr", "nul", "/dev/null", "/dev/stdout", "/dev/stderr"]
        .contains(&value.to_lowercase().as_str())
        || socket
}

fn broken(file: &Path, error: &quick_xml::Error) -> SumoFileError {
    let reason = std::io::Error::new(std::io::ErrorKind::InvalidData, error.to_string());
    SumoFileError::Unreadable { path: file.to_owned(), reason }
}

fn unwritable(file: &Path, reason: std::io::Error) -> SumoFileError {
    SumoFileError::Unwritable { path: file.to_owned(), reason }
}

/// Calls `see` for every element of an XML file, with whether it stands inside a traffic light.
fn elements(
    file: &Path,
    mut see: impl FnMut(&BytesStart<'_>, bool) -> Result<(), SumoFileError>,
) -> Result<(), SumoFileError> {
    let text = read_text(file)?;
    let mut reader = Reader::from_str(&text);
    let mut inside_light = false;
    loop {
        match reader.read_event().map_err(|e| broken(file, &e))? {
            Event::Start(tag) => {
                inside_light |= tag.name().as_ref() == "tlLogic";
                see(&tag, inside_light)?;
            }
            Event::Empty(tag) => see(&tag, inside_light)?,
            Event::End(tag) => inside_light &= tag.name().as_ref() != "tlLogic",
            Event::Eof => return Ok(()),
            _ => {}
        }
    }
}

/// Whether a file, or one that it includes, names files to write.
fn names_outputs(file: &Path) -> Result<bool, SumoFileError> {
    let folder = file.parent().unwrap_or(Path::new("")).to_owned();
    let mut found = false;
    elements(file, |tag, inside_light| {
        let element = tag.name().as_ref().to_owned();
        found |= WRITTEN.iter().any(|(e, a)| *e == element && attribute(tag, a).is_some());
        found |= inside_light && element == "param" && attribute(tag, "key").as_deref() == Some("file");
        if let Some(href) = attribute(tag, "href").filter(|_| element == "include" && !found) {
            found = names_outputs(&absolute(&folder, Path::new(&href)))?;
        }
        Ok(())
    })?;
    Ok(found)
}

/// The files that an additional file reads: included ones and theirs, and definitions of single elements.
pub(super) fn included(file: &Path) -> Result<Vec<PathBuf>, SumoFileError> {
    included_by(file, &mut Vec::new())
}

fn included_by(file: &Path, above: &mut Vec<PathBuf>) -> Result<Vec<PathBuf>, SumoFileError> {
    let mut files = Vec::new();
    if is_compressed(file) {
        return Ok(files);
    }
    if above.iter().any(|f| f == file) {
        let reason = std::io::Error::new(std::io::ErrorKind::InvalidData, "it includes itself");
        return Err(SumoFileError::Unreadable { path: file.to_owned(), reason });
    }
    above.push(file.to_owned());
    let folder = file.parent().unwrap_or(Path::new("")).to_owned();
    elements(file, |tag, _| {
        let element = tag.name().as_ref().to_owned();
        for name in ["href", "file"] {
            let named = attribute(tag, name).filter(|_| !WRITTEN.contains(&(element.as_str(), name)));
            let Some(path) = named.map(|v| absolute(&folder, Path::new(&v))).filter(|p| p.is_file()) else { continue };
            if element == "include" {
                files.extend(included_by(&path, above)?);
            }
            files.push(path);
        }
        Ok(())
    })?;
    above.pop();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_every_file_has_a_name_of_its_own() {
        let mut redirect = Redirect::new(Path::new("/r"));
        let mut target = |from: &str, value: &str| redirect.target(Path::new(from), value);
        assert_eq!(target("/cfg", "a/out.xml"), "/r/out.xml");
        assert_eq!(target("/cfg", "b/out.xml"), "/r/2_out.xml");
        assert_eq!(target("/cfg/a", "out.xml"), "/r/out.xml", "the same file by another name");
        assert_eq!(target("/cfg", "statistics.xml"), "/r/statistics.xml");
        assert_eq!(target("/cfg", "console.log"), "/r/2_console.log");
        for none in ["NUL", "stdout", "-", "localhost:9000", "/dev/null"] {
            assert_eq!(target("/cfg", none), none);
        }
        assert_eq!(redirect.own("statistics.xml"), Path::new("/r/2_statistics.xml"));
        assert_eq!(redirect.own("statistics.xml"), Path::new("/r/3_statistics.xml"));
        redirect.take_prefix("../../deep/x_TIME");
        assert_eq!(redirect.target(Path::new("/cfg"), "c.xml"), "/r/x_c.xml");
    }
}
