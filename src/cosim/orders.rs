//! What a caller orders for single vehicles between two steps: a speed in place of the target, a torque that disturbs, another value
//! of a `mfc.*` parameter. All of it acts from the next step on.

use super::admission::Admission;
use super::egos::{Ego, EgoTable};
use super::error::CosimError;
use super::sumo::{Sumo, Tell};
use crate::fleet::Fleet;
use crate::keys::Key;
use crate::registry::nearest;
use crate::scenario::{parameter_keys, parameter_names};
use std::collections::BTreeSet;
use std::sync::Arc;

/// What a vehicle that drives keeps: its wheels turn, and its axles are where they are.
const KEPT: [&str; 5] = ["front_axle_m", "rear_axle_m", "track_width_m", "wheel_radius_m", "wheel_inertia_kgm2"];

/// Faster than any road vehicle [m/s], and more torque than any has [N·m].
const FASTEST_MPS: f64 = 100.0;
const STRONGEST_NM: f64 = 1e6;

/// Why an order is refused. Nothing has changed then.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OrderError {
    /// No such vehicle.
    #[error(
        "vehicle \"{id}\": found no ego of this id, wanted one that is on the road at the end of the last step{}",
        .near.as_ref().map(|near| format!("; did you mean \"{near}\"?")).unwrap_or_default()
    )]
    Vehicle {
        /// The id.
        id: String,
        /// The id of an ego that is nearly the same.
        near: Option<String>,
    },
    /// No such parameter.
    #[error(
        "vehicle \"{id}\": found the parameter {name}, wanted a mfc.* parameter of a body or its actuators{}",
        .near.as_ref().map(|near| format!("; did you mean {near}?")).unwrap_or_default()
    )]
    Parameter {
        /// The vehicle.
        id: String,
        /// What was found.
        name: String,
        /// The name that is nearly the same.
        near: Option<String>,
    },
    /// A parameter that stays.
    #[error(
        "vehicle \"{id}\": mfc.{key} cannot change while the vehicle drives: its wheels turn, and its axles are where they are; \
         wanted it in the demand or the scenario"
    )]
    Kept {
        /// The vehicle.
        id: String,
        /// The key.
        key: &'static str,
    },
    /// A value that cannot be.
    #[error("vehicle \"{id}\", {what}: found {found}, wanted {wanted}")]
    Value {
        /// The vehicle.
        id: String,
        /// What was to be set.
        what: &'static str,
        /// The value.
        found: f64,
        /// What it should be.
        wanted: String,
    },
    /// A vehicle that nothing but SUMO moves.
    #[error("vehicle \"{id}\": found no body (its controller is ideal), wanted one that {what} can change")]
    Bodiless {
        /// The vehicle.
        id: String,
        /// What was to be set.
        what: &'static str,
    },
    /// The coupling: a value that the parameter does not take, or SUMO.
    #[error(transparent)]
    Cosim(#[from] CosimError),
}

/// For whom anything was ordered so far.
#[derive(Debug, Clone, Default)]
pub struct Orders {
    references: BTreeSet<Arc<str>>,
    disturbances: BTreeSet<Arc<str>>,
    parameters: BTreeSet<Arc<str>>,
}

impl Orders {
    /// One sentence about each kind of order that was given.
    pub fn notes(&self) -> Vec<String> {
        let kinds = [
            ("references", &self.references),
            ("torque disturbances", &self.disturbances),
            ("mfc.* parameters", &self.parameters),
        ];
        let given = kinds.into_iter().filter(|(_, ids)| !ids.is_empty());
        let note = |(what, ids): (&str, &BTreeSet<Arc<str>>)| {
            let (count, first) = (ids.len(), ids.first().map(|id| &**id).unwrap_or_default());
            let vehicles = if count == 1 { "vehicle" } else { "vehicles" };
            let example = if count == 1 { "" } else { ", for one" };
            format!("{what} of {count} {vehicles} were set by the caller between steps (\"{first}\"{example})")
        };
        given.map(note).collect()
    }
}

/// Takes one order.
pub struct Hand<'w, S: Sumo> {
    pub(super) sumo: &'w mut S,
    pub(super) fleet: &'w mut Fleet,
    pub(super) egos: &'w mut EgoTable,
    pub(super) admission: &'w Admission,
    pub(super) orders: &'w mut Orders,
}

