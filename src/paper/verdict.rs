//! How a number or a claim compares with the paper.

use std::fmt;

/// How a number compares with the published one, the best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// It agrees.
    Reproduced,
    /// It does not, but it is within a factor of 2, and the adaptive law is better than the classic one by at least half as
    /// much as published; of a claim in words, as its criterion says.
    Partly,
    /// Neither.
    NotReproduced,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Reproduced => "reproduced",
            Self::Partly => "partly",
            Self::NotReproduced => "not reproduced",
        })
    }
}

/// How many verdicts of each kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Count {
    /// Reproduced.
    pub reproduced: usize,
    /// Partly.
    pub partly: usize,
    /// Not reproduced.
    pub not: usize,
}

impl Count {
    /// Counts one more.
    pub fn add(&mut self, verdict: Verdict) {
        match verdict {
            Verdict::Reproduced => self.reproduced += 1,
            Verdict::Partly => self.partly += 1,
            Verdict::NotReproduced => self.not += 1,
        }
    }

    /// How many verdicts.
    pub fn all(&self) -> usize {
        self.reproduced + self.partly + self.not
    }
}
