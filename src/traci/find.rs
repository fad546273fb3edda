//! Finding the binary of SUMO.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use super::error::Error;

/// Environment variable with the path of the SUMO binary to use.
pub const SUMO_BINARY_VARIABLE: &str = "SUMO_BINARY";

/// A SUMO binary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SumoBinary {
    /// The real binary, never the Python package's launcher script: killing a launcher would leave SUMO running.
    pub path: PathBuf,
    /// `SUMO_HOME` for it (data files and schemas), if one was found.
    pub home: Option<PathBuf>,
    /// Where it came from, in words.
    pub origin: String,
}

impl SumoBinary {
    fn new(path: PathBuf, origin: impl Into<String>) -> Self {
        let home = std::env::var_os("SUMO_HOME").map(PathBuf::from);
        let beside = path.parent().and_then(Path::parent).filter(|home| home.join("data").is_dir());
        let debian = Path::new("/usr/share/sumo");
        let home = beside.map(Path::to_path_buf).or(home).or_else(|| debian.is_dir().then(|| debian.to_path_buf()));
        Self { path, home, origin: origin.into() }
    }
}

/// Finds SUMO. An explicit path (`given`, else the variable `SUMO_BINARY`) must hold; without one these are tried in
/// turn: `SUMO_HOME/bin`, the PATH, the Python package `eclipse-sumo` of any `python3` on the PATH, and `.sumo/` in the
/// working directory (newest version first).
///
/// # Errors
/// [`Error::NotFound`] whose text says what to type.
pub fn find_sumo(given: Option<&Path>) -> Result<SumoBinary, Error> {
    find_named(given, "sumo")
}

/// Like [`find_sumo`], for `sumo` or `sumo-gui`.
///
/// # Errors
/// As [`find_sumo`].
pub fn find_named(given: Option<&Path>, name: &str) -> Result<SumoBinary, Error> {
    let variable = std::env::var_os(SUMO_BINARY_VARIABLE).map(PathBuf::from);
    let explicit = match (given, &variable) {
        (Some(path), _) => Some((path, "as given")),
        (None, Some(path)) => Some((path.as_path(), SUMO_BINARY_VARIABLE)),
        (None, None) => None,
    };
    if let Some((path, origin)) = explicit {
        let found = real_binary(path, name).map(|path| SumoBinary::new(path, origin));
        return found.ok_or_else(|| Error::NotFound(format!("no SUMO binary at {} ({origin})", path.display())));
    }
    let home = std::env::var_os("SUMO_HOME").map(PathBuf::from);
    let path = std::env::var_os("PATH").unwrap_or_default();
    search(home.as_deref(), &std::env::split_paths(&path).collect::<Vec<_>>(), Path::new(".sumo"), name)
        .ok_or_else(|| Error::NotFound(what_to_type(home.as_deref(), name)))
}

impl SumoBinary {
    /// What it says of its version, for example "Eclipse SUMO sumo 1.28.0".
    ///
    /// # Errors
    /// [`Error::Start`] if it cannot be started.
    pub fn version_text(&self) -> Result<String, Error> {
        let mut command = std::process::Command::new(&self.path);
        let output = command.arg("--version").stdin(Stdio::null()).stderr(Stdio::null()).output();
        let output = output.map_err(|source| Error::Start { path: self.path.clone(), source })?;
        Ok(String::from_utf8_lossy(&output.stdout).lines().next().unwrap_or_default().trim().to_owned())
    }
}

fn what_to_type(home: Option<&Path>, name: &str) -> String {
    let home = home.map_or("SUMO_HOME is not set".to_owned(), |home| format!("SUMO_HOME is {}", home.display()));
    format!(
        "no `{name}` found ({home}; nor on the PATH, in a Python package, or below .sumo/). Type one of:\n  \
         python3 -m venv .sumo/1.28.0 && .sumo/1.28.0/bin/pip install eclipse-sumo==1.28.0\n  \
         sudo apt-get install sumo\n  \
         make setup (in a checkout of sumo-mfc)\n  \
         export SUMO_HOME=/path/to/sumo"
    )
}

/// The search itself, on given places.
fn search(home: Option<&Path>, path: &[PathBuf], local: &Path, name: &str) -> Option<SumoBinary> {
    let from_home = home.and_then(|home| real_binary(&home.join("bin").join(name), name));
    if let Some(binary) = from_home {
        return Some(SumoBinary::new(binary, "SUMO_HOME"));
    }
    if let Some(binary) = path.iter().find_map(|folder| real_binary(&folder.join(name), name)) {
        return Some(SumoBinary::new(binary, "PATH"));
    }
    let pythons = path.iter().map(|folder| folder.join("python3")).filter(|python| python.is_file());
    for python in pythons {
        if let Some(binary) = in_package(&python, name) {
            return Some(SumoBinary::new(binary, format!("Python package of {}", python.display())));
        }
    }
    let mut versions = folders(local);
    versions.sort_by_key(|folder| std::cmp::Reverse(version_key(folder)));
    let (binary, folder) = versions.iter().find_map(|folder| Some((in_prefix(folder, name)?, folder)))?;
    Some(SumoBinary::new(binary, folder.display().to_string()))
}

/// `1.28.0` as numbers, so that 1.15 is newer than 1.9.
fn version_key(folder: &Path) -> Vec<u32> {
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    name.split('.').map_while(|part| part.parse().ok()).collect()
}

fn folders(parent: &Path) -> Vec<PathBuf> {
    let mut found: Vec<_> =
        std::fs::read_dir(parent).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    found.retain(|path| path.is_dir());
    found.sort();
    found
}

