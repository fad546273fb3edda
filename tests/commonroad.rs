//! The 7-DoF model against the CommonRoad vehicle models, a code, equations and parameter files that have nothing in
//! common with this crate but the vehicles. `tests/data/commonroad.py` makes the reference data and says how.

use std::collections::BTreeMap;

use sumo_mfc::lanes::{Flags, LANES};
use sumo_mfc::plant::{BODIES, Body, Inputs, Plant, PlantBlock, SevenDof, State};

const PERIOD_S: f64 = 0.01;
const FIRST: Flags = {
    let mut first = [0.0; LANES];
    first[0] = 1.0;
    first
};

/// A row of the reference data: its texts, then its numbers.
fn rows(csv: &str, texts: usize) -> impl Iterator<Item = (Vec<&str>, Vec<f64>)> {
    assert!(csv.starts_with("# commonroad-vehicle-models 3.0.2\n"), "the data say which version made them");
    csv.lines().skip(2).map(move |row| {
        let fields: Vec<&str> = row.split(',').collect();
        (fields[..texts].to_vec(), fields[texts..].iter().map(|x| x.parse().unwrap()).collect())
    })
}

fn preset(name: &str) -> Body {
    (BODIES.iter().find(|body| body.name == name).unwrap().build)()
}

/// States every 10 ms of `body` from `v0_mps` straight ahead, at the torque m·r·`accel_mps2` and the steer angle of the
/// instant.
fn drive(body: &Body, v0_mps: f64, accel_mps2: f64, seconds: f64, steer_rad: impl Fn(f64) -> f64) -> Vec<State> {
    let plant = SevenDof::new(PERIOD_S);
    let mut block = PlantBlock::default();
    block.set_body(0, body);
    block.set_state(0, &State::rolling(body, v0_mps));
    let mut inputs = Inputs::default();
    inputs.torque_nm[0] = accel_mps2 * body.nominal_nm_per_mps2();
    let periods = (seconds / PERIOD_S).round() as usize;
    (0..periods)
        .map(|k| {
            inputs.steer_rad[0] = steer_rad((k as f64 + 0.5) * PERIOD_S);
            plant.advance(&mut block, &inputs, &FIRST, PERIOD_S);
            block.state(0)
        })
        .collect()
}

#[test]
fn val_manoeuvres_of_the_single_track_drift_model() {
    // h_s of the three parameter files.
    let heights_m = BTreeMap::from([("ford_escort", 0.59436), ("bmw_320i", 0.61373), ("vw_vanagon", 0.804491)]);
    let mut worst = [0.0_f64; 2];
    for (texts, numbers) in rows(include_str!("data/commonroad_std.csv"), 1) {
        let [v0, accel, steer, seconds, vx, _, yaw_rate] = numbers[..] else { panic!("{numbers:?}") };
        let mut body = preset(texts[0]);
        // Its single track has one wheel per axle with the inertia of one, and loads that move with the acceleration.
        body.wheel_inertia_kgm2 *= 0.5;
        body.cg_height_m = heights_m[texts[0]];
        let state = *drive(&body, v0, accel, seconds, |_| steer).last().unwrap();
        worst[0] = worst[0].max((state.vx_mps / vx - 1.0).abs());
        if steer != 0.0 {
            worst[1] = worst[1].max((state.yaw_rate_radps / yaw_rate - 1.0).abs());
        }
    }
    println!("worst relative difference: V_x {:.1e}, yaw rate {:.1e}", worst[0], worst[1]);
    assert!(worst[0] < 5e-4 && worst[1] < 0.02, "{worst:?}");
}

/// One manoeuvre of the multi-body model next to the 7-DoF model's.
struct Manoeuvre {
    body: String,
    tyres: String,
    kind: String,
    v0_mps: f64,
    accel_mps2: f64,
    steer_rad: f64,
    /// Time [s], V_x [m/s], yaw rate [rad/s] of the reference.
    reference: Vec<[f64; 3]>,
    /// V_x and yaw rate here, at the same times.
    ours: Vec<[f64; 2]>,
}

