//! How much more time headway a driver keeps because the car does not follow at once.

use crate::{
    fleet::VehicleSetup,
    keys::{Kind, Setting, Value},
};

/// The largest margin that can be asked for \[s\].
const MARGIN_MAX_S: f64 = 10.0;

/// What is added to the vType's `tau`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HeadwayMargin {
    /// As much as the actuation takes: dead time + lag + 1/K_P, of each vehicle.
    Auto,
    /// This much \[s\].
    Seconds(f64),
}

impl HeadwayMargin {
    fn parse(text: &str) -> Result<Self, String> {
        let seconds = || text.parse().ok().filter(|s| (0.0..=MARGIN_MAX_S).contains(s)).map(Self::Seconds);
        let read = if text == "auto" { Some(Self::Auto) } else { seconds() };
        read.ok_or_else(|| format!("a number in s from 0 to {MARGIN_MAX_S} or \"auto\""))
    }

    /// The margin of a vehicle whose controller has this K_P, if it has one, [1/s] \[s\].
    pub fn of(self, vehicle: &VehicleSetup, k_p: Option<f64>) -> f64 {
        let rate = || k_p.filter(|k_p| *k_p > 0.0).map_or(0.0, |k_p| 1.0 / k_p);
        match self {
            Self::Auto => vehicle.actuator.dead_time_s + vehicle.actuator.lag_s + rate(),
            Self::Seconds(margin_s) => margin_s,
        }
    }
}

impl Setting for HeadwayMargin {
    type Literal = Self;
    const KIND: Kind = Kind::Form(|text| Self::parse(text).map(drop));

    fn from_value(value: &Value) -> Option<Self> {
        if let Value::Text(text) = value { Self::parse(text).ok() } else { None }
    }

    fn to_value(&self) -> Option<Value> {
        Some(Value::Text(match self {
            Self::Auto => "auto".to_owned(),
            Self::Seconds(margin_s) => margin_s.to_string(),
        }))
    }
}
