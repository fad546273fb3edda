//! Vehicles that have departed: what must be known of them, who becomes an ego, and with which body.
//!
//! A vehicle that SUMO reports as departed has not moved yet. One more message, only in steps with departures, asks for
//! its type, speed and parameters (and once for those of a new type), so that the next message can already carry its
//! body's speed and its subscription.

use super::bodies::{self, TypeFacts, parameter_keys, parameter_names, preset_of_class};
use super::book::{Before, Ego, EgoKey, Lead, Presence};
use super::{CosimError, World};
use crate::random::Stream;
use crate::reference::Target;
use crate::scenario::{EgoInfo, Group};
use crate::traci::{Batch, BatchError, Handle, Prefix, Reply, vehicle, vehicletype};
use std::collections::HashMap;
use std::sync::Arc;

/// Vehicles that are asked about in one message, some 60 questions each: a crowd that departs at once must not make the
/// buffers large for good.
const ASKED_AT_ONCE: usize = 64;

/// What is known of vTypes.
#[derive(Default)]
pub struct TypeBook(HashMap<String, TypeFacts>);

/// Where the answers about one vehicle will be.
pub(super) struct Questions {
    id: String,
    prefix: Prefix,
    type_id: Handle<String>,
    speed: Handle<f64>,
    odometer: Handle<f64>,
    parameters: Vec<(usize, Handle<String>)>,
    sigma: Option<Handle<f64>>,
    lead: Option<LeadQuestions>,
}

struct LeadQuestions {
    speed_factor: Handle<f64>,
    accel: Handle<f64>,
    decel: Handle<f64>,
    speed_mode: Handle<i32>,
    lane: Handle<String>,
}

/// Where the answers about one vType will be.
struct TypeQuestions {
    id: String,
    class: Handle<String>,
    length: Handle<f64>,
    accel: Handle<f64>,
    emergency_decel: Handle<f64>,
    mass: Handle<f64>,
    equipped: Handle<String>,
    probability: Handle<String>,
    parameters: Vec<(usize, Handle<String>)>,
}

/// The answers about one vehicle.
pub(super) struct Facts {
    id: String,
    prefix: Prefix,
    type_id: String,
    /// `None` while SUMO carries it.
    speed_mps: Option<f64>,
    odometer_m: f64,
    parameters: Vec<(usize, String)>,
    sigma: Option<f64>,
    lead: Option<(Before, String)>,
}

impl World {
    /// Decides on all vehicles that have departed since the last step: those of which the answers are there, and those
    /// that were not asked about yet.
    pub(super) async fn admit_waiting(&mut self) -> Result<(), CosimError> {
        let mut vehicles = std::mem::take(&mut self.facts);
        let mut waiting = std::mem::take(&mut self.state.waiting);
        while !waiting.is_empty() {
            let asked = self.question(waiting.drain(..waiting.len().min(ASKED_AT_ONCE)));
            if !asked.is_empty() {
                vehicles.extend(answers(asked, &self.client.exchange(&self.batch).await?));
            }
        }
        self.ask_types(&vehicles).await?;
        for vehicle in vehicles {
            self.admit(vehicle)?;
        }
        Ok(())
    }

    /// Asks about vehicles that departed in the step just read, as many as one message may be about. SUMO answers while
    /// the bodies drive.
    pub(super) async fn ask_about_newcomers(&mut self) -> Result<(), CosimError> {
        let mut waiting = std::mem::take(&mut self.state.waiting);
        self.asked = self.question(waiting.drain(..waiting.len().min(ASKED_AT_ONCE)));
        self.state.waiting = waiting;
        if !self.asked.is_empty() {
            self.client.send([&self.batch]).await?;
        }
        Ok(())
    }

    /// Takes the answers to that.
    pub(super) async fn hear_of_newcomers(&mut self) -> Result<(), CosimError> {
        if !self.asked.is_empty() {
            self.facts = answers(std::mem::take(&mut self.asked), &self.client.receive().await?);
        }
        Ok(())
    }

