//! Whose trajectories are traced, and how often.

use crate::keys::{Kind, Setting, Value};

/// Whose trajectories are traced.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Trace {
    /// Nobody's.
    None,
    /// Every ego's.
    All,
    /// These vehicles'.
    Ids(Vec<String>),
}

/// When a trace has rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TraceRows {
    /// At the end of every so many SUMO steps.
    Steps(u64),
    /// At the end of every so many control periods, which divide a step.
    Periods(u32),
}

impl Trace {
    /// Whether a vehicle is traced.
    pub fn names(&self, id: &str) -> bool {
        match self {
            Self::None => false,
            Self::All => true,
            Self::Ids(ids) => ids.iter().any(|i| i == id),
        }
    }
}

impl TraceRows {
    /// Whether there is a row at the end of this step.
    pub fn at_the_end_of(self, step: u64) -> bool {
        match self {
            Self::Steps(every) => step.is_multiple_of(every),
            Self::Periods(_) => true,
        }
    }

    /// Rows every `trace_s` \[s\], of steps and control periods of these lengths \[s\].
    ///
    /// # Errors
    /// What is wanted, if rows would fall between two control periods or be unevenly spaced.
    pub fn every(trace_s: f64, step_s: f64, period_s: f64) -> Result<Self, String> {
        let steps = whole(trace_s / step_s).map(|steps| Self::Steps(steps as u64));
        let periods = whole(step_s / trace_s).and(whole(trace_s / period_s));
        let rows = steps.or(periods.map(|periods| Self::Periods(periods as u32)));
        rows.ok_or_else(|| {
            format!(
                "a multiple of SUMO's step ({step_s:?} s), or a part of it of whole control periods ({period_s:?} s)"
            )
        })
    }
}

/// The ratio of two times, if it is a whole number but for rounding.
pub(super) fn whole(ratio: f64) -> Option<f64> {
    (ratio > 0.5 && (ratio - ratio.round()).abs() < 1e-6 * ratio).then(|| ratio.round())
}

impl Setting for Trace {
    type Literal = Self;
    const KIND: Kind = Kind::Text;

    fn from_value(value: &Value) -> Option<Self> {
        let Value::Text(text) = value else { return None };
        Some(match text.as_str() {
            "" | "none" => Self::None,
            "all" => Self::All,
            ids => Self::Ids(ids.split(',').map(|id| id.trim().to_owned()).filter(|id| !id.is_empty()).collect()),
        })
    }

    fn to_value(&self) -> Option<Value> {
        Some(Value::Text(match self {
            Self::None => "none".to_owned(),
            Self::All => "all".to_owned(),
            Self::Ids(ids) => ids.join(","),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_fall_on_steps_or_on_control_periods_that_divide_one() {
        let rows = |trace_s| TraceRows::every(trace_s, 0.1, 0.01).ok();
        assert_eq!([0.1, 1.0, 0.3].map(rows), [1, 10, 3].map(|n| Some(TraceRows::Steps(n))));
        assert_eq!([0.01, 0.02, 0.05].map(rows), [1, 2, 5].map(|n| Some(TraceRows::Periods(n))));
        assert_eq!([0.001, 0.03, 0.15, 0.015].map(rows), [None; 4]);
    }
}
