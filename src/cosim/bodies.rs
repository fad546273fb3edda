//! Which body a SUMO vehicle gets: by vehicle class, then by what SUMO knows of the vType, then by the scenario's group,
//! then by `<param key="mfc....">` of vType and vehicle. Two-wheelers, rail, ships and pedestrians stay SUMO's own.

use super::error::CosimError;
use crate::fleet::{ActuatorSetup, VehicleSetup};
use crate::keys::{Key, Keys, Value, Values};
use crate::measurement::sigma_mps;
use crate::plant::{ActuatorKeys, Body, BodyKeys};
use crate::random::Stream;
use crate::registry::find;
use crate::scenario::{Group, Parameter, Preset};

/// The factor that may be 0: a vehicle without drive and brakes.
const TORQUE_FACTOR: &str = "torque_factor";

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
    /// `mfc.*` parameters.
    pub parameters: Vec<(&'static Key, String)>,
    /// `has.mfc.device`.
    pub equipped: Option<bool>,
    /// `device.mfc.probability`.
    pub probability: Option<f64>,
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

/// Builds the vehicle `id` of `group`, and tells the mass that it has by preset and vType alone \[kg\]; `tyre_curve` is
/// the content of the file that the group's key names.
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
) -> Result<(VehicleSetup, f64), CosimError> {
    let (preset, by_class) = match &group.vehicle.preset {
        Preset::Named(preset) => (preset, false),
        Preset::ByClass(bodies) => (find("body", bodies, preset_of_class(&facts.class).unwrap_or("car"))?, true),
    };
    let mut body = (preset.build)();
    if by_class && matches!(preset.name, "bus" | "truck") {
        scale(&mut body, facts);
    }
    let usual_kg = body.mass_kg;
    let mut given = group.vehicle.body.draw(seed, id);
    let mut actuator = group.actuator.values.clone();
    actuator.0.append(&mut group.actuator.draw(seed, id).0);
    for (key, text) in facts.parameters.iter().chain(parameters) {
        given.0.insert(key.name, parse(id, key, text)?.value(key, seed, id));
    }
    let mut keys = BodyKeys::from_values(&group.vehicle.body.values);
    if given.get::<f64>(TORQUE_FACTOR).is_some() && keys.torque_factor == Some(0.0) {
        // No factor makes anything of the 0 of its group, whose place it takes.
        keys.torque_factor = Some(1.0);
    }
    body.apply(&keys);
    if let Some(curve) = tyre_curve {
        body.apply_tyre_curve(curve)?;
    }
    let nominal_nm_per_mps2 = body.nominal_nm_per_mps2();
    cover_type(&mut body, facts, &keys);

    replace_factors(&mut given, &group.vehicle.body.values);
    body.apply(&BodyKeys::from_values(&given));
    actuator.0.append(&mut given.0);
    let actuator = ActuatorKeys::from_values(&actuator);
    let actuator = ActuatorSetup { dead_time_s: actuator.delay_s, lag_s: actuator.lag_s };
    let noise = group.noise.power_db.map(|db| (Stream::new(seed, "noise", id), sigma_mps(db)));
    Ok((VehicleSetup { body, nominal_nm_per_mps2, actuator, noise, speed_mps }, usual_kg))
}

/// A vehicle's own factor takes the place of its group's, which is in the body already.
fn replace_factors(own: &mut Values, group: &Values) {
    for (name, value) in own.0.iter_mut().filter(|(name, _)| name.ends_with("_factor")) {
        if let (Value::Number(factor), Some(applied)) = (value, group.get::<f64>(name).filter(|f| *f > 0.0)) {
            *factor /= applied;
        }
    }
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
    if set.drive_torque_max_nm.or(set.torque_factor).is_some() {
        body.drive_torque_max_nm = given.0;
    }
    if set.brake_torque_max_nm.or(set.torque_factor).is_some() {
        body.brake_torque_max_nm = given.1;
    }
}

