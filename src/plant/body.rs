//! Vehicle bodies: constants, presets with their public sources, and the keys that override them.

use super::tyre::{Identified, Tyre, TyreError, identify, read_curve};
use crate::keys;
use crate::keys::Keys;
use crate::registry::Entry;
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};

/// Gravity g [m/s²].
pub const GRAVITY_MPS2: f64 = 9.80665;

/// Density of air at 15 °C and sea level [kg/m³].
pub const AIR_DENSITY_KGPM3: f64 = 1.225;

/// Constants of one vehicle. Wheels are ordered front left, front right, rear left, rear right.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Mass M \[kg\].
    pub mass_kg: f64,
    /// Yaw inertia I_z [kg·m²].
    pub yaw_inertia_kgm2: f64,
    /// Centre of gravity to front axle l_f \[m\].
    pub front_axle_m: f64,
    /// Centre of gravity to rear axle l_r \[m\].
    pub rear_axle_m: f64,
    /// Track width w \[m\]; 0 is the paper's model, whose yaw equation knows no left and right.
    pub track_width_m: f64,
    /// Effective wheel radius r \[m\].
    pub wheel_radius_m: f64,
    /// Inertia I_r of each wheel [kg·m²].
    pub wheel_inertia_kgm2: f64,
    /// Longitudinal tyre shape, front and rear axle.
    pub longitudinal: [Tyre; 2],
    /// Lateral tyre shape, front and rear axle.
    pub lateral: [Tyre; 2],
    /// Friction μ of each wheel; the tyre's peak is D = μ F_z.
    pub friction: [f64; 4],
    /// Lateral peak over longitudinal peak [-]; 1 where one friction describes both.
    pub lateral_grip: f64,
    /// Share of the driving torque on the front axle, 0 to 1.
    pub drive_front_share: f64,
    /// Share of the braking torque on the front axle, 0 to 1.
    pub brake_front_share: f64,
    /// Largest driving torque, sum over the wheels [N·m].
    pub drive_torque_max_nm: f64,
    /// Largest braking torque, sum over the wheels [N·m].
    pub brake_torque_max_nm: f64,
    /// Drag area C_d·A \[m²\]; 0 is the paper's model.
    pub drag_area_m2: f64,
    /// Rolling resistance coefficient [-]; 0 is the paper's model.
    pub rolling_resistance: f64,
    /// Height of the centre of gravity for quasi-static load transfer \[m\]; 0 is the paper's model.
    pub cg_height_m: f64,
    /// Friction ellipse: longitudinal force costs lateral force. Off in the paper's model.
    pub combined_slip: bool,
}

impl Default for Body {
    /// The mid-size saloon.
    fn default() -> Self {
        car()
    }
}

impl Body {
    /// Wheelbase L = l_f + l_r \[m\].
    pub fn wheelbase_m(&self) -> f64 {
        self.front_axle_m + self.rear_axle_m
    }

    /// Torque that accelerates this body at 1 m/s² if its wheels had no inertia, M·r [N·m per m/s²].
    pub fn nominal_nm_per_mps2(&self) -> f64 {
        self.mass_kg * self.wheel_radius_m
    }

    /// Mass that a torque has to accelerate, M + ΣI_r/r² \[kg\].
    pub fn effective_mass_kg(&self) -> f64 {
        self.mass_kg + 4.0 * self.wheel_inertia_kgm2 / (self.wheel_radius_m * self.wheel_radius_m)
    }

    /// Rolling resistance on a flat road \[N\].
    pub fn rolling_n(&self) -> f64 {
        self.rolling_resistance * self.mass_kg * GRAVITY_MPS2
    }

    /// Drag over the square of the speed through the air, ρ C_d A/2 [N·s²/m²].
    pub fn drag_ns2pm2(&self) -> f64 {
        0.5 * AIR_DENSITY_KGPM3 * self.drag_area_m2
    }

    /// Makes the vehicle heavier or lighter as a loaded one of its kind: yaw inertia and torque limits go with the mass.
    pub fn load_to(&mut self, mass_kg: f64) {
        let factor = mass_kg / self.mass_kg;
        self.mass_kg = mass_kg;
        self.yaw_inertia_kgm2 *= factor;
        self.drive_torque_max_nm *= factor;
        self.brake_torque_max_nm *= factor;
    }

