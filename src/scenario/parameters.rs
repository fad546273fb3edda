//! `<param key="mfc.mass_factor" value="normal(1, 0.1)"/>` of a vehicle or vType: its names, and what its text says.

use super::spread::Distribution;
use crate::{
    keys::{Key, Keys, Kind, Value},
    plant::{ActuatorKeys, BodyKeys},
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

    /// The value of `key` for the vehicle `id` in a run with `seed`.
    pub fn value(&self, key: &Key, seed: u64, id: &str) -> Value {
        match self {
            Self::Fixed(value) => value.clone(),
            Self::Drawn(distribution) => Value::Number(distribution.draw(seed, key.name, id)),
        }
    }
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
