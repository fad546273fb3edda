//! Vehicles that have departed: what must be known of them, who becomes an ego, and with which body.
//!
//! A vehicle that SUMO reports as departed has not moved yet. Its type, speed and parameters (and once those of a new
//! type) are asked for while the bodies drive, only in steps with departures, so that the next step can already carry its
//! body's speed.

use super::bodies::{self, TypeFacts, preset_of_class};
use super::error::CosimError;
use super::leader::Before;
use super::question::{Gets, NoAnswer, Object, Question};
use super::records::Counters;
use super::sumo::Sumo;
use crate::fleet::VehicleSetup;
use crate::keys::Key;
use crate::random::Stream;
use crate::scenario::{EgoInfo, Group, HeadwayMargin, Selector, parameter_keys, parameter_names};
use crate::sumo_files::Equipped;
use crate::traci::{Color, Var, vehicle, vehicletype};
use std::collections::{BTreeSet, HashMap};
use std::ops::RangeInclusive;

/// Vehicles that are asked about in one message, some 60 values each: a crowd that departs at once must not make the
/// buffers large for good.
const ASKED_AT_ONCE: usize = 64;

/// A mass between these shares of what preset and vType say is one that such a vehicle can have, empty or loaded.
const USUAL_MASS: RangeInclusive<f64> = 0.5..=2.0;

/// Who becomes an ego, and what of.
pub struct Rules {
    /// The scenario's groups; the first whose selector matches takes a vehicle.
    pub groups: Vec<Group>,
    /// The measured tyre curve of each group, if it has one.
    pub tyre_curves: Vec<Option<String>>,
    /// Which vehicles may become egos at all.
    pub egos: Selector,
    /// What the demand says of `has.mfc.device`.
    pub equipped: Equipped,
    /// How much more time headway the egos keep.
    pub headway: Option<HeadwayMargin>,
    /// Seed of everything that is drawn per vehicle.
    pub seed: u64,
}

/// What more has to be known of a vehicle.
#[derive(Debug, Clone, Copy)]
pub struct Wanted {
    /// What body-leads mode changes.
    pub before: bool,
    /// Its lane.
    pub lane: bool,
    /// Its driver imperfection.
    pub imperfection: bool,
    /// Its desired time headway.
    pub headway: bool,
    /// The mass of its vType.
    pub mass: bool,
    /// Its colour.
    pub colour: bool,
}

/// Departed vehicles on their way to becoming egos.
pub struct Admission {
    rules: Rules,
    wanted: Wanted,
    /// What is known of vTypes.
    types: HashMap<String, TypeFacts>,
    /// Vehicles that have not been asked about.
    waiting: Vec<String>,
    /// Vehicles that have been, and are not decided on.
    known: Vec<Departed>,
}

/// A vehicle that is to become an ego.
pub struct Newcomer {
    /// What SUMO told of it.
    pub departed: Departed,
    /// Index of its group.
    pub group: usize,
    /// Time between two decisions of its driver \[s\].
    pub action_step_s: f64,
    /// The time headway that it is given, if that is changed \[s\].
    pub headway_s: Option<f64>,
    /// Its body.
    pub setup: VehicleSetup,
}

/// What SUMO tells of a vehicle.
pub struct Departed {
    /// The vehicle.
    pub object: Object,
    /// Its vType.
    pub type_id: String,
    /// Its speed [m/s]; `None` while SUMO carries it.
    speed_mps: Option<f64>,
    /// SUMO's odometer \[m\].
    pub odometer_m: f64,
    /// Its `mfc.*` parameters.
    pub parameters: Vec<(&'static Key, String)>,
    /// Its driver imperfection, if that is changed.
    pub imperfection: Option<f64>,
    /// Its desired time headway, if that is changed \[s\].
    pub headway_s: Option<f64>,
    /// What body-leads mode changes, if bodies lead.
    pub before: Option<Before>,
    /// Its lane, if that matters.
    pub lane: Option<String>,
    /// Its colour, if that is changed.
    pub colour: Option<Color>,
}

impl Admission {
    /// Decides by these rules.
    pub fn new(rules: Rules, wanted: Wanted) -> Self {
        Self { rules, wanted, types: HashMap::new(), waiting: Vec::new(), known: Vec::new() }
    }

    /// These vehicles have departed.
    pub fn wait(&mut self, ids: impl IntoIterator<Item = String>) {
        self.waiting.extend(ids);
    }

    /// This vehicle has arrived: if it departed in the same step, it never gets a body.
    pub fn forget(&mut self, id: &str) {
        self.waiting.retain(|waiting| waiting != id);
    }

