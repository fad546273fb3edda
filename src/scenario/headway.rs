//! How much more time headway a driver keeps because the car does not follow at once.

use crate::{
    fleet::VehicleSetup,
    keys::{Kind, Setting, Value, Values},
};

/// The word for [`HeadwayMargin::Auto`].
const AUTO: &str = "auto";

/// What is added to the vType's `tau`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HeadwayMargin {
    /// As much as the actuation takes: dead time + lag + 1/K_P of each vehicle; T_e in place of 1/K_P for laws that have that.
    Auto,
    /// This much \[s\].
    Seconds(f64),
}

impl HeadwayMargin {
    /// The margin of a vehicle whose controller has these keys \[s\].
    pub fn of(self, vehicle: &VehicleSetup, law: &Values) -> f64 {
        let rate = || law.get("k_p").filter(|k_p| *k_p > 0.0).map(|k_p: f64| 1.0 / k_p);
        let answer_s = || rate().or_else(|| law.get("error_time_s")).unwrap_or(0.0);
        match self {
            Self::Auto => vehicle.actuator.dead_time_s + vehicle.actuator.lag_s + answer_s(),
            Self::Seconds(margin_s) => margin_s,
        }
    }
}

impl Setting for HeadwayMargin {
    type Literal = Self;
    const KIND: Kind = Kind::NumberOr { unit: "-", min: f64::MIN, max: f64::MAX, word: AUTO };

    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Number(margin_s) => Some(Self::Seconds(*margin_s)),
            Value::Text(word) => (word == AUTO).then_some(Self::Auto),
            _ => None,
        }
    }

    fn to_value(&self) -> Option<Value> {
        Some(match self {
            Self::Auto => Value::Text(AUTO.to_owned()),
            Self::Seconds(margin_s) => Value::Number(*margin_s),
        })
    }
}