impl<S: Sumo> Hand<'_, S> {
    /// The vehicle is to drive at this speed [m/s] in place of its target; `None` = at its target again. Where SUMO leads, it drives
    /// there as it drives to any speed (`setSpeed`): with the vType's accelerations, and never too fast for who is ahead, a light or
    /// the lane. Where the body leads, the speed is the reference at once, and SUMO clamps it as it clamps all targets.
    ///
    /// # Errors
    /// [`OrderError`] for an unknown vehicle, or a speed that is none.
    pub fn reference(self, id: &str, speed_mps: Option<f64>) -> Result<(), OrderError> {
        if let Some(found) = speed_mps.filter(|speed_mps| !(0.0..=FASTEST_MPS).contains(speed_mps)) {
            let wanted = format!("a speed from 0 to {FASTEST_MPS} m/s, or none to give it back to its target");
            return Err(OrderError::Value { id: id.to_owned(), what: "reference", found, wanted });
        }
        let ego = find(self.egos, id)?;
        if let Some(leader) = &mut ego.leader {
            leader.ordered_mps = speed_mps;
        } else {
            self.sumo.tell(&ego.object, speed_mps.map_or(Tell::ReleaseSpeed, Tell::Speed))?;
            ego.has_ordered_speed = speed_mps.is_some();
        }
        self.orders.references.insert(ego.id().clone());
        Ok(())
    }

    /// This torque acts on the wheels of the vehicle, beside that of the actuators, until another is ordered; sum over the wheels,
    /// positive drives, 0 = none [N·m]. The law does not learn of it, and the columns of torques have it not. A vehicle that is held
    /// at rest stays there.
    ///
    /// # Errors
    /// [`OrderError`] for an unknown vehicle, one without a body, or a torque that is none.
    pub fn disturbance(self, id: &str, torque_nm: f64) -> Result<(), OrderError> {
        const WHAT: &str = "torque disturbance";
        if !(-STRONGEST_NM..=STRONGEST_NM).contains(&torque_nm) {
            let wanted = format!("a torque from -{STRONGEST_NM} to {STRONGEST_NM} N·m");
            return Err(OrderError::Value { id: id.to_owned(), what: WHAT, found: torque_nm, wanted });
        }
        let ego = find(self.egos, id)?;
        let block = self.fleet.block_mut(ego.slot);
        if !block.has_bodies() {
            return Err(OrderError::Bodiless { id: id.to_owned(), what: WHAT });
        }
        block.disturb(ego.slot.lane(), torque_nm);
        self.orders.disturbances.insert(ego.id().clone());
        Ok(())
    }

    /// The vehicle goes on as it would be if it had departed with `<param key="{name}" value="{text}"/>`; `None` takes the order back.
    /// As with such parameters, its law never learns of it.
    ///
    /// # Errors
    /// [`OrderError`] for an unknown vehicle, one without a body, an unknown parameter, one that cannot change on the way, or a value
    /// that it does not take.
    pub fn parameter(self, id: &str, name: &str, text: Option<&str>) -> Result<(), OrderError> {
        let ego = find(self.egos, id)?;
        let key = key(id, name)?;
        if KEPT.contains(&key.name) {
            return Err(OrderError::Kept { id: id.to_owned(), key: key.name });
        }
        let block = self.fleet.block_mut(ego.slot);
        if !block.has_bodies() {
            return Err(OrderError::Bodiless { id: id.to_owned(), what: "a parameter" });
        }
        let mut ordered = ego.ordered_parameters.clone();
        ordered.retain(|(other, _)| other.name != key.name);
        ordered.extend(text.map(|text| (key, text.to_owned())));
        let parameters = [&ego.parameters[..], &ordered].concat();
        let setup =
            self.admission.vehicle(id, &ego.type_id, ego.group, &parameters, block.speed_mps(ego.slot.lane()))?;
        block.change(ego.slot.lane(), &setup);
        ego.ordered_parameters = ordered;
        self.orders.parameters.insert(ego.id().clone());
        Ok(())
    }
}

fn find<'e>(egos: &'e mut EgoTable, id: &str) -> Result<&'e mut Ego, OrderError> {
    if egos.find(id).is_none() {
        let near = nearest(id, egos.iter().map(|ego| &**ego.id())).map(str::to_owned);
        return Err(OrderError::Vehicle { id: id.to_owned(), near });
    }
    Ok(egos.find_mut(id).expect("it was found"))
}

fn key(id: &str, name: &str) -> Result<&'static Key, OrderError> {
    parameter_keys().find(|key| parameter_names(key).iter().any(|known| known == name)).ok_or_else(|| {
        let names: Vec<String> = parameter_keys().flat_map(parameter_names).collect();
        let near = nearest(name, names.iter().map(String::as_str)).map(str::to_owned);
        OrderError::Parameter { id: id.to_owned(), name: name.to_owned(), near }
    })
}
