//! A file of demand or of additional elements together with the files that it includes.

use std::{
    collections::BTreeMap,
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use super::{
    error::SumoFileError,
    path::absolute,
    xml::{Element, Xml},
};
use crate::missing::did_you_mean;

/// Files that include each other this deep are a mistake.
const DEPTH_MAX: usize = 16;

/// SUMO reads a file as often as it is included. More than this is a mistake.
const READINGS_MAX: u64 = 10_000;

/// Reads files and what they include, each file once.
#[derive(Debug, Default)]
pub(super) struct Files {
    /// The files that are read, each with how often SUMO reads a file if it reads this one once.
    seen: BTreeMap<PathBuf, u64>,
    /// Whether networks and configurations are read like other files.
    all_roots: bool,
    /// The files from the first one to the one under reading.
    chain: Vec<PathBuf>,
}

impl Files {
    /// Reads networks and configurations like other files: SUMO does, wherever they are named.
    pub fn of_any_root() -> Self {
        Self { all_roots: true, ..Self::default() }
    }

    /// Calls `visit` with every element of `file`, then with those of the files that it includes, until it breaks. True
    /// if all of them are whole: none breaks off.
    pub fn each(
        &mut self,
        file: &Path,
        visit: &mut impl FnMut(&Path, &Element<'_>) -> ControlFlow<()>,
    ) -> Result<bool, SumoFileError> {
        let identity = std::fs::canonicalize(file).unwrap_or_else(|_| file.to_owned());
        if self.chain.contains(&identity) {
            return Err(self.endless(file, "it includes itself"));
        }
        if self.chain.len() == DEPTH_MAX {
            return Err(self.endless(file, &format!("files include each other more than {DEPTH_MAX} deep")));
        }
        if self.seen.contains_key(&identity) {
            return Ok(true);
        }
        let folder = file.parent().unwrap_or(Path::new(""));
        let mut xml = Xml::open(file)?;
        let (mut included, all_roots) = (Vec::new(), self.all_roots);
        let mut broken = false;
        xml.each(|element| {
            // Networks are large, and neither they nor configurations include anything.
            if !all_roots && element.parent.is_empty() && ["net", "configuration"].contains(&element.name()) {
                broken = true;
                return Ok(ControlFlow::Break(()));
            }
            if let Some(name) = element.attribute("href").filter(|_| element.name() == "include") {
                let path = absolute(folder, Path::new(&name));
                if !path.is_file() {
                    return Err(format!("include: {} does not exist{}", path.display(), did_you_mean(&path)));
                }
                included.push(path);
            }
            let flow = visit(file, element);
            broken = flow.is_break();
            Ok(flow)
        })?;
        if !xml.is_rooted() {
            return Err(xml.error("not XML as SUMO writes it: no element in it".to_owned()));
        }
        let mut whole = broken || xml.is_whole();
        self.chain.push(identity.clone());
        let mut readings = 1_u64;
        for included in included {
            whole &= self.each(&included, visit)?;
            let identity = std::fs::canonicalize(&included).unwrap_or(included);
            readings = readings.saturating_add(self.seen.get(&identity).copied().unwrap_or(1));
            if readings > READINGS_MAX {
                return Err(self.endless(file, &format!("it makes SUMO read more than {READINGS_MAX} files")));
            }
        }
        self.chain.pop();
        self.seen.insert(identity, readings);
        Ok(whole)
    }

    fn endless(&self, file: &Path, what: &str) -> SumoFileError {
        let chain: Vec<_> = self.chain.iter().chain([&file.to_owned()]).map(|f| f.display().to_string()).collect();
        SumoFileError::Include { path: file.to_owned(), what: what.to_owned(), chain: chain.join(" > ") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The elements with an id below `file`, in the order in which they are seen.
    fn ids(file: &Path) -> Result<(Vec<String>, bool), SumoFileError> {
        let mut ids = Vec::new();
        let whole = Files::default().each(file, &mut |_, element| {
            ids.extend(element.attribute("id"));
            ControlFlow::Continue(())
        })?;
        Ok((ids, whole))
    }

    #[test]
    fn each_file_is_read_once_from_where_it_is_named() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("sub")).unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("a.xml", "<r><include href=\"sub/b.xml\"/><include href=\"sub/../c.xml\"/><vehicle id=\"a\"/></r>");
        write("sub/b.xml", "<r><vehicle id=\"b\"/><include href=\"../c.xml\"/></r>");
        write("c.xml", "<r><vehicle id=\"c\"/></r>");
        let a = folder.path().join("a.xml");
        assert_eq!(ids(&a).unwrap(), (["a", "b", "c"].map(str::to_owned).to_vec(), true));
        write("c.xml", "<r><vehicle id=\"c\"/>");
        assert!(!ids(&a).unwrap().1);
        write("c.xml", "<r>\n<vehicle></r>");
        assert!(ids(&a).unwrap_err().to_string().contains("c.xml:2: not XML"));
    }

    #[test]
    fn law_endless_inclusion_is_an_error_that_names_the_chain() {
        let folder = tempfile::tempdir().unwrap();
        let path = |i: usize| folder.path().join(format!("f{i}.xml"));
        for i in 0..20 {
            std::fs::write(path(i), format!("<r><include href=\"f{}.xml\"/></r>", i + 1)).unwrap();
        }
        let error = ids(&path(0)).unwrap_err().to_string();
        assert!(
            error.contains("more than 16 deep") && error.contains("f0.xml > ") && error.contains("f16.xml"),
            "{error}"
        );
        for i in 0..14 {
            let next = format!("<include href=\"f{}.xml\"/>", i + 1);
            std::fs::write(path(i), format!("<r>{}</r>", next.repeat(2))).unwrap();
        }
        std::fs::write(path(14), "<r/>").unwrap();
        let error = ids(&path(0)).unwrap_err().to_string();
        assert!(error.contains("it makes SUMO read more than 10000 files") && error.contains("f1.xml"), "{error}");
        assert_eq!(ids(&path(3)).unwrap(), (Vec::new(), true), "4095 files");
        std::fs::write(path(1), "<r><include href=\"./f0.xml\"/></r>").unwrap();
        let error = ids(&path(0)).unwrap_err().to_string();
        assert!(error.contains("f0.xml: it includes itself: ") && error.contains("f1.xml > "), "{error}");
    }
}
