//! One scenario, one result: SUMO is started, stepped to the end, and all files of the result are written.
//!
//! [`run()`] does this as the program does. A [`Session`] is the same step by step, for code of your own that looks at
//! the egos between the steps, or ends the run early:
//!
//! ```no_run
//! use sumo_mfc::run::{Session, SessionOptions};
//! use sumo_mfc::scenario::{Catalog, Request, Scenario};
//!
//! # async fn example() -> Result<(), Box<dyn std::error::Error>> {
//! let scenario = Scenario::load(&Request::file("scenarios/straight.toml"), &Catalog::installed())?;
//! let options = SessionOptions { out_dir: "out/straight".into(), force: true, ..SessionOptions::default() };
//! let mut session = Session::open(&scenario, &options).await?;
//! while !session.is_over() {
//!     session.step().await?;
//!     for ego in session.egos() {
//!         println!("{} {}: {:+.3} m/s", session.time_s(), ego.id, ego.speed - ego.reference);
//!     }
//! }
//! println!("{:?}", session.finish().await?.summary.fleet["error_rms"]);
//! # Ok(())
//! # }
//! ```
//!
//! Whatever ends a run early (SUMO died, the disk is full, Ctrl-C) leaves what was computed so far, marked incomplete.

mod backend;
mod error;
#[cfg(feature = "libsumo")]
mod here;
mod host;
mod joined;
mod manifest;
mod noted;
#[cfg(target_os = "linux")]
mod one_core;
mod options;
mod outcome;
mod profile;
mod progress;
mod recorder;
mod recover;
mod remote;
mod repeat;
mod result;
mod result_dir;
mod rows;
mod sampler;
mod schema;
mod session;
pub mod setup;
mod signals;
mod spread;
mod summary;
mod tally;
mod tied;
mod whole;

pub use backend::Backend;
pub use error::RunError;
#[cfg(feature = "libsumo")]
pub(crate) use here::version as version_here;
pub use manifest::{Input, Manifest, Status};
pub use options::SessionOptions;
pub use profile::Profile;
pub use recover::{Recovered, recover};
pub use remote::{Remote, Times};
pub use repeat::repeated;
pub use result::RunResult;
pub use result_dir::{MANIFEST, ResultDir};
pub use rows::{EDGES, EdgeRow, QUALITY, QualityRow, SAMPLE, SampleRow, TRACE, TraceRow, VEHICLES, VehicleRow};
pub use schema::{FileSchema, Schema};
pub use session::Session;
pub use setup::world;
pub use signals::Signal;
pub(crate) use signals::Signals;
pub use spread::Spread;
pub use summary::{Summary, SumoTotals, terminal_text};
pub use tally::Remarkable;
pub(crate) use tied::LINGER;
pub use whole::{RunOptions, run, run_remote};
