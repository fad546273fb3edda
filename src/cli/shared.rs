//! Arguments that several subcommands have.

use clap::{
    Args,
    builder::{PossibleValuesParser, TypedValueParser},
};

use super::help::OUTPUT;
use crate::{
    output::{FORMS, Form},
    registry::find,
    scenario::Override,
};

/// How a table is printed.
#[derive(Debug, Args)]
#[command(next_help_heading = OUTPUT)]
pub struct ExportArgs {
    /// Print nothing on stdout but the table, in this form
    #[arg(long, value_name = "FORMAT", value_parser = forms())]
    pub export: Option<Form>,
}

/// The names of [`FORMS`].
fn forms() -> impl TypedValueParser<Value = Form> {
    PossibleValuesParser::new(FORMS.iter().map(|form| form.name))
        .try_map(|name| find("form", FORMS, &name).map(|form| form.build))
}

/// Reads the value of `--set`.
pub fn set(argument: &str) -> Result<Override, String> {
    Override::set(argument).ok_or_else(|| "wanted KEY=VALUE, e.g. controller.k_p=1.2".to_owned())
}
