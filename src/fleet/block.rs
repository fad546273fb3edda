//! Sixteen vehicles side by side: their plant, controller, actuators, measurement and statistics, and the order in
//! which these work in one control period.

mod change;

use super::course::{Course, Demand, Here};
use super::driver::{Driver, Ramp, SumoStep};
use super::follow::{Bound, Follow};
use super::setup::{ActuatorSetup, LoopConfig, VehicleSetup, least, road_load};
use super::snapshot::Snapshot;
use super::steering::Steering;
use crate::columns::{Slots, columns};
use crate::control::{Actuation, Command, Controller, Observation, Port};
use crate::lanes::{Flags, LANES, Lanes};
use crate::measurement::Measurement;
use crate::plant::{Actuators, Body, Inputs, PlantBlock, State};
use crate::stats::{DriveQuality, QualityBlock, Sample, StatsBlock, StepSample, Sums, VehicleStats};
use crate::stopwatch::Stopwatch;

/// Slower than this and wanted at rest: the brake holds and all states are exactly 0 [m/s].
pub const HOLD_BELOW_MPS: f64 = 0.05;

/// The parts of a block's work, as its stopwatch books them.
pub(super) const CONTROL: usize = 0;
pub(super) const PLANT: usize = 1;
pub(super) const STATISTICS: usize = 2;

/// A control period under way: its reference, who moves, and what the law is to see if there is one.
pub(super) struct Due {
    demand: Demand,
    pub(super) moving: Flags,
    pub(super) observation: Option<Observation>,
}

columns! {
    /// One block of a group: `controller`, if there is one, drives its vehicles with control periods of `period_s` and dead times up to
    /// `dead_time_max_s`. Their drive quality is kept if it is `rated`.
    pub struct Block(group: usize, controller: Option<Box<dyn Controller>>, period_s: f64, dead_time_max_s: f64, rated: bool) {
        shared {
            group: usize = group,
            command: Command = Command::default(),
            /// Control periods of the last step.
            periods: u32 = 1,
            /// What watched slots showed within the last step: period of the step (from 1), slot.
            snapshots: Vec<(u32, usize, Snapshot)> = Vec::new(),
            /// The law of its group commands it, together with the others.
            pub(super) in_lockstep: bool = false,
            /// Any slot has a disturbance.
            is_disturbed: bool = false,
            pub(super) stopwatch: Stopwatch<3> = Stopwatch::new(false),
        }
        parts {
            plant: PlantBlock = PlantBlock::default(),
            inputs: Inputs = Inputs::default(),
            controller: Option<Box<dyn Controller>> = controller,
            actuators: Actuators = Actuators::new(period_s, dead_time_max_s),
            measurement: Measurement = Measurement::default(),
            driver: Driver = Driver::default(),
            /// How each slot is steered.
            pub steering: Steering = Steering::default(),
            stats: StatsBlock = StatsBlock::new(period_s),
            quality: Option<Box<QualityBlock>> = rated.then(|| Box::new(QualityBlock::new(period_s))),
        }
        columns {
            nominal_nm_per_mps2: f64 = 1.0,
            /// Friction of the tyres on a road of friction 1.
            tyre_friction: [f64; 4] = [1.0; 4],
            road_friction: f64 = 1.0,
            occupied: f64 = 0.0,
            /// 1 = on the road; 0 = free, or teleporting.
            present: f64 = 0.0,
            held: f64 = 0.0,
            target_mps: f64 = 0.0,
            /// 1 = the target is a caller's, and no profile is below it.
            ordered: f64 = 0.0,
            /// Torque that acts beside that of the actuators.
            disturbance_nm: f64 = 0.0,
            reference_mps: f64 = 0.0,
            measured_mps: f64 = 0.0,
            clock_s: f64 = 0.0,
            acceleration_mps2: f64 = 0.0,
            sumo_mps: f64 = 0.0,
            lead_limited: f64 = 0.0,
            curvature_limited: f64 = 0.0,
            bound: Bound = Bound::Traffic,
            /// Control periods between two snapshots; 0 = none.
            watched_every: u32 = 0,
        }
    }
}

impl Block {
    /// The group that this block belongs to.
    pub fn group(&self) -> usize {
        self.group
    }

    /// Number of vehicles in the block.
    pub fn len(&self) -> usize {
        self.occupied.iter().filter(|o| **o > 0.0).count()
    }

    /// True if no slot is taken.
    pub fn is_empty(&self) -> bool {
        self.occupied.iter().all(|o| *o == 0.0)
    }