fn parse(id: &str, key: &Key, text: &str) -> Result<Parameter, CosimError> {
    Parameter::read(key, text).map_err(|wanted| CosimError::Parameter {
        vehicle: id.to_owned(),
        key: format!("mfc.{}", key.name),
        found: text.to_owned(),
        wanted,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::BODIES;
    use crate::scenario::{Catalog, Override, Request, Scenario, parameter_keys};

    /// The vehicle `id`, perhaps with a parameter of its own (key without `mfc.`, text), and its usual mass \[kg\].
    fn built(class: &str, id: &str, own: Option<(&str, &str)>, sets: &[&str]) -> (VehicleSetup, f64) {
        let overrides = sets.iter().map(|set| Override::set(set).unwrap()).collect();
        let scenario = Scenario::load_offline(&Request { scenario: None, overrides }, &Catalog::installed()).unwrap();
        let key = |name| parameter_keys().find(|key| key.name == name).unwrap();
        let own: Vec<_> = own.map(|(name, text)| (key(name), text.to_owned())).into_iter().collect();
        let facts = TypeFacts { class: class.to_owned(), ..TypeFacts::default() };
        vehicle(id, &facts, &own, &scenario.groups[0], None, 1, 0.0).unwrap()
    }

    /// Mass over the preset's, and over what the law believes, of the vehicle `id` with a parameter `mfc.mass_factor`.
    fn masses(class: &str, id: &str, own: Option<&str>, sets: &[&str]) -> [f64; 2] {
        let (setup, usual_kg) = built(class, id, own.map(|text| ("mass_factor", text)), sets);
        let believed_kg = setup.nominal_nm_per_mps2 / setup.body.wheel_radius_m;
        [setup.body.mass_kg / usual_kg, setup.body.mass_kg / believed_kg]
    }

    #[test]
    fn law_a_factor_is_drawn_alike_for_every_kind_and_the_law_never_learns_it() {
        let drawn = ["vehicle.mass_factor={distribution=\"uniform\", min=0.7, max=1.5}"];
        for id in (0..50).map(|i| format!("v{i}")) {
            let [car, truck] = ["passenger", "truck"].map(|class| masses(class, &id, None, &drawn));
            assert!((0.7..=1.5).contains(&car[0]) && (car[0] - truck[0]).abs() < 1e-12, "{car:?} {truck:?}");
            assert!((truck[0] - truck[1]).abs() < 1e-12, "{truck:?}");
            let own = masses("truck", &id, Some("normal(1, 0.1, 0.9, 1.1)"), &drawn);
            assert!((0.9..=1.1).contains(&own[0]), "{own:?}");
        }
        let [[a, _], [b, _]] = ["a", "b"].map(|id| masses("truck", id, Some("uniform(0.7, 1.5)"), &[]));
        assert!(a != b, "each vehicle of a type draws its own");
    }

    #[test]
    fn a_vehicles_own_factor_takes_the_place_of_the_groups() {
        let [mass, believed] = masses("truck", "v", Some("1.5"), &["vehicle.mass_factor=1.2"]);
        assert!((mass - 1.5).abs() < 1e-12 && (believed - 1.25).abs() < 1e-12, "{mass} {believed}");
        let [mass, believed] = masses("truck", "v", None, &["vehicle.mass_factor=1.2"]);
        assert!((mass - 1.2).abs() < 1e-12 && (believed - 1.0).abs() < 1e-12, "{mass} {believed}");
    }

    #[test]
    fn a_factor_of_the_torque_limits_is_not_covered_up() {
        let facts =
            TypeFacts { class: "truck".into(), accel_mps2: 3.0, emergency_decel_mps2: 9.0, ..TypeFacts::default() };
        let limits = |factor: Option<f64>| {
            let mut body = (find("body", &BODIES, "truck").unwrap().build)();
            let keys = BodyKeys { torque_factor: factor, ..BodyKeys::default() };
            body.apply(&keys);
            cover_type(&mut body, &facts, &keys);
            [body.drive_torque_max_nm, body.brake_torque_max_nm]
        };
        let preset = (find("body", &BODIES, "truck").unwrap().build)();
        assert_eq!(limits(Some(0.5)), [0.5 * preset.drive_torque_max_nm, 0.5 * preset.brake_torque_max_nm]);
        assert!(limits(None)[0] > preset.drive_torque_max_nm);
    }

    #[test]
    fn four_wheels_or_none() {
        assert_eq!(preset_of_class("passenger"), Some("car"));
        assert_eq!(preset_of_class("coach"), Some("bus"));
        assert_eq!(preset_of_class("delivery"), Some("van"));
        assert_eq!(["truck", "trailer"].map(preset_of_class), [Some("truck"); 2]);
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
        // The radius of gyration grows with the length.
        let gyration = |b: &Body| (b.yaw_inertia_kgm2 / b.mass_kg).sqrt() / b.wheelbase_m();
        assert!((gyration(&bus) - gyration(&before)).abs() < 1e-9, "{} {}", gyration(&bus), gyration(&before));
        let mut unknown = before.clone();
        scale(&mut unknown, &TypeFacts::default());
        assert_eq!(unknown, before, "without a length or a mass it stays as it is");
        scale(&mut unknown, &TypeFacts { mass_kg: Some(0.0), ..TypeFacts::default() });
        assert_eq!(unknown, before, "a mass of 0 is none");
    }

    #[test]
    fn law_torque_limits_are_what_the_type_asks_for_and_15_percent() {
        for asked_mps2 in [[4.0, 12.0], [8.0, 24.0]] {
            let mut body = (find("body", &BODIES, "truck").unwrap().build)();
            let [accel_mps2, emergency_decel_mps2] = asked_mps2;
            cover_type(
                &mut body,
                &TypeFacts { accel_mps2, emergency_decel_mps2, ..TypeFacts::default() },
                &BodyKeys::default(),
            );
            let given =
                [body.drive_torque_max_nm, body.brake_torque_max_nm].map(|torque_nm| torque_nm / body.wheel_radius_m);
            for (given_n, asked_mps2) in given.into_iter().zip(asked_mps2) {
                let reserve = given_n / (body.effective_mass_kg() * asked_mps2);
                assert!((reserve - 1.15).abs() < 1e-9, "{reserve}");
            }
        }
    }
}
