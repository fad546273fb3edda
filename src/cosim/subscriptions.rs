//! What a shared SUMO reports of watched vehicles in every step. SUMO sends every client what any client has subscribed
//! to, so that some blocks are not ours; they are told apart by vehicle and variables, not by their order.

use super::error::CosimError;
use super::question::{Gets, Object, With};
use crate::traci::{Block, Domain, Value};
use std::collections::HashMap;
use std::sync::Arc;

/// Watched vehicles by id, with the values of the last step.
#[derive(Default)]
pub(super) struct Subscriptions(HashMap<Arc<str>, Watched>);

struct Watched {
    /// The first variable of the question: SUMO knows the vehicle if it tells this one.
    first: u8,
    /// Values by variable; `None` if the last step said nothing of the vehicle, or that it is gone.
    values: Option<Vec<(u8, Kept)>>,
}

/// A value that outlives the reply.
enum Kept {
    Number(f64),
    Integer(i32),
    Text(String),
}

impl Subscriptions {
    /// A vehicle with the first variable that it is watched for.
    pub fn add(&mut self, vehicle: &Object, first: u8) {
        self.0.insert(vehicle.id.clone(), Watched { first, values: Some(Vec::new()) });
    }

    /// The vehicle is not watched any more.
    pub fn remove(&mut self, id: &str) {
        self.0.remove(id);
    }

    /// A step is over: what was known before it is old, and vehicles that were gone then are not watched any more.
    pub fn forget_values(&mut self) {
        self.0.retain(|_, watched| watched.values.take().is_some());
    }

    /// Takes a block about a vehicle: its values, if it has the first variable; nothing, if SUMO declines that, because
    /// the vehicle is gone; and no change, if another client subscribed to it.
    pub fn note(&mut self, block: &Block<'_>) -> Result<(), CosimError> {
        let Some(watched) = self.0.get_mut(block.id) else { return Ok(()) };
        let (mut values, mut first_is_there) = (Vec::new(), None);
        for entry in block.values() {
            let (variable, value) = entry?;
            if variable == watched.first {
                first_is_there = Some(value.is_ok());
            }
            let kept = match value {
                Ok(Value::Double(v)) => Kept::Number(v),
                Ok(Value::Int(v)) => Kept::Integer(v),
                Ok(Value::Text(v)) => Kept::Text(v.to_owned()),
                _ => continue,
            };
            values.push((variable, kept));
        }
        if let Some(is_there) = first_is_there {
            watched.values = is_there.then_some(values);
        }
        Ok(())
    }

    /// What the last step said of a vehicle; `None` if it is not there any more.
    pub fn values(&self, id: &str) -> Option<Lookup<'_>> {
        Some(Lookup(self.0.get(id)?.values.as_deref()?))
    }
}

/// Looks values up by their variables.
pub(super) struct Lookup<'a>(&'a [(u8, Kept)]);

impl<'a> Gets<'a> for Lookup<'a> {
    fn value(&mut self, _: Domain, variable: u8, _: Option<With<'_>>) -> Option<Value<'a>> {
        let (_, kept) = self.0.iter().find(|(id, _)| *id == variable)?;
        Some(match kept {
            Kept::Number(v) => Value::Double(*v),
            Kept::Integer(v) => Value::Int(*v),
            Kept::Text(v) => Value::Text(v),
        })
    }
}

/// Collects the variables of a question, to subscribe to them; those with a parameter are asked for by gets.
#[derive(Default)]
pub(super) struct Variables(pub Vec<u8>);

impl<'a> Gets<'a> for Variables {
    fn value(&mut self, _: Domain, variable: u8, with: Option<With<'_>>) -> Option<Value<'a>> {
        if with.is_none() {
            self.0.push(variable);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::traci::vehicle;

    #[test]
    fn values_are_looked_up_by_their_variables_until_the_next_step() {
        let mut subscriptions = Subscriptions::default();
        subscriptions.add(&Object::known("a"), vehicle::SPEED.id);
        let of_step = [
            (vehicle::LANE.id, Kept::Text("road_0".to_owned())),
            (vehicle::STOP_STATE.id, Kept::Integer(1)),
            (vehicle::SPEED.id, Kept::Number(12.5)),
        ];
        subscriptions.0.get_mut("a").unwrap().values = Some(of_step.into());
        let mut found = subscriptions.values("a").unwrap();
        assert_eq!(found.number(vehicle::SPEED), Some(12.5));
        assert_eq!((found.integer(vehicle::STOP_STATE), found.text(vehicle::LANE)), (Some(1), Some("road_0")));
        assert_eq!(found.number(vehicle::ANGLE), None, "nobody has subscribed to it");
        assert!(subscriptions.values("b").is_none());
        subscriptions.forget_values();
        assert!(subscriptions.values("a").is_none(), "the next step has said nothing of it");
    }

    #[test]
    fn a_variable_is_subscribed_to_unless_more_has_to_be_said_with_it() {
        let mut variables = Variables::default();
        assert_eq!((variables.number(vehicle::SPEED), variables.text(vehicle::LANE)), (None, None));
        assert_eq!(variables.leader(100.0), None);
        assert_eq!(variables.0, [vehicle::SPEED.id, vehicle::LANE.id]);
    }
}