    /// A vehicle takes the slot, in which nothing is left of the one before.
    pub(super) fn admit(&mut self, slot: usize, vehicle: VehicleSetup) {
        self.clear(slot);
        let body = &vehicle.body;
        self.nominal_nm_per_mps2[slot] = vehicle.nominal_nm_per_mps2;
        let ActuatorSetup { dead_time_s, lag_s } = vehicle.actuator;
        self.actuators.set(slot, dead_time_s, lag_s, body.drive_torque_max_nm, body.brake_torque_max_nm);
        self.tyre_friction[slot] = body.friction;
        self.steering.set(slot, body.wheelbase_m(), body.understeer_gradient(), least(body.friction));
        self.plant.set_body(slot, body);
        self.quality.iter_mut().for_each(|quality| quality.set_load(slot, &road_load(body)));
        if self.controller.is_some() {
            self.driver.set_limits(slot, self.acceleration_limits_mps2(slot));
        }
        let (stream, sigma_mps) = vehicle.noise.map_or((None, 0.0), |(stream, sigma)| (Some(stream), sigma));
        self.measurement.set(slot, stream, sigma_mps);
        self.occupied[slot] = 1.0;
        self.appear(slot, vehicle.speed_mps);
    }

    /// The vehicle leaves; its statistics.
    pub(super) fn release(&mut self, slot: usize) -> VehicleStats {
        self.occupied[slot] = 0.0;
        self.vanish(slot);
        self.stats.read(slot)
    }

    /// The vehicle is on the road at this speed, rolling straight ahead: it departed, or its teleport ended.
    pub fn appear(&mut self, slot: usize, speed_mps: f64) {
        self.present[slot] = 1.0;
        self.stats.rejoin(slot, speed_mps);
        self.quality.iter_mut().for_each(|quality| quality.rejoin(slot, speed_mps));
        self.held[slot] = 0.0;
        self.target_mps[slot] = speed_mps;
        self.driver.appear(slot, speed_mps);
        self.reference_mps[slot] = speed_mps;
        self.measured_mps[slot] = speed_mps;
        self.acceleration_mps2[slot] = 0.0;
        self.plant.set_state(slot, &State::rolling(self.plant.body(slot), speed_mps));
        self.controller.iter_mut().for_each(|controller| controller.reset(slot, speed_mps));
        self.actuators.reset(slot);
        self.steering.straighten(slot);
    }

    /// The vehicle is not on the road (teleporting): nothing of it moves and nothing is counted.
    pub fn vanish(&mut self, slot: usize) {
        self.present[slot] = 0.0;
        self.plant.rest(slot);
        self.controller.clear(slot);
        self.actuators.reset(slot);
    }

    /// The speed that the vehicle is to have at the end of the coming step (or during it), and what bound it.
    pub fn set_target(&mut self, slot: usize, target_mps: f64, bound: Bound) {
        self.target_mps[slot] = target_mps;
        self.bound[slot] = bound;
    }

    /// Changes what bound the target of the running step.
    pub fn set_bound(&mut self, slot: usize, bound: Bound) {
        self.bound[slot] = bound;
    }

    /// Takes the speed v* that SUMO shows at the end of a step [m/s].
    pub fn see_speed(&mut self, slot: usize, sumo_mps: f64) {
        self.sumo_mps[slot] = sumo_mps;
    }

    /// Takes the heading that SUMO shows at the end of a step (radians, left positive); a body that stands needs none.
    pub fn see_heading(&mut self, slot: usize, heading_rad: impl Into<Option<f64>>, step_s: f64) {
        let speed_mps = self.plant.vx_mps[slot];
        let limited = self.steering.see_heading(slot, heading_rad.into(), speed_mps * step_s, speed_mps);
        self.curvature_limited[slot] = f64::from(u8::from(limited));
    }

    /// True if the body stands.
    pub fn stands(&self, slot: usize) -> bool {
        self.plant.vx_mps[slot] == 0.0
    }

    /// True if the body stood all through the last step and SUMO's car stands too: there is nothing to tell SUMO.
    pub fn rests(&self, slot: usize) -> bool {
        self.stands(slot) && self.acceleration_mps2[slot] == 0.0 && self.sumo_mps[slot] == 0.0
    }

    /// Slope of the road (radians, uphill positive).
    pub fn set_grade(&mut self, slot: usize, grade_rad: f64) {
        self.inputs.grade_rad[slot] = grade_rad;
    }

