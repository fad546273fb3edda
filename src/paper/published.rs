//! The paper's numbers: fourteen, of which ten are facts of their own.

use std::fmt;

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

    /// Whether our number is the published one, up to a factor; a bound is exceeded by less than that.
    pub fn is_within_factor(self, factor: f64, ours: f64) -> bool {
        let ratio = ours / self.number();
        match self {
            Self::Number { .. } => (1.0 / factor..=factor).contains(&ratio),
            Self::AtMost(_) => ratio <= factor,
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

/// What a number says that the others do not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// A fact of its own.
    Fact,
    /// The same fact as the RMS: the standard deviation of an error whose mean is about zero.
    SameAsRms,
    /// Little: a mean near zero is what any law with integral action has on a drive that ends as it began.
    Little,
}

impl fmt::Display for Weight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Fact => "is a fact of its own",
            Self::SameAsRms => "is the same fact as error_rms",
            Self::Little => "says little",
        })
    }
}

/// A row of [`PUBLISHED`]: test, controller, quantity.
type Printed = (&'static str, &'static str, &'static str, Published, Weight);

const fn number(
    test: &'static str,
    controller: &'static str,
    quantity: &'static str,
    value: f64,
    within: f64,
    weight: Weight,
) -> Printed {
    (test, controller, quantity, Published::Number { value, within }, weight)
}

/// A published error, with [`ERROR_WITHIN`].
const fn error(
    test: &'static str,
    controller: &'static str,
    quantity: &'static str,
    value: f64,
    weight: Weight,
) -> Printed {
    number(test, controller, quantity, value, ERROR_WITHIN * value, weight)
}

const fn bound(test: &'static str, controller: &'static str, quantity: &'static str, value: f64) -> Printed {
    (test, controller, quantity, Published::AtMost(value), Weight::Fact)
}

/// The paper's numbers (Section 5, Table 2 and text).
const PUBLISHED: &[Printed] = &[
    number("step", "classic", "overshoot_1", 19.5, 1.0, Weight::Fact),
    number("step", "classic", "overshoot_2", 9.5, 0.7, Weight::Fact),
    number("step", "adaptive", "overshoot_1", 8.0, 0.7, Weight::Fact),
    number("step", "adaptive", "overshoot_2", 3.9, 0.5, Weight::Fact),
    bound("step", "adaptive", "settling_1", 100.0),
    bound("step", "adaptive", "settling_2", 100.0),
    number("driver", "classic", "error_mean", -0.01, 0.05, Weight::Little),
    error("driver", "classic", "error_std", 0.77, Weight::SameAsRms),
    error("driver", "classic", "error_rms", 0.78, Weight::Fact),
    number("driver", "adaptive", "error_mean", -0.02, 0.05, Weight::Little),
    error("driver", "adaptive", "error_std", 0.35, Weight::SameAsRms),
    error("driver", "adaptive", "error_rms", 0.35, Weight::Fact),
    error("delay", "classic", "error_rms", 2.27, Weight::Fact),
    error("delay", "adaptive", "error_rms", 0.68, Weight::Fact),
];

/// Test, controller and quantity of each number, in the order of the paper.
pub fn all() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    PUBLISHED.iter().map(|(test, controller, quantity, ..)| (*test, *controller, *quantity))
}

fn printed(family: &str, controller: &str, quantity: &str) -> Option<&'static Printed> {
    PUBLISHED.iter().find(|(t, c, q, ..)| (*t, *c, *q) == (family, controller, quantity))
}

/// What the paper says about a quantity of a family of tests.
pub fn published(family: &str, controller: &str, quantity: &str) -> Option<Published> {
    printed(family, controller, quantity).map(|printed| printed.3)
}

/// What the number says that the others do not.
pub fn weight(family: &str, controller: &str, quantity: &str) -> Option<Weight> {
    printed(family, controller, quantity).map(|printed| printed.4)
}
