//! Vehicle bodies: constants, presets with their public sources, and the keys that override them.

use super::tyre::{Identified, Tyre, TyreError, identify, read_curve};
use crate::keys::{Key, Kind, Values};
use crate::registry::Entry;

/// Gravity g [m/s²].
pub const GRAVITY_MPS2: f64 = 9.80665;

/// Density of air at 15 °C and sea level [kg/m³].
pub const AIR_DENSITY_KGPM3: f64 = 1.225;

/// Constants of one vehicle. Wheels are ordered front left, front right, rear left, rear right.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Mass M [kg].
    pub mass_kg: f64,
    /// Yaw inertia I_z [kg·m²].
    pub yaw_inertia_kgm2: f64,
    /// Centre of gravity to front axle l_f [m].
    pub front_axle_m: f64,
    /// Centre of gravity to rear axle l_r [m].
    pub rear_axle_m: f64,
    /// Track width w [m]; 0 is the paper's model, whose yaw equation knows no left and right.
    pub track_width_m: f64,
    /// Effective wheel radius r [m].
    pub wheel_radius_m: f64,
    /// Inertia I_r of each wheel [kg·m²].
    pub wheel_inertia_kgm2: f64,
    /// Longitudinal tyre shape, front and rear axle.
    pub longitudinal: [Tyre; 2],
    /// Lateral tyre shape, front and rear axle.
    pub lateral: [Tyre; 2],
    /// Friction μ of each wheel; the tyre's peak is D = μ F_z.
    pub friction: [f64; 4],
    /// Share of the driving torque on the front axle, 0 to 1.
    pub drive_front_share: f64,
    /// Share of the braking torque on the front axle, 0 to 1.
    pub brake_front_share: f64,
    /// Largest driving torque, sum over the wheels [N·m].
    pub drive_torque_max_nm: f64,
    /// Largest braking torque, sum over the wheels [N·m].
    pub brake_torque_max_nm: f64,
    /// Drag area C_d·A [m²]; 0 is the paper's model.
    pub drag_area_m2: f64,
    /// Rolling resistance coefficient [-]; 0 is the paper's model.
    pub rolling_resistance: f64,
    /// Height of the centre of gravity for quasi-static load transfer [m]; 0 is the paper's model.
    pub cg_height_m: f64,
    /// Friction ellipse: longitudinal force costs lateral force. Off in the paper's model.
    pub combined_slip: bool,
}

impl Body {
    /// Wheelbase L = l_f + l_r [m].
    pub fn wheelbase_m(&self) -> f64 {
        self.front_axle_m + self.rear_axle_m
    }

    /// Torque that accelerates this body at 1 m/s² if its wheels had no inertia, M·r [N·m per m/s²].
    pub fn nominal_nm_per_mps2(&self) -> f64 {
        self.mass_kg * self.wheel_radius_m
    }

    /// Static load F_z of each wheel on a flat road [N].
    pub fn static_load_n(&self) -> [f64; 4] {
        let half = 0.5 * self.mass_kg * GRAVITY_MPS2 / self.wheelbase_m();
        let (front, rear) = (half * self.rear_axle_m, half * self.front_axle_m);
        [front, front, rear, rear]
    }

    /// Cornering stiffness of the front and the rear axle, BCD summed over its two wheels [N/rad].
    pub fn cornering_stiffness_nprad(&self) -> [f64; 2] {
        let load = self.static_load_n();
        [0, 1].map(|axle| {
            let (left, right) = (2 * axle, 2 * axle + 1);
            let peak = self.friction[left] * load[left] + self.friction[right] * load[right];
            self.lateral[axle].slope_per_peak() * peak
        })
    }

    /// Sets B of the lateral tyres so that the axles have these cornering stiffnesses [N/rad] with the present friction.
    pub fn set_cornering_stiffness(&mut self, front_rear_nprad: [f64; 2]) {
        let now = self.cornering_stiffness_nprad();
        for axle in [0, 1] {
            self.lateral[axle].b *= front_rear_nprad[axle] / now[axle];
        }
    }

