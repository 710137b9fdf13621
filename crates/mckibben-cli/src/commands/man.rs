//! `mckibben man`: the manual pages.

use crate::arguments::Arguments;
use crate::terminal;
use clap::CommandFactory as _;
use clap_mangen::Man;
use mckibben_run::failure::Failure;
use std::path::Path;

/// Arguments of `mckibben man`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben man | man -l -
  mckibben man sweep > ~/.local/share/man/man1/mckibben-sweep.1

Exit codes: 0 done; 2 there is no such command.")]
pub struct ManArguments {
    /// The command whose page is printed; without it, that of the program.
    #[arg(value_name = "COMMAND")]
    pub command: Option<String>,
}

/// Prints a page.
///
/// # Errors
/// [`Failure::input`] for a command that there is not; [`Failure::output`] when the page cannot be printed.
pub fn run(arguments: &ManArguments) -> Result<(), Failure> {
    let mut program = Arguments::command();
    program.build();
    let page = match &arguments.command {
        None => program,
        Some(name) => match program.find_subcommand(name) {
            Some(command) => command.clone().display_name(format!("mckibben-{name}")),
            None => {
                let known: Vec<&str> = program.get_subcommands().map(clap::Command::get_name).collect();
                let title = format!("there is no command `{name}`");
                return Err(Failure::input(title, format!("known: {}", known.join(", "))));
            }
        },
    };
    let mut text = Vec::new();
    let source = concat!("mckibben ", env!("CARGO_PKG_VERSION"));
    let made = Man::new(page).source(source).render(&mut text);
    made.map_err(|error| Failure::output(Path::new("standard output"), error))?;
    terminal::print(&String::from_utf8_lossy(&text))
}
