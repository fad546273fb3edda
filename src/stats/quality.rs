//! Drive quality of a block of vehicles: how the body drove what SUMO's driver wanted, how it felt, and what it cost.
//!
//! - **Ratings** after SAE J2951 (2014) compare the trace that was driven, V_x at the ends of SUMO's steps, with the trace
//!   that was wanted, v* at the same instants. A rating is 100·(driven − wanted)/wanted. Both traces are given the road load
//!   of the vehicle as it is on a flat road. J2951 takes 1.015 times the test weight for the inertia of the wheels; here
//!   it is M + ΣI_r/r².
//! - **Comfort** after ISO 2631-1 (1997), along the lane alone, of the body and of v* (which is linear between the ends of
//!   steps), both every control period.
//! - **Work** of the applied torque at the wheels, ∫T·ω dt, drive and brake apart.

use super::comfort::Comfort;
use super::trace::Trace;
use crate::columns::columns;
use crate::lanes::{LANES, Lanes, vectorised};
use crate::table::record;

record! {
    /// The drive quality of one vehicle; `None` where there is nothing to rate.
    #[derive(Debug, Clone, Copy, Default, PartialEq)]
    pub struct DriveQuality {
        energy_rating: Option<f64> = "SAE J2951 ER: cycle energy driven over that of v*, less 1" ["%"];
        distance_rating: Option<f64> = "SAE J2951 DR: distance driven over that of v*, less 1" ["%"];
        energy_economy_rating: Option<f64> = "SAE J2951 EER: 1 − (1 + DR)/(1 + ER)" ["%"];
        speed_change_rating: Option<f64> = "SAE J2951 ASCR: sum of |Δv| driven over that of v*, less 1" ["%"];
        inertial_work_rating: Option<f64> = "SAE J2951 IWR: positive inertial work driven over that of v*, less 1" ["%"];
        comfort_accel: Option<f64> = "ISO 2631-1: RMS of the acceleration weighted by W_d" ["m/s²"];
        comfort_accel_target: Option<f64> = "The same of v*" ["m/s²"];
        motion_sickness: Option<f64> = "ISO 2631-1: motion sickness dose value, with W_f" ["m/s^1.5"];
        motion_sickness_target: Option<f64> = "The same of v*" ["m/s^1.5"];
        jerk_rms_target: Option<f64> = "Root mean square of the jerk of v*, as jerk_rms of vehicles.csv" ["m/s³"];
        high_jerk_share: Option<f64> = "Share of the jerks above 2 m/s³, with the acceleration averaged over 0.5 s";
        high_jerk_share_target: Option<f64> = "The same of v*";
        tractive_work: Option<f64> = "Work of driving torques at the wheels" ["kJ"];
        braking_work: Option<f64> = "Work of braking torques at the wheels, positive" ["kJ"];
        energy_per_km: Option<f64> = "Tractive work by distance" ["Wh/km"];
        energy_per_km_target: Option<f64> = "Cycle energy of v* by its distance" ["Wh/km"];
    }
}

/// What resists a vehicle on a flat road, its inertia, and how its torque is shared out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadLoad {
    /// Mass that has to be accelerated, wheels included \[kg\].
    pub effective_mass_kg: f64,
    /// Rolling resistance \[N\].
    pub rolling_n: f64,
    /// Drag over the square of the speed [N·s²/m²].
    pub drag_ns2pm2: f64,
    /// Share of a driving torque on the front axle.
    pub drive_front_share: f64,
    /// Share of a braking torque on the front axle.
    pub brake_front_share: f64,
}

columns! {
    /// The running sums of a block with control periods of `period_s` \[s\].
    #[derive(Debug, Clone)]
    pub struct QualityBlock(period_s: f64) {
        shared {
            period_s: f64 = period_s,
        }
        parts {
            driven: Trace = Trace::default(),
            wanted: Trace = Trace::default(),
            felt: Comfort = Comfort::new(period_s),
            asked: Comfort = Comfort::new(period_s),
        }
        columns {
            /// v* at the end of the last step [m/s].
            target_mps: f64 = 0.0,
            effective_mass_kg: f64 = 0.0,
            rolling_n: f64 = 0.0,
            drag_ns2pm2: f64 = 0.0,
            drive_front_share: f64 = 0.0,
            brake_front_share: f64 = 0.0,
            tractive_j: f64 = 0.0,
            braking_j: f64 = 0.0,
        }
    }
}

