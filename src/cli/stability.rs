//! The arguments of `stability`.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use super::help::{CONTROLLER, GENERAL, OUTPUT, SCENARIO};
use super::shared::{ExportArgs, set};
use crate::{
    scenario::{Override, Request},
    stability,
};

/// `stability`.
#[derive(Debug, Args)]
pub struct StabilityArgs {
    /// A scenario (.toml) with the body and the gains [default: the default body and gains]
    #[arg(value_name = "SCENARIO", value_hint = ValueHint::FilePath)]
    scenario: Option<PathBuf>,
    /// Laws, separated by commas [default: all that drive a body]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', help_heading = CONTROLLER)]
    controllers: Vec<String>,
    /// Targets that keep the gaps of a string, separated by commas
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "ctg_acc,path_cacc", help_heading = CONTROLLER)]
    uppers: Vec<String>,
    /// Time constants of the actuators [s], separated by commas
    #[arg(long, value_name = "S", value_delimiter = ',', default_value = "0,0.3", value_parser = seconds, help_heading = SCENARIO)]
    lag: Vec<f64>,
    /// Dead times of the actuators [s], separated by commas
    #[arg(long, value_name = "S", value_delimiter = ',', default_value = "0,0.1,0.25", value_parser = seconds, help_heading = SCENARIO)]
    delay: Vec<f64>,
    /// Any key of the scenario, by its TOML path: controller.k_p=2
    #[arg(long, value_name = "KEY=VALUE", value_parser = set, help_heading = SCENARIO)]
    set: Vec<Override>,
    /// Folder of the tables
    #[arg(short, long, value_name = "DIR", default_value = "out/stability", help_heading = OUTPUT)]
    pub out: PathBuf,
    #[command(flatten)]
    pub export: ExportArgs,
    /// Only errors
    #[arg(short, long, help_heading = GENERAL)]
    pub quiet: bool,
}

impl StabilityArgs {
    /// What they ask for.
    pub fn request(&self, progress: bool) -> stability::Request {
        stability::Request {
            scenario: Request { scenario: self.scenario.clone(), overrides: self.set.clone() },
            controllers: self.controllers.clone(),
            lags_s: self.lag.clone(),
            delays_s: self.delay.clone(),
            uppers: self.uppers.clone(),
            progress,
        }
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|s| (0.0..=5.0).contains(s)).ok_or_else(|| "wanted seconds from 0 to 5".to_owned())
}
