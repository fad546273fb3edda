//! The result of a run or a study as one HTML page, made from the files of its folder alone.
//!
//! The way is one: the folder is read (`data`), numbers become sections of tables and figures (`run_page`, `study_page`),
//! these are a `page::Page`, and its template makes HTML of it. The page's script adds sorting, filtering, curves of a vehicle,
//! and zoom.

mod compact;
mod data;
mod error;
mod figures;
mod fleet;
mod groups;
mod head;
mod number;
mod road_map;
mod run_page;
mod safety;
mod study_data;
mod study_figures;
mod study_page;
mod table;
mod traces;
mod vehicles;
mod write;

pub use error::ReportError;
pub use write::{FILES, Request, Written, report};
