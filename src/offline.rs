//! Vehicles on a road without SUMO. They drive in the fleet that `run` uses, so the closed loop is the same to the last
//! bit: measurement, law, actuator and body in every control period.
//!
//! [`Drive`] is one vehicle on one profile. Everything that a scenario file can say is set by the same keys:
//!
//! ```
//! use sumo_mfc::{offline::Drive, reference::{Axis, Profile}, scenario::Catalog};
//!
//! let drive = Drive::new(&Catalog::installed())
//!     .set("vehicle.preset", "van")
//!     .set("controller.name", "adaptive")
//!     .set("actuator.delay_s", 0.1)
//!     .follow(Profile::step(Axis::Time, &[0.0, 20.0], &[10.0, 20.0])?)
//!     .for_s(60.0)
//!     .run()?;
//! let last = drive.series.last().unwrap();
//! assert!((last.speed_mps - 20.0).abs() < 0.5);
//! assert!(drive.stats.error_rms < Some(5.0));
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Road`] drives many vehicles of one scenario at once and shows each of them in every control period, also to change
//! its body, its road or the wind on the way.

mod drive;
mod error;
mod road;
mod vehicle;

pub use drive::{Drive, Driven};
pub use error::OfflineError;
pub use road::{End, Outcome, Road, Trip};
pub use vehicle::{Moment, Vehicle};
