//! `run.json`: what was run, with what, and how it ended.

use crate::output::{OutputError, file_error};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// A study has planned it; nothing has run.
    Planned,
    /// It has not ended, or was killed.
    Running,
    /// It ran to its end.
    Complete,
    /// It broke off; what was computed until then is kept.
    Incomplete,
}

/// A file that went into a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// Its path as given.
    pub path: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

impl Input {
    /// Reads and hashes a file.
    ///
    /// # Errors
    /// [`OutputError::File`] if it cannot be read.
    pub fn of(path: &Path) -> Result<Self, OutputError> {
        Ok(Self { path: path.display().to_string(), sha256: sha256_of(path)? })
    }
}

/// The contents of `run.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of this file's form.
    pub schema: u32,
    /// How far the run has come.
    pub status: Status,
    /// Why it is incomplete.
    pub reason: Option<String>,
    /// Version of this program.
    pub version: String,
    /// SUMO's version text, once it is known.
    pub sumo_version: Option<String>,
    /// The API number that SUMO answers, once it is known.
    pub sumo_api: Option<i32>,
    /// The seed.
    pub seed: u64,
    /// Every input file.
    pub inputs: Vec<Input>,
    /// The resolved scenario, TOML in SI units: running it again gives the same bytes.
    pub scenario: String,
    /// SUMO's command line, word by word.
    pub sumo_command: Vec<String>,
    /// What was overridden or left out, one line each, as told on the terminal.
    pub notes: Vec<String>,
    /// The files of the result, relative to its folder.
    pub files: Vec<String>,
}

impl Manifest {
    /// The manifest of a run that starts.
    pub fn new(seed: u64, scenario: String, inputs: Vec<Input>) -> Self {
        Self {
            schema: 1,
            status: Status::Running,
            reason: None,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            sumo_version: None,
            sumo_api: None,
            seed,
            inputs,
            scenario,
            sumo_command: Vec::new(),
            notes: Vec::new(),
            files: Vec::new(),
        }
    }

    /// Reads a `run.json`.
    ///
    /// # Errors
    /// [`OutputError::File`] if it cannot be read, or is no manifest.
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        let text = std::fs::read_to_string(path).map_err(file_error("read", path))?;
        serde_json::from_str(&text).map_err(|error| file_error("read", path)(error.into()))
    }

    /// The file that an option of SUMO named, in the result folder `dir`, which may have been written where the folder was elsewhere.
    pub fn written(&self, dir: &Path, option: &str) -> Option<PathBuf> {
        let option = self.sumo_command.iter().rposition(|word| word == option)?;
        Some(dir.join("sumo").join(Path::new(self.sumo_command.get(option + 1)?).file_name()?))
    }

    /// What makes the run: SHA-256 of the resolved scenario, all inputs, and the versions of this program and of SUMO.
    /// `sumo` stands in for SUMO's version where the run has not come so far as to ask for it.
    pub fn identity(&self, sumo: &str) -> String {
        let sumo = version_number(self.sumo_version.as_deref().unwrap_or(sumo));
        let inputs: Vec<[&str; 2]> = self.inputs.iter().map(|input| [&*input.path, &*input.sha256]).collect();
        let parts = serde_json::json!([self.version, sumo, self.scenario, inputs]);
        hexadecimal(&Sha256::digest(parts.to_string()))
    }
}

/// The part of SUMO's version text that does not depend on who is asked: over TraCI it says "SUMO 1.28.0", with
/// `--version` "Eclipse SUMO sumo 1.28.0".
fn version_number(text: &str) -> &str {
    &text[text.find(|c: char| c.is_ascii_digit()).unwrap_or(0)..]
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// SHA-256 of a file's bytes, hexadecimal.
fn sha256_of(path: &Path) -> Result<String, OutputError> {
    let mut hash = Sha256::new();
    let mut file = File::open(path).map_err(file_error("open", path))?;
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer).map_err(file_error("read", path))? {
            0 => break,
            n => hash.update(&buffer[..n]),
        }
    }
    Ok(hexadecimal(&hash.finalize()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_sha256_of_fips_180() {
        // FIPS 180-2, appendix B.1: SHA-256 of "abc".
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("abc.net.xml");
        std::fs::write(&path, "abc").unwrap();
        let wanted = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(Input::of(&path).unwrap().sha256, wanted);
        assert!(sha256_of(&folder.path().join("none")).unwrap_err().to_string().contains("none"));
    }
}
