//! How SUMO is started, and on which files.

use std::path::{Path, PathBuf};

use crate::keys;

keys! {
    /// How SUMO is started, the section `[sumo]` of a scenario. All paths are absolute.
    pub struct SumoSetup {
        /// SUMO configuration (.sumocfg); or net and routes
        config: Option<PathBuf>;
        /// SUMO network (.net.xml), instead of config
        net: Option<PathBuf>;
        /// route files of net
        routes: Vec<PathBuf>;
        /// additional files of net
        additional: Vec<PathBuf>;
        /// state that SUMO has saved (.xml, .xml.gz), from which it goes on
        load_state: Option<PathBuf>;
        /// SUMO's step, a whole number of control periods and of 1 ms
        step_length_s: f64 = 0.1, "s", 0.001..=10.0;
        /// simulation time at which the run ends; not set = the configuration's
        end_s: Option<f64>, "s", 0.001..=1e9;
        /// seed of SUMO and of everything drawn here
        seed: u64 = 23423, "-", 0..=i32::MAX;
        /// SUMO moves vehicles by the mean of old and new speed, as the body does
        ballistic: bool = true;
        /// only vehicles that touch collide (collision.mingap-factor 0); not set = where any ego has a body
        contacts: Option<bool>;
        /// SUMO measures conflicts of all vehicles (its SSM device: TTC, DRAC, PET)
        safety: bool = false;
        /// SUMO's FCD output (sumo/fcd.xml, or where the configuration has it) holds mfc.err, mfc.torque and mfc.alpha of egos
        fcd: bool = false;
        /// further options of SUMO
        options: Vec<String>;
        /// start sumo-gui instead of sumo
        gui: bool = false;
        /// TraCI port; not set = a free one
        port: Option<u16>, "-", 1..=65535;
        /// TraCI clients that SUMO waits for, this one included
        num_clients: u32 = 1, "-", 1..=1000;
        /// longest time that SUMO may take to load, and to answer
        timeout_s: f64 = 600.0, "s", 0.1..=1e6;
        /// HOST:PORT of a SUMO that already runs
        connect: Option<String>, form address;
    }
}

fn address(text: &str) -> Result<(), String> {
    match text.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => Ok(()),
        _ => Err("HOST:PORT".to_owned()),
    }
}

/// What SUMO loads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source<'a> {
    /// A `.sumocfg`.
    Config(&'a Path),
    /// A network with its traffic.
    Network(&'a Path),
    /// What the SUMO at `connect` has loaded.
    Running,
    /// Nothing: the vehicles drive without SUMO (`Scenario::load_offline`).
    Offline,
}

impl SumoSetup {
    /// What SUMO loads.
    pub fn source(&self) -> Source<'_> {
        match (&self.config, &self.net, &self.connect) {
            (Some(config), _, _) => Source::Config(config),
            (None, Some(net), _) => Source::Network(net),
            (None, None, Some(_)) => Source::Running,
            (None, None, None) => Source::Offline,
        }
    }

    /// True if other clients may be at the SUMO.
    pub fn is_shared(&self) -> bool {
        self.connect.is_some() || self.num_clients > 1
    }

    /// All files that are named for SUMO to load.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.config.iter().chain(&self.net).chain(&self.routes).chain(&self.additional).chain(&self.load_state)
    }
}