    /// Understeer gradient K_us = M/L·(l_r/C_f − l_f/C_r) [rad per m/s²]: the steering angle of steady cornering is
    /// δ = L·κ + K_us·a_y as long as the tyres are linear.
    pub fn understeer_gradient(&self) -> f64 {
        let [front, rear] = self.cornering_stiffness_nprad();
        self.mass_kg / self.wheelbase_m() * (self.rear_axle_m / front - self.front_axle_m / rear)
    }

    /// Takes over the keys of [`BODY_KEYS`] that are set in `values`; the key `tyre_curve` names a file and is left to
    /// the caller, see [`Body::apply_tyre_curve`].
    pub fn apply(&mut self, values: &Values) {
        for (name, field) in [
            ("mass_kg", &mut self.mass_kg),
            ("yaw_inertia_kgm2", &mut self.yaw_inertia_kgm2),
            ("front_axle_m", &mut self.front_axle_m),
            ("rear_axle_m", &mut self.rear_axle_m),
            ("track_width_m", &mut self.track_width_m),
            ("wheel_radius_m", &mut self.wheel_radius_m),
            ("wheel_inertia_kgm2", &mut self.wheel_inertia_kgm2),
            ("drive_front_share", &mut self.drive_front_share),
            ("brake_front_share", &mut self.brake_front_share),
            ("drive_torque_max_nm", &mut self.drive_torque_max_nm),
            ("brake_torque_max_nm", &mut self.brake_torque_max_nm),
            ("drag_area_m2", &mut self.drag_area_m2),
            ("rolling_resistance", &mut self.rolling_resistance),
            ("cg_height_m", &mut self.cg_height_m),
        ] {
            set(field, values, name);
        }
        self.apply_tyres(values);
        if values.0.contains_key("combined_slip") {
            self.combined_slip = values.flag("combined_slip");
        }
    }

    /// Tyre shapes and friction: the key without an axle or wheel first, then the more special one.
    fn apply_tyres(&mut self, values: &Values) {
        for friction in &mut self.friction {
            set(friction, values, "friction");
        }
        for (wheel, name) in
            ["friction_front_left", "friction_front_right", "friction_rear_left", "friction_rear_right"]
                .iter()
                .enumerate()
        {
            set(&mut self.friction[wheel], values, name);
        }
        for axle in [0, 1] {
            let tyre = &mut self.longitudinal[axle];
            set(&mut tyre.b, values, "longitudinal_b");
            set(&mut tyre.c, values, "longitudinal_c");
            set(&mut tyre.e, values, "longitudinal_e");
            let tyre = &mut self.lateral[axle];
            set(&mut tyre.b, values, "lateral_b");
            set(&mut tyre.c, values, "lateral_c");
            set(&mut tyre.e, values, "lateral_e");
        }
        let mut stiffness = self.cornering_stiffness_nprad();
        set(&mut stiffness[0], values, "front_stiffness_nprad");
        set(&mut stiffness[1], values, "rear_stiffness_nprad");
        if stiffness != self.cornering_stiffness_nprad() {
            self.set_cornering_stiffness(stiffness);
        }
    }

    /// Identifies the longitudinal tyre from a measured curve (`slip,force_n`, one wheel under this body's static front
    /// load) and uses its shape on both axles and its peak as the friction of all wheels.
    ///
    /// # Errors
    /// [`TyreError`] if the text is not a curve or the curve shows no Magic Formula.
    pub fn apply_tyre_curve(&mut self, csv: &str) -> Result<Identified, TyreError> {
        let found = identify(&read_curve(csv)?)?;
        self.longitudinal = [found.tyre; 2];
        self.friction = [found.peak_n / self.static_load_n()[0]; 4];
        Ok(found)
    }
}

fn set(field: &mut f64, values: &Values, name: &str) {
    if let Some(value) = values.try_number(name) {
        *field = value;
    }
}

/// The bodies that can be chosen by name.
pub static BODIES: &[Entry<fn() -> Body>] = &[Entry {
    name: "car",
    summary: "mid-size saloon, 1719 kg, front-wheel drive, the usual parameter set of the model-free control literature",
    keys: BODY_KEYS,
    build: car,
}];

