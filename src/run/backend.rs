//! How SUMO is reached. Results are the same bytes whichever way it is, so this is no key of a scenario.

use crate::traci::SumoBinary;
use std::fmt;
use std::str::FromStr;

/// How SUMO is reached.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Backend {
    /// As a process of its own, over TraCI.
    #[default]
    Traci,
    /// As a library in this process.
    Libsumo,
    /// In this process where that can be, otherwise over TraCI.
    Auto,
}

impl Backend {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Traci, Self::Libsumo, Self::Auto];

    /// Why a SUMO cannot be run in this process, as far as can be seen without loading it.
    #[cfg(feature = "libsumo")]
    pub fn obstacle(binary: &SumoBinary) -> Option<String> {
        sumo_mfc_libsumo::find(&binary.path).err().map(|error| error.to_string())
    }

    /// Why a SUMO cannot be run in this process.
    #[cfg(not(feature = "libsumo"))]
    pub fn obstacle(_: &SumoBinary) -> Option<String> {
        Some(NOT_BUILT.to_owned())
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Traci => "traci",
            Self::Libsumo => "libsumo",
            Self::Auto => "auto",
        }
    }
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Backend {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|backend| backend.name() == text);
        found.ok_or_else(|| format!("found {text}, wanted {}", Self::ALL.map(Self::name).join(", ")))
    }
}

/// What a program says that has no SUMO inside.
#[cfg(not(feature = "libsumo"))]
pub(super) const NOT_BUILT: &str = "this sumo-mfc was built without it (cargo build --release --features libsumo, with g++ and SUMO's headers, builds one with it)";