impl Manoeuvre {
    fn name(&self) -> String {
        format!("{} {} {} {} {}", self.body, self.kind, self.v0_mps, self.accel_mps2, self.steer_rad)
    }

    /// Largest lateral acceleration V_x·ψ̇ of the reference [m/s²].
    fn lateral_mps2(&self) -> f64 {
        self.reference.iter().map(|[_, vx, yaw_rate]| (vx * yaw_rate).abs()).fold(0.0, f64::max)
    }

    /// Worst relative difference of V_x.
    fn speed_error(&self) -> f64 {
        std::iter::zip(&self.ours, &self.reference).map(|(a, b)| (a[0] / b[1] - 1.0).abs()).fold(0.0, f64::max)
    }

    /// Worst difference of the yaw rate over the largest yaw rate of the reference.
    fn yaw_error(&self) -> f64 {
        let largest = self.reference.iter().map(|row| row[2].abs()).fold(0.0, f64::max);
        let worst = std::iter::zip(&self.ours, &self.reference).map(|(a, b)| (a[1] - b[2]).abs()).fold(0.0, f64::max);
        worst / largest
    }
}

/// The package's vehicle as the 7-DoF model can have it. Of the parameter files: h_cg, mean track, m_s and m_uf = m_ur.
/// The axles of the multi-body model carry their unsprung masses beside their share of the sprung one, while its lever
/// arms a and b are those of the sprung mass; as D = μ F_z, the friction makes up for the difference in F_z.
fn multi_body(name: &str) -> Body {
    let [height_m, track_m, sprung_kg, unsprung_kg] = match name {
        "ford_escort" => [0.55778, 1.40665, 1094.543, 65.673],
        "bmw_320i" => [0.57487, 1.37541, 965.711, 63.792],
        "vw_vanagon" => [0.74782, 1.55905, 1316.609, 81.144],
        other => panic!("{other}"),
    };
    let mut body = preset(name);
    (body.cg_height_m, body.track_width_m) = (height_m, track_m);
    let share = [body.rear_axle_m, body.front_axle_m].map(|arm| arm / body.wheelbase_m());
    let here = body.static_load_n();
    for wheel in 0..4 {
        let there = 0.5 * 9.81 * (sprung_kg * share[wheel / 2] + unsprung_kg);
        body.friction[wheel] *= there / here[wheel];
    }
    body
}

/// All manoeuvres of the multi-body model, driven here too.
fn manoeuvres() -> Vec<Manoeuvre> {
    let mut all: Vec<Manoeuvre> = Vec::new();
    for (texts, numbers) in rows(include_str!("data/commonroad_mb.csv"), 3) {
        let [v0_mps, accel_mps2, steer_rad, time_s, vx, _, yaw_rate] = numbers[..] else { panic!("{numbers:?}") };
        let [body, tyres, kind] = [0, 1, 2].map(|k| texts[k].to_owned());
        let next = Manoeuvre { body, tyres, kind, v0_mps, accel_mps2, steer_rad, reference: vec![], ours: vec![] };
        if all.last().is_none_or(|last| last.name() != next.name() || last.tyres != next.tyres) {
            all.push(next);
        }
        all.last_mut().unwrap().reference.push([time_s, vx, yaw_rate]);
    }
    for m in &mut all {
        let steer = m.steer_rad;
        let states = drive(&multi_body(&m.body), m.v0_mps, m.accel_mps2, 5.0, |t| match m.kind.as_str() {
            "circle" => steer.signum() * (0.1 * t).min(steer.abs()),
            "lane_change" if t < 2.0 => steer * libm::sin(std::f64::consts::PI * t),
            _ => 0.0,
        });
        let at = |time_s: f64| states[(time_s / PERIOD_S).round() as usize - 1];
        m.ours = m.reference.iter().map(|row| at(row[0])).map(|s| [s.vx_mps, s.yaw_rate_radps]).collect();
    }
    all
}

#[test]
fn val_straight_runs_of_the_multi_body_model() {
    let straight: Vec<_> =
        manoeuvres().into_iter().filter(|m| m.kind == "straight" && m.accel_mps2.abs() <= 3.0).collect();
    assert_eq!(straight.len(), 12);
    let worst = straight.iter().map(Manoeuvre::speed_error).fold(0.0, f64::max);
    println!("worst relative difference of V_x in 5 s: {worst:.1e}, to be below 5e-3");
    assert!(worst < 1e-4, "{worst}");
}

