use super::*;
use crate::lanes::LANES;
use crate::random::Stream;

const PERIOD_S: f64 = 0.01;

/// Runs one vehicle in slot 0 through `(speed, reference)` pairs.
fn drive(start_mps: f64, points: impl IntoIterator<Item = (f64, f64)>) -> VehicleStats {
    let mut block = StatsBlock::new(PERIOD_S);
    block.reset(0, start_mps);
    for (speed, reference) in points {
        block.sample(&one(speed, reference));
    }
    block.read(0)
}

fn one(speed: f64, reference: f64) -> Sample {
    let mut sample = Sample { speed_mps: [f64::NAN; LANES], reference_mps: [f64::NAN; LANES], ..Sample::default() };
    (sample.speed_mps[0], sample.reference_mps[0], sample.active[0]) = (speed, reference, 1.0);
    sample
}

fn near(got: Option<f64>, wanted: f64, tolerance: f64) {
    let got = got.expect("a value");
    assert!((got - wanted).abs() <= tolerance, "{got} instead of {wanted}");
}

#[test]
fn law_welford_equals_two_passes() {
    let mut noise = Stream::new(7, "test", "welford");
    // A large offset: the naive Σe² − (Σe)²/n loses digits here.
    let errors: Vec<f64> = (0..5000).map(|_| 1e3 + noise.normal()).collect();
    let stats = drive(0.0, errors.iter().map(|e| (20.0 + e, 20.0)));
    let n = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / n;
    let std = (errors.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>() / n).sqrt();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt();
    assert_eq!(stats.samples, 5000);
    near(stats.error_mean, mean, 1e-9);
    near(stats.error_std, std, 1e-9);
    near(stats.error_rms, rms, 1e-9);
    near(stats.error_max_abs, errors.iter().fold(0.0, |m, e| e.abs().max(m)), 1e-9);
}

#[test]
fn law_slots_are_independent() {
    let mut noise = Stream::new(7, "test", "slots");
    let mut together = StatsBlock::new(PERIOD_S);
    let mut alone: Vec<StatsBlock> = (0..LANES).map(|_| StatsBlock::new(PERIOD_S)).collect();
    for _ in 0..400 {
        let mut sample = Sample::default();
        for i in 0..LANES {
            sample.speed_mps[i] = 10.0 + noise.normal();
            sample.reference_mps[i] = 10.0 + noise.normal();
            sample.torque_nm[i] = 100.0 * noise.normal();
            sample.active[i] = if noise.uniform() < 0.8 { 1.0 } else { 0.0 };
        }
        together.sample(&sample);
        for (i, block) in alone.iter_mut().enumerate() {
            let mut single = Sample { speed_mps: [f64::INFINITY; LANES], ..Sample::default() };
            single.speed_mps[i] = sample.speed_mps[i];
            single.reference_mps[i] = sample.reference_mps[i];
            single.torque_nm[i] = sample.torque_nm[i];
            single.active[i] = sample.active[i];
            block.sample(&single);
        }
    }
    for (i, block) in alone.iter().enumerate() {
        assert!(together.read(i).samples > 200);
        assert_eq!(together.read(i), block.read(i), "slot {i}");
    }
    let before = together.read(4);
    together.reset(3, 0.0);
    assert_eq!(together.read(3), VehicleStats::default());
    assert_eq!(together.read(4), before);
}

#[test]
fn law_shares_sum_to_one() {
    let mut block = StatsBlock::new(PERIOD_S);
    for k in 0..70 {
        let mut step = StepSample { active: [1.0; LANES], speed_gap_mps: [3.0; LANES], ..StepSample::default() };
        let bound = match k % 7 {
            0 => &mut step.bound_limit,
            1 | 2 => &mut step.bound_profile,
            3 => &mut step.bound_clamp,
            _ => &mut step.bound_traffic,
        };
        bound[5] = 1.0;
        step.lead_limited[5] = f64::from(k % 2);
        block.step(&step);
    }
    let stats = block.read(5);
    let shares = [stats.share_traffic, stats.share_limit, stats.share_profile, stats.share_clamp];
    near(shares.iter().copied().sum(), 1.0, 1e-15);
    near(stats.share_traffic, 3.0 / 7.0, 1e-15);
    near(stats.lead_limited, 0.5, 0.0);
    near(stats.speed_gap_rms, 3.0, 1e-12);
    assert_eq!(stats.clamped_steps, 10);
}

#[test]
fn a_vehicle_without_samples_has_no_statistics() {
    assert_eq!(StatsBlock::new(PERIOD_S).read(0), VehicleStats::default());
}

