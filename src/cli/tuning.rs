//! The arguments of `tune`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use super::help::{CONTROLLER, GENERAL, OUTPUT, SCENARIO, STUDY};
use super::shared::{ExportArgs, set};
use crate::{
    scenario::{Override, Request},
    tune::{self, Condition},
};

/// `tune`.
#[derive(Debug, Args)]
pub struct TuneArgs {
    /// A scenario (.toml) with body, actuators and noise [default: the default body, no noise]
    #[arg(value_name = "SCENARIO")]
    scenario: Option<PathBuf>,
    /// Laws, separated by commas; ratios are to the first
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "classic,adaptive,calibrating,pid", help_heading = CONTROLLER)]
    controllers: Vec<String>,
    /// How many gains of each law are free
    #[arg(long, value_name = "N", default_value_t = 2, help_heading = CONTROLLER)]
    gains: usize,
    /// Recordings to tune on (see docs/how-to/recordings.md)
    #[arg(long, value_name = "FILE", num_args = 1.., required = true, help_heading = SCENARIO, value_hint = ValueHint::FilePath)]
    train: Vec<PathBuf>,
    /// Other recordings, to judge on
    #[arg(long, value_name = "FILE", num_args = 1.., required = true, help_heading = SCENARIO, value_hint = ValueHint::FilePath)]
    test: Vec<PathBuf>,
    /// A condition, "NAME: KEY=VALUE KEY=VALUE"; several make a table [default: the scenario as it is]. Beside the scenario's keys there are
    /// road.grade (0.05 is 5 % uphill), road.hill_m (from hill to hill), and law.torque_scale (4: laws take the vehicle for four times as heavy)
    #[arg(long, value_name = "CONDITION", value_parser = Condition::parse, help_heading = STUDY)]
    condition: Vec<Condition>,
    /// Vehicles per recording, each with noise and draws of its own
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = at_least_one, help_heading = STUDY)]
    seeds: usize,
    /// Sets of gains to try per law and condition
    #[arg(long, value_name = "N", default_value_t = 150, value_parser = at_least_one, help_heading = STUDY)]
    trials: usize,
    /// Any key of the scenario, by its TOML path: noise.power_db=-12
    #[arg(long, value_name = "KEY=VALUE", value_parser = set, help_heading = SCENARIO)]
    set: Vec<Override>,
    /// Folder of the table
    #[arg(short, long, value_name = "DIR", default_value = "out/tune", help_heading = OUTPUT)]
    pub out: PathBuf,
    #[command(flatten)]
    pub export: ExportArgs,
    /// Only errors
    #[arg(short, long, help_heading = GENERAL)]
    pub quiet: bool,
}

impl TuneArgs {
    /// What they ask for.
    pub fn request(&self, progress: bool) -> tune::Request {
        let as_it_is = || vec![Condition::parse("as it is:").expect("a name")];
        tune::Request {
            scenario: Request { scenario: self.scenario.clone(), overrides: self.set.clone() },
            controllers: self.controllers.clone(),
            gains: self.gains,
            train: self.train.clone(),
            test: self.test.clone(),
            seeds: self.seeds,
            trials: self.trials,
            conditions: if self.condition.is_empty() { as_it_is() } else { self.condition.clone() },
            progress,
        }
    }
}

fn at_least_one(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|count| *count > 0).ok_or_else(|| "wanted a whole number above 0".to_owned())
}