impl QualityBlock {
    /// A vehicle takes the slot, in which nothing may be left of the one before ([`crate::columns::Slots::clear`]).
    pub fn set_load(&mut self, slot: usize, load: &RoadLoad) {
        self.effective_mass_kg[slot] = load.effective_mass_kg;
        self.rolling_n[slot] = load.rolling_n;
        self.drag_ns2pm2[slot] = load.drag_ns2pm2;
        self.drive_front_share[slot] = load.drive_front_share;
        self.brake_front_share[slot] = load.brake_front_share;
    }

    /// The vehicle goes on at `speed_mps`, and so does v*: it departed, or was put there.
    pub fn rejoin(&mut self, slot: usize, speed_mps: f64) {
        self.target_mps[slot] = speed_mps;
        self.driven.rejoin(slot, speed_mps);
        self.wanted.rejoin(slot, speed_mps);
        self.felt.rejoin(slot, speed_mps);
        self.asked.rejoin(slot, speed_mps);
    }

    /// Takes the end of a control period: V_x [m/s], the torque applied, sum over the wheels [N·m], and the wheels' speeds,
    /// as of the plant [rad/s].
    pub fn sample(&mut self, speed_mps: &Lanes, torque_nm: &Lanes, wheels_radps: &[Lanes; 4], active: &Lanes) {
        sample_end(self, speed_mps, torque_nm, wheels_radps, active);
    }

    /// Takes the end of a SUMO step of so many control periods, of which both ends are known: V_x and v* [m/s].
    pub fn step(&mut self, speed_mps: &Lanes, target_mps: &Lanes, periods: u32, active: &Lanes) {
        step_end(self, speed_mps, target_mps, periods, active);
    }

    /// What the sums of a slot say so far.
    pub fn read(&self, slot: usize) -> DriveQuality {
        let (driven, wanted) = (&self.driven, &self.wanted);
        let rating = |driven: &Lanes, wanted: &Lanes| {
            (wanted[slot] > 0.0).then(|| 100.0 * (driven[slot] - wanted[slot]) / wanted[slot])
        };
        let energy = rating(&driven.cycle_energy_j, &wanted.cycle_energy_j);
        let distance = rating(&driven.distance_m, &wanted.distance_m);
        let economy = energy.zip(distance).map(|(er, dr)| 100.0 * (1.0 - (100.0 + dr) / (100.0 + er)));
        let per_km = |work_j: f64, trace: &Trace| {
            let distance_m = trace.distance_m[slot];
            (distance_m > 0.0).then(|| work_j / 3.6 / distance_m)
        };
        let (tractive_j, braking_j) = (self.tractive_j[slot], self.braking_j[slot]);
        // Without a controller there are no torques.
        let worked = tractive_j > 0.0 || braking_j > 0.0;
        let (felt, asked) = (&self.felt, &self.asked);
        DriveQuality {
            energy_rating: energy,
            distance_rating: distance,
            energy_economy_rating: economy,
            speed_change_rating: rating(&driven.speed_change_mps, &wanted.speed_change_mps),
            inertial_work_rating: rating(&driven.inertial_work_j, &wanted.inertial_work_j),
            comfort_accel: felt.acceleration(slot),
            comfort_accel_target: asked.acceleration(slot),
            motion_sickness: felt.sickness(slot),
            motion_sickness_target: asked.sickness(slot),
            jerk_rms_target: asked.window().jerk_rms(slot),
            high_jerk_share: felt.window().high_jerk_share(slot),
            high_jerk_share_target: asked.window().high_jerk_share(slot),
            tractive_work: worked.then_some(tractive_j / 1000.0),
            braking_work: worked.then_some(braking_j / 1000.0),
            energy_per_km: per_km(tractive_j, driven).filter(|_| worked),
            energy_per_km_target: per_km(wanted.cycle_energy_j[slot], wanted),
        }
    }
}

