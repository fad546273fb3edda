//! Law, actuators and vehicle around one speed, opened where gain or delay are to be added: sixteen variants at a time.

use super::error::StabilityError;
use crate::control::{Actuation, Command, Controller, Observation};
use crate::fleet::VehicleSetup;
use crate::lanes::{LANES, Lanes};
use crate::offline::{End, Road};
use crate::plant::{Actuators, Inputs, PlantBlock, State};
use crate::reference::{Axis, Profile};
use crate::scenario::Scenario;

/// The speed around which the loop is examined [m/s].
pub const SPEED_MPS: f64 = 20.0;

/// What is added to the loop of one slot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// The vehicle answers so many times as much as its nominal torque says.
    pub gain: f64,
    /// The speed is measured so many control periods later. Unlike a dead time of the actuators, no law hears of it.
    pub late: usize,
}

/// Nothing is added.
pub const AS_IT_IS: Change = Change { gain: 1.0, late: 0 };

/// Which vehicle is in the loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Vehicle {
    /// The body's inertia and the slope of its drag, nothing else.
    Linear,
    /// The scenario's plant, with all that resists it.
    Full,
}

/// A law's loop.
pub struct ClosedLoop<'a> {
    scenario: &'a Scenario,
    setup: VehicleSetup,
}

impl<'a> ClosedLoop<'a> {
    /// The loop of a scenario's first group.
    pub fn new(scenario: &'a Scenario) -> Result<Self, StabilityError> {
        let profile = Profile::step(Axis::Time, &[0.0], &[SPEED_MPS])?;
        let road = Road::with_profile(scenario, profile.into())?;
        let setup = road.trip(0, SPEED_MPS, End::Time(1.0))?.vehicle;
        Ok(Self { scenario, setup })
    }

    /// Control period \[s\].
    pub fn period_s(&self) -> f64 {
        self.scenario.coupling.control_period_s
    }

    fn law(&self) -> Result<Box<dyn Controller>, StabilityError> {
        let group = &self.scenario.groups[0];
        let law = (self.scenario.blocks(group).law)().block();
        law.ok_or_else(|| StabilityError::NoLaw(group.controller.name().to_owned()))
    }

    /// The measured speeds less [`SPEED_MPS`], period by period, after the first one was wrong by `kick_mps`.
    pub fn run(
        &self,
        vehicle: Vehicle,
        changes: &[Change; LANES],
        seconds: f64,
        kick_mps: f64,
    ) -> Result<Vec<Lanes>, StabilityError> {
        let (mut law, period_s) = (self.law()?, self.period_s());
        let mut actuators = Actuators::new(period_s, self.setup.actuator.dead_time_s);
        let mut moving = Moving::new(vehicle, self);
        for slot in 0..LANES {
            let actuator = self.setup.actuator;
            actuators.set(slot, actuator.dead_time_s, actuator.lag_s, f64::INFINITY, f64::INFINITY);
            law.reset(slot, SPEED_MPS);
        }
        let nominal_nm_per_mps2 = changes.map(|change| change.gain * self.setup.nominal_nm_per_mps2);
        let (mut command, mut past) = (Command::default(), Vec::<Lanes>::new());
        for k in 0..(seconds / period_s) as usize {
            let kick_mps = if k == 0 { kick_mps } else { 0.0 };
            past.push(moving.deviation_mps().map(|deviation| deviation + kick_mps));
            let measured = |slot: usize| k.checked_sub(changes[slot].late).map_or(0.0, |then| past[then][slot]);
            let observation = Observation {
                measured_mps: std::array::from_fn(|slot| SPEED_MPS + measured(slot)),
                reference_mps: [SPEED_MPS; LANES],
                reference_rate_mps2: [0.0; LANES],
                nominal_nm_per_mps2,
            };
            law.command(&observation, &mut command);
            let acted = actuators.step(&command.torque_nm, &command.gain_mps2_per_nm);
            law.feedback(&Actuation {
                commanded_mps2: acted.commanded,
                saturated_mps2: acted.saturated,
                applied_mps2: acted.applied,
            });
            moving.advance(&acted.torque_nm, period_s);
        }
        Ok(past)
    }
}

/// Sixteen vehicles.
enum Moving<'a> {
    Linear { deviation_mps: Lanes, mps2_per_nm: f64, drag_per_s: f64 },
    Full { plant: Box<dyn crate::plant::Plant>, block: Box<PlantBlock>, loops: &'a ClosedLoop<'a> },
}

impl<'a> Moving<'a> {
    fn new(vehicle: Vehicle, loops: &'a ClosedLoop<'a>) -> Self {
        let body = &loops.setup.body;
        match vehicle {
            Vehicle::Linear => Self::Linear {
                deviation_mps: [0.0; LANES],
                mps2_per_nm: 1.0 / (body.effective_mass_kg() * body.wheel_radius_m),
                drag_per_s: 2.0 * body.drag_ns2pm2() * SPEED_MPS / body.effective_mass_kg(),
            },
            Vehicle::Full => {
                let mut block = Box::<PlantBlock>::default();
                for slot in 0..LANES {
                    block.set_body(slot, body);
                    block.set_state(slot, &State::rolling(body, SPEED_MPS));
                }
                Self::Full { plant: loops.scenario.loop_config().plant, block, loops }
            }
        }
    }

    fn deviation_mps(&self) -> Lanes {
        match self {
            Self::Linear { deviation_mps, .. } => *deviation_mps,
            Self::Full { block, .. } => block.vx_mps.map(|speed| speed - SPEED_MPS),
        }
    }

    fn advance(&mut self, torque_nm: &Lanes, period_s: f64) {
        match self {
            Self::Linear { deviation_mps, mps2_per_nm, drag_per_s } => {
                for (deviation, torque) in deviation_mps.iter_mut().zip(torque_nm) {
                    *deviation += period_s * (*mps2_per_nm * torque - *drag_per_s * *deviation);
                }
            }
            Self::Full { plant, block, loops } => {
                let inputs = Inputs { torque_nm: *torque_nm, ..Inputs::default() };
                plant.advance(block, &inputs, &[1.0; LANES], period_s);
                for slot in 0..LANES {
                    // Who has swung up to nonsense starts again: its past says enough.
                    if !block.is_sensible(slot) || block.vx_mps[slot] < 0.0 {
                        block.set_state(slot, &State::rolling(&loops.setup.body, 0.0));
                    }
                }
            }
        }
    }
}