    /// Writes the questions about vehicles.
    fn question(&mut self, ids: impl Iterator<Item = String>) -> Vec<Questions> {
        self.batch.clear();
        let leads = self.state.targets.iter().any(|t| !matches!(t, Target::Traffic));
        let mut asked = Vec::new();
        for id in ids {
            match ask_vehicle(&mut self.batch, &id, leads, self.sigma.is_some()) {
                Ok(questions) => asked.push(questions),
                // Too long an id; what was asked of it so far is answered and left unread.
                Err(error) => self.state.refused.push((id, error.to_string())),
            }
        }
        asked
    }

    async fn ask_types(&mut self, vehicles: &[Facts]) -> Result<(), CosimError> {
        let mut unknown: Vec<&str> = vehicles.iter().map(|v| v.type_id.as_str()).collect();
        unknown.retain(|t| !self.types.0.contains_key(*t));
        unknown.sort_unstable();
        unknown.dedup();
        if unknown.is_empty() {
            return Ok(());
        }
        self.batch.clear();
        let batch = &mut self.batch;
        let mut asked = Vec::new();
        for id in unknown {
            // Too long an id: its vehicles are refused.
            asked.extend(ask_type(batch, id));
        }
        let reply = self.client.exchange(&self.batch).await?;
        for questions in asked {
            let facts = questions.answers(&reply)?;
            self.types.0.insert(questions.id, facts);
        }
        Ok(())
    }

    fn admit(&mut self, vehicle: Facts) -> Result<(), CosimError> {
        let Some(speed_mps) = vehicle.speed_mps else {
            // Departed and carried away at once: ask again when it is back.
            self.state.waiting.push(vehicle.id);
            return Ok(());
        };
        let Some(facts) = self.types.0.get(&vehicle.type_id) else {
            self.state.refused.push((vehicle.id, "the id of its vType is too long".to_owned()));
            return Ok(());
        };
        if preset_of_class(&facts.class).is_none() {
            *self.state.others.entry(facts.class.clone()).or_default() += 1;
            return Ok(());
        }
        let drawn = |share: f64| Stream::new(self.seed, "device.mfc", &vehicle.id).uniform() < share;
        let param =
            self.equipped.of(&vehicle.id).or(facts.equipped).unwrap_or_else(|| facts.probability.is_some_and(drawn));
        let info = EgoInfo { id: &vehicle.id, type_id: &vehicle.type_id, class: &facts.class, param };
        let Some(group) = Group::of(&self.groups, &info, self.seed).filter(|_| self.egos.matches(&info, self.seed))
        else {
            self.state.unequipped += 1;
            return Ok(());
        };
        let curve = self.tyre_curves[group].as_deref();
        let parameters = &vehicle.parameters;
        let setup = bodies::vehicle(&vehicle.id, facts, parameters, &self.groups[group], curve, self.seed, speed_mps)?;
        let state = &mut self.state;
        let slot = state.fleet.admit(group, setup);
        let leads = !matches!(state.targets[group], Target::Traffic);
        let (before, lane) = vehicle.lead.filter(|_| leads).unzip();
        let lead = before.map(|before| Lead { before, limit_mps: speed_mps, command_mps: speed_mps, clamp_mps: None });
        if let Some(lane) = &lane
            && !state.unknown_lanes.contains(lane)
        {
            state.unknown_lanes.push(lane.clone());
        }
        let id: Arc<str> = Arc::from(vehicle.id);
        state.admitted.push(id.clone());
        let key: EgoKey = state.book.insert(Ego {
            id,
            type_id: vehicle.type_id,
            group,
            slot,
            // It was inserted at the end of the step before the one that it will move in.
            depart_s: state.time_s - if state.has_stepped() { state.step_s } else { 0.0 },
            prefix: vehicle.prefix,
            presence: Presence::Driving,
            teleported: false,
            odometer_offset_m: vehicle.odometer_m,
            odometer_gap_m: None,
            edge: None,
            lead,
            lane,
            sigma_before: vehicle.sigma,
            seen_in_step: 0,
            told_after: None,
        });
        self.newcomers.push(key);
        Ok(())
    }
}

fn answers(asked: Vec<Questions>, reply: &Reply<'_>) -> Vec<Facts> {
    asked.into_iter().filter_map(|questions| questions.answers(reply)).collect()
}

