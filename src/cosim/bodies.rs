//! Which body a SUMO vehicle gets: by vehicle class, then by what SUMO knows of the vType, then by the scenario's group,
//! then by `<param key="mfc....">` of vType and vehicle. Two-wheelers, rail, ships and pedestrians stay SUMO's own.

use super::error::CosimError;
use crate::fleet::{ActuatorSetup, VehicleSetup};
use crate::keys::{Key, Keys, Kind, Value};
use crate::measurement::sigma_mps;
use crate::plant::{ActuatorKeys, Body, BodyKeys};
use crate::random::Stream;
use crate::registry::find;
use crate::scenario::{Group, Preset};

/// What is asked of SUMO about a vType.
#[derive(Debug, Clone, Default)]
pub struct TypeFacts {
    /// vClass.
    pub class: String,
    /// Length \[m\].
    pub length_m: f64,
    /// Mass \[kg\]; SUMO before 1.21 does not tell one.
    pub mass_kg: Option<f64>,
    /// Largest acceleration [m/s²].
    pub accel_mps2: f64,
    /// Hardest braking [m/s²].
    pub emergency_decel_mps2: f64,
    /// Time between two decisions of SUMO's driver \[s\].
    pub action_step_s: f64,
    /// `mfc.*` parameters, of [`parameter_keys`].
    pub parameters: Vec<(&'static Key, String)>,
    /// `has.mfc.device`.
    pub equipped: Option<bool>,
    /// `device.mfc.probability`.
    pub probability: Option<f64>,
}

/// All keys that a vehicle or vType may carry as `mfc.<key>`.
pub fn parameter_keys() -> impl Iterator<Item = &'static Key> {
    BodyKeys::keys().iter().filter(|k| !matches!(k.kind, Kind::File)).chain(ActuatorKeys::keys())
}

/// Names under which SUMO is asked for the parameter of a key: `mfc.mass_kg` and, shorter, `mfc.mass`.
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

/// The preset for a vClass; `None` for what has no four wheels.
pub fn preset_of_class(class: &str) -> Option<&'static str> {
    match class {
        "motorcycle" | "moped" | "bicycle" | "scooter" | "pedestrian" | "wheelchair" | "tram" | "rail_urban"
        | "rail" | "rail_electric" | "rail_fast" | "subway" | "cable_car" | "ship" | "container" | "aircraft"
        | "drone" => None,
        "delivery" => Some("van"),
        "bus" | "coach" => Some("bus"),
        "truck" | "trailer" => Some("truck"),
        _ => Some("car"),
    }
}

