//! The folder of a run's results.

use std::{
    io::ErrorKind,
    path::{Path, PathBuf},
};

use super::{Scenario, ScenarioError};

impl Scenario {
    /// Where the results go if the user does not say: `out/<scenario>-<controller>-<seed>`, with the controller of the
    /// vehicles that no `[[group]]` takes.
    pub fn default_folder(&self) -> PathBuf {
        let controller = self.groups.last().map_or("none", |g| g.controller.name);
        Path::new("out").join(format!("{}-{controller}-{}", self.name, self.sumo.seed))
    }
}

/// Makes sure that results can be written to `dir`, creating it if need be.
///
/// # Errors
/// [`ScenarioError::Finished`] if a finished result is there and `force` is not set; [`ScenarioError::Unwritable`] if
/// nothing can be written there.
pub fn claim_folder(dir: &Path, force: bool) -> Result<(), ScenarioError> {
    if !force && is_finished(dir) {
        return Err(ScenarioError::Finished { path: dir.to_owned() });
    }
    let unwritable = |reason| ScenarioError::Unwritable { path: dir.to_owned(), reason };
    std::fs::create_dir_all(dir).map_err(unwritable)?;
    // Permissions, read-only file systems and full disks show only in the attempt.
    tempfile::Builder::new().suffix(".part").tempfile_in(dir).map(drop).map_err(unwritable)
}

fn is_finished(dir: &Path) -> bool {
    let text = match std::fs::read_to_string(dir.join("run.json")) {
        Ok(text) => text,
        Err(e) => return e.kind() != ErrorKind::NotFound && e.kind() != ErrorKind::NotADirectory,
    };
    let status = serde_json::from_str::<serde_json::Value>(&text).ok();
    status.and_then(|v| v.get("status")?.as_str().map(|s| s == "complete")).unwrap_or(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_finished_result_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let out = dir.path().join("a/b");
        claim_folder(&out, false).unwrap();
        assert_eq!(std::fs::read_dir(&out).unwrap().count(), 0, "nothing is left by the attempt");
        for (status, free) in [("running", true), ("incomplete", true), ("complete", false)] {
            std::fs::write(out.join("run.json"), format!("{{\"status\": \"{status}\"}}")).unwrap();
            assert_eq!(claim_folder(&out, false).is_ok(), free, "{status}");
        }
        claim_folder(&out, true).unwrap();
        std::fs::write(dir.path().join("file"), "").unwrap();
        assert!(matches!(claim_folder(&dir.path().join("file/x"), false), Err(ScenarioError::Unwritable { .. })));
    }
}