    /// Asks about vehicles that wait, as many as one message may be about.
    pub fn ask<S: Sumo>(
        &mut self,
        sumo: &mut S,
        counters: &mut Counters,
    ) -> Result<S::Asked<VehicleQuestion>, CosimError> {
        let mut vehicles = Vec::new();
        for id in self.waiting.drain(..self.waiting.len().min(ASKED_AT_ONCE)) {
            match Object::new(id.as_str()) {
                Ok(vehicle) => vehicles.push(vehicle),
                Err(error) => counters.refused.add(|| format!("\"{id}\": {error}")),
            }
        }
        let wanted = self.wanted;
        sumo.ask(vehicles.iter().map(|vehicle| (vehicle, VehicleQuestion { object: vehicle.clone(), wanted })))
    }

    /// Takes the answers.
    pub async fn hear<S: Sumo>(
        &mut self,
        sumo: &mut S,
        asked: S::Asked<VehicleQuestion>,
        counters: &mut Counters,
    ) -> Result<(), CosimError> {
        let known = &mut self.known;
        sumo.answers(asked, |VehicleQuestion { object, .. }, answer| match answer {
            Ok(departed) => known.extend(departed),
            Err(NoAnswer::Unaskable(error)) => counters.refused.add(|| format!("\"{}\": {error}", object.id)),
            // It has left in the meantime.
            Err(NoAnswer::Gone) => {}
        })
        .await
        .map(drop)
    }

    /// Decides on all vehicles that have departed, also those that were not asked about yet.
    pub async fn decide<S: Sumo>(
        &mut self,
        sumo: &mut S,
        counters: &mut Counters,
    ) -> Result<Vec<Newcomer>, CosimError> {
        while !self.waiting.is_empty() {
            let asked = self.ask(sumo, counters)?;
            self.hear(sumo, asked, counters).await?;
        }
        let known = std::mem::take(&mut self.known);
        self.learn_types(sumo, &known).await?;
        let mut newcomers = Vec::new();
        for departed in known {
            newcomers.extend(self.judge(departed, counters)?);
        }
        Ok(newcomers)
    }

