//! What was probably meant by the name of a file that is not there.

use crate::registry::nearest;
use std::fs;
use std::path::{Path, PathBuf};

/// A deeper path has no likeness anywhere, and each of its folders would be looked for.
const DEPTH_MAX: usize = 100;

/// "; did you mean scenarios/demo.toml?" where something with a name like that is there, else nothing.
pub fn did_you_mean(path: &Path) -> String {
    if path.components().count() > DEPTH_MAX {
        return String::new();
    }
    match existing(path).filter(|meant| meant != path) {
        Some(meant) => format!("; did you mean {}?", meant.display()),
        None => String::new(),
    }
}

/// The path as far as it is there, and the nearest names from where it is not.
fn existing(path: &Path) -> Option<PathBuf> {
    if path.exists() {
        return Some(path.to_owned());
    }
    let (folder, name) = (path.parent()?, path.file_name()?.to_str()?);
    let here = folder.as_os_str().is_empty();
    let folder = if here { folder.to_owned() } else { existing(folder)? };
    let listed = fs::read_dir(if here { Path::new(".") } else { &folder }).ok()?;
    let mut names: Vec<String> = listed.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    names.sort();
    let without_suffix = names.iter().find(|known| Path::new(known).file_stem().is_some_and(|stem| stem == name));
    let meant = without_suffix.map(String::as_str).or_else(|| nearest(name, names.iter().map(String::as_str)))?;
    Some(folder.join(meant))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_folders_and_suffixes_are_found_and_strangers_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir_all(path("scenarios")).unwrap();
        for name in ["scenarios/demo.toml", "scenarios/sine.toml", "city.net.xml"] {
            fs::write(path(name), "").unwrap();
        }
        for (typed, meant) in [
            ("scenarios/demp.toml", Some("scenarios/demo.toml")),
            ("senarios/demo.toml", Some("scenarios/demo.toml")),
            ("senarios/sin.toml", Some("scenarios/sine.toml")),
            ("scenarios/demo", Some("scenarios/demo.toml")),
            ("City.net.xml", Some("city.net.xml")),
            ("scenarios/motorway.toml", None),
            ("elsewhere/demo.toml", None),
            ("city.net.xml", None),
        ] {
            let wanted = meant.map_or(String::new(), |meant| format!("; did you mean {}?", path(meant).display()));
            assert_eq!(did_you_mean(&path(typed)), wanted, "{typed}");
        }
        assert_eq!(
            did_you_mean(&path(&"a/".repeat(100_000))),
            "",
            "each folder of it costs a look and some of the stack"
        );
    }
}
