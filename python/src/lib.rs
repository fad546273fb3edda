//! `sumo_mfc._core`: what of the Python package is Rust. Its Python side, in `sumo_mfc/`, has the names that users see.

mod command;
mod controller;
mod error;
mod offline;
mod parts;
mod plan;
mod session;
mod table;
mod views;

use pyo3::prelude::*;

/// What of sumo_mfc is Rust.
#[pymodule]
mod _core {
    #[pymodule_export]
    use super::command::{choices, main, report};
    #[pymodule_export]
    use super::controller::register;
    #[pymodule_export]
    use super::error::Error;
    #[pymodule_export]
    use super::offline::drive;
    #[pymodule_export]
    use super::parts::{Plant, identify_tyre, tyre_force, ultra_local_f};
    #[pymodule_export]
    use super::plan::Plan;
    #[pymodule_export]
    use super::session::Session;
    #[pymodule_export]
    use super::table::{Table, read_table};

    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
