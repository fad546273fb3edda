//! The whole command line with a law of one's own, proportional with feed-forward:
//! `cargo run -- run scenarios/straight.toml --controller proportional --set controller.k_p=2`.

use std::process::ExitCode;

use sumo_mfc::cli;
use sumo_mfc::control::{Build, Command, Controller, Observation, law};
use sumo_mfc::lanes::LANES;
use sumo_mfc::registry::Entry;
use sumo_mfc::scenario::Catalog;

sumo_mfc::keys! {
    /// Keys of the law.
    pub struct ProportionalKeys {
        /// acceleration per speed error
        k_p: f64 = 1.0, "1/s", 0.0..=100.0;
    }
}

/// a = ẏ_r − k_p (y − y_r), asked for as the torque that gives it to the nominal vehicle.
struct Proportional(ProportionalKeys);

impl Controller for Proportional {
    fn command(&mut self, seen: &Observation, command: &mut Command) {
        for i in 0..LANES {
            let error_mps = seen.measured_mps[i] - seen.reference_mps[i];
            let accel_mps2 = seen.reference_rate_mps2[i] - self.0.k_p * error_mps;
            command.ask(i, accel_mps2, seen.nominal_nm_per_mps2[i], 1.0);
        }
    }

    fn reset(&mut self, _: usize, _: f64) {}
}

/// The law as it is registered.
pub fn proportional() -> Entry<Build> {
    law("proportional", "P with feed-forward", |keys: ProportionalKeys, _period_s| Proportional(keys))
}

fn main() -> ExitCode {
    let catalog = Catalog::installed().with_controller(proportional()).expect("a name that no other law has");
    cli::main(&catalog)
}
