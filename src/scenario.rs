//! What to run: a TOML file, a `.sumocfg` or a bare network with routes, together with what the command line overrides,
//! becomes one [`Scenario`] of checked SI values.
//!
//! Every key is declared once ([`mod@crate::keys`]): those of the fixed sections in `sections.rs` and beside what they
//! describe, those of a controller, target or plant with its entry. The check of a file, its suggestions, `check`,
//! `check --template` and `check --schema` come from these declarations.
//!
//! A file is read in one pass that notes every mistake ([`Mistake`]) instead of stopping at the first one. What can be
//! chosen by name is a value, the [`Catalog`], to which other crates add entries of their own.

mod catalog;
mod document;
mod error;
mod fleet;
mod headway;
mod layout;
mod load;
mod model;
mod parameters;
mod print;
mod reader;
mod schema;
mod sections;
mod selector;
mod spread;
mod trace;

pub use catalog::Catalog;
pub use document::Override;
pub(crate) use document::{Entry, Node, Table};
pub use error::{Mistake, ScenarioError, Wrong};
pub use headway::HeadwayMargin;
#[doc(hidden)]
pub use layout::{Form, Section, sections};
pub use load::Request;
pub(crate) use load::read;
pub use model::{Choice, Group, Preset, Scenario, Vehicle};
pub use parameters::{Parameter, parameter_keys, parameter_names};
pub use print::template;
pub(crate) use reader::{Reader, names};
pub use schema::schema;
pub use sections::{Coupling, Output, Traffic};
pub use selector::{EgoInfo, Selector};
pub use spread::{Distribution, PerVehicle};
pub use trace::{Trace, TraceRows};

#[cfg(test)]
mod tests;
