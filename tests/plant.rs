//! Laws, oracles and limits of the plant.

use sumo_mfc::lanes::LANES;
use sumo_mfc::plant::oracle::Reference;
use sumo_mfc::plant::*;

/// Torque and steering of an urban drive, one pair per 10 ms: three times away from a red light, round bends and back to
/// a stop.
fn urban_drive(seconds: usize) -> Vec<(f64, f64)> {
    let plant = SevenDof::new(0.001);
    let mut block = PlantBlock::new();
    let scale = block.body(0).nominal_nm_per_mps2();
    let mut inputs = Inputs::default();
    let mut target: f64 = 0.0;
    (0..seconds * 100)
        .map(|k| {
            let t = k as f64 * 0.01;
            let (wish, rate) = match t % 20.0 {
                s if s < 2.0 => (0.0, 4.0),
                s if s < 10.0 => (13.9, 2.6),
                s if s < 12.0 => (8.0, 4.5),
                s if s < 15.0 => (11.0, 1.5),
                _ => (0.0, 4.5),
            };
            target += (wish - target).clamp(-0.01 * rate, 0.01 * rate);
            let v = block.vx_mps[0];
            let force = if target > 0.0 || v > 0.3 {
                3.0 * (target - v) + (wish - target).signum() * rate.min(3.0 * (wish - target).abs())
            } else {
                -3.0
            };
            inputs.torque_nm[0] = scale * force.clamp(-9.0, 4.0);
            inputs.steer_rad[0] = 0.06 * libm::sin(0.7 * t) + if v < 4.0 { 0.2 * libm::sin(0.3 * t) } else { 0.0 };
            plant.advance(&mut block, &inputs, &[1.0; LANES], 0.01);
            (inputs.torque_nm[0], inputs.steer_rad[0])
        })
        .collect()
}

fn replay(plant: &dyn Plant, drive: &[(f64, f64)]) -> Vec<State> {
    let mut block = PlantBlock::new();
    let mut inputs = Inputs::default();
    let moving = std::array::from_fn(|lane| if lane == 0 { 1.0 } else { 0.0 });
    drive
        .iter()
        .map(|&(torque, steer)| {
            inputs.torque_nm[0] = torque;
            inputs.steer_rad[0] = steer;
            plant.advance(&mut block, &inputs, &moving, 0.01);
            block.state(0)
        })
        .collect()
}

#[test]
fn probe_accuracy() {
    let drive = urban_drive(60);
    let t0 = std::time::Instant::now();
    let exact = replay(&Reference::new(1e-9), &drive);
    println!("reference took {:?}", t0.elapsed());
    for tol in [1e-7] {
        let t0 = std::time::Instant::now();
        let r = replay(&Reference::new(tol), &drive);
        let e = r.iter().zip(&exact).map(|(a, b)| (a.vx_mps - b.vx_mps).abs()).fold(0.0, f64::max);
        println!("tol {tol} err {e} took {:?}", t0.elapsed());
    }
    for h in [0.01, 0.005, 0.0025, 0.00125, 0.000625, 0.0003125] {
        let r = replay(&SevenDof::new(h), &drive);
        let mut worst = (0.0, 0, 0.0, 0.0);
        let mut ey = 0.0_f64;
        let mut eyaw = 0.0_f64;
        let mut above = 0;
        for (k, (a, b)) in r.iter().zip(&exact).enumerate() {
            let e = (a.vx_mps - b.vx_mps).abs();
            if e > worst.0 {
                worst = (e, k, a.vx_mps, b.vx_mps);
            }
            if e > 1e-4 {
                above += 1;
            }
            ey = ey.max((a.vy_mps - b.vy_mps).abs());
            eyaw = eyaw.max((a.yaw_rate_radps - b.yaw_rate_radps).abs());
        }
        println!("h {h} worst {worst:?} vy {ey:.2e} yaw {eyaw:.2e} above1e-4: {above}");
    }
    for k in (0..6000).step_by(100) {
        let s = exact[k];
        print!("{:.2}/{:.2}/{:.2} ", s.vx_mps, s.vy_mps, s.yaw_rate_radps);
    }
    println!();
}
