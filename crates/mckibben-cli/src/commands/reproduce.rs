//! `mckibben reproduce`: the paper's experiments as one report.
//!
//! Each figure is written as SVG, PNG and CSV, and all of them with what was found stand in one page that needs no other file.
//! Everything is done by [`mckibben_run::reproduce`]. Checked by `tests/reproduce.rs`.

use crate::terminal;
use mckibben_run::failure::Failure;
use mckibben_run::reproduce;
use std::path::PathBuf;

/// Arguments of `mckibben reproduce`.
#[derive(Clone, Debug, clap::Args)]
pub struct ReproduceArguments {
    /// The folder for the report; it is made if it is not there
    #[arg(short, long, value_name = "DIR", default_value = "reproduction")]
    pub output: PathBuf,
}

/// Runs the paper's experiments and writes the report.
///
/// # Errors
/// When the folder or a file in it cannot be written, or an experiment cannot go on.
pub fn run(arguments: &ReproduceArguments) -> Result<(), Failure> {
    // That the folder cannot be made is known before any work is done.
    let folder = &arguments.output;
    std::fs::create_dir_all(folder).map_err(|error| Failure::output(folder, error))?;
    let report = reproduce::report()?;
    let page = report.write(folder)?;
    terminal::print(&format!("{}\n{}", report.summary(), terminal::wrote(&page, "")))
}