    /// The vehicle of a known vType as it would be with these parameters in place of those that it departed with.
    ///
    /// # Errors
    /// If a parameter is not what its key takes.
    pub fn vehicle(
        &self,
        id: &str,
        type_id: &str,
        group: usize,
        parameters: &[(&'static Key, String)],
        speed_mps: f64,
    ) -> Result<VehicleSetup, CosimError> {
        let unknown = TypeFacts::default();
        let facts = self.types.get(type_id).unwrap_or(&unknown);
        self.rules.vehicle(id, facts, group, parameters, speed_mps).map(|(setup, _)| setup)
    }

    async fn learn_types<S: Sumo>(&mut self, sumo: &mut S, vehicles: &[Departed]) -> Result<(), CosimError> {
        let unknown: BTreeSet<&str> =
            vehicles.iter().map(|v| v.type_id.as_str()).filter(|id| !self.types.contains_key(*id)).collect();
        let objects: Vec<Object> = unknown.into_iter().map(Object::known).collect();
        let mass = self.wanted.mass;
        let question = |object: &Object| TypeQuestion { id: object.id.to_string(), mass };
        let asked = sumo.ask(objects.iter().map(|object| (object, question(object))))?;
        let types = &mut self.types;
        sumo.answers(asked, |TypeQuestion { id, .. }, answer| {
            types.extend(answer.ok().flatten().map(|facts| (id, facts)))
        })
        .await
        .map(drop)
    }

    fn judge(&mut self, departed: Departed, counters: &mut Counters) -> Result<Option<Newcomer>, CosimError> {
        let id = &departed.object.id;
        let Some(speed_mps) = departed.speed_mps else {
            // Departed and carried away at once: it is asked about again when it is back.
            self.waiting.push(id.to_string());
            return Ok(None);
        };
        let Some(facts) = self.types.get(&departed.type_id) else {
            counters.refused.add(|| format!("\"{id}\": SUMO does not tell about its vType \"{}\"", departed.type_id));
            return Ok(None);
        };
        if preset_of_class(&facts.class).is_none() {
            *counters.others.entry(facts.class.clone()).or_default() += 1;
            return Ok(None);
        }
        let Some(group) = self.rules.group_of(&departed, facts) else {
            counters.unequipped += 1;
            return Ok(None);
        };
        let (setup, usual_kg) = self.rules.vehicle(id, facts, group, &departed.parameters, speed_mps)?;
        let groups = &self.rules.groups;
        let has_body = groups[group].has_body();
        if has_body && !counters.beyond_body.contains_key(&departed.type_id) {
            let (asked, given) = ([facts.accel_mps2, facts.emergency_decel_mps2], setup.body.acceleration_max_mps2());
            if asked[0] > given[0] || asked[1] > given[1] {
                counters.beyond_body.insert(departed.type_id.clone(), [asked, given]);
            }
        }
        if !USUAL_MASS.contains(&(setup.body.mass_kg / usual_kg)) {
            let mass_kg = setup.body.mass_kg;
            counters.odd_masses.add(|| format!("\"{id}\": {mass_kg:.0} kg instead of {usual_kg:.0} kg"));
        }
        let margin_s =
            self.rules.headway.filter(|_| has_body).map(|margin| margin.of(&setup, &groups[group].controller.values));
        let headway_s = departed.headway_s.zip(margin_s).map(|(headway_s, margin_s)| headway_s + margin_s);
        Ok(Some(Newcomer { departed, group, action_step_s: facts.action_step_s, headway_s, setup }))
    }
}

impl Rules {
    /// A vehicle of a group, and the mass that it has by preset and vType alone \[kg\].
    fn vehicle(
        &self,
        id: &str,
        facts: &TypeFacts,
        group: usize,
        parameters: &[(&'static Key, String)],
        speed_mps: f64,
    ) -> Result<(VehicleSetup, f64), CosimError> {
        let curve = self.tyre_curves[group].as_deref();
        bodies::vehicle(id, facts, parameters, &self.groups[group], curve, self.seed, speed_mps)
    }

    /// The group that takes a vehicle.
    fn group_of(&self, departed: &Departed, facts: &TypeFacts) -> Option<usize> {
        let id = &*departed.object.id;
        let drawn = |share: f64| Stream::new(self.seed, "device.mfc", id).uniform() < share;
        let param = self.equipped.of(id).or(facts.equipped).unwrap_or_else(|| facts.probability.is_some_and(drawn));
        let info = EgoInfo { id, type_id: &departed.type_id, class: &facts.class, param };
        Group::of(&self.groups, &info, self.seed).filter(|_| self.egos.matches(&info, self.seed))
    }
}

/// The question about a departed vehicle.
pub struct VehicleQuestion {
    object: Object,
    wanted: Wanted,
}

impl Question for VehicleQuestion {
    /// `None` if SUMO does not tell the type.
    type Answer<'a> = Option<Departed>;

    fn answer<'a>(&self, gets: &mut impl Gets<'a>) -> Option<Departed> {
        let type_id = gets.text(vehicle::TYPE);
        let speed_mps = gets.number(vehicle::SPEED);
        let odometer_m = gets.number(vehicle::DISTANCE).unwrap_or(0.0);
        let parameters = parameters(gets, vehicle::PARAMETER);
        let imperfection = if self.wanted.imperfection { gets.number(vehicle::IMPERFECTION) } else { None };
        let headway_s = if self.wanted.headway { gets.number(vehicle::TAU) } else { None };
        let before = if self.wanted.before { Before::ask(gets) } else { None };
        let lane = if self.wanted.lane { gets.text(vehicle::LANE).map(str::to_owned) } else { None };
        let colour = if self.wanted.colour { gets.colour(vehicle::COLOR) } else { None };
        Some(Departed {
            object: self.object.clone(),
            type_id: type_id?.to_owned(),
            speed_mps,
            odometer_m,
            parameters,
            imperfection,
            headway_s,
            before,
            lane,
            colour,
        })
    }
}

/// The question about a vType.
struct TypeQuestion {
    id: String,
    mass: bool,
}

impl Question for TypeQuestion {
    type Answer<'a> = Option<TypeFacts>;

    fn answer<'a>(&self, gets: &mut impl Gets<'a>) -> Option<TypeFacts> {
        let class = gets.text(vehicletype::CLASS);
        let length_m = gets.number(vehicletype::LENGTH);
        let accel_mps2 = gets.number(vehicletype::ACCEL);
        let emergency_decel_mps2 = gets.number(vehicletype::EMERGENCY_DECEL);
        let action_step_s = gets.number(vehicletype::ACTION_STEP_LENGTH);
        // Older SUMO knows no mass; then the preset's stands.
        let mass_kg = if self.mass { gets.number(vehicletype::MASS) } else { None };
        let equipped = gets.parameter(vehicletype::PARAMETER, "has.mfc.device").and_then(|text| text.parse().ok());
        let probability =
            gets.parameter(vehicletype::PARAMETER, "device.mfc.probability").and_then(|text| text.parse().ok());
        let parameters = parameters(gets, vehicletype::PARAMETER);
        Some(TypeFacts {
            class: class?.to_owned(),
            length_m: length_m?,
            mass_kg,
            accel_mps2: accel_mps2?,
            emergency_decel_mps2: emergency_decel_mps2?,
            action_step_s: action_step_s?,
            parameters,
            equipped,
            probability,
        })
    }
}

/// Asks for all `mfc.*` parameters, and keeps those that the object has, each with its key.
fn parameters<'a, S>(gets: &mut impl Gets<'a>, variable: Var<String, S, String>) -> Vec<(&'static Key, String)> {
    let mut given = Vec::new();
    for key in parameter_keys() {
        for name in parameter_names(key) {
            let text = gets.parameter(variable, &name).filter(|text| !text.is_empty());
            given.extend(text.map(|text| (key, text.to_owned())));
        }
    }
    given
}
