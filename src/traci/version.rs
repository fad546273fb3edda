//! The version of a SUMO, by its own text.

use std::fmt;

/// What SUMO says about itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SumoVersion {
    /// TraCI's API number: 20 up to 1.18, 21 up to 1.22, then 22. Too coarse to decide by.
    pub api: i32,
    /// Full text, for example "SUMO 1.28.0".
    pub text: String,
    /// Major, minor, patch; 0 where the text has none.
    pub number: (u32, u32, u32),
}

impl SumoVersion {
    /// The oldest SUMO that is supported.
    pub const MINIMUM: (u32, u32, u32) = (1, 15, 0);

    /// Reads the version out of SUMO's text: "SUMO 1.28.0", "SUMO v1_27_0+0123-0a1b2c3d4e5".
    #[must_use]
    pub fn parse(api: i32, text: &str) -> Self {
        let start = text.find(|c: char| c.is_ascii_digit()).unwrap_or(text.len());
        let digits =
            text[start..].split(|c: char| c == '+' || c == '-' || c.is_whitespace()).next().unwrap_or_default();
        let mut parts = digits.split(['.', '_']).map(|part| part.parse().unwrap_or(0));
        let mut next = || parts.next().unwrap_or(0);
        Self { api, text: text.to_owned(), number: (next(), next(), next()) }
    }

    /// True for this release and all later ones.
    #[must_use]
    pub fn at_least(&self, major: u32, minor: u32) -> bool {
        self.number >= (major, minor, 0)
    }
}

impl fmt::Display for SumoVersion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_read_and_compared() {
        let number = |text: &str| SumoVersion::parse(20, text).number;
        assert_eq!(number("SUMO 1.15.0"), (1, 15, 0));
        assert_eq!(number("SUMO v1_27_1+0123-0a1b2c3d4e5"), (1, 27, 1));
        assert_eq!(number("SUMO 2.0"), (2, 0, 0));
        assert_eq!(number("something"), (0, 0, 0));
        assert!(SumoVersion::parse(20, "SUMO 1.16.2").at_least(1, 16));
        assert!(!SumoVersion::parse(20, "SUMO 1.9.2").at_least(1, 15));
    }
}