/// The binary inside the package `eclipse-sumo` of a Python installation at `prefix`.
fn in_prefix(prefix: &Path, name: &str) -> Option<PathBuf> {
    ["lib", "local/lib"].into_iter().flat_map(|lib| folders(&prefix.join(lib))).find_map(|python| {
        if !python.file_name().is_some_and(|file| file.to_string_lossy().starts_with("python3")) {
            return None;
        }
        ["site-packages", "dist-packages"]
            .into_iter()
            .map(|site| python.join(site).join("sumo/bin").join(name))
            .find(|binary| is_elf(binary))
    })
}

/// The binary inside the package `eclipse-sumo` as this Python finds it: only it knows user and virtual environments.
fn in_package(python: &Path, name: &str) -> Option<PathBuf> {
    let ask =
        "import importlib.util as u; s = u.find_spec('sumo'); print(s.submodule_search_locations[0] if s else '')";
    let output = std::process::Command::new(python).args(["-c", ask]).stdin(Stdio::null()).output().ok()?;
    let package = String::from_utf8(output.stdout).ok()?;
    Some(Path::new(package.trim()).join("bin").join(name)).filter(|binary| !package.trim().is_empty() && is_elf(binary))
}

/// The program at `path`, or behind it: the Python package puts a launcher script with SUMO's name on the PATH.
fn real_binary(path: &Path, name: &str) -> Option<PathBuf> {
    let path = if path.is_dir() { path.join("bin").join(name) } else { path.to_path_buf() };
    if is_elf(&path) {
        return Some(path);
    }
    let real = path.canonicalize().ok()?;
    [path.as_path(), real.as_path()].into_iter().find_map(|script| in_prefix(script.parent()?.parent()?, name))
}

/// True for a program that is not a script.
fn is_elf(path: &Path) -> bool {
    let mut start = [0; 2];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut start));
    path.is_file() && read.is_ok() && &start != b"#!"
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A program for the search: anything that is not a script.
    fn program(path: PathBuf) -> PathBuf {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, b"\x7fELF").unwrap();
        path
    }

    fn script(path: &Path) {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, b"#!/usr/bin/env python3\n").unwrap();
    }

    #[test]
    fn the_search_goes_home_path_and_newest_version() {
        let root = tempfile::tempdir().unwrap();
        let at = |path: &str| root.path().join(path);
        let site = |version: &str| at(&format!(".sumo/{version}/lib/python3.11/site-packages/sumo/bin/sumo"));
        let local = at(".sumo");
        let find = |home: Option<&Path>, path: &[PathBuf]| search(home, path, &local, "sumo").map(|found| found.path);
        assert_eq!(find(Some(&at("home")), &[at("bin")]), None);
        ["1.9.0", "1.27.0"].into_iter().for_each(|older| drop(program(site(older))));
        let newest = program(site("1.28.0"));
        assert_eq!(find(Some(&at("home")), &[at("bin")]), Some(newest), "1.28 is newer than 1.9 and 1.27");
        let on_path = program(at("bin/sumo"));
        assert_eq!(find(Some(&at("home")), &[at("bin")]), Some(on_path));
        let home = program(at("home/bin/sumo"));
        assert_eq!(find(Some(&at("home")), &[at("bin")]), Some(home));
    }

    #[test]
    fn a_launcher_script_is_resolved_to_the_binary_behind_it() {
        let root = tempfile::tempdir().unwrap();
        let launcher = root.path().join("venv/bin/sumo");
        script(&launcher);
        let path = [root.path().join("venv/bin")];
        assert_eq!(search(None, &path, root.path(), "sumo"), None, "a script is no binary");
        let real = program(root.path().join("venv/lib/python3.12/site-packages/sumo/bin/sumo"));
        std::fs::create_dir_all(root.path().join("venv/lib/python3.12/site-packages/sumo/data")).unwrap();
        let found = search(None, &path, root.path(), "sumo").unwrap();
        assert_eq!(found.path, real);
        assert_eq!(found.home, Some(root.path().join("venv/lib/python3.12/site-packages/sumo")));
        assert_eq!(find_sumo(Some(&launcher)).unwrap().path, real);
    }

    /// Only Python knows where its packages are.
    #[cfg(unix)]
    #[test]
    fn a_python_on_the_path_is_asked_for_its_package() {
        use std::os::unix::fs::PermissionsExt;
        let root = tempfile::tempdir().unwrap();
        let (bin, package) = (root.path().join("bin"), root.path().join("package"));
        let python_says = |what: &str| {
            std::fs::create_dir_all(&bin).unwrap();
            std::fs::write(bin.join("python3"), format!("#!/bin/sh\necho {what}\n")).unwrap();
            std::fs::set_permissions(bin.join("python3"), std::fs::Permissions::from_mode(0o755)).unwrap();
            search(None, std::slice::from_ref(&bin), &root.path().join("none"), "sumo").map(|found| found.path)
        };
        assert_eq!(python_says(package.to_str().unwrap()), None, "it has no program");
        let binary = program(package.join("bin/sumo"));
        assert_eq!(python_says(package.to_str().unwrap()), Some(binary));
        assert_eq!(python_says(""), None);
    }

    #[test]
    fn a_missing_sumo_says_what_to_type() {
        let error = find_sumo(Some(Path::new("nowhere/sumo"))).unwrap_err().to_string();
        assert_eq!(error, "no SUMO binary at nowhere/sumo (as given)");
        assert!(what_to_type(None, "sumo").contains("pip install eclipse-sumo==1.28.0"));
    }
}
