//! A condition under which laws are tuned and judged.

use crate::scenario::Override;
use std::f64::consts::TAU;

/// A name, and what differs from the scenario.
#[derive(Debug, Clone)]
pub struct Condition {
    /// Its name.
    pub name: String,
    /// The keys that differ.
    pub sets: Vec<Override>,
    /// How steep the road is.
    pub slope: Slope,
    /// The torque that the laws are told to be worth 1 m/s², over the one that is. No scenario is wrong about it for every law:
    /// `controller.accel_per_unit_mps2` is a key of some.
    pub torque_scale: f64,
}

/// How steep the road is, unlike what recordings say.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Slope {
    /// Rise over run, uphill positive; the steepest, where there are hills.
    pub grade: f64,
    /// From hill to hill \[m\]; 0 is the same slope all the way.
    pub hill_m: f64,
}

impl Condition {
    /// Reads `NAME: KEY=VALUE KEY=VALUE ...`; the values have no blanks. Beside the keys of the scenario there are those that only
    /// drives without SUMO have: `road.grade`, `road.hill_m`, `law.torque_scale`.
    ///
    /// # Errors
    /// What was wanted.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wanted = || format!("found \"{text}\", wanted \"NAME: KEY=VALUE KEY=VALUE\"");
        let (name, sets) = text.split_once(':').ok_or_else(wanted)?;
        let name = Some(name.trim()).filter(|name| !name.is_empty()).ok_or_else(wanted)?.to_owned();
        let mut condition = Self { name, sets: Vec::new(), slope: Slope::default(), torque_scale: 1.0 };
        for set in sets.split_whitespace() {
            match set.split_once('=') {
                Some(("road.grade", value)) => condition.slope.grade = number(set, value, [-0.3, 0.3])?,
                Some(("road.hill_m", value)) => condition.slope.hill_m = number(set, value, [10.0, 1e6])?,
                Some(("law.torque_scale", value)) => condition.torque_scale = number(set, value, [0.01, 100.0])?,
                _ => condition.sets.push(Override::set(set).ok_or_else(wanted)?),
            }
        }
        if condition.slope.hill_m > 0.0 && condition.slope.grade == 0.0 {
            return Err(format!("found \"{text}\", wanted how steep the hills are, too: road.grade"));
        }
        Ok(condition)
    }
}

fn number(set: &str, value: &str, [least, most]: [f64; 2]) -> Result<f64, String> {
    let found = value.parse().ok().filter(|number| (least..=most).contains(number));
    found.ok_or_else(|| format!("found \"{set}\", wanted a number from {least} to {most}"))
}

impl Slope {
    /// The slope at a place (radians, uphill positive); hills begin level and uphill.
    pub fn at(&self, distance_m: f64) -> f64 {
        let share = if self.hill_m > 0.0 { libm::sin(TAU * distance_m / self.hill_m) } else { 1.0 };
        libm::atan(self.grade * share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_is_the_same_all_the_way_or_hills() {
        let all_the_way = Condition::parse("up: road.grade=0.05").unwrap().slope;
        assert_eq!([all_the_way.at(0.0), all_the_way.at(77.0)], [libm::atan(0.05); 2]);
        let hills = Condition::parse("hills: road.grade=0.05 road.hill_m=400").unwrap().slope;
        let degrees = [0.0, 100.0, 300.0].map(|place_m| hills.at(place_m));
        assert_eq!(degrees[0], 0.0);
        assert!((degrees[1] - 0.05_f64.atan()).abs() < 1e-12 && (degrees[2] + 0.05_f64.atan()).abs() < 1e-12);
        assert_eq!(Condition::parse("level:").unwrap().slope.at(50.0), 0.0);
        let flat = Condition::parse("flat hills: road.hill_m=400").unwrap_err();
        assert!(flat.contains("road.grade"), "{flat}");
    }
}