/// 1719 kg, I_z 3300 kg·m², l_f 1.195 m, l_r 1.513 m, r 0.3 m: the mid-size saloon used widely in the literature on
/// model-free vehicle control. Torque limits: 4 m/s² of drive, 9 m/s² of brakes with the wheels' inertia.
fn car() -> Body {
    let tyre = Tyre { b: 10.0, c: 1.65, e: 0.5 };
    Body {
        mass_kg: 1719.0,
        yaw_inertia_kgm2: 3300.0,
        front_axle_m: 1.195,
        rear_axle_m: 1.513,
        track_width_m: 0.0,
        wheel_radius_m: 0.3,
        wheel_inertia_kgm2: 1.0,
        longitudinal: [tyre; 2],
        lateral: [tyre; 2],
        friction: [1.0; 4],
        drive_front_share: 1.0,
        brake_front_share: 0.6,
        drive_torque_max_nm: 2120.0,
        brake_torque_max_nm: 4770.0,
        drag_area_m2: 0.0,
        rolling_resistance: 0.0,
        cg_height_m: 0.0,
        combined_slip: false,
    }
}

const fn number(name: &'static str, unit: &'static str, min: f64, max: f64, help: &'static str) -> Key {
    Key { name, kind: Kind::Number { unit, min, max }, default: "", help }
}

/// Keys that override a preset. None has a default: what is not set stays as in the preset.
pub const BODY_KEYS: &[Key] = &[
    number("mass_kg", "kg", 50.0, 100_000.0, "mass"),
    number("yaw_inertia_kgm2", "kg m2", 10.0, 2e6, "yaw inertia"),
    number("front_axle_m", "m", 0.1, 20.0, "centre of gravity to front axle"),
    number("rear_axle_m", "m", 0.1, 20.0, "centre of gravity to rear axle"),
    number("track_width_m", "m", 0.0, 4.0, "track width; 0 = no yaw moment from left and right"),
    number("wheel_radius_m", "m", 0.1, 1.5, "effective wheel radius"),
    number("wheel_inertia_kgm2", "kg m2", 0.05, 200.0, "inertia of each wheel"),
    number("longitudinal_b", "-", 0.5, 100.0, "longitudinal tyre, stiffness factor B"),
    number("longitudinal_c", "-", 0.5, 2.5, "longitudinal tyre, shape factor C"),
    number("longitudinal_e", "-", -20.0, 1.0, "longitudinal tyre, curvature factor E"),
    number("lateral_b", "1/rad", 0.5, 100.0, "lateral tyre, stiffness factor B"),
    number("lateral_c", "-", 0.5, 2.5, "lateral tyre, shape factor C"),
    number("lateral_e", "-", -20.0, 1.0, "lateral tyre, curvature factor E"),
    number("front_stiffness_nprad", "N/rad", 1e3, 1e7, "cornering stiffness of the front axle; sets lateral B"),
    number("rear_stiffness_nprad", "N/rad", 1e3, 1e7, "cornering stiffness of the rear axle; sets lateral B"),
    number("friction", "-", 0.01, 2.0, "friction of all wheels"),
    number("friction_front_left", "-", 0.01, 2.0, "friction of this wheel"),
    number("friction_front_right", "-", 0.01, 2.0, "friction of this wheel"),
    number("friction_rear_left", "-", 0.01, 2.0, "friction of this wheel"),
    number("friction_rear_right", "-", 0.01, 2.0, "friction of this wheel"),
    number("drive_front_share", "-", 0.0, 1.0, "share of the driving torque on the front axle"),
    number("brake_front_share", "-", 0.0, 1.0, "share of the braking torque on the front axle"),
    number("drive_torque_max_nm", "N m", 0.0, 1e6, "largest driving torque, sum over the wheels"),
    number("brake_torque_max_nm", "N m", 0.0, 1e6, "largest braking torque, sum over the wheels"),
    number("drag_area_m2", "m2", 0.0, 20.0, "drag area C_d A; 0 = no drag"),
    number("rolling_resistance", "-", 0.0, 0.5, "rolling resistance coefficient; 0 = none"),
    number("cg_height_m", "m", 0.0, 3.0, "height of the centre of gravity; 0 = no load transfer"),
    Key {
        name: "combined_slip",
        kind: Kind::Flag,
        default: "",
        help: "friction ellipse: longitudinal force costs lateral force",
    },
    Key {
        name: "tyre_curve",
        kind: Kind::File,
        default: "",
        help: "CSV slip,force_n of one front wheel from which B, C, D and E are identified",
    },
];
