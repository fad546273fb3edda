//! A copy of the checkout that can be changed. A file that is the same already is not written again, so that cargo builds
//! what has changed only.

use std::collections::HashSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Folders that are built or installed, not written; SUMO's is reached through a link.
const LEFT_OUT: [&str; 6] = ["target", ".git", ".tools", "out", ".sumo", "__pycache__"];
const LINKED: &str = ".sumo";

/// Makes `copy` the same as `root`, apart from the files `kept` (below the root), which are somebody else's to write.
///
/// # Errors
/// When a file cannot be read or written.
pub fn copy(root: &Path, copy: &Path, kept: &HashSet<PathBuf>) -> io::Result<()> {
    fs::create_dir_all(copy)?;
    let installed = root.join(LINKED);
    if installed.is_dir() && !copy.join(LINKED).exists() {
        std::os::unix::fs::symlink(installed, copy.join(LINKED))?;
    }
    copy_folder(root, copy, Path::new(""), kept)
}

fn copy_folder(root: &Path, copy: &Path, below: &Path, kept: &HashSet<PathBuf>) -> io::Result<()> {
    let names = |folder: &Path| -> io::Result<HashSet<std::ffi::OsString>> {
        fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.file_name())).collect()
    };
    let wanted = names(&root.join(below))?;
    fs::create_dir_all(copy.join(below))?;
    for name in names(&copy.join(below))?.difference(&wanted) {
        let (left_out, gone) = (LEFT_OUT.iter().any(|other| name == other), copy.join(below).join(name));
        if left_out || kept.contains(&below.join(name)) {
            continue;
        }
        if gone.is_dir() { fs::remove_dir_all(gone)? } else { fs::remove_file(gone)? }
    }
    for name in wanted {
        let (path, left_out) = (below.join(&name), LEFT_OUT.iter().any(|other| name == *other));
        if root.join(&path).is_dir() {
            if !left_out {
                copy_folder(root, copy, &path, kept)?;
            }
        } else if !left_out && !kept.contains(&path) {
            write_new(&copy.join(&path), &fs::read(root.join(&path))?)?;
            fs::set_permissions(copy.join(&path), fs::metadata(root.join(&path))?.permissions())?;
        }
    }
    Ok(())
}

/// Writes a file unless it has these bytes already.
///
/// # Errors
/// When it cannot be written.
pub fn write_new(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if fs::read(path).is_ok_and(|there| there == bytes) { Ok(()) } else { fs::write(path, bytes) }
}

/// Lines for the end of `src/ROOM.rs` that declare the files of `src/ROOM/` which only a macro declares: cargo-mutants does
/// not see what a macro makes. Nothing is compiled twice, because no crate has the configuration `mutants_list`.
///
/// # Errors
/// When the folder cannot be read.
pub fn undeclared(root: &Path, room: &str) -> io::Result<String> {
    let declared = fs::read_to_string(root.join(format!("src/{room}.rs")))?;
    let mut lines = String::new();
    let folder = root.join("src").join(room);
    for entry in if folder.is_dir() { fs::read_dir(folder)?.collect() } else { Vec::new() } {
        let name = entry?.file_name().to_string_lossy().trim_end_matches(".rs").to_string();
        if !declared.contains(&format!("mod {name};")) {
            lines.push_str(&format!("#[cfg(mutants_list)]\nmod {name};\n"));
        }
    }
    Ok(lines)
}
