//! What egos show of themselves in SUMO: signals for its FCD output, and colours for sumo-gui. Nothing is decided by it.

use super::egos::{Ego, Presence};
use super::error::CosimError;
use super::sumo::{Sumo, Tell};
use crate::figure::{STEPS, step_rgb};
use crate::fleet::block::Block;
use crate::sumo_files::SIGNALS;
use crate::traci::Color;

/// The error from which on an ego has the last colour [m/s].
pub const FULL_COLOUR_MPS: f64 = 1.0;

/// What is shown.
#[derive(Debug, Clone, Copy, Default)]
pub struct Display {
    /// The generic parameters [`SIGNALS`], for SUMO's own FCD output. It writes them with the next step, under the time
    /// at which that begins: a row holds the signals of its time.
    pub signals: bool,
    /// The colour of the vehicle says how large its error is.
    pub colours: bool,
}

impl Display {
    /// Whether anything is shown.
    pub fn is_on(self) -> bool {
        self.signals || self.colours
    }

    /// Tells SUMO what an ego shows after a step.
    pub fn show<S: Sumo>(self, sumo: &mut S, ego: &mut Ego, block: &Block) -> Result<(), CosimError> {
        if ego.presence != Presence::Driving {
            return Ok(());
        }
        let now = block.snapshot(ego.slot.lane());
        let error_mps = now.speed_mps - now.reference_mps;
        if self.signals {
            for (name, value) in SIGNALS.into_iter().zip([error_mps, now.torque_nm, now.alpha_ratio]) {
                sumo.tell(&ego.object, Tell::Parameter(name, value))?;
            }
        }
        let shade = shade(error_mps);
        if self.colours && ego.shade.replace(shade) != Some(shade) {
            let [red, green, blue] = step_rgb(shade);
            sumo.tell(&ego.object, Tell::Colour(Color { red, green, blue, alpha: 255 }))?;
        }
        Ok(())
    }
}

/// The step of colour of an error.
fn shade(error_mps: f64) -> usize {
    ((error_mps.abs() / FULL_COLOUR_MPS * STEPS as f64) as usize).min(STEPS - 1)
}
