//! Everything that can go wrong between us and SUMO.

use std::path::PathBuf;
use std::time::Duration;

use super::version::SumoVersion;
use super::wire::DecodeError;

/// Longest object id in bytes. SUMO repeats ids in error texts, and ends itself if a text does not fit a status of 255
/// bytes; the longest text around an id has about 60 bytes (a subscription to an unknown traffic light).
pub const MAX_ID_BYTES: usize = 180;

/// A command that must not be sent.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BatchError {
    /// SUMO would act on it before the step.
    #[error("the batch already ends with a step; a command behind it would act before it: send it in the next batch")]
    AfterStep,
    /// SUMO ends itself when an error text with such an id does not fit.
    #[error("id of {length} bytes (at most {MAX_ID_BYTES}, longer ones can end SUMO): {id}...")]
    IdTooLong {
        /// The beginning of the id.
        id: String,
        /// Its length in bytes, with the parameter of a get.
        length: usize,
    },
    /// Not a number, infinite, or a negative speed: SUMO would silently release the vehicle.
    #[error("{value} is not a usable {what}")]
    BadNumber {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Subscribed without the parameter that it needs: SUMO takes the next variable for the parameter, loses its place
    /// in the message and hangs, or dies.
    #[error("variable 0x{id:02x} needs a parameter: use `subscribe_with`")]
    NeedsParameter {
        /// Its identifier.
        id: u8,
    },
    /// One subscription is about one object, and so about one domain.
    #[error("variables of several domains in one subscription")]
    SeveralDomains,
    /// The message would exceed 2 GiB, or one command 255 variables.
    #[error("the batch grows too large")]
    TooLarge,
}

/// An error of the TraCI room.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The command must not be sent.
    #[error(transparent)]
    Batch(#[from] BatchError),
    /// SUMO's answer is not TraCI; the connection is finished.
    #[error("SUMO's answer cannot be understood: {0}")]
    Decode(#[from] DecodeError),
    /// SUMO declined the command; the connection is well.
    #[error("SUMO declined: {text}")]
    Refused {
        /// SUMO's reason.
        text: String,
        /// True if this SUMO does not know the command.
        not_implemented: bool,
    },
    /// The object exists but has no value now (a vehicle not departed or teleporting).
    #[error("no value now: the object has not departed or is teleporting")]
    NoValue,
    /// The answer has another type than the table says.
    #[error("expected a {expected}, SUMO sent a {got}")]
    Type {
        /// What the table says.
        expected: &'static str,
        /// What came.
        got: &'static str,
    },
    /// The reply holds no answer to a get with this number.
    #[error("command {command} of the batch asked for no value")]
    NotAsked {
        /// Number of the command.
        command: usize,
    },
    /// A batch without commands; SUMO would never answer it.
    #[error("an empty batch has no answer")]
    Empty,
    /// SUMO did not answer in time; the connection is finished.
    #[error("SUMO did not answer within {:.1} s", .after.as_secs_f64())]
    Timeout {
        /// The time allowed.
        after: Duration,
    },
    /// SUMO closed the connection: it ended or was killed.
    #[error("SUMO ended the connection: {0}")]
    Disconnected(#[source] std::io::Error),
    /// An earlier error finished the connection.
    #[error("the connection to SUMO is finished after an earlier error")]
    Finished,
    /// Nobody listens there.
    #[error("cannot connect to SUMO at {address}: {source}")]
    Connect {
        /// Where.
        address: String,
        /// Why.
        source: std::io::Error,
    },
    /// SUMO is older than this client supports.
    #[error("{found} is too old, SUMO {}.{} or newer is needed", SumoVersion::MINIMUM.0, SumoVersion::MINIMUM.1)]
    TooOld {
        /// The version found.
        found: SumoVersion,
    },
    /// No SUMO binary anywhere; the text says what to type.
    #[error("{0}")]
    NotFound(String),
    /// The operating system does not start SUMO, or its log cannot be written.
    #[error("cannot start SUMO: {}: {source}", .path.display())]
    Start {
        /// The binary or log file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The port asked for is taken.
    #[error("port {port} is in use")]
    PortInUse {
        /// The port.
        port: u16,
    },
    /// SUMO ended. `report` is what it said last.
    #[error("SUMO ended ({status}){}{report}", if .report.is_empty() { "" } else { ":\n" })]
    Died {
        /// Exit code or signal.
        status: String,
        /// Its last lines.
        report: String,
    },
}
