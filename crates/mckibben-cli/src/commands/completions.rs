//! `mckibben completions`: scripts that let a shell complete commands and options.

use crate::arguments::Arguments;
use crate::terminal;
use clap::CommandFactory as _;
use clap_complete::Shell;
use mckibben_run::failure::Failure;

/// What `mckibben completions` is asked.
#[derive(Clone, Copy, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben completions bash > ~/.local/share/bash-completion/completions/mckibben
  mckibben completions zsh > ~/.zfunc/_mckibben
  mckibben completions fish > ~/.config/fish/completions/mckibben.fish")]
pub struct CompletionsArguments {
    /// The shell.
    #[arg(value_enum)]
    pub shell: Shell,
}

/// Prints the script.
///
/// # Errors
/// [`Failure::output`] when it cannot be printed.
pub fn run(arguments: &CompletionsArguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "mckibben", &mut script);
    terminal::print(&String::from_utf8_lossy(&script))
}
