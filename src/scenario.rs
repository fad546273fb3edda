//! What to run: a TOML file, a `.sumocfg` or a bare network with routes, together with what the command line overrides,
//! becomes one [`Scenario`] of checked SI values.
//!
//! Every key lives in a table ([`mod@crate::keys`]): the fixed sections in `sections.rs`, the rest in the registries. Reading,
//! range checks, suggestions, `check` and `check --template` all come from these tables, so a new key is one line.

mod catalog;
mod document;
mod error;
mod fleet;
mod layout;
mod load;
mod model;
mod print;
mod reader;
mod schema;
mod sections;
mod selector;
mod spread;

pub use catalog::Catalog;
pub use document::Override;
pub use error::{Mistake, ScenarioError, Wrong};
pub use load::Request;
pub use model::{Choice, Group, Preset, Scenario, Vehicle};
pub use print::template;
pub use schema::schema;
pub use sections::{Coupling, Output, Trace, Traffic};
pub use selector::{EgoInfo, Selector};
pub use spread::{Distribution, PerVehicle};

#[cfg(test)]
mod tests;
