//! SUMO's own files: the configuration and its options, SUMO's command line, what it writes and where, who drives in the
//! demand, and the results that SUMO leaves.
//!
//! The module knows nothing of scenarios: [`SumoSetup`] says how SUMO is to be started, and `scenario` fills it.

mod arguments;
mod configuration;
mod conflicts;
mod demand;
mod equipped;
mod error;
mod incidents;
mod include;
mod log;
mod network;
mod options;
mod path;
mod records;
mod redirect;
mod sampling;
mod settings;
mod setup;
mod state;
mod statistics;
mod tripinfo;
mod xml;

pub(crate) use arguments::ours;
pub use arguments::{SIGNALS, SumoCommand, sumo_arguments};
pub use conflicts::{Conflict, Conflicts, each_conflict};
pub(crate) use demand::{Demand, LeftOpen, Param};
pub use equipped::Equipped;
pub use error::SumoFileError;
pub use incidents::{Incident, incidents};
pub use log::left_out;
pub use network::{NetworkRoad, is_network, network_roads};
pub(crate) use options::{below_results, boolean, named_output, refused_of_file};
pub(crate) use path::{absolute, environment};
pub(crate) use records::each_row;
pub use settings::as_configured;
pub use setup::{Source, SumoSetup};
pub use state::{plain_until, saving, span_s};
pub use statistics::SumoStatistics;
pub use tripinfo::{EMISSIONS, TripInfo, Trips, each_trip};
pub(crate) use xml::{bounded, is_xml};