#[test]
fn val_circles_and_lane_changes_of_the_multi_body_model() {
    for (kind, count) in [("circle", 9), ("lane_change", 6)] {
        let gentle: Vec<_> = manoeuvres()
            .into_iter()
            .filter(|m| m.kind == kind && m.tyres == "cambered" && m.lateral_mps2() <= 3.0)
            .collect();
        assert_eq!(gentle.len(), count, "{:?}", gentle.iter().map(Manoeuvre::name).collect::<Vec<_>>());
        for m in &gentle {
            println!("{} ({:.1} m/s²): yaw rate {:.2} %", m.name(), m.lateral_mps2(), 100.0 * m.yaw_error());
            assert!(m.yaw_error() < 0.05 && m.speed_error() < 0.005, "{}: {}", m.name(), m.yaw_error());
        }
    }
}

/// What is left above is camber: rolling leans the wheels by 0.4 to 0.9 rad per metre of suspension travel, and a leaning
/// tyre has a lateral force of its own. On upright tyres both models settle on the same circle, hard cornering included;
/// on the way there the multi-body model still has to roll.
#[test]
fn val_circles_of_the_multi_body_model_on_upright_tyres() {
    let upright: Vec<_> = manoeuvres().into_iter().filter(|m| m.tyres == "upright").collect();
    assert_eq!(upright.len(), 15);
    assert!(upright.iter().any(|m| m.lateral_mps2() > 6.0));
    for m in &upright {
        let (here, there) = (m.ours.last().unwrap()[1], m.reference.last().unwrap()[2]);
        println!("{} ({:.1} m/s²): {:+.2} %", m.name(), m.lateral_mps2(), 100.0 * (here / there - 1.0));
        assert!((here / there - 1.0).abs() < 0.01 && m.speed_error() < 0.005, "{}: {here}, {there}", m.name());
    }
}

/// Beyond 3 m/s² the same camber acts on more roll, and load transfer empties the inner wheels: worst differences of V_x
/// and of the yaw rate, as they are.
#[test]
fn regress_differences_to_the_multi_body_model_beyond_3_mps2() {
    let frozen = [
        ("ford_escort straight 35 -6 0", 0.00004, 0.0),
        ("ford_escort circle 15 0 0.06", 0.00628, 0.0305),
        ("ford_escort circle 20 0 0.04", 0.00776, 0.0607),
        ("ford_escort lane_change 25 0 0.03", 0.00133, 0.0620),
        ("bmw_320i straight 35 -6 0", 0.00001, 0.0),
        ("bmw_320i circle 15 0 0.06", 0.00259, 0.0211),
        ("bmw_320i circle 20 0 0.04", 0.00141, 0.0336),
        ("bmw_320i lane_change 25 0 0.03", 0.00015, 0.0556),
        ("vw_vanagon straight 35 -6 0", 0.00074, 0.0),
        ("vw_vanagon circle 15 0 0.06", 0.00393, 0.0050),
        ("vw_vanagon circle 20 0 0.04", 0.00481, 0.0187),
        ("vw_vanagon lane_change 25 0 0.03", 0.00075, 0.0142),
    ];
    let hard: Vec<_> = manoeuvres()
        .into_iter()
        .filter(|m| m.tyres == "cambered" && (m.lateral_mps2() > 3.0 || m.accel_mps2.abs() > 3.0))
        .collect();
    assert_eq!(hard.len(), frozen.len());
    for (m, (name, speed, yaw)) in std::iter::zip(&hard, frozen) {
        let now = (m.speed_error(), if m.kind == "straight" { 0.0 } else { m.yaw_error() });
        println!("(\"{}\", {:.5}, {:.4}),", m.name(), now.0, now.1);
        assert_eq!(m.name(), name);
        assert!((now.0 - speed).abs() < 1e-4 && (now.1 - yaw).abs() < 1e-3, "{name}: {now:?}");
    }
}