    /// Raises the torque limits where they do not allow this acceleration and deceleration [m/s²] on a flat road. What
    /// the tyres can hold of it is another matter.
    pub fn cover(&mut self, accel_mps2: f64, decel_mps2: f64) {
        let scale = self.effective_mass_kg() * self.wheel_radius_m;
        self.drive_torque_max_nm = self.drive_torque_max_nm.max(scale * accel_mps2);
        self.brake_torque_max_nm = self.brake_torque_max_nm.max(scale * decel_mps2);
    }

    /// Largest acceleration and deceleration that torque limits and friction allow on a flat road [m/s²]. All wheels brake;
    /// where one axle drives, it pulls with the load that the acceleration leaves on it (Gillespie 1992, Chapter 2).
    pub fn acceleration_max_mps2(&self) -> [f64; 2] {
        let scale = self.effective_mass_kg() * self.wheel_radius_m;
        let load_n = self.static_load_n();
        let grip = |wheels: [usize; 2]| wheels.map(|i| load_n[i] * self.friction[i]).iter().sum::<f64>() / self.mass_kg;
        let shift = |wheels: [usize; 2]| {
            wheels.map(|i| 0.5 * self.friction[i]).iter().sum::<f64>() * self.cg_height_m / self.wheelbase_m()
        };
        let (front, rear) = ([0, 1], [2, 3]);
        let all = grip(front) + grip(rear);
        let driven = match self.drive_front_share {
            1.0 => grip(front) / (1.0 + shift(front)),
            0.0 => (grip(rear) / (1.0 - shift(rear)).max(f64::MIN_POSITIVE)).min(all),
            _ => all,
        };
        [(self.drive_torque_max_nm / scale).min(driven), (self.brake_torque_max_nm / scale).min(all)]
    }

    /// Static load F_z of each wheel on a flat road \[N\].
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
            self.lateral[axle].slope_per_peak() * self.lateral_grip * peak
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

    /// Takes over the keys that are set; the key `tyre_curve` names a file and is left to
    /// the caller, see [`Body::apply_tyre_curve`].
    pub fn apply(&mut self, keys: &BodyKeys) {
        for (field, value) in [
            (&mut self.mass_kg, keys.mass_kg),
            (&mut self.yaw_inertia_kgm2, keys.yaw_inertia_kgm2),
            (&mut self.front_axle_m, keys.front_axle_m),
            (&mut self.rear_axle_m, keys.rear_axle_m),
            (&mut self.track_width_m, keys.track_width_m),
            (&mut self.wheel_radius_m, keys.wheel_radius_m),
            (&mut self.wheel_inertia_kgm2, keys.wheel_inertia_kgm2),
            (&mut self.drive_front_share, keys.drive_front_share),
            (&mut self.brake_front_share, keys.brake_front_share),
            (&mut self.drive_torque_max_nm, keys.drive_torque_max_nm),
            (&mut self.brake_torque_max_nm, keys.brake_torque_max_nm),
            (&mut self.drag_area_m2, keys.drag_area_m2),
            (&mut self.rolling_resistance, keys.rolling_resistance),
            (&mut self.cg_height_m, keys.cg_height_m),
            (&mut self.lateral_grip, keys.lateral_grip),
        ] {
            set(field, value);
        }
        self.apply_tyres(keys);
        self.apply_factors(keys);
        self.combined_slip = keys.combined_slip.unwrap_or(self.combined_slip);
    }

    /// Factors of what the preset and the other keys say.
    fn apply_factors(&mut self, keys: &BodyKeys) {
        let scale = |fields: &mut [&mut f64], factor: Option<f64>| {
            fields.iter_mut().for_each(|field| **field *= factor.unwrap_or(1.0));
        };
        scale(&mut [&mut self.mass_kg, &mut self.yaw_inertia_kgm2], keys.mass_factor);
        scale(&mut self.friction.each_mut(), keys.friction_factor);
        scale(&mut self.lateral.each_mut().map(|tyre| &mut tyre.b), keys.stiffness_factor);
        scale(&mut [&mut self.drive_torque_max_nm, &mut self.brake_torque_max_nm], keys.torque_factor);
    }

