//! What the paper claims in words, with the criterion by which each claim is judged. The words are the paper's; the
//! criteria are ours, one number derived from each, the same for every preset.

use super::row::{Row, find};
use super::verdict::Verdict;

/// A claim about one quantity.
#[derive(Debug)]
pub struct Claim {
    /// `step`, `sine`, ...; holds for `driver_udds` as for `driver`.
    test: &'static str,
    controller: &'static str,
    quantity: &'static str,
    /// The paper's words.
    pub words: &'static str,
    /// When it counts as reproduced.
    pub criterion: &'static str,
    reproduced: Limit,
    partly: Limit,
}

/// A bound on a quantity, in units of the scale.
type Limit = (Scale, f64);

/// In what a quantity is measured before it is held against the limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scale {
    /// Itself.
    Itself,
    /// Itself, and larger is better.
    AtLeast,
    /// The same quantity of the classic law.
    Classic,
    /// Its factor from that of the classic law, up or down.
    LikeClassic,
}

const fn claim(
    test: &'static str,
    controller: &'static str,
    quantity: &'static str,
    words: &'static str,
    criterion: &'static str,
) -> Claim {
    let never = (Scale::Itself, f64::NEG_INFINITY);
    Claim { test, controller, quantity, words, criterion, reproduced: never, partly: never }
}

impl Claim {
    const fn up_to(self, scale: Scale, reproduced: f64, partly: f64) -> Self {
        Self { reproduced: (scale, reproduced), partly: (scale, partly), ..self }
    }

    const fn partly(self, scale: Scale, limit: f64) -> Self {
        Self { partly: (scale, limit), ..self }
    }
}

const OSCILLATORY: &str = "undershoot after the overshoot of at least 2 %, the band of settling; partly: 0.5 %";
const LESS_OSCILLATORY: &str = "undershoot at most half of the classic law's; partly: less";
const TORQUE: &str = "torque below 5 % of its largest value for good within 100 m of the step; partly: 200 m";
const COMFORT: &str = "jerk RMS at least 5 % below the classic law's; partly: not 5 % above";
/// What the paper itself shows of the two laws on its recording (Table 2) [m/s].
const TRACKED: [f64; 2] = [0.35, 0.78];
const REJECTED: &str =
    "error RMS at most 0.35 m/s, as the adaptive law has it in Table 2; partly: 0.78 m/s, as the classic law";
/// Shortened from "the external disturbances such as wind, slope, road-bank are taken into account".
const DISTURBANCES: &str = "taken into account";

/// All claims; Section 5.1, abstract, 5.2, 5.4 and 2.
const CLAIMS: &[Claim] = &[
    claim("step", "classic", "undershoot_1", "oscillatory", OSCILLATORY).up_to(Scale::AtLeast, 2.0, 0.5),
    claim("step", "classic", "undershoot_2", "oscillatory", OSCILLATORY).up_to(Scale::AtLeast, 2.0, 0.5),
    claim("step", "adaptive", "undershoot_1", "less oscillatory", LESS_OSCILLATORY).up_to(Scale::Classic, 0.5, 0.999),
    claim("step", "adaptive", "undershoot_2", "less oscillatory", LESS_OSCILLATORY).up_to(Scale::Classic, 0.5, 0.999),
    claim("step", "adaptive", "torque_settling_1", "stabilizes itself quickly around the value 0", TORQUE)
        .up_to(Scale::Itself, 100.0, 200.0),
    claim("step", "adaptive", "torque_settling_2", "stabilizes itself quickly around the value 0", TORQUE)
        .up_to(Scale::Itself, 100.0, 200.0),
    claim(
        "step",
        "adaptive",
        "alpha_ratio_max",
        "increases strongly when the speed exceeds the target",
        "largest alpha above the target at least twice the nominal one; partly: 1.1 times",
    )
    .up_to(Scale::AtLeast, 2.0, 1.1),
    claim(
        "step",
        "adaptive",
        "alpha_nominal_share",
        "nominal most of the time",
        "nominal for more than half of the time; partly: 40 %",
    )
    .up_to(Scale::AtLeast, 0.5, 0.4),
    claim("step", "adaptive", "jerk_rms", "driving comfort is increased", COMFORT).up_to(Scale::Classic, 0.95, 1.05),
    claim(
        "sine",
        "adaptive",
        "error_rms_converged",
        "approximately the same results",
        "error RMS from where each law has converged, within a factor of 1.1 of the classic law's; partly: 1.25",
    )
    .up_to(Scale::LikeClassic, 1.1, 1.25),
    claim(
        "sine",
        "adaptive",
        "settling_1",
        "quicker on the first oscillation",
        "within 5 % of the reference for the rest of the first oscillation after at most 0.9 of the classic law's metres; \
         partly: 1.1",
    )
    .up_to(Scale::Classic, 0.9, 1.1),
    claim(
        "sine",
        "adaptive",
        "overshoot_1",
        "the overshooting is almost non-existing",
        "at most 2 %, the band of settling; partly: at most half of the classic law's",
    )
    .up_to(Scale::Itself, 2.0, 2.0)
    .partly(Scale::Classic, 0.5),
    claim("driver", "adaptive", "jerk_rms", "driving comfort is increased", COMFORT).up_to(Scale::Classic, 0.95, 1.05),
    claim(
        "delay",
        "adaptive",
        "rms_over_prompt_classic",
        "quite similar to the classic MFC without delay",
        "error RMS at most 1.25 times that of the classic law without delay; partly: twice",
    )
    .up_to(Scale::Itself, 1.25, 2.0),
    claim("disturb", "classic", "error_rms", DISTURBANCES, REJECTED).up_to(Scale::Itself, TRACKED[0], TRACKED[1]),
    claim("disturb", "adaptive", "error_rms", DISTURBANCES, REJECTED).up_to(Scale::Itself, TRACKED[0], TRACKED[1]),
];

