//! One vehicle on one profile, in a few lines.

use super::error::OfflineError;
use super::road::{End, Road};
use super::vehicle::{Moment, Vehicle};
use crate::reference::Profile;
use crate::scenario::{Catalog, Override, Request, Scenario};
use crate::stats::VehicleStats;
use std::sync::Arc;
use toml_edit::Value;

/// One vehicle on one profile.
#[derive(Debug, Clone)]
pub struct Drive {
    catalog: Catalog,
    settings: Vec<Override>,
    profile: Option<Arc<Profile>>,
    start_mps: Option<f64>,
    end: Option<End>,
}

/// What a vehicle did.
#[derive(Debug, Clone)]
pub struct Driven {
    /// The end of every control period.
    pub series: Vec<Moment>,
    /// The statistics, as `run` has them.
    pub stats: VehicleStats,
    /// False if the vehicle did not reach the end, or its state is not a number.
    pub finished: bool,
}

impl Drive {
    /// A drive with the default law and body. Names of laws, bodies and plants are those of the catalog.
    pub fn new(catalog: &Catalog) -> Self {
        let settings = vec![Override::text("target", "target.name", "profile")];
        Self { catalog: catalog.clone(), settings, profile: None, start_mps: None, end: None }
    }

    /// Sets a key of the scenario, e.g. `controller.name`, `controller.k_p`, `vehicle.preset`, `vehicle.mass_kg`,
    /// `actuator.delay_s`, `noise.power_db`, `target.file`, `coupling.control_period_s`.
    #[must_use]
    pub fn set(mut self, key: &str, value: impl Into<Value>) -> Self {
        self.settings.push(Override::literal(&format!("{key} ="), key, value.into()));
        self
    }

    /// Follows this profile, and not the one of the section `target`.
    #[must_use]
    pub fn follow(self, profile: Profile) -> Self {
        Self { profile: Some(Arc::new(profile)), ..self }
    }

    /// Starts at this speed [m/s], and not at the profile's first speed.
    #[must_use]
    pub fn starting_at(self, speed_mps: f64) -> Self {
        Self { start_mps: Some(speed_mps), ..self }
    }

    /// Ends after so many seconds, and not at the profile's end.
    #[must_use]
    pub fn for_s(self, seconds: f64) -> Self {
        Self { end: Some(End::Time(seconds)), ..self }
    }

    /// Ends after so many metres, and not at the profile's end.
    #[must_use]
    pub fn for_m(self, metres: f64) -> Self {
        Self { end: Some(End::Distance(metres)), ..self }
    }

    /// Drives.
    ///
    /// # Errors
    /// [`OfflineError`] with the key that is wrong, or if the profile has no end and the drive has none.
    pub fn run(&self) -> Result<Driven, OfflineError> {
        self.run_disturbed(|_| {})
    }

    /// Drives, and shows the vehicle to `disturb` at the end of every control period.
    ///
    /// # Errors
    /// As [`Drive::run`].
    pub fn run_disturbed(&self, mut disturb: impl FnMut(&mut Vehicle)) -> Result<Driven, OfflineError> {
        let request = Request { scenario: None, overrides: self.settings.clone() };
        let scenario = Scenario::load_offline(&request, &self.catalog)?;
        let road = match &self.profile {
            Some(profile) => Road::with_profile(&scenario, Arc::clone(profile))?,
            None => Road::new(&scenario)?,
        };
        let end = self.end.or(road.end()).ok_or(OfflineError::NoProfile)?;
        let trip = road.trip(0, self.start_mps.unwrap_or(road.first_speed_mps()), end)?;
        let mut series = Vec::new();
        let outcomes = road.drive(&[trip], |vehicle| {
            series.push(vehicle.moment());
            disturb(vehicle);
        })?;
        Ok(Driven { series, stats: outcomes[0].stats, finished: outcomes[0].finished })
    }
}