#[test]
fn law_sums_taken_piecewise_are_the_whole() {
    let mut block = StatsBlock::new(PERIOD_S);
    let mut whole = Sums::default();
    for k in 0..1000 {
        block.sample(&one(10.0 + f64::from(k) * 0.001, 10.0));
        if k % 100 == 99 {
            let part = block.take_sums(0);
            assert_eq!(part.samples, 100);
            whole.samples += part.samples;
            whole.error_mps += part.error_mps;
            whole.error_squared += part.error_squared;
            whole.speed_mps += part.speed_mps;
        }
    }
    let stats = block.read(0);
    assert_eq!(whole.samples, stats.samples);
    near(stats.error_mean, whole.error_mps / 1000.0, 1e-12);
    near(stats.error_rms, (whole.error_squared / 1000.0).sqrt(), 1e-12);
    near(stats.error_mean.map(|e| e + 10.0), whole.speed_mps / 1000.0, 1e-12);
    assert_eq!(block.take_sums(0), Sums::default());
}

#[test]
fn law_uniform_acceleration_has_no_jerk() {
    let stats = drive(5.0, (1..=300).map(|k| (5.0 + 2.0 * f64::from(k) * PERIOD_S, 20.0)));
    near(stats.accel_max, 2.0, 1e-9);
    near(stats.decel_max, 0.0, 0.0);
    near(stats.jerk_rms, 0.0, 1e-9);
}

#[test]
fn jerk_is_the_difference_of_neighbouring_windows() {
    // One window at +1 m/s², one at −3: a single jerk of −4 / 0.5.
    let speed = |k: u32| if k <= 50 { 0.01 * f64::from(k) } else { 0.5 - 0.03 * f64::from(k - 50) };
    let stats = drive(0.0, (1..=100).map(|k| (speed(k), 0.0)));
    near(stats.jerk_rms, 8.0, 1e-9);
    near(stats.accel_max, 1.0, 1e-9);
    near(stats.decel_max, 3.0, 1e-9);
    assert_eq!(drive(0.0, (1..=99).map(|k| (speed(k), 0.0))).jerk_rms, None);
    assert_eq!(drive(0.0, (1..=49).map(|k| (speed(k), 0.0))).accel_max, None);
}

#[test]
fn a_gap_is_no_acceleration() {
    let mut block = StatsBlock::new(PERIOD_S);
    block.reset(0, 10.0);
    for speed in [10.0, 25.0] {
        block.rejoin(0, speed);
        for _ in 0..120 {
            block.sample(&one(speed, speed));
        }
    }
    let stats = block.read(0);
    assert_eq!((stats.accel_max, stats.jerk_rms, stats.samples), (Some(0.0), Some(0.0), 240));
}

#[test]
fn overshoot_of_two_steps_up_is_the_larger_peak() {
    // 0 → 10 with a peak of 11.95, ringing, then 10 → 20 with a peak of 21.9.
    let first = [2.0, 6.0, 9.9, 11.0, 11.95, 10.5, 9.2, 10.8, 10.0].map(|v| (v, 10.0));
    let second = [12.0, 17.0, 20.5, 21.9, 19.0, 20.0].map(|v| (v, 20.0));
    near(drive(0.0, first).overshoot_max, 1.95, 1e-12);
    near(drive(0.0, first.into_iter().chain(second)).overshoot_max, 1.95, 1e-12);
    near(drive(10.0, second).overshoot_max, 1.9, 1e-12);
}

#[test]
fn a_falling_reference_has_no_overshoot() {
    // The vehicle lags behind a reference that falls: e is large and positive, and undershoots later.
    let fall = (0..500).map(|k| {
        let y = (20.0 - 0.05 * f64::from(k)).max(10.0);
        (if k < 300 { y + 1.5 } else { 9.5 }, y)
    });
    near(drive(20.0, fall.clone()).overshoot_max, 0.0, 0.0);
    // The same after a rise that was reached without overshoot.
    let rise = (0..400).map(|k| (f64::from(k) * 0.05, 20.0));
    near(drive(0.0, rise.chain(fall.skip(60))).overshoot_max, 0.0, 1e-9);
}

#[test]
fn ripples_of_the_traffic_are_no_rise() {
    let points = (0..1000).map(|k| {
        let phase = f64::from(k % 100) / 100.0;
        (10.3 - 0.4 * phase, 10.0 + 0.4 * phase)
    });
    near(drive(10.0, points).overshoot_max, 0.0, 0.0);
}

#[test]
fn a_rise_towards_a_faster_vehicle_is_not_reached_from_below() {
    // Reference 5 → 8 while the vehicle still brakes from 12: nothing was overshot.
    let falling = (0..200).map(|k| (12.0 - 0.01 * f64::from(k), 5.0));
    let risen = (0..200).map(|k| (10.0 - 0.01 * f64::from(k), 8.0));
    near(drive(12.0, falling.chain(risen)).overshoot_max, 0.0, 0.0);
}