vectorised! {
    /// The end of a control period.
    fn sample_end(
        block: &mut QualityBlock,
        speed_mps: &Lanes,
        torque_nm: &Lanes,
        wheels_radps: &[Lanes; 4],
        active: &Lanes
    ) {
        let [front_left, front_right, rear_left, rear_right] = wheels_radps;
        for i in 0..LANES {
            let torque_nm = if active[i] > 0.0 { torque_nm[i] } else { 0.0 };
            let share = if torque_nm > 0.0 { block.drive_front_share[i] } else { block.brake_front_share[i] };
            let front_radps = 0.5 * (front_left[i] + front_right[i]);
            let rear_radps = 0.5 * (rear_left[i] + rear_right[i]);
            let work_j = torque_nm * (share * front_radps + (1.0 - share) * rear_radps) * block.period_s;
            block.tractive_j[i] += work_j.max(0.0);
            block.braking_j[i] += (-work_j).max(0.0);
        }
        block.felt.sample(speed_mps, active);
    }
}

vectorised! {
    /// The end of a SUMO step.
    fn step_end(block: &mut QualityBlock, speed_mps: &Lanes, target_mps: &Lanes, periods: u32, active: &Lanes) {
        let step_s = f64::from(periods) * block.period_s;
        let load = [&block.effective_mass_kg, &block.rolling_n, &block.drag_ns2pm2];
        block.driven.step(speed_mps, load, step_s, active);
        block.wanted.step(target_mps, load, step_s, active);
        for k in 1..=periods {
            let share = f64::from(k) / f64::from(periods);
            let mut between_mps = [0.0; LANES];
            for i in 0..LANES {
                between_mps[i] = block.target_mps[i] + (target_mps[i] - block.target_mps[i]) * share;
            }
            block.asked.sample(&between_mps, active);
        }
        for i in 0..LANES {
            block.target_mps[i] = if active[i] > 0.0 { target_mps[i] } else { block.target_mps[i] };
        }
        block.felt.settle();
        block.asked.settle();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 0.01;
    const ACTIVE: Lanes = [1.0; LANES];
    /// A body of 1000 kg whose front axle drives and whose rear axle has half of the brakes.
    const LOAD: RoadLoad = RoadLoad {
        effective_mass_kg: 1000.0,
        rolling_n: 100.0,
        drag_ns2pm2: 0.4,
        drive_front_share: 1.0,
        brake_front_share: 0.5,
    };

    /// A vehicle that is at these speeds at the ends of steps of 1 s, while these were wanted.
    fn rated(start_mps: f64, steps: &[[f64; 2]]) -> DriveQuality {
        let mut block = QualityBlock::new(PERIOD_S);
        block.set_load(0, &LOAD);
        block.rejoin(0, start_mps);
        for [driven, wanted] in steps {
            block.step(&[*driven; LANES], &[*wanted; LANES], 100, &ACTIVE);
        }
        block.read(0)
    }

    fn near(got: Option<f64>, wanted: f64) {
        let got = got.expect("a value");
        assert!((got - wanted).abs() <= 1e-9 * wanted.abs().max(1.0), "{got} instead of {wanted}");
    }

    /// By hand. Wanted: 10 → 12 → 10 m/s, driven 10 → 13 → 10.
    /// Wanted, first second: 11 m, F = 2000 + 100 + 0.4·121 = 2148.4 N, 23 632.4 J, of which inertia 22 000 J; second:
    /// F < 0. Driven, first second: 11.5 m, F = 3000 + 100 + 0.4·132.25 = 3152.9 N, 36 258.35 J, inertia 34 500 J.
    #[test]
    fn law_ratings_are_those_of_a_hand_worked_trace() {
        let quality = rated(10.0, &[[13.0, 12.0], [10.0, 10.0]]);
        let er = 100.0 * (36_258.35 / 23_632.4 - 1.0);
        let dr = 100.0 * (23.0 / 22.0 - 1.0);
        near(quality.energy_rating, er);
        near(quality.distance_rating, dr);
        near(quality.energy_economy_rating, 100.0 * (1.0 - (1.0 + dr / 100.0) / (1.0 + er / 100.0)));
        near(quality.speed_change_rating, 50.0);
        near(quality.inertial_work_rating, 100.0 * (34_500.0 / 22_000.0 - 1.0));
        near(quality.energy_per_km_target, 23_632.4 / 3600.0 / 0.022);
    }

    #[test]
    fn law_a_trace_that_is_the_wanted_one_rates_zero() {
        let quality = rated(10.0, &[[12.0, 12.0], [10.0, 10.0], [11.0, 11.0]]);
        for rating in [
            quality.energy_rating,
            quality.distance_rating,
            quality.energy_economy_rating,
            quality.speed_change_rating,
            quality.inertial_work_rating,
        ] {
            assert_eq!(rating, Some(0.0));
        }
        assert_eq!((quality.tractive_work, quality.energy_per_km), (None, None));
    }

    #[test]
    fn a_vehicle_that_stood_has_no_ratings() {
        let quality = rated(0.0, &[[0.0, 0.0]]);
        assert_eq!((quality.energy_rating, quality.distance_rating, quality.energy_per_km_target), (None, None, None));
        assert_eq!(quality.comfort_accel_target, Some(0.0));
    }

    /// 400 N·m on front wheels at 30 rad/s are 12 kW; −400 N·m half on them, half on rear wheels at 20 rad/s, 10 kW.
    #[test]
    fn law_work_is_torque_times_the_speed_of_the_wheels_it_acts_on() {
        let mut block = QualityBlock::new(PERIOD_S);
        block.set_load(0, &LOAD);
        block.rejoin(0, 10.0);
        let wheels = [[30.0; LANES], [30.0; LANES], [20.0; LANES], [20.0; LANES]];
        for torque in [400.0, -400.0] {
            // Then the slot is not active and does no work, whatever stands in it.
            for (count, torque_nm, active) in [(100, [torque; LANES], ACTIVE), (1, [f64::NAN; LANES], [0.0; LANES])] {
                (0..count).for_each(|_| block.sample(&[10.0; LANES], &torque_nm, &wheels, &active));
            }
        }
        block.step(&[10.0; LANES], &[10.0; LANES], 100, &ACTIVE);
        block.step(&[10.0; LANES], &[10.0; LANES], 100, &ACTIVE);
        let quality = block.read(0);
        near(quality.tractive_work, 12.0);
        near(quality.braking_work, 10.0);
        near(quality.energy_per_km, 12_000.0 / 3600.0 / 0.02);
    }

    /// An acceleration 0.5·sin(2π·1 Hz·t) is weighted by 1.011 for discomfort: 0.357 m/s². For sickness, over 100 s at
    /// 0.16 Hz, by 1.006: 0.5·1.006/√2·√100 = 3.557 m/s^1.5, less what the filter takes to
    /// answer at first. Its jerk is not above 2 m/s³.
    #[test]
    fn law_sines_are_felt_as_the_standard_says() {
        let drive = |frequency_hz: f64| {
            let mut comfort = Comfort::new(PERIOD_S);
            comfort.rejoin(0, 20.0);
            let omega = 2.0 * std::f64::consts::PI * frequency_hz;
            for k in 1..=10_000 {
                let speed_mps = 20.0 + 0.5 / omega * (1.0 - (omega * PERIOD_S * f64::from(k)).cos());
                comfort.sample(&[speed_mps; LANES], &ACTIVE);
            }
            comfort
        };
        let (fast, slow) = (drive(1.0), drive(0.16));
        assert!((fast.acceleration(0).unwrap() - 0.357).abs() < 0.004, "{:?}", fast.acceleration(0));
        assert!((slow.sickness(0).unwrap() - 3.557).abs() < 0.1, "{:?}", slow.sickness(0));
        assert_eq!(slow.window().high_jerk_share(0), Some(0.0));
    }

    /// The acceleration changes between 0 and 3 m/s² every second: of two changes of window one has 6 m/s³, one none.
    #[test]
    fn law_high_jerk_is_counted_by_windows() {
        let wanted: Vec<f64> = (0..20).map(|k| 3.0 * f64::from((k + 1) / 2)).collect();
        let steps: Vec<[f64; 2]> = wanted.iter().map(|v| [*v, *v]).collect();
        let quality = rated(0.0, &steps);
        near(quality.high_jerk_share_target, 19.0 / 39.0);
        near(quality.jerk_rms_target, (36.0 * 19.0 / 39.0_f64).sqrt());
    }

    #[test]
    fn a_jump_to_another_speed_is_no_driving() {
        let mut block = QualityBlock::new(PERIOD_S);
        block.set_load(0, &LOAD);
        block.rejoin(0, 5.0);
        block.step(&[5.0; LANES], &[5.0; LANES], 100, &ACTIVE);
        block.rejoin(0, 25.0);
        block.step(&[25.0; LANES], &[25.0; LANES], 100, &ACTIVE);
        let quality = block.read(0);
        assert_eq!((quality.speed_change_rating, quality.jerk_rms_target), (None, Some(0.0)));
        near(Some(block.driven.distance_m[0]), 30.0);
    }

    /// A speed that rises and falls, one sample per period and one step per second.
    fn ride(block: &mut QualityBlock, slot: usize, active: &Lanes) {
        block.set_load(slot, &LOAD);
        block.rejoin(slot, 10.0);
        for second in 0..20 {
            for k in 1..=100 {
                let speed_mps = 10.0 + 2.0 * (0.01 * f64::from(100 * second + k)).sin();
                block.sample(&[speed_mps; LANES], &[50.0; LANES], &[[30.0; LANES]; 4], active);
            }
            let speed_mps = 10.0 + 2.0 * f64::from(second + 1).sin();
            block.step(&[speed_mps; LANES], &[speed_mps + 0.1; LANES], 100, active);
        }
    }

    #[test]
    fn law_who_does_not_drive_is_not_rated() {
        assert_eq!(QualityBlock::new(PERIOD_S).read(0), DriveQuality::default());
        let mut block = QualityBlock::new(PERIOD_S);
        block.set_load(1, &LOAD);
        ride(&mut block, 0, &std::array::from_fn(|slot| if slot == 0 { 1.0 } else { 0.0 }));
        assert_eq!(block.read(1), DriveQuality::default());
        assert!(block.read(0).comfort_accel > Some(0.1) && block.read(0).motion_sickness > Some(0.1));
    }

    #[test]
    fn law_a_new_vehicle_feels_nothing_of_the_one_before() {
        let [mut second, mut first] = [QualityBlock::new(PERIOD_S), QualityBlock::new(PERIOD_S)];
        ride(&mut second, 0, &ACTIVE);
        crate::columns::Slots::clear(&mut second, 0);
        ride(&mut second, 0, &ACTIVE);
        ride(&mut first, 0, &ACTIVE);
        assert_eq!(second.read(0), first.read(0));
    }

    /// Whatever the step, the inertial work is the kinetic energy that was gained, 1000/2·(14² − 10²), and against
    /// 100 N of rolling resistance and no drag the cycle takes 100 J more for every metre.
    #[test]
    fn law_inertial_work_is_the_kinetic_energy_gained() {
        for (periods, steps) in [(10, 40), (50, 8), (100, 4)] {
            let mut block = QualityBlock::new(PERIOD_S);
            block.set_load(0, &RoadLoad { drag_ns2pm2: 0.0, ..LOAD });
            block.rejoin(0, 10.0);
            for k in 1..=steps {
                let speed_mps = 10.0 + 4.0 * f64::from(k) / f64::from(steps);
                block.step(&[speed_mps; LANES], &[speed_mps; LANES], periods, &ACTIVE);
            }
            near(Some(block.driven.distance_m[0]), 48.0);
            near(Some(block.driven.inertial_work_j[0]), 48_000.0);
            near(Some(block.driven.cycle_energy_j[0]), 52_800.0);
        }
    }

    #[test]
    fn a_vehicle_that_only_brakes_or_only_drives_has_worked() {
        for (torque_nm, tractive_kj, braking_kj) in [(400.0, 12.0, 0.0), (-400.0, 0.0, 12.0)] {
            let mut block = QualityBlock::new(PERIOD_S);
            block.set_load(0, &LOAD);
            (0..100).for_each(|_| block.sample(&[9.0; LANES], &[torque_nm; LANES], &[[30.0; LANES]; 4], &ACTIVE));
            near(block.read(0).tractive_work, tractive_kj);
            near(block.read(0).braking_work, braking_kj);
        }
    }

    /// In windows of 0.5 s from 0 to 1 m/s² is a jerk of exactly 2 m/s³, which is not above it; to 1.25 m/s² is.
    #[test]
    fn a_jerk_of_exactly_the_bound_is_not_high() {
        for (gained_mps, share) in [(0.5, 0.0), (0.625, 1.0)] {
            let mut block = QualityBlock::new(0.5);
            for speed_mps in [0.0, gained_mps] {
                block.sample(&[speed_mps; LANES], &[0.0; LANES], &[[0.0; LANES]; 4], &ACTIVE);
            }
            assert_eq!(block.read(0).high_jerk_share, Some(share));
        }
    }
}
