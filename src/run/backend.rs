//! How SUMO is reached. Results are the same bytes whichever way it is, so this is no key of a scenario.

use std::fmt;
use std::str::FromStr;

/// How SUMO is reached.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
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
