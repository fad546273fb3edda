//! `<param key="mfc.mass_factor" value="normal(1, 0.1)"/>` of a vehicle or vType: its names, and what its text says.

use std::collections::BTreeMap;

use super::spread::Distribution;
use crate::{
    keys::{Key, Keys, Kind, Value},
    plant::{ActuatorKeys, BodyKeys},
    registry::nearest,
    sumo_files::{Param, SumoFileError, boolean},
};

/// What a parameter gives a vehicle.
#[derive(Debug, Clone, PartialEq)]
pub enum Parameter {
    /// A value.
    Fixed(Value),
    /// A value that each vehicle draws for itself.
    Drawn(Distribution),
}

impl Parameter {
    /// Reads the text of a parameter.
    ///
    /// # Errors
    /// What would be right instead.
    pub fn read(key: &Key, text: &str) -> Result<Self, String> {
        match key.kind {
            Kind::Flag => {
                text.parse().map(|flag| Self::Fixed(Value::Flag(flag))).map_err(|_| "true or false".to_owned())
            }
            Kind::Number { unit, min, max } => {
                let number = text.trim().parse().ok().filter(|x| (min..=max).contains(x));
                let fixed = number.map(|x| Self::Fixed(Value::Number(x)));
                fixed.or_else(|| Distribution::parse(text, (min, max)).map(Self::Drawn)).ok_or_else(|| {
                    format!("a number from {min} to {max} {unit}, or normal(mean, std[, min, max]) or uniform(min, max) of such")
                })
            }
            _ => Err("nothing: this key is one of the scenario".to_owned()),
        }
    }

    /// The largest number that it gives; 0 if it gives none.
    fn largest(&self) -> f64 {
        match self {
            Self::Fixed(Value::Number(x)) => *x,
            Self::Fixed(_) => 0.0,
            Self::Drawn(distribution) => distribution.largest(),
        }
    }

    /// The value of `key` for the vehicle `id` in a run with `seed`.
    pub fn value(&self, key: &Key, seed: u64, id: &str) -> Value {
        match self {
            Self::Fixed(value) => value.clone(),
            Self::Drawn(distribution) => Value::Number(distribution.draw(seed, key.name, id)),
        }
    }
}

/// What the parameters of the demand come to.
#[derive(Debug, Default)]
pub(super) struct Checked {
    /// Keys that are none, one line each.
    pub notes: Vec<String>,
    /// The largest dead time that a vehicle may ask for \[s\].
    pub dead_time_max_s: f64,
}

/// Checks the parameters of the demand, so that a wrong one is known before its vehicle departs.
///
/// # Errors
/// The first value that its key does not take, with file and line.
pub(super) fn check(params: &[Param]) -> Result<Checked, SumoFileError> {
    let keys: BTreeMap<String, &Key> =
        parameter_keys().flat_map(|key| parameter_names(key).into_iter().map(move |name| (name, key))).collect();
    let (mut checked, mut unknown) = (Checked::default(), BTreeMap::<&str, (usize, &Param)>::new());
    for param in params {
        let read = match (param.key.as_str(), keys.get(&param.key)) {
            (_, Some(key)) => Parameter::read(key, &param.value).map(|value| {
                if key.name == "delay_s" {
                    checked.dead_time_max_s = checked.dead_time_max_s.max(value.largest());
                }
            }),
            ("has.mfc.device", _) => boolean(&param.value).map(drop).ok_or_else(|| "true or false".to_owned()),
            ("device.mfc.probability", _) => match param.value.trim().parse::<f64>() {
                Ok(share) if (0.0..=1.0).contains(&share) => Ok(()),
                _ => Err("a number from 0 to 1".to_owned()),
            },
            (name, None) => {
                unknown.entry(name).or_insert((0, param)).0 += 1;
                Ok(())
            }
        };
        read.map_err(|wanted| {
            let what = format!("{}: found \"{}\", wanted {wanted}", param.key, param.value);
            SumoFileError::Content { path: param.path.clone(), line: param.line, what }
        })?;
    }
    let names = || keys.keys().map(String::as_str).chain(["has.mfc.device", "device.mfc.probability"]);
    checked.notes.extend(unknown.into_iter().map(|(name, (count, Param { path, line, .. }))| {
        let meant = nearest(name, names()).map(|near| format!("; did you mean {near}?")).unwrap_or_default();
        let more = if count > 1 { format!(" ({count} times)") } else { String::new() };
        format!("{}:{line}: the parameter {name} is not known and changes nothing{more}{meant}", path.display())
    }));
    Ok(checked)
}

/// All keys that a vehicle or vType may carry as `mfc.<key>`.
pub fn parameter_keys() -> impl Iterator<Item = &'static Key> {
    BodyKeys::keys().iter().filter(|k| !matches!(k.kind, Kind::File)).chain(ActuatorKeys::keys())
}