/// Builds the vehicle `id` of `group`; `tyre_curve` is the content of the file that the group's key names.
///
/// # Errors
/// If a `mfc.*` parameter is not what its key takes.
pub fn vehicle(
    id: &str,
    facts: &TypeFacts,
    parameters: &[(&'static Key, String)],
    group: &Group,
    tyre_curve: Option<&str>,
    seed: u64,
    speed_mps: f64,
) -> Result<VehicleSetup, CosimError> {
    let (preset, by_class) = match &group.vehicle.preset {
        Preset::Named(preset) => (preset, false),
        Preset::ByClass(bodies) => (find("body", bodies, preset_of_class(&facts.class).unwrap_or("car"))?, true),
    };
    let mut body = (preset.build)();
    if by_class && matches!(preset.name, "bus" | "truck") {
        scale(&mut body, facts);
    }
    let keys = BodyKeys::from_values(&group.vehicle.body.values);
    body.apply(&keys);
    if let Some(curve) = tyre_curve {
        body.apply_tyre_curve(curve)?;
    }
    let nominal_nm_per_mps2 = body.nominal_nm_per_mps2();
    cover_type(&mut body, facts, &keys);

    let mut given = group.vehicle.body.draw(seed, id);
    let mut actuator = group.actuator.values.clone();
    actuator.0.append(&mut group.actuator.draw(seed, id).0);
    for (key, text) in facts.parameters.iter().chain(parameters) {
        given.0.insert(key.name, parse(id, key, text)?);
    }
    body.apply(&BodyKeys::from_values(&given));
    actuator.0.append(&mut given.0);
    let actuator = ActuatorKeys::from_values(&actuator);
    let actuator = ActuatorSetup { dead_time_s: actuator.delay_s, lag_s: actuator.lag_s };
    let noise = group.noise.power_db.map(|db| (Stream::new(seed, "noise", id), sigma_mps(db)));
    Ok(VehicleSetup { body, nominal_nm_per_mps2, actuator, noise, speed_mps })
}

/// A bus or truck of another mass and length than the preset's: axles move with the length, inertia with both, and the
/// actuators stay as strong per mass.
fn scale(body: &mut Body, facts: &TypeFacts) {
    const LENGTH_PER_WHEELBASE: f64 = 2.0;
    let ratio = facts.length_m / (LENGTH_PER_WHEELBASE * body.wheelbase_m());
    if ratio > 0.0 {
        body.front_axle_m *= ratio;
        body.rear_axle_m *= ratio;
        body.yaw_inertia_kgm2 *= ratio * ratio;
    }
    if let Some(mass_kg) = facts.mass_kg.filter(|m| *m > 0.0) {
        body.load_to(mass_kg);
    }
}

/// Torque limits that the scenario does not set are at least what the vType's accel and emergencyDecel ask for, with a
/// reserve for catching up with the reference; what the tyres make of it is the tyres' affair.
fn cover_type(body: &mut Body, facts: &TypeFacts, set: &BodyKeys) {
    const RESERVE: f64 = 1.15;
    let given = (body.drive_torque_max_nm, body.brake_torque_max_nm);
    body.cover(RESERVE * facts.accel_mps2, RESERVE * facts.emergency_decel_mps2);
    if set.drive_torque_max_nm.is_some() {
        body.drive_torque_max_nm = given.0;
    }
    if set.brake_torque_max_nm.is_some() {
        body.brake_torque_max_nm = given.1;
    }
}

fn parse(id: &str, key: &Key, text: &str) -> Result<Value, CosimError> {
    let value = match key.kind {
        Kind::Flag => text.parse().ok().map(Value::Flag),
        Kind::Number { min, max, .. } => {
            text.parse::<f64>().ok().filter(|x| (min..=max).contains(x)).map(Value::Number)
        }
        _ => None,
    };
    value.ok_or_else(|| CosimError::Parameter {
        vehicle: id.to_owned(),
        key: format!("mfc.{}", key.name),
        found: text.to_owned(),
        wanted: match key.kind {
            Kind::Number { unit, min, max } => format!("a number from {min} to {max} {unit}"),
            _ => "true or false".to_owned(),
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::BODIES;

    #[test]
    fn parameters_have_a_short_name_without_the_unit() {
        let mass = BodyKeys::keys().iter().find(|k| k.name == "mass_kg").unwrap();
        assert_eq!(parameter_names(mass), ["mfc.mass_kg", "mfc.mass"]);
        let friction = BodyKeys::keys().iter().find(|k| k.name == "friction").unwrap();
        assert_eq!(parameter_names(friction), ["mfc.friction"]);
    }

    #[test]
    fn four_wheels_or_none() {
        assert_eq!(preset_of_class("passenger"), Some("car"));
        assert_eq!(preset_of_class("coach"), Some("bus"));
        assert_eq!(preset_of_class("delivery"), Some("van"));
        assert_eq!(preset_of_class("bicycle"), None);
        assert_eq!(preset_of_class("rail_urban"), None);
    }

    #[test]
    fn a_heavier_longer_bus_keeps_its_strength_per_mass() {
        let mut bus = (find("body", &BODIES, "bus").unwrap().build)();
        let before = bus.clone();
        let facts = TypeFacts { length_m: 18.0, mass_kg: Some(2.0 * before.mass_kg), ..TypeFacts::default() };
        scale(&mut bus, &facts);
        assert_eq!(bus.mass_kg, 2.0 * before.mass_kg);
        assert!((bus.wheelbase_m() - 9.0).abs() < 1e-9);
        let per_mass = |b: &Body| b.brake_torque_max_nm / b.mass_kg;
        assert!((per_mass(&bus) - per_mass(&before)).abs() < 1e-9);
    }
}