#[test]
fn law_a_new_vehicle_does_not_inherit_the_overshoot() {
    let mut block = StatsBlock::new(PERIOD_S);
    block.reset(0, 0.0);
    for speed in [5.0, 12.0] {
        block.sample(&one(speed, 10.0));
    }
    near(block.read(0).overshoot_max, 2.0, 0.0);
    block.reset(0, 12.0);
    block.sample(&one(12.0, 10.0));
    near(block.read(0).overshoot_max, 0.0, 0.0);
}

/// What stands in the slot of a vehicle that is off the road is not its motion: its statistics are those of the same drive
/// without the pause.
#[test]
fn law_a_pause_leaves_no_trace() {
    let mut noise = Stream::new(7, "test", "pause");
    let mut blocks = [StatsBlock::new(PERIOD_S), StatsBlock::new(PERIOD_S)];
    blocks.iter_mut().for_each(|block| block.reset(0, 0.0));
    let [paused, driven] = &mut blocks;
    for k in 0..600 {
        let wanted = if k < 300 { 10.0 } else { 20.0 };
        let mut sample = one(wanted + noise.normal(), wanted);
        sample.torque_nm[0] = 100.0 * noise.normal();
        driven.sample(&sample);
        paused.sample(&sample);
        let elsewhere = [1e3, f64::NAN, -1e3][k % 3];
        let mut off = Sample { speed_mps: [elsewhere; LANES], torque_nm: [elsewhere; LANES], ..Sample::default() };
        off.reference_mps = [20.0 * noise.uniform(); LANES];
        paused.sample(&off);
        paused.step(&StepSample { speed_gap_mps: [elsewhere; LANES], bound_limit: [1.0; LANES], ..Default::default() });
    }
    assert_eq!(paused.read(0), driven.read(0));
    assert!(paused.read(0).overshoot_max > Some(1.0) && paused.read(0).jerk_rms.is_some());
    assert_eq!(paused.read(1), VehicleStats::default(), "nobody ever drove there");
}

#[test]
fn law_the_rms_of_torques_is_between_their_magnitudes() {
    let mut block = StatsBlock::new(PERIOD_S);
    for k in 0..400 {
        let mut sample = one(10.0, 10.0);
        sample.torque_nm[0] = if k % 2 == 0 { 100.0 } else { -700.0 };
        block.sample(&sample);
    }
    near(block.read(0).torque_rms, 500.0, 1e-9);
}

#[test]
fn a_vehicle_put_elsewhere_waits_for_another_rise() {
    // Under way to 10 m/s it is put to 20 m/s, from where it brakes: it did not shoot beyond 10 m/s.
    let mut block = StatsBlock::new(PERIOD_S);
    block.reset(0, 0.0);
    (0..50).for_each(|k| block.sample(&one(0.1 * f64::from(k), 10.0)));
    block.rejoin(0, 20.0);
    (0..50).for_each(|k| block.sample(&one(20.0 - 0.1 * f64::from(k), 10.0)));
    near(block.read(0).overshoot_max, 0.0, 0.0);
}

#[test]
fn a_rise_is_over_when_the_reference_has_fallen_by_more_than_its_measure() {
    // Up to 20, down to 10, up to 15 with a peak of 16.25: the crest of the first rise counts no more.
    let drive_to = |v: f64, y: f64| (0..100).map(move |k| (v * f64::from(k) / 100.0, y));
    let again = [(10.0, 10.0), (12.0, 15.0), (16.25, 15.0)];
    near(drive(0.0, drive_to(20.0, 20.0).chain(again)).overshoot_max, 1.25, 0.0);
    // Down by exactly the measure the rise goes on, and its crest is 10; by a little more it is over.
    for (fallen, overshoot) in [(10.0 - RISE_MPS, 0.25), (9.9 - RISE_MPS, 0.0)] {
        let points = [(5.0, 10.0), (9.0, fallen), (10.25, fallen)];
        near(drive(0.0, points).overshoot_max, overshoot, 0.0);
    }
}

#[test]
fn a_rise_must_exceed_its_measure_and_lie_above_the_vehicle() {
    // A vehicle that swings about a reference that stands still, or is lifted by exactly the measure, overshoots nothing.
    for reference in [10.0, 10.0 + RISE_MPS] {
        near(drive(10.0, [(9.75, reference), (11.0, reference)]).overshoot_max, 0.0, 0.0);
    }
    near(drive(10.0, [(9.75, 10.75), (11.0, 10.75)]).overshoot_max, 0.25, 0.0);
    // Nor does one that the reference has just reached from below.
    near(drive(12.0, [(12.0, 5.0), (12.0, 12.0), (12.5, 12.0)]).overshoot_max, 0.0, 0.0);
}

#[test]
fn a_slow_rise_is_a_rise() {
    let ramp = (0..1000).map(|k| (0.01 * f64::from(k) - 0.1, 0.01 * f64::from(k)));
    near(drive(0.0, ramp.chain([(10.5, 10.0)])).overshoot_max, 0.5, 1e-12);
}