    /// Tyre shapes and friction: the key without an axle or wheel first, then the more special one.
    fn apply_tyres(&mut self, keys: &BodyKeys) {
        let special =
            [keys.friction_front_left, keys.friction_front_right, keys.friction_rear_left, keys.friction_rear_right];
        for (friction, special) in self.friction.iter_mut().zip(special) {
            set(friction, special.or(keys.friction));
        }
        for axle in [0, 1] {
            let tyre = &mut self.longitudinal[axle];
            set(&mut tyre.b, keys.longitudinal_b);
            set(&mut tyre.c, keys.longitudinal_c);
            set(&mut tyre.e, keys.longitudinal_e);
            let tyre = &mut self.lateral[axle];
            set(&mut tyre.b, keys.lateral_b);
            set(&mut tyre.c, keys.lateral_c);
            set(&mut tyre.e, keys.lateral_e);
        }
        let mut stiffness = self.cornering_stiffness_nprad();
        set(&mut stiffness[0], keys.front_stiffness_nprad);
        set(&mut stiffness[1], keys.rear_stiffness_nprad);
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

fn set(field: &mut f64, value: Option<f64>) {
    *field = value.unwrap_or(*field);
}

/// Builds a body.
pub type BuildBody = Arc<dyn Fn() -> Body + Send + Sync>;

/// The entry of a body preset: its name, one line about it, and the body.
pub fn preset(
    name: &'static str,
    summary: &'static str,
    build: impl Fn() -> Body + Send + Sync + 'static,
) -> Entry<BuildBody> {
    Entry { name, summary, keys: BodyKeys::keys(), build: Arc::new(build) }
}

/// The bodies that can be chosen by name.
pub static BODIES: LazyLock<Vec<Entry<BuildBody>>> = LazyLock::new(|| {
    vec![
        preset(
            "car",
            "mid-size saloon, 1719 kg, front-wheel drive (usual set of the model-free control literature)",
            car,
        ),
        preset("ford_escort", "compact car, 1226 kg, front-wheel drive (CommonRoad vehicle 1)", ford_escort),
        preset("bmw_320i", "saloon, 1093 kg, rear-wheel drive (CommonRoad vehicle 2)", bmw_320i),
        preset("vw_vanagon", "minibus, 1479 kg, rear-wheel drive (CommonRoad vehicle 3)", vw_vanagon),
        preset("van", "delivery van of 3.5 t, loaded to 2.8 t (wheelbase and length of a Mercedes-Benz Sprinter)", van),
        preset("bus", "city bus of 12 m, 14 t (data sheet of a Mercedes-Benz Citaro)", bus),
        preset("truck", "rigid two-axle truck, 12 t (SUMO's default mass and length, UMTRI-86-12 tyres)", truck),
    ]
});

/// 1719 kg, I_z 3300 kg·m², l_f 1.195 m, l_r 1.513 m, r 0.3 m: the mid-size saloon used widely in the literature on
/// model-free vehicle control. The paper gives no tyres: B = 10, C = 1.65, E = 0.5, μ = 1 are those of a passenger car on
/// dry asphalt. Drive for 4 m/s², brakes for 9 m/s².
fn car() -> Body {
    let tyre = Tyre { b: 10.0, c: 1.65, e: 0.5 };
    let mut body = Body {
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
        lateral_grip: 1.0,
        drive_front_share: 1.0,
        brake_front_share: 0.6,
        drive_torque_max_nm: 0.0,
        brake_torque_max_nm: 0.0,
        drag_area_m2: 0.0,
        rolling_resistance: 0.0,
        cg_height_m: 0.0,
        combined_slip: false,
    };
    body.cover(4.0, 9.0);
    body
}

/// The tyres of all CommonRoad vehicles (commonroad-vehicle-models 3.0.2, `parameters_tire.yaml`): C, E and μ are p_cx1,
/// p_ex1, p_dx1 and p_cy1, p_ey1, p_dy1; B = K/(C·μ) from the stiffness per load p_kx1 and p_ky1. Wheels: radius
/// 0.344 m, 1.7 kg·m².
fn common_road(mass_kg: f64, axles_m: [f64; 2], yaw_inertia_kgm2: f64, drive_front: f64, brake_front: f64) -> Body {
    let (mu_x, mu_y) = (1.1739, 1.0489);
    let mut body = Body {
        mass_kg,
        yaw_inertia_kgm2,
        front_axle_m: axles_m[0],
        rear_axle_m: axles_m[1],
        wheel_radius_m: 0.344,
        wheel_inertia_kgm2: 1.7,
        longitudinal: [Tyre { b: 22.303 / (1.6411 * mu_x), c: 1.6411, e: 0.46403 }; 2],
        lateral: [Tyre { b: 21.92 / (1.3507 * mu_y), c: 1.3507, e: -0.0074722 }; 2],
        friction: [mu_x; 4],
        lateral_grip: mu_y / mu_x,
        drive_front_share: drive_front,
        brake_front_share: brake_front,
        drive_torque_max_nm: 0.0,
        brake_torque_max_nm: 0.0,
        ..car()
    };
    body.cover(4.0, 9.0);
    body
}

/// CommonRoad vehicle 1: m, a, b, I_z, T_se, T_sb of `parameters_vehicle1.yaml`.
fn ford_escort() -> Body {
    common_road(1225.888, [0.88392, 1.50876], 1538.853, 1.0, 0.76)
}

/// CommonRoad vehicle 2.
fn bmw_320i() -> Body {
    common_road(1093.295, [1.156196, 1.422717], 1791.600, 0.0, 0.66)
}

/// CommonRoad vehicle 3.
fn vw_vanagon() -> Body {
    common_road(1478.898, [1.150792, 1.321136], 2473.118, 0.0, 0.64)
}

/// Sprinter of 3.5 t with medium wheelbase (manufacturer's data: wheelbase 3.665 m, tyres 235/65 R16), half loaded, the
/// load evenly on both axles; I_z = M l_f l_r, as within 10 % for the measured vehicles above. Tyres as the car's with
/// the lower friction and cornering stiffness of van tyres.
fn van() -> Body {
    let mut body = Body {
        mass_kg: 2800.0,
        yaw_inertia_kgm2: 2800.0 * 1.83 * 1.835,
        front_axle_m: 1.83,
        rear_axle_m: 1.835,
        wheel_radius_m: 0.345,
        wheel_inertia_kgm2: 1.6,
        lateral: [Tyre { b: 8.0, c: 1.5, e: 0.3 }; 2],
        friction: [0.98; 4],
        drive_front_share: 0.0,
        brake_front_share: 0.52,
        drive_torque_max_nm: 0.0,
        brake_torque_max_nm: 0.0,
        ..car()
    };
    body.cover(3.0, 9.0);
    body
}

/// Tyres of heavy vehicles: cornering stiffness 0.1 of the load per degree, peak friction 0.8 (Fancher, Ervin, Winkler,
/// Gillespie: A Factbook of the Mechanical Properties of the Components for Single-Unit and Articulated Heavy Trucks,
/// UMTRI-86-12, 1986, gives the ranges); radius and inertia of 275/70 R 22.5, twins at the rear taken into the mean.
fn heavy(mass_kg: f64, axles_m: [f64; 2], length_m: f64, brake_front: f64) -> Body {
    let mut body = Body {
        mass_kg,
        // The mass spread evenly over the vehicle's length.
        yaw_inertia_kgm2: mass_kg * length_m * length_m / 12.0,
        front_axle_m: axles_m[0],
        rear_axle_m: axles_m[1],
        wheel_radius_m: 0.465,
        wheel_inertia_kgm2: 15.0,
        longitudinal: [Tyre { b: 8.0, c: 1.5, e: 0.3 }; 2],
        lateral: [Tyre { b: 5.5, c: 1.3, e: 0.0 }; 2],
        friction: [0.8; 4],
        drive_front_share: 0.0,
        brake_front_share: brake_front,
        drive_torque_max_nm: 0.0,
        brake_torque_max_nm: 0.0,
        ..car()
    };
    body.cover(1.6, 7.0);
    body
}

/// Citaro of 12 m (manufacturer's technical information: length 11.95 m, wheelbase 5.845 m, axle loads 7.245 t and 12 t,
/// 18 t gross), half full at 14 t, the mass on the axles as the permissible loads are.
fn bus() -> Body {
    heavy(14_000.0, [3.645, 2.2], 11.95, 0.38)
}

/// SUMO's default truck (7.1 m, 12 t) with the wheelbase of distribution trucks of that size, 60 % of the load at the
/// rear.
fn truck() -> Body {
    heavy(12_000.0, [2.52, 1.68], 7.1, 0.4)
}

keys! {
    /// Keys that override a preset. None has a default: what is not set stays as in the preset.
    pub struct BodyKeys {
        /// mass
        mass_kg: Option<f64>, "kg", 50.0..=100_000.0;
        /// mass over what it is without this key; yaw inertia goes with it
        mass_factor: Option<f64>, "-", 0.1..=10.0;
        /// yaw inertia
        yaw_inertia_kgm2: Option<f64>, "kg m2", 10.0..=2e6;
        /// centre of gravity to front axle
        front_axle_m: Option<f64>, "m", 0.1..=20.0;
        /// centre of gravity to rear axle
        rear_axle_m: Option<f64>, "m", 0.1..=20.0;
        /// track width; 0 = no yaw moment from left and right
        track_width_m: Option<f64>, "m", 0.0..=4.0;
        /// effective wheel radius
        wheel_radius_m: Option<f64>, "m", 0.1..=1.5;
        /// inertia of each wheel
        wheel_inertia_kgm2: Option<f64>, "kg m2", 0.05..=200.0;
        /// longitudinal tyre, stiffness factor B
        longitudinal_b: Option<f64>, "-", 0.5..=100.0;
        /// longitudinal tyre, shape factor C
        longitudinal_c: Option<f64>, "-", 0.5..=2.5;
        /// longitudinal tyre, curvature factor E
        longitudinal_e: Option<f64>, "-", -20.0..=1.0;
        /// lateral tyre, stiffness factor B
        lateral_b: Option<f64>, "1/rad", 0.5..=100.0;
        /// lateral tyre, shape factor C
        lateral_c: Option<f64>, "-", 0.5..=2.5;
        /// lateral tyre, curvature factor E
        lateral_e: Option<f64>, "-", -20.0..=1.0;
        /// cornering stiffness of the front axle; sets lateral B
        front_stiffness_nprad: Option<f64>, "N/rad", 1e3..=1e7;
        /// cornering stiffness of the rear axle; sets lateral B
        rear_stiffness_nprad: Option<f64>, "N/rad", 1e3..=1e7;
        /// cornering stiffness of both axles over what it is without this key
        stiffness_factor: Option<f64>, "-", 0.1..=10.0;
        /// friction of all wheels
        friction: Option<f64>, "-", 0.01..=2.0;
        /// friction over what it is without this key
        friction_factor: Option<f64>, "-", 0.01..=10.0;
        /// friction of this wheel
        friction_front_left: Option<f64>, "-", 0.01..=2.0;
        /// friction of this wheel
        friction_front_right: Option<f64>, "-", 0.01..=2.0;
        /// friction of this wheel
        friction_rear_left: Option<f64>, "-", 0.01..=2.0;
        /// friction of this wheel
        friction_rear_right: Option<f64>, "-", 0.01..=2.0;
        /// lateral peak force over longitudinal peak force
        lateral_grip: Option<f64>, "-", 0.1..=2.0;
        /// share of the driving torque on the front axle
        drive_front_share: Option<f64>, "-", 0.0..=1.0;
        /// share of the braking torque on the front axle
        brake_front_share: Option<f64>, "-", 0.0..=1.0;
        /// largest driving torque, sum over the wheels
        drive_torque_max_nm: Option<f64>, "N m", 0.0..=1e6;
        /// largest braking torque, sum over the wheels
        brake_torque_max_nm: Option<f64>, "N m", 0.0..=1e6;
        /// limits of both torques over what they are without this key
        torque_factor: Option<f64>, "-", 0.0..=10.0;
        /// drag area C_d A; 0 = no drag
        drag_area_m2: Option<f64>, "m2", 0.0..=20.0;
        /// rolling resistance coefficient; 0 = none
        rolling_resistance: Option<f64>, "-", 0.0..=0.5;
        /// height of the centre of gravity; 0 = no load transfer
        cg_height_m: Option<f64>, "m", 0.0..=3.0;
        /// friction ellipse: longitudinal force costs lateral force
        combined_slip: Option<bool>;
        /// CSV slip,force_n of one front wheel from which B, C, D and E are identified
        tyre_curve: Option<PathBuf>;
    }
}