/// The claim that a row is about.
pub fn about(row: &Row) -> Option<&'static Claim> {
    let mine = |c: &&Claim| (c.test, c.controller, c.quantity) == (row.family(), row.controller, row.quantity);
    // What the disturbed drives are compared with claims nothing itself.
    CLAIMS.iter().find(mine).filter(|_| row.test != "disturb")
}

impl Claim {
    /// The verdict on the row.
    pub fn judge(&self, row: &Row, rows: &[Row]) -> Verdict {
        let keeps = |(scale, limit): Limit| match measure(scale, row, rows) {
            Some(ours) if scale == Scale::AtLeast => ours >= limit,
            Some(ours) => ours <= limit,
            None => false,
        };
        match (keeps(self.reproduced), keeps(self.partly)) {
            (true, _) => Verdict::Reproduced,
            (_, true) => Verdict::Partly,
            _ => Verdict::NotReproduced,
        }
    }

    /// The number that was judged, in words.
    pub fn why(&self, row: &Row, rows: &[Row]) -> String {
        let in_words = |scale| match (row.value, measure(scale, row, rows)) {
            (None, _) => "it never got there".to_owned(),
            (_, None) => "there is nothing to compare it with".to_owned(),
            (Some(ours), Some(measure)) => match scale {
                Scale::Itself | Scale::AtLeast if row.unit == "1" => format!("{ours:.2}"),
                Scale::Itself | Scale::AtLeast => format!("{ours:.2} {}", row.unit),
                Scale::Classic | Scale::LikeClassic => format!("{measure:.2} times the classic law's"),
            },
        };
        let mut number = in_words(self.reproduced.0);
        if self.partly.0 != self.reproduced.0 && row.value.is_some() {
            number = format!("{number}, {}", in_words(self.partly.0));
        }
        format!("{number}. Criterion: {}", self.criterion)
    }
}

/// A row's value on a scale; none if it or what it is compared with is missing.
fn measure(scale: Scale, row: &Row, rows: &[Row]) -> Option<f64> {
    let ours = row.value?;
    let other = |test: &str, controller| find(rows, test, &row.preset, row.noise, controller, row.quantity)?.value;
    match scale {
        Scale::Itself | Scale::AtLeast => Some(ours),
        // A classic law that never got there is beaten by any that did.
        Scale::Classic => Some(other(&row.test, "classic").map_or(0.0, |classic| ours / classic)),
        Scale::LikeClassic => {
            let classic = other(&row.test, "classic")?;
            Some((ours / classic).max(classic / ours))
        }
    }
}
