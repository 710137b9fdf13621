//! `mckibben init`: writes a scenario file to start from.

use crate::terminal;
use mckibben_run::failure::Failure;
use mckibben_run::{output, units};
use mckibben_scenario::Starter;
use std::path::{Path, PathBuf};

/// Arguments of `mckibben init`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben init                     write scenario.toml
  mckibben init muscle.toml         write muscle.toml
  mckibben init --minimal --metric  the shortest file, in mm, bar and kg
  mckibben init --units metric      the same units as with --metric
  mckibben init - | less            look at it first

Exit codes: 0 done; 2 the file is there already; 4 it could not be written.")]
pub struct InitArguments {
    /// The file to write; `-` for standard output.
    #[arg(value_name = "FILE", default_value = "scenario.toml")]
    pub file: PathBuf,
    /// Write only the keys that are in force; without it every other key stands as a comment.
    #[arg(long)]
    pub minimal: bool,
    /// Write metric quantities, as with --units metric or si; without it they are in the units of the paper.
    #[arg(long)]
    pub metric: bool,
    /// Replace a file that is there already.
    #[arg(short, long)]
    pub force: bool,
}

/// Writes the file.
///
/// # Errors
/// [`Failure::input`] when the file exists; [`Failure::output`] when it cannot be written.
pub fn run(arguments: &InitArguments) -> Result<(), Failure> {
    let metric = arguments.metric || units::is_metric_chosen();
    let text = Starter { minimal: arguments.minimal, metric }.text();
    let path = arguments.file.as_path();
    if path == Path::new("-") {
        return terminal::print(&text);
    }
    if !arguments.force && path.symlink_metadata().is_ok() {
        return Err(Failure::input(
            format!("`{}` is there already", path.display()),
            "give another name, or --force to replace it",
        ));
    }
    output::write(path, text.as_bytes())?;
    let shown = path.display();
    let next = format!("next: mckibben simulate {shown} --output run.csv --plot run.svg\n");
    terminal::print(&(terminal::wrote(path, "") + &next))
}
