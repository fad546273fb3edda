//! What can go wrong between fleet and SUMO.

use crate::fleet::LawFailure;
use crate::plant::tyre::TyreError;
use crate::registry::UnknownName;
use crate::traci;

/// What can go wrong between fleet and SUMO.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CosimError {
    /// The connection, or SUMO.
    #[error(transparent)]
    Traci(#[from] traci::Error),
    /// SUMO in this process.
    #[cfg(feature = "libsumo")]
    #[error("SUMO in this process: {0}")]
    Libsumo(#[from] sumo_mfc_libsumo::Error),
    /// A command that must not be sent.
    #[error(transparent)]
    Batch(#[from] traci::BatchError),
    /// Bytes that are not TraCI.
    #[error("SUMO's answer cannot be understood: {0}")]
    Decode(#[from] traci::wire::DecodeError),
    /// A name that no registry has.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// A measured tyre curve.
    #[error("vehicle.tyre_curve: {0}")]
    Tyre(#[from] TyreError),
    /// The law of a group gave up.
    #[error(transparent)]
    Law(#[from] LawFailure),
    /// A `mfc.*` parameter of a vehicle or vType.
    #[error("vehicle \"{vehicle}\", parameter {key}: found \"{found}\", wanted {wanted}")]
    Parameter {
        /// The vehicle.
        vehicle: String,
        /// The parameter.
        key: String,
        /// Its value.
        found: String,
        /// What it should be.
        wanted: String,
    },
    /// Rows of the trace would not fall on the ends of control periods.
    #[error("output.trace_period_s: found {trace_s}, wanted {wanted}")]
    TracePeriod {
        /// Time between rows \[s\].
        trace_s: f64,
        /// What it should be.
        wanted: String,
    },
    /// SUMO's step is not a whole number of control periods.
    #[error("SUMO steps by {step_s} s, which is not a whole number of control periods of {period_s} s")]
    Step {
        /// SUMO's step \[s\].
        step_s: f64,
        /// Control period \[s\].
        period_s: f64,
    },
}