/// Names of the parameter of a key: `mfc.mass_kg` and, shorter, `mfc.mass`.
pub fn parameter_names(key: &Key) -> Vec<String> {
    let mut names = vec![format!("mfc.{}", key.name)];
    if let Kind::Number { unit, .. } = key.kind
        && unit != "-"
        && let Some((short, _)) = key.name.rsplit_once('_')
    {
        names.push(format!("mfc.{short}"));
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(name: &str) -> &'static Key {
        parameter_keys().find(|key| key.name == name).unwrap()
    }

    #[test]
    fn parameters_have_a_short_name_without_the_unit() {
        assert_eq!(parameter_names(key("mass_kg")), ["mfc.mass_kg", "mfc.mass"]);
        assert_eq!(parameter_names(key("friction")), ["mfc.friction"]);
    }

    /// Checks the parameters `key = value` of a file, one a line.
    fn checked(params: &[(&str, &str)]) -> Result<Checked, String> {
        let param = |(i, (key, value)): (usize, &(&str, &str))| Param {
            path: "a.rou.xml".into(),
            line: i + 1,
            key: (*key).to_owned(),
            value: (*value).to_owned(),
        };
        check(&params.iter().enumerate().map(param).collect::<Vec<_>>()).map_err(|error| error.to_string())
    }

    #[test]
    fn wrong_values_are_errors_and_unknown_keys_are_told_with_the_nearest() {
        for (key, value, said) in [
            ("mfc.mass", "heavy", "a.rou.xml:2: mfc.mass: found \"heavy\", wanted a number from 50 to 100000 kg"),
            ("mfc.delay_s", "9", "wanted a number from 0 to 5 s"),
            ("has.mfc.device", "ture", "a.rou.xml:2: has.mfc.device: found \"ture\", wanted true or false"),
            ("device.mfc.probability", "25", "wanted a number from 0 to 1"),
        ] {
            let error = checked(&[("mfc.mass", "1700"), (key, value)]).unwrap_err();
            assert!(error.contains(said), "{error}");
        }
        let known = [("mfc.mass_factor", "normal(1,0.1)"), ("has.mfc.device", "on"), ("device.mfc.probability", "0.5")];
        assert!(checked(&known).unwrap().notes.is_empty());
        let notes = checked(&[("mfc.mas", "1"), ("mfc.mas", "2"), ("has.mfc.devise", "1"), ("mfc.colour", "red")])
            .unwrap()
            .notes;
        let unknown = "is not known and changes nothing";
        assert_eq!(
            notes,
            [
                format!("a.rou.xml:3: the parameter has.mfc.devise {unknown}; did you mean has.mfc.device?"),
                format!("a.rou.xml:4: the parameter mfc.colour {unknown}"),
                format!("a.rou.xml:1: the parameter mfc.mas {unknown} (2 times); did you mean mfc.mass?"),
            ]
        );
    }

    #[test]
    fn the_largest_dead_time_is_known_before() {
        let checked = checked(&[("mfc.delay", "0.2"), ("mfc.delay_s", "uniform(0.1, 0.6)"), ("mfc.mass", "1700")]);
        assert_eq!(checked.unwrap().dead_time_max_s, 0.6);
    }

    #[test]
    fn a_parameter_is_a_value_or_a_distribution_within_the_range_of_its_key() {
        let read = |text: &str| Parameter::read(key("mass_factor"), text);
        assert_eq!(read("1.5"), Ok(Parameter::Fixed(Value::Number(1.5))));
        let normal = |std, min, max| Ok(Parameter::Drawn(Distribution::Normal { mean: 1.0, std, min, max }));
        assert_eq!(read("normal(1,0.2)"), normal(0.2, 0.1, 10.0));
        assert_eq!(read(" normal( 1, 0.2, 0.7, 1.5 ) "), normal(0.2, 0.7, 1.5));
        assert_eq!(read("normc(1,0.2,0.7,1.5)"), normal(0.2, 0.7, 1.5), "as SUMO writes a speedFactor");
        assert_eq!(read("uniform(0.7,1.5)"), Ok(Parameter::Drawn(Distribution::Uniform { min: 0.7, max: 1.5 })));
        let wrong =
            ["", "heavy", "11", "NaN", "normal(1)", "normal(1,-1)", "normal(20,1)", "uniform(2,1)", "uniform(0,1)"];
        for text in wrong.into_iter().chain(["normal(1,0.1,2,3)", "normal(1,inf)", "uniform(1,nan)"]) {
            assert!(read(text).unwrap_err().contains("from 0.1 to 10"), "{text}");
        }
        assert_eq!(Parameter::read(key("combined_slip"), "true"), Ok(Parameter::Fixed(Value::Flag(true))));
        assert_eq!(Parameter::read(key("combined_slip"), "maybe"), Err("true or false".to_owned()));
    }
}