fn ask_vehicle(batch: &mut Batch, id: &str, leads: bool, sigma: bool) -> Result<Questions, BatchError> {
    let prefix = Prefix::new(id)?;
    let lead = if leads {
        Some(LeadQuestions {
            speed_factor: batch.get(vehicle::SPEED_FACTOR, id)?,
            accel: batch.get(vehicle::ACCEL, id)?,
            decel: batch.get(vehicle::DECEL, id)?,
            speed_mode: batch.get(vehicle::SPEED_MODE, id)?,
            lane: batch.get(vehicle::LANE, id)?,
        })
    } else {
        None
    };
    Ok(Questions {
        type_id: batch.get(vehicle::TYPE, id)?,
        speed: batch.get(vehicle::SPEED, id)?,
        odometer: batch.get(vehicle::DISTANCE, id)?,
        parameters: ask_parameters(|name| batch.get_with(vehicle::PARAMETER, id, name))?,
        sigma: if sigma { Some(batch.get(vehicle::IMPERFECTION, id)?) } else { None },
        lead,
        id: id.to_owned(),
        prefix,
    })
}

fn ask_type(batch: &mut Batch, id: &str) -> Result<TypeQuestions, BatchError> {
    Ok(TypeQuestions {
        id: id.to_owned(),
        class: batch.get(vehicletype::CLASS, id)?,
        length: batch.get(vehicletype::LENGTH, id)?,
        accel: batch.get(vehicletype::ACCEL, id)?,
        emergency_decel: batch.get(vehicletype::EMERGENCY_DECEL, id)?,
        mass: batch.get(vehicletype::MASS, id)?,
        equipped: batch.get_with(vehicletype::PARAMETER, id, "has.mfc.device")?,
        probability: batch.get_with(vehicletype::PARAMETER, id, "device.mfc.probability")?,
        parameters: ask_parameters(|name| batch.get_with(vehicletype::PARAMETER, id, name))?,
    })
}

fn ask_parameters<E>(
    mut ask: impl FnMut(&str) -> Result<Handle<String>, E>,
) -> Result<Vec<(usize, Handle<String>)>, E> {
    let mut asked = Vec::new();
    for (index, key) in parameter_keys().enumerate() {
        for name in parameter_names(key) {
            asked.push((index, ask(&name)?));
        }
    }
    Ok(asked)
}

fn answers_of(reply: &Reply<'_>, asked: &[(usize, Handle<String>)]) -> Vec<(usize, String)> {
    let given = asked.iter().filter_map(|(index, handle)| Some((*index, reply.get(*handle).ok()?)));
    given.filter(|(_, text)| !text.is_empty()).collect()
}

impl TypeQuestions {
    fn answers(&self, reply: &Reply<'_>) -> Result<TypeFacts, CosimError> {
        Ok(TypeFacts {
            class: reply.get(self.class)?,
            length_m: reply.get(self.length)?,
            // Older SUMO knows no mass; then the preset's stands.
            mass_kg: reply.get(self.mass).ok(),
            accel_mps2: reply.get(self.accel)?,
            emergency_decel_mps2: reply.get(self.emergency_decel)?,
            parameters: answers_of(reply, &self.parameters),
            equipped: reply.get(self.equipped).ok().and_then(|text| text.parse().ok()),
            probability: reply.get(self.probability).ok().and_then(|text| text.parse().ok()),
        })
    }
}

impl Questions {
    /// `None` if the vehicle has left in the meantime.
    fn answers(self, reply: &Reply<'_>) -> Option<Facts> {
        let lead = self.lead.and_then(|lead| {
            let before = Before {
                speed_factor: reply.get(lead.speed_factor).ok()?,
                accel_mps2: reply.get(lead.accel).ok()?,
                decel_mps2: reply.get(lead.decel).ok()?,
                speed_mode: reply.get(lead.speed_mode).ok()?,
            };
            Some((before, reply.get(lead.lane).ok()?))
        });
        Some(Facts {
            type_id: reply.get(self.type_id).ok()?,
            speed_mps: reply.get(self.speed).ok(),
            odometer_m: reply.get(self.odometer).unwrap_or(0.0),
            parameters: answers_of(reply, &self.parameters),
            sigma: self.sigma.and_then(|sigma| reply.get(sigma).ok()),
            lead,
            id: self.id,
            prefix: self.prefix,
        })
    }
}
