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
    options::{A_FILE, is_no_file, is_socket, writes},
    path::absolute,
    xml::{Element, Item, Xml, attribute, is_xml},
};

/// Attributes that name a file to write, in whatever element.
const WRITTEN: [&str; 2] = ["file", "output"];

/// The elements in which such an attribute names a file to read.
const READERS: &[(&str, &str)] =
    &[("variableSpeedSign", "file"), ("rerouter", "file"), ("calibrator", "file"), ("decal", "file")];

/// Parameters that name a file to read.
const READ_PARAMS: [&str; 2] = ["device.fcd-replay.file", "device.fcd-replay.files"];

/// Attributes of any element that name a file to read.
const READ: &[&str] = &["href", "file", "imgFile", "osgFile", "shapeFile", "edgesFile"];

/// Elements whose parameters are free for anybody's use; elsewhere the parameter `file` may be a traffic light's output.
const FREE: &[&str] = &["vehicle", "trip", "flow", "vType", "person", "personFlow", "poi", "poly", "edge", "lane"];

/// Copies that name each other this deep are a mistake.
const DEPTH_MAX: usize = 32;

/// Gives every file that SUMO would write a name of its own below `folder`.
#[derive(Debug)]
pub(super) struct Redirect {
    folder: PathBuf,
    prefix: String,
    taken: BTreeMap<String, PathBuf>,
    copies: BTreeMap<PathBuf, PathBuf>,
    /// How many files are being copied, each named in the one before.
    depth: usize,
}

impl Redirect {
    pub fn new(folder: &Path) -> Self {
        // What SUMO prints is kept under this name.
        let taken = BTreeMap::from([("console.log".to_owned(), PathBuf::new())]);
        Self { folder: folder.to_owned(), prefix: String::new(), taken, copies: BTreeMap::new(), depth: 0 }
    }

    /// Puts a configuration's output prefix before all names to come: its last component, without the time.
    pub fn take_prefix(&mut self, prefix: &str) {
        self.prefix = prefix.rsplit(['/', '\\']).next().unwrap_or_default().replace("TIME", "").replace(':', "_");
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
        // SUMO takes a name with a colon for a socket.
        let name =
            original.file_name().map_or("output".to_owned(), |n| n.to_string_lossy().replace([':', '\n', '\r'], "_"));
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
        if self.depth == DEPTH_MAX {
            let what = format!("files name each other more than {DEPTH_MAX} deep");
            return Err(SumoFileError::Include { path: file.to_owned(), what, chain: file.display().to_string() });
        }
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let copy = self.own(name.trim_end_matches(".gz"));
        self.copies.insert(file.to_owned(), copy.clone());
        std::fs::create_dir_all(&self.folder).map_err(unwritable(&self.folder))?;
        let text = File::create(&copy).map_err(unwritable(&copy))?;
        let mut writer = Writer::new(BufWriter::new(text));
        self.depth += 1;
        self.rewrite(file, &copy, &mut writer)?;
        self.depth -= 1;
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
            } else if let Some(read) = read_by(element, name, folder, &value)? {
                self.loaded(&read)?.to_string_lossy().into_owned()
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
    let written = WRITTEN.contains(&attribute) || (element, attribute) == ("timedEvent", "dest");
    written && !READERS.contains(&(element, attribute))
}

/// Refuses an element that would have SUMO send something to a socket.
pub(super) fn refuse_sockets(file: &Path, element: &Element<'_>) -> Result<(), SumoFileError> {
    let name = element.name();
    let param = is_output_param(name, element.parent, || element.attribute("key"));
    let written = [WRITTEN[0], WRITTEN[1], "dest", "value"].into_iter();
    let written = written.filter(|attribute| writes_file(name, attribute) || param && *attribute == "value");
    let mut named = written.filter_map(|attribute| Some((attribute, element.attribute(attribute)?)));
    let Some((attribute, found)) = named.find(|(_, value)| is_socket(value)) else { return Ok(()) };
    let key = element.attribute("key").filter(|_| param).unwrap_or_else(|| attribute.to_owned());
    let what = format!("{key} of {}: found {found}, wanted {A_FILE}", if param { element.parent } else { name });
    Err(SumoFileError::Content { path: file.to_owned(), line: element.line, what })
}

/// Whether the value of a parameter names a file to write: that of a traffic light's program, or of a device of a vehicle.
fn is_output_param(element: &str, parent: &str, key: impl FnOnce() -> Option<String>) -> bool {
    element == "param"
        && key().is_some_and(|k| {
            let of_device = k.starts_with("device.") && (writes(&k) || k.ends_with(".file") || k.ends_with(".files"));
            of_device && !READ_PARAMS.contains(&k.as_str()) || k == "file" && !FREE.contains(&parent)
        })
}

fn unwritable(file: &Path) -> impl Fn(io::Error) -> SumoFileError {
    move |reason| SumoFileError::Unwritable { path: file.to_owned(), reason }
}

/// The file of SUMO's XML that an attribute of an element names to be read: that of a calibrator has vTypes.
fn read_by(element: &str, attribute: &str, folder: &Path, value: &str) -> Result<Option<PathBuf>, SumoFileError> {
    let path = absolute(folder, Path::new(value));
    let is_read = READERS.contains(&(element, attribute)) && path.is_file() && is_xml(&path)?;
    Ok(is_read.then_some(path))
}

/// Whether a file, or one that is read with it, names files to write. All of them are read, so that what includes too
/// much is refused.
fn names_outputs(file: &Path) -> Result<bool, SumoFileError> {
    let (mut found, mut files, mut refused) = (false, Files::of_any_root(), Ok(()));
    let mut open = vec![file.to_owned()];
    while let Some(file) = open.pop() {
        files.each(&file, &mut |file, element| {
            let name = element.name();
            refused = refuse_sockets(file, element);
            found = found
                || element.has_attribute(|attribute| writes_file(name, attribute))
                || is_output_param(name, element.parent, || element.attribute("key"));
            let readers = READERS.iter().filter(|(reader, _)| *reader == name);
            let named = readers.filter_map(|(_, attribute)| element.attribute(attribute));
            let folder = file.parent().unwrap_or(Path::new(""));
            let paths = named.map(|value| absolute(folder, Path::new(&value)));
            open.extend(paths.filter(|path| path.is_file() && is_xml(path).is_ok_and(|is_xml| is_xml)));
            if refused.is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        std::mem::replace(&mut refused, Ok(()))?;
    }
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
        for none in ["NUL", "stdout", "-", "/dev/null"] {
            assert_eq!(target("/cfg", none), none);
        }
        assert_eq!(target("/cfg", "Stdout"), "/r/Stdout", "SUMO knows stdout and STDOUT alone");
        assert_eq!(target("/cfg", "a:99999"), "/r/a_99999", "or SUMO would look for a host");
        assert_eq!(target("/cfg", "localhost:9"), "/r/localhost_9", "refused before");
        assert_eq!(redirect.own("statistics.xml"), Path::new("/r/2_statistics.xml"));
        assert_eq!(redirect.own("statistics.xml"), Path::new("/r/3_statistics.xml"));
        redirect.take_prefix("../../deep/x:_TIME");
        assert_eq!(redirect.target(Path::new("/cfg"), "c.xml"), "/r/x__c.xml");
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
