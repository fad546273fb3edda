//! How SUMO is started, and on which files.

use std::path::PathBuf;

/// How SUMO is started.
#[derive(Debug, Clone, PartialEq)]
pub struct SumoSetup {
    /// What SUMO loads.
    pub source: Source,
    /// SUMO's step \[s\].
    pub step_length_s: f64,
    /// Simulation time at which the run ends \[s\]; `None` = as the configuration says.
    pub end_s: Option<f64>,
    /// Seed of SUMO and of everything drawn here.
    pub seed: u64,
    /// Whether SUMO moves vehicles by the mean of old and new speed.
    pub ballistic: bool,
    /// Further options of SUMO, passed on as they are.
    pub options: Vec<String>,
    /// Start sumo-gui.
    pub gui: bool,
    /// TraCI port; `None` = a free one.
    pub port: Option<u16>,
    /// TraCI clients that SUMO waits for, this one included.
    pub num_clients: u32,
    /// `HOST:PORT` of a SUMO that already runs.
    pub connect: Option<String>,
}

/// What SUMO loads; all paths absolute.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// A `.sumocfg`.
    Config(PathBuf),
    /// A network with its traffic.
    Network {
        /// The network.
        net: PathBuf,
        /// Route files.
        routes: Vec<PathBuf>,
        /// Additional files.
        additional: Vec<PathBuf>,
    },
    /// Whatever the SUMO at `connect` has loaded.
    Running,
    /// Nothing: the vehicles drive without SUMO (`Scenario::load_offline`).
    Offline,
}
