//! The seam: SUMO as the coupling needs it. [`super::traci_link::TraciLink`] implements it over a socket; the tests of
//! the coupling have a small traffic world in memory; `libsumo_link.rs` has a SUMO in this process.

use super::error::CosimError;
use super::events::Events;
use super::question::{NoAnswer, Object, Question};
use crate::traci::{Color, SumoVersion};
use std::future::Future;
use std::time::Duration;

/// What SUMO is told about a vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tell {
    /// `setPreviousSpeed`: the speed [m/s] and acceleration [m/s²] that the vehicle has now.
    PreviousSpeed(f64, f64),
    /// `setSpeed`: the speed to drive in the next step [m/s].
    Speed(f64),
    /// The end of `setSpeed`: SUMO's own car-following drives again.
    ReleaseSpeed,
    /// Desired time headway \[s\].
    Headway(f64),
    /// Driver imperfection.
    Imperfection(f64),
    /// Largest acceleration [m/s²].
    Accel(f64),
    /// Largest comfortable deceleration [m/s²].
    Decel(f64),
    /// Speed factor.
    SpeedFactor(f64),
    /// Speed mode.
    SpeedMode(i32),
    /// A generic parameter.
    Parameter(&'static str, f64),
    /// Colour.
    Colour(Color),
}

/// What SUMO says about itself when it is joined.
#[derive(Debug, Clone, Default)]
pub struct Joined {
    /// Length of a step \[s\].
    pub step_s: f64,
    /// Simulation time \[s\].
    pub time_s: f64,
    /// Number of vehicles that are on the road or still to come.
    pub expected: i32,
    /// Ids of the vehicles on the road.
    pub present: Vec<String>,
    /// Whether it tells the mass of a vType.
    pub tells_mass: bool,
}

/// SUMO, to be told, stepped and asked. Everything acts in the order of the calls: a question that is asked after
/// [`Sumo::step`] is answered with the state after the step, also where the answer is fetched later.
pub trait Sumo {
    /// A step that SUMO is making.
    type Step;
    /// Questions that SUMO is answering. Only [`Sumo::answers`] of the same type of question takes them.
    type Asked<Q: Question>: Default;

    /// Reads where SUMO is, and lets it report events from now on.
    fn join(&mut self) -> impl Future<Output = Result<Joined, CosimError>>;

    /// The end that SUMO's configuration asks for \[s\]; negative without one.
    fn end_s(&mut self) -> impl Future<Output = Result<f64, CosimError>>;

    /// An option that SUMO runs with, by its name; `None` if it has none of that name.
    fn option(&mut self, name: &str) -> impl Future<Output = Result<Option<String>, CosimError>>;

    /// Tells SUMO something about a vehicle, at the latest with the next step. If SUMO does not know the vehicle any
    /// more, nothing happens.
    fn tell(&mut self, vehicle: &Object, what: Tell) -> Result<(), CosimError>;

    /// From the next step on `question` will be asked of this vehicle after every step, until [`Sumo::unwatch`].
    fn watch<Q: Question>(&mut self, vehicle: &Object, question: &Q) -> Result<(), CosimError>;

    /// The vehicle will not be asked about any more.
    fn unwatch(&mut self, vehicle: &Object) -> Result<(), CosimError>;

    /// Hands over now what was told, so that SUMO works on it while this program computes.
    fn hand_over(&mut self) -> impl Future<Output = Result<(), CosimError>>;

    /// Begins one step, after all that was told.
    fn step(&mut self) -> impl Future<Output = Result<Self::Step, CosimError>>;

    /// Waits for the end of a step, and notes what it says.
    fn events(&mut self, step: Self::Step, events: &mut Events) -> impl Future<Output = Result<(), CosimError>>;

    /// Asks one question about each of some objects.
    fn ask<'o, Q: Question>(
        &mut self,
        questions: impl Iterator<Item = (&'o Object, Q)>,
    ) -> Result<Self::Asked<Q>, CosimError> {
        self.ask_in(Self::Asked::default(), questions)
    }

    /// The same in the memory of questions that are answered: steps in which nobody comes or goes allocate nothing.
    fn ask_in<'o, Q: Question>(
        &mut self,
        room: Self::Asked<Q>,
        questions: impl Iterator<Item = (&'o Object, Q)>,
    ) -> Result<Self::Asked<Q>, CosimError>;

    /// Waits for the answers and hands them to `each`, in the order of the questions. Gives the memory back.
    fn answers<Q: Question>(
        &mut self,
        asked: Self::Asked<Q>,
        each: impl for<'a> FnMut(Q, Result<Q::Answer<'a>, NoAnswer>),
    ) -> impl Future<Output = Result<Self::Asked<Q>, CosimError>>;

    /// Hands over what was told, and ends all reports. SUMO could go on without us.
    fn leave(&mut self) -> impl Future<Output = Result<(), CosimError>>;

    /// Ends the connection.
    fn close(self) -> impl Future<Output = Result<(), CosimError>>;

    /// Time spent waiting for SUMO so far.
    fn waited(&self) -> Duration;
}

/// Whether this SUMO tells the mass of a vType.
pub(super) fn tells_mass(version: &SumoVersion) -> bool {
    version.at_least(1, 21)
}

/// A number as the value of a parameter: four decimals say all that a plot can show.
pub(super) fn value_text(value: f64) -> String {
    ((value * 1e4).round() / 1e4 + 0.0).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_shown_with_four_decimals_and_never_as_minus_nothing() {
        let texts = [0.123_456, -1.5, 12.0, 0.0, -0.000_01, 1_234.567_89].map(value_text);
        assert_eq!(texts, ["0.1235", "-1.5", "12", "0", "0", "1234.5679"]);
    }

    #[test]
    fn sumo_tells_the_mass_of_a_type_since_1_21() {
        let tells = |number| tells_mass(&SumoVersion { api: 21, text: String::new(), number });
        assert_eq!(
            [(1, 15, 0), (1, 20, 0), (1, 21, 0), (1, 28, 0), (2, 0, 0)].map(tells),
            [false, false, true, true, true]
        );
    }
}