    /// Friction of the road: that of the tyres is multiplied by it.
    pub fn set_road_friction(&mut self, slot: usize, road_friction: f64) {
        if self.road_friction[slot] == road_friction {
            return;
        }
        self.road_friction[slot] = road_friction;
        let friction = self.tyre_friction[slot].map(|tyre| tyre * road_friction);
        let body = Body { friction, ..self.plant.body(slot).clone() };
        self.plant.set_body(slot, &body);
        self.steering.set_friction(slot, least(friction));
    }

    /// From now on a snapshot of the slot is taken every so many control periods of a step.
    pub fn watch(&mut self, slot: usize, every: u32) {
        self.watched_every[slot] = every;
    }

    /// The snapshots of a slot in the last step, each with its control period, from 1.
    pub fn snapshots(&self, slot: usize) -> impl Iterator<Item = (u32, &Snapshot)> {
        self.snapshots.iter().filter(move |(_, of, _)| *of == slot).map(|(period, _, snapshot)| (*period, snapshot))
    }

    /// Takes the snapshots that are due at the end of a control period.
    pub(super) fn note_snapshots(&mut self, period: u32) {
        for slot in (0..LANES).filter(|i| self.watched_every[*i] > 0 && self.present[*i] > 0.0) {
            if period.is_multiple_of(self.watched_every[slot]) {
                self.snapshots.push((period, slot, self.snapshot(slot)));
            }
        }
    }

    /// The inputs that the road and the air have on the bodies, to disturb them.
    pub fn inputs_mut(&mut self) -> &mut Inputs {
        &mut self.inputs
    }

    /// The bodies, to look at or to change (a load, another road surface).
    pub fn plant_mut(&mut self) -> &mut PlantBlock {
        &mut self.plant
    }

    /// The bodies.
    pub fn plant(&self) -> &PlantBlock {
        &self.plant
    }

    /// α̂/α_nominal of a slot; 1 without adaptation.
    pub fn alpha_ratio(&self, slot: usize) -> f64 {
        self.controller.as_ref().map_or(1.0, |controller| controller.alpha_ratio(slot))
    }

    /// F̂ of a slot [m/s²]; 0 without an estimate.
    pub fn f_hat_mps2(&self, slot: usize) -> f64 {
        self.controller.as_ref().map_or(0.0, |controller| controller.f_hat_mps2(slot))
    }

    /// True longitudinal speed [m/s].
    pub fn speed_mps(&self, slot: usize) -> f64 {
        self.plant.vx_mps[slot]
    }

    /// Acceleration that SUMO asked for in the last step [m/s²].
    pub fn asked_mps2(&self, slot: usize) -> f64 {
        self.driver.asked_mps2(slot)
    }

    /// Mean acceleration of the last step [m/s²].
    pub fn acceleration_mps2(&self, slot: usize) -> f64 {
        self.acceleration_mps2[slot]
    }

    /// ∫V_x dt since departure \[m\].
    pub fn distance_m(&self, slot: usize) -> f64 {
        self.plant.distance_m[slot]
    }

    /// Reference at the end of the last control period [m/s].
    pub fn reference_mps(&self, slot: usize) -> f64 {
        self.reference_mps[slot]
    }

    /// What the controller measured last [m/s].
    pub fn measured_mps(&self, slot: usize) -> f64 {
        self.measured_mps[slot]
    }

    /// What a slot shows now.
    pub fn snapshot(&self, slot: usize) -> Snapshot {
        let speeds_mps = [self.target_mps[slot], self.reference_mps[slot], self.measured_mps[slot]];
        Snapshot::of(slot, &self.plant, &self.inputs, self.controller.as_deref(), speeds_mps)
    }

    /// SUMO's speed v* at the end of the last step [m/s].
    pub fn sumo_mps(&self, slot: usize) -> f64 {
        self.sumo_mps[slot]
    }

    /// The vehicle's largest acceleration and deceleration as its torque limits have it [m/s²].
    pub fn acceleration_limits_mps2(&self, slot: usize) -> [f64; 2] {
        let body = self.plant.body(slot);
        [body.drive_torque_max_nm, body.brake_torque_max_nm].map(|t| t / body.nominal_nm_per_mps2())
    }

    /// Sums since they were last taken, for tables by road.
    pub fn take_sums(&mut self, slot: usize) -> Sums {
        self.stats.take_sums(slot)
    }

