//! The paper's numbers.

/// What the paper says about a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Published {
    /// This number; ours is the same if it is no further away than `within`.
    Number {
        /// The number.
        value: f64,
        /// How far away ours may be.
        within: f64,
    },
    /// A bound.
    AtMost(f64),
}

impl Published {
    /// The number printed in the paper.
    pub fn number(self) -> f64 {
        match self {
            Self::Number { value, .. } | Self::AtMost(value) => value,
        }
    }

    /// Whether our number is the published one, within its tolerance.
    pub fn agrees(self, ours: f64) -> bool {
        match self {
            Self::Number { value, within } => (ours - value).abs() <= within,
            Self::AtMost(bound) => ours <= bound,
        }
    }
}

/// Tolerance on published errors, relative: the recordings are not the paper's own.
const ERROR_WITHIN: f64 = 0.15;

/// The paper's numbers (Section 5, Table 2 and text): test, controller, quantity.
const PUBLISHED: &[(&str, &str, &str, Published)] = &[
    ("step", "classic", "overshoot_1", Published::Number { value: 19.5, within: 1.0 }),
    ("step", "classic", "overshoot_2", Published::Number { value: 9.5, within: 0.7 }),
    ("step", "adaptive", "overshoot_1", Published::Number { value: 8.0, within: 0.7 }),
    ("step", "adaptive", "overshoot_2", Published::Number { value: 3.9, within: 0.5 }),
    ("step", "adaptive", "settling_1", Published::AtMost(100.0)),
    ("step", "adaptive", "settling_2", Published::AtMost(100.0)),
    ("driver", "classic", "error_mean", Published::Number { value: -0.01, within: 0.05 }),
    ("driver", "classic", "error_std", Published::Number { value: 0.77, within: ERROR_WITHIN * 0.77 }),
    ("driver", "classic", "error_rms", Published::Number { value: 0.78, within: ERROR_WITHIN * 0.78 }),
    ("driver", "adaptive", "error_mean", Published::Number { value: -0.02, within: 0.05 }),
    ("driver", "adaptive", "error_std", Published::Number { value: 0.35, within: ERROR_WITHIN * 0.35 }),
    ("driver", "adaptive", "error_rms", Published::Number { value: 0.35, within: ERROR_WITHIN * 0.35 }),
    ("delay", "classic", "error_rms", Published::Number { value: 2.27, within: ERROR_WITHIN * 2.27 }),
    ("delay", "adaptive", "error_rms", Published::Number { value: 0.68, within: ERROR_WITHIN * 0.68 }),
];

/// What the paper says about a quantity of a family of tests.
pub fn published(family: &str, controller: &str, quantity: &str) -> Option<Published> {
    PUBLISHED.iter().find(|(t, c, q, _)| (*t, *c, *q) == (family, controller, quantity)).map(|p| p.3)
}
