//! What a block of the reply says about a vehicle. SUMO sends every client what any client has subscribed to, so that
//! some blocks are not ours.

use super::{CosimError, variable};
use crate::traci::Block;

/// What a block about a vehicle is to us.
pub(super) enum Seen<'a> {
    /// What we subscribed to.
    Ours(Values<'a>),
    /// The vehicle is not there any more.
    Gone,
    /// What another client subscribed to.
    Others,
}

/// Values of a vehicle; none while SUMO carries it.
#[derive(Default)]
pub(super) struct Values<'a> {
    /// Speed [m/s].
    pub speed: Option<f64>,
    /// Heading, clockwise from north \[degrees\].
    pub angle: Option<f64>,
    /// Lane; only asked for of leading egos.
    pub lane: Option<&'a str>,
    /// Slope of the road, uphill positive \[degrees\]; only asked for if bodies are to feel it.
    pub slope: Option<f64>,
}

/// Reads a block about a vehicle.
pub(super) fn seen<'a>(block: &Block<'a>) -> Result<Seen<'a>, CosimError> {
    let mut values = Values::default();
    let mut ours = false;
    for entry in block.values() {
        match entry? {
            (variable::SPEED | variable::SPEED_WITHOUT_TRACI, Err(_)) => return Ok(Seen::Gone),
            (variable::SPEED | variable::SPEED_WITHOUT_TRACI, Ok(value)) => {
                ours = true;
                values.speed = value.as_f64();
            }
            (variable::ANGLE, Ok(value)) => values.angle = value.as_f64(),
            (variable::SLOPE, Ok(value)) => values.slope = value.as_f64(),
            (variable::LANE_ID, Ok(value)) => values.lane = value.as_str(),
            _ => {}
        }
    }
    Ok(if ours { Seen::Ours(values) } else { Seen::Others })
}
