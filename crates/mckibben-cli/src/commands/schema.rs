//! `mckibben schema`: the JSON Schema of scenario files, for editors.

use crate::terminal;
use mckibben_run::failure::Failure;

/// Arguments of `mckibben schema`.
#[derive(Clone, Copy, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben schema > mckibben.schema.json

An editor that knows TOML then completes keys and explains them. With Taplo or \"Even Better TOML\", begin the scenario file with the line
  #:schema ./mckibben.schema.json")]
pub struct SchemaArguments {}

/// Prints the schema.
///
/// # Errors
/// [`Failure::output`] when it cannot be printed.
pub fn run(_arguments: &SchemaArguments) -> Result<(), Failure> {
    terminal::print(&format!("{:#}\n", mckibben_scenario::schema()))
}
