//! File names as SUMO and scenarios write them.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crate::traci::find_sumo;

/// `path` seen from `folder`, absolute; `.` and empty parts vanish, symbolic links stay.
pub(crate) fn absolute(folder: &Path, path: &Path) -> PathBuf {
    let joined = folder.join(path);
    std::path::absolute(&joined).unwrap_or(joined)
}

/// Where SUMO was found. The search may start a Python, so it is made once.
static SUMO_HOME: LazyLock<Option<String>> = LazyLock::new(|| {
    let home = find_sumo(None).ok()?.home?;
    Some(absolute(Path::new(""), &home).to_string_lossy().into_owned())
});

/// Puts environment variables in place of `${NAME}`, as SUMO does. Unknown ones stay. `${SUMO_HOME}` is where SUMO was
/// found, if the variable is not set.
pub(crate) fn environment(text: &str) -> String {
    let value = |name: &str| match std::env::var(name).ok().filter(|v| !v.is_empty()) {
        None if name == "SUMO_HOME" => SUMO_HOME.clone(),
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
