//! Vehicles of all bodies, with and without dead time, lag and noise, for tests of a fleet.

use sumo_mfc::fleet::{ActuatorSetup, VehicleSetup};
use sumo_mfc::plant::BODIES;
use sumo_mfc::random::Stream;

/// A vehicle by its number: the same number is the same vehicle.
pub fn vehicle(number: usize) -> VehicleSetup {
    let body = (BODIES[number % BODIES.len()].build)();
    VehicleSetup {
        nominal_nm_per_mps2: body.nominal_nm_per_mps2(),
        actuator: ActuatorSetup { dead_time_s: 0.013 * (number % 7) as f64, lag_s: 0.02 * (number % 3) as f64 },
        noise: (number.is_multiple_of(2)).then(|| (Stream::new(5, "noise", &number.to_string()), 0.3)),
        speed_mps: (number % 15) as f64,
        body,
    }
}
