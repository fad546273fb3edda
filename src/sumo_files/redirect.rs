//! Everything that SUMO would write next to a foreign configuration goes below the run's own folder instead: options by
//! other values on the command line, detectors and devices of vehicles by rewritten copies of the files that name them.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, BufWriter, Write},
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use quick_xml::{
    Writer,
    events::{BytesStart, Event},
};

use super::{
    error::SumoFileError,
    include::Files,
    options::writes,
    path::absolute,
    xml::{Item, Xml, attribute},
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
    copies: BTreeMap<PathBuf, PathBuf>,
}

impl Redirect {
    pub fn new(folder: &Path) -> Self {
        // What SUMO prints is kept under this name.
        let taken = BTreeMap::from([("console.log".to_owned(), PathBuf::new())]);
        Self { folder: folder.to_owned(), prefix: String::new(), taken, copies: BTreeMap::new() }
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

    /// The file to load in place of one of demand or additional elements: itself, or its rewritten copy if it, or a file
    /// that it includes, names files to write.
    pub fn loaded(&mut self, file: &Path) -> Result<PathBuf, SumoFileError> {
        if let Some(copy) = self.copies.get(file) {
            return Ok(copy.clone());
        }
        if !names_outputs(file)? {
            return Ok(file.to_owned());
        }
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let copy = self.own(name.trim_end_matches(".gz"));
        self.copies.insert(file.to_owned(), copy.clone());
        std::fs::create_dir_all(&self.folder).map_err(unwritable(&self.folder))?;
        let text = File::create(&copy).map_err(unwritable(&copy))?;
        let mut writer = Writer::new(BufWriter::new(text));
        self.rewrite(file, &copy, &mut writer)?;
        writer.into_inner().flush().map_err(unwritable(&copy))?;
        Ok(copy)
    }

    /// The files to load in place of these.
    pub fn all_loaded(&mut self, files: &[PathBuf]) -> Result<Vec<PathBuf>, SumoFileError> {
        files.iter().map(|file| self.loaded(file)).collect()
    }

    fn rewrite(&mut self, file: &Path, copy: &Path, writer: &mut Writer<impl Write>) -> Result<(), SumoFileError> {
        let folder = file.parent().unwrap_or(Path::new(""));
        let mut xml = Xml::open(file)?;
        while let Some(Item { event, parent, .. }) = xml.next()? {
            let event = match event {
                Event::Start(tag) => Event::Start(self.tag(&tag, folder, parent)?),
                Event::Empty(tag) => Event::Empty(self.tag(&tag, folder, parent)?),
                // The copy is UTF-8, whatever the original says.
                Event::Decl(_) => continue,
                other => other,
            };
            writer.write_event(event).map_err(unwritable(copy))?;
        }
        if xml.is_whole() { Ok(()) } else { Err(xml.breaks_off()) }
    }

    /// The element with its files where they belong: written ones below our folder, read ones absolute.
    fn tag(&mut self, tag: &BytesStart<'_>, folder: &Path, parent: &str) -> Result<BytesStart<'static>, SumoFileError> {
        let element = tag.name().into_inner();
        let output = is_output_param(element, parent, || attribute(tag, "key"));
        let mut copy = BytesStart::new(element.to_owned());
        for found in tag.attributes().with_checks(false).flatten() {
            let name = found.key.as_ref();
            let value = attribute(tag, name).unwrap_or_default();
            let value = if writes_file(element, name) || (output && name == "value") {
                self.target(folder, &value)
            } else if element == "include" && name == "href" {
                self.loaded(&absolute(folder, Path::new(&value)))?.to_string_lossy().into_owned()
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

/// Whether an attribute of an element names a file to write.
pub(super) fn writes_file(element: &str, attribute: &str) -> bool {
    WRITTEN.contains(&(element, attribute))
}

/// Whether the value of a parameter names a file to write: that of a traffic light's program, or of a device of a vehicle.
fn is_output_param(element: &str, parent: &str, key: impl FnOnce() -> Option<String>) -> bool {
    element == "param"
        && key().is_some_and(|k| k.starts_with("device.") && writes(&k) || k == "file" && parent == "tlLogic")
}

/// Standard streams, the void and network sockets (`host:port`).
pub(super) fn is_no_file(value: &str) -> bool {
    let socket = value.rsplit_once(':').is_some_and(|(host, port)| !host.contains('/') && port.parse::<u16>().is_ok());
    ["", "-", "stdout", "stderr", "nul", "/dev/null", "/dev/stdout", "/dev/stderr"]
        .contains(&value.to_lowercase().as_str())
        || socket
}

fn unwritable(file: &Path) -> impl Fn(io::Error) -> SumoFileError {
    move |reason| SumoFileError::Unwritable { path: file.to_owned(), reason }
}

/// Whether a file, or one that it includes, names files to write.
fn names_outputs(file: &Path) -> Result<bool, SumoFileError> {
    let mut found = false;
    Files::default().each(file, &mut |_, element| {
        let name = element.name();
        found |= WRITTEN.iter().any(|(e, a)| *e == name && element.attribute(a).is_some())
            || is_output_param(name, element.parent, || element.attribute("key"));
        if found { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    Ok(found)
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

    #[test]
    fn law_what_devices_and_detectors_of_any_file_write_goes_below_the_results() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let inner = "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><routes><vType id=\"gr\u{fc}n\">\
             <param key=\"device.ssm.file\" value=\"ssm.xml\"/></vType></routes>";
        std::fs::write(path("inner.xml"), inner.chars().map(|c| c as u8).collect::<Vec<u8>>()).unwrap();
        let outer = "<routes><include href=\"inner.xml\"/><include href=\"inner.xml\"/><vehicle id=\"a\">\
             <param key=\"file\" value=\"b.xml\"/></vehicle><edgeData id=\"e\" file=\"edges.xml\"/></routes>";
        let mut gz = flate2::write::GzEncoder::new(File::create(path("outer.rou.xml.gz")).unwrap(), Default::default());
        gz.write_all(outer.as_bytes()).unwrap();
        gz.finish().unwrap();

        let mut redirect = Redirect::new(&path("out"));
        let copy = redirect.loaded(&path("outer.rou.xml.gz")).unwrap();
        assert_eq!(copy, path("out/outer.rou.xml"));
        let out = path("out").display().to_string();
        let expected =
            outer.replace("inner.xml", &format!("{out}/inner.xml")).replace("edges.xml", &format!("{out}/edges.xml"));
        assert_eq!(
            std::fs::read_to_string(copy).unwrap(),
            expected,
            "both name one copy; the vehicle's file is no output"
        );
        let copy = std::fs::read_to_string(path("out/inner.xml")).unwrap();
        assert!(copy.contains("gr\u{fc}n") && copy.contains(&format!("value=\"{out}/ssm.xml\"")), "{copy}");
    }
}