    /// Applied sum of wheel torques [N·m].
    pub fn torque_nm(&self, slot: usize) -> f64 {
        self.inputs.torque_nm[slot]
    }

    /// False if the slot's vehicle has diverged.
    pub fn is_sound(&self, slot: usize) -> bool {
        self.plant.is_sensible(slot)
    }

    /// What the statistics of a slot say so far.
    pub fn stats(&self, slot: usize) -> VehicleStats {
        self.stats.read(slot)
    }

    /// What the drive quality of a slot is so far, if it is kept.
    pub fn quality(&self, slot: usize) -> DriveQuality {
        self.quality.as_ref().map_or_else(DriveQuality::default, |quality| quality.read(slot))
    }

    /// One SUMO step: `periods` control periods along the reference.
    pub(super) fn step(&mut self, config: &LoopConfig, periods: u32, follow: Follow) {
        let course = self.begin(config, periods, follow);
        for k in 0..periods {
            let due = self.observe(config, &course, k);
            self.act(config, &due);
            self.note_snapshots(k + 1);
        }
        self.finish(config, &course);
    }

    /// The step begins: where its reference goes.
    pub(super) fn begin<'f>(&mut self, config: &LoopConfig, periods: u32, follow: Follow<'f>) -> Course<'f> {
        self.stopwatch.start();
        self.snapshots.clear();
        self.periods = periods;
        let before_mps = self.plant.vx_mps;
        self.lead_limited = [0.0; LANES];
        let Follow::Traffic = follow else { return Course::of_targets(follow, before_mps) };
        let step_s = f64::from(periods) * config.period_s;
        let ramps: [Ramp; LANES] = std::array::from_fn(|i| {
            let step = SumoStep { target_mps: self.target_mps[i], speed_mps: before_mps[i], step_s };
            self.driver.ramp(i, step, self.reference_mps[i], config.reference_bound_mps)
        });
        self.lead_limited = ramps.map(|r| f64::from(u8::from(r.limited)));
        let rest = self.target_mps.map(|v| if v == 0.0 { 1.0 } else { 0.0 });
        let (start_mps, rate_mps2) = (ramps.map(|r| r.start_mps), ramps.map(|r| r.rate_mps2));
        Course { follow, before_mps, start_mps, rate_mps2, rest }
    }

    /// The control period `k` (from 0) begins: what is wanted, and what is measured.
    #[inline(always)]
    pub(super) fn observe(&mut self, config: &LoopConfig, course: &Course<'_>, k: u32) -> Due {
        let here = Here {
            present: &self.present,
            target_mps: &self.target_mps,
            ordered: &self.ordered,
            speed_mps: &self.plant.vx_mps,
            distance_m: &self.plant.distance_m,
            clock_s: &self.clock_s,
        };
        let demand = course.demand(k, self.periods, config.period_s, &here);
        for i in 0..LANES {
            self.held[i] *= demand.rest[i];
            self.clock_s[i] += config.period_s;
        }
        let moving: Flags = std::array::from_fn(|i| self.present[i] * (1.0 - self.held[i]));
        let observation = self.controller.is_some().then(|| {
            self.measured_mps = self.measurement.measure(&self.plant.vx_mps, &moving);
            let seen = |x: &Lanes| std::array::from_fn(|i| x[i] * moving[i]);
            Observation {
                measured_mps: seen(&self.measured_mps),
                reference_mps: seen(&demand.start_mps),
                reference_rate_mps2: seen(&demand.rate_mps2),
                nominal_nm_per_mps2: self.nominal_nm_per_mps2,
            }
        });
        Due { demand, moving, observation }
    }

    /// The rest of the control period: the law, the actuators, the bodies, the statistics.
    #[inline(always)]
    pub(super) fn act(&mut self, config: &LoopConfig, due: &Due) {
        let Due { demand, moving, observation } = due;
        if let Some(observation) = observation {
            self.control(observation);
            self.stopwatch.lap(CONTROL);
            self.steering.angles_rad(demand.share, &self.plant.vx_mps, &mut self.inputs.steer_rad);
            let disturbed = self.is_disturbed.then(|| self.inputs.with_torque(&self.disturbance_nm));
            let inputs = disturbed.as_ref().unwrap_or(&self.inputs);
            config.plant.advance(&mut self.plant, inputs, moving, config.period_s);
            self.stand_still(demand, moving);
        } else {
            self.take_speeds(&demand.end_mps, moving, config.period_s);
        }
        self.stopwatch.lap(PLANT);
        let speed_mps = self.plant.vx_mps;
        for i in 0..LANES {
            self.reference_mps[i] = demand.end_mps[i] * (1.0 - self.held[i]);
        }
        self.stats.sample(&Sample {
            speed_mps,
            reference_mps: self.reference_mps,
            torque_nm: self.inputs.torque_nm,
            active: self.present,
        });
        if let Some(quality) = &mut self.quality {
            quality.sample(&speed_mps, &self.inputs.torque_nm, &self.plant.wheel_speed_radps, &self.present);
        }
        self.stopwatch.lap(STATISTICS);
    }

    /// The step ends.
    pub(super) fn finish(&mut self, config: &LoopConfig, course: &Course<'_>) {
        if let (None, Follow::Traffic) = (&self.controller, course.follow) {
            // To the last bit what SUMO chose: the sum of the periods' ramps need not be.
            for i in (0..LANES).filter(|i| self.present[*i] > 0.0) {
                self.plant.vx_mps[i] = self.target_mps[i];
                self.reference_mps[i] = self.target_mps[i];
            }
        }
        let (speed_mps, step_s) = (self.plant.vx_mps, f64::from(self.periods) * config.period_s);
        self.acceleration_mps2 = std::array::from_fn(|i| (speed_mps[i] - course.before_mps[i]) / step_s);
    }

    /// The law's connection to its group, if it is one of a group.
    pub(super) fn port(&mut self) -> Option<&mut Port> {
        self.controller.as_mut()?.port()
    }

    /// Without a controller the vehicle has the speed of the reference, and covers the trapezoid between the two.
    fn take_speeds(&mut self, next_mps: &Lanes, moving: &Flags, period_s: f64) {
        for i in 0..LANES {
            let before_mps = self.plant.vx_mps[i];
            let next_mps = before_mps + moving[i] * (next_mps[i] - before_mps);
            self.plant.distance_m[i] += 0.5 * (before_mps + next_mps) * period_s;
            self.plant.vx_mps[i] = next_mps;
        }
    }

    /// Ask the law, send its torque through the actuators.
    fn control(&mut self, observation: &Observation) {
        let Some(controller) = &mut self.controller else { return };
        controller.command(observation, &mut self.command);
        let actuated = self.actuators.step(&self.command.torque_nm, &self.command.gain_mps2_per_nm);
        controller.feedback(&Actuation {
            commanded_mps2: actuated.commanded,
            saturated_mps2: actuated.saturated,
            applied_mps2: actuated.applied,
        });
        self.inputs.torque_nm = actuated.torque_nm;
    }

    /// A car that nearly stands where SUMO wants it to stand is put to rest exactly and held there; one that braking
    /// or the slope would drive backwards stops, its controller going on (it has to find the torque that starts it again).
    /// A residue of a millimetre per second would make SUMO believe that a halted car still rolls.
    fn stand_still(&mut self, demand: &Demand, moving: &Flags) {
        for i in 0..LANES {
            let speed_mps = self.plant.vx_mps[i];
            let arrived = demand.rest[i] > 0.0 && speed_mps < HOLD_BELOW_MPS;
            if moving[i] == 0.0 || !(arrived || speed_mps < 0.0) {
                continue;
            }
            self.plant.rest(i);
            if demand.rest[i] > 0.0 {
                self.inputs.torque_nm[i] = 0.0;
                self.controller.iter_mut().for_each(|controller| controller.rest(i));
                self.actuators.reset(i);
                self.held[i] = 1.0;
            }
        }
    }

    /// Counts a step of which both ends are known: the body's and SUMO's.
    pub(super) fn close_step(&mut self) {
        let speed_mps = self.plant.vx_mps;
        let bound = |which: Bound| std::array::from_fn(|i| if self.bound[i] == which { 1.0 } else { 0.0 });
        self.stats.step(&StepSample {
            speed_gap_mps: std::array::from_fn(|i| speed_mps[i] - self.sumo_mps[i]),
            lead_limited: self.lead_limited,
            curvature_limited: self.curvature_limited,
            bound_traffic: bound(Bound::Traffic),
            bound_limit: bound(Bound::Limit),
            bound_profile: bound(Bound::Profile),
            bound_clamp: bound(Bound::Clamp),
            active: self.present,
        });
        if let Some(quality) = &mut self.quality {
            quality.step(&speed_mps, &self.sumo_mps, self.periods, &self.present);
        }
    }
}
